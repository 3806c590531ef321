#include "sim/local_problem/faceted.h"

#include <numbers>

namespace gonogo::sim {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Entry = Eigen::Triplet<double>;
using Entries = std::vector<Entry>;

}  // namespace

FacetedProblem::FacetedProblem(const LocalProblem& problem, Target target, int facets)
    : p_(problem), target_(target), facets_(facets), of_(problem) {
  lay_out();
  make_generators();
}

Eigen::Vector2d FacetedProblem::direction(const Polygon& polygon, int j) const {
  if (polygon.size == 1) return {j == 0 ? 1 : -1, 0};
  const double angle = 2 * std::numbers::pi * j / facets_;
  return {std::cos(angle), std::sin(angle)};
}

void FacetedProblem::lay_out() {
  Entries entry;
  Index next = 0;
  for (Index i = 0; i < p_.contact_count(); ++i) {
    const Index normal = i * p_.dimension, x_normal = next++;
    x_normal_.push_back(x_normal);
    entry.emplace_back(normal, x_normal, 1);
    for (int d = 0; d < p_.disc_count(); ++d) {
      if (!(p_.coefficient(int(i), d) > 0)) continue;
      Polygon polygon{.normal = normal, .x_normal = x_normal, .x = next};
      polygon.first = p_.disc(d).first;
      polygon.size = p_.disc(d).size;
      polygon.c = p_.coefficient(int(i), d);
      for (int j = 0; j < directions(polygon); ++j, ++next)
        for (int a = 0; a < polygon.size; ++a)
          entry.emplace_back(normal + polygon.first + a, next, direction(polygon, j)[a]);
      polygon.lambda = next++;
      polygons_.push_back(polygon);
    }
  }
  rays_.resize(of_.q.size(), next);
  rays_.setFromTriplets(entry.begin(), entry.end());
}

void FacetedProblem::make_generators() {
  Entries ray, split;
  Index next = 0;
  std::size_t k = 0;
  for (Index i = 0; i < p_.contact_count(); ++i) {
    const Index normal = i * p_.dimension;
    std::vector<const Polygon*> of_contact;
    for (; k < polygons_.size() && polygons_[k].normal == normal; ++k) of_contact.push_back(&polygons_[k]);
    int count = 1;  // one generator per choice of a direction on every disc
    for (const Polygon* polygon : of_contact) count *= directions(*polygon);
    for (int choice = 0; choice < count; ++choice, ++next) {
      ray.emplace_back(normal, next, 1);
      split.emplace_back(x_normal_[std::size_t(i)], next, 1);
      int rest = choice;
      for (const Polygon* polygon : of_contact) {
        const int j = rest % directions(*polygon);
        rest /= directions(*polygon);
        split.emplace_back(polygon->x + j, next, polygon->c);
        for (int a = 0; a < polygon->size; ++a)
          ray.emplace_back(normal + polygon->first + a, next, polygon->c * direction(*polygon, j)[a]);
      }
    }
  }
  generators_.resize(of_.q.size(), next);
  generators_.setFromTriplets(ray.begin(), ray.end());
  split_.resize(rays_.cols(), next);
  split_.setFromTriplets(split.begin(), split.end());
}

Lcp FacetedProblem::multiplier_form() const {
  Entries entry;
  for (const Polygon& polygon : polygons_) {
    for (int j = 0; j < directions(polygon); ++j) {
      entry.emplace_back(polygon.x + j, polygon.lambda, 1);
      entry.emplace_back(polygon.lambda, polygon.x + j, -1);
    }
    entry.emplace_back(polygon.lambda, polygon.x_normal, polygon.c);
    if (target_ == Target::ccp) entry.emplace_back(polygon.x_normal, polygon.lambda, -polygon.c);
  }
  Eigen::SparseMatrix<double> law(rays_.cols(), rays_.cols());
  law.setFromTriplets(entry.begin(), entry.end());
  const Eigen::SparseMatrix<double> image = of_.w * rays_;
  return {Eigen::SparseMatrix<double>(Eigen::SparseMatrix<double>(rays_.transpose() * image) + law),
          rays_.transpose() * of_.q};
}

Lcp FacetedProblem::generator_form() const {
  const Eigen::SparseMatrix<double> image = of_.w * generators_;
  return {Eigen::SparseMatrix<double>(generators_.transpose() * image), generators_.transpose() * of_.q};
}

double FacetedProblem::facet_speed(const Polygon& polygon, const VectorXd& u) const {
  double fastest = 0;
  for (int j = 0; j < directions(polygon); ++j) {
    double along = 0;
    for (int a = 0; a < polygon.size; ++a) along += direction(polygon, j)[a] * u[polygon.normal + polygon.first + a];
    fastest = std::max(fastest, -along);
  }
  return fastest;
}

VectorXd FacetedProblem::slip_shift(const VectorXd& r) const {
  VectorXd shift = VectorXd::Zero(of_.q.size());
  if (target_ == Target::coulomb) {
    const VectorXd u = of_.w * r + of_.q;
    for (const Polygon& polygon : polygons_) shift[polygon.normal] += polygon.c * facet_speed(polygon, u);
  }
  return generators_.transpose() * shift;
}

VectorXd FacetedProblem::multipliers_of(const VectorXd& gamma) const {
  VectorXd x = split_ * gamma;
  const VectorXd r = generators_ * gamma, u = of_.w * r + of_.q;
  for (const Polygon& polygon : polygons_) x[polygon.lambda] = facet_speed(polygon, u);
  return x;
}

bool FacetedProblem::is_symmetric() const {
  constexpr double kRounding = 1e-12;
  return (of_.w - Eigen::SparseMatrix<double>(of_.w.transpose())).norm() <= kRounding * of_.w.norm();
}

}  // namespace gonogo::sim
