#include "sim/local_problem/residual.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gonogo::sim {
namespace {

double norm(const double* values, int count) {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += values[i] * values[i];
  return std::sqrt(sum);
}

double norm(const std::vector<double>& values) {
  double sum = 0;
  for (const double x : values) sum += x * x;
  return std::sqrt(sum);
}

/// The n that minimises over those discs which `clipped` says are on their bound.
double normal_with(const LocalProblem& problem, Index contact, double p_n, const double* length, const bool* clipped) {
  double sum = p_n, weight = 1;
  for (int d = 0; d < problem.disc_count(); ++d) {
    const double c = problem.coefficient(contact, d);
    sum += clipped[d] ? c * length[d] : 0;
    weight += clipped[d] ? c * c : 0;
  }
  return sum / weight;
}

}  // namespace

void project_onto_cone(const LocalProblem& problem, Index contact, double* p) {
  const int discs = problem.disc_count();
  double length[2] = {0, 0};
  for (int d = 0; d < discs; ++d) length[d] = norm(p + problem.disc(d).first, problem.disc(d).size);
  // The squared distance is convex and piecewise quadratic in n. A disc is clipped below n = |p_d| / c_d; growing the
  // set of clipped discs by one at a time until none outside it needs clipping finds the piece of the minimum.
  bool clipped[2] = {false, false};
  double n = p[0];
  for (int round = 0; round <= discs; ++round) {
    n = normal_with(problem, contact, p[0], length, clipped);
    int worst = -1;
    for (int d = 0; d < discs; ++d) {
      const bool outside = !clipped[d] && length[d] > problem.coefficient(contact, d) * n;
      if (outside && (worst < 0 || length[d] * problem.coefficient(contact, worst) >
                                       length[worst] * problem.coefficient(contact, d)))
        worst = d;
    }
    if (worst < 0) break;
    clipped[worst] = true;
  }
  n = std::max(n, 0.0);
  p[0] = n;
  for (int d = 0; d < discs; ++d) {
    const double bound = problem.coefficient(contact, d) * n;
    const double scale = length[d] > bound ? bound / length[d] : 1;
    for (int a = 0; a < problem.disc(d).size; ++a) p[problem.disc(d).first + a] *= scale;
  }
}

double de_saxce_term(const LocalProblem& problem, Index contact, const double* u) {
  double sum = 0;
  for (int d = 0; d < problem.disc_count(); ++d)
    sum += problem.coefficient(contact, d) * norm(u + problem.disc(d).first, problem.disc(d).size);
  return sum;
}

double siconos_error(const LocalProblem& problem, const std::vector<double>& r, Target target) {
  return siconos_error(problem, r, velocity(problem, r), target);
}

double siconos_error(const LocalProblem& problem, const std::vector<double>& r, const std::vector<double>& u,
                     Target target) {
  const int dimension = problem.dimension;
  double sum = 0;
  for (Index i = 0; i < problem.contact_count(); ++i) {
    const double* const ri = r.data() + std::size_t(i) * dimension;
    const double* const ui = u.data() + std::size_t(i) * dimension;
    std::array<double, 5> p{};
    for (int a = 0; a < dimension; ++a) p[a] = ri[a] - ui[a];
    if (target == Target::coulomb) p[0] -= de_saxce_term(problem, i, ui);
    project_onto_cone(problem, i, p.data());
    for (int a = 0; a < dimension; ++a) sum += (ri[a] - p[a]) * (ri[a] - p[a]);
  }
  const double scale = std::max({norm(problem.q), norm(r), norm(u)});
  return scale > 0 ? std::sqrt(sum) / scale : std::sqrt(sum);
}

}  // namespace gonogo::sim
