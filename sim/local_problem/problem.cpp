#include "sim/local_problem/problem.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace gonogo::sim {
namespace {

[[noreturn]] void fail(const std::string& name, const std::string& message) { throw InputError(name + ": " + message); }

void require_length(const std::string& name, const std::string& what, std::size_t length, std::size_t needed) {
  if (length != needed)
    fail(name, what + " has " + std::to_string(length) + " values, " + std::to_string(needed) + " are needed");
}

void require_finite(const std::string& name, const std::string& what, const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]))
      fail(name, what + "[" + std::to_string(i) + "] = " + std::to_string(values[i]) + "; a finite number is needed");
}

void require_coefficients(const std::string& name, const std::string& what, const std::vector<double>& values) {
  require_finite(name, what, values);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (values[i] < 0)
      fail(name, what + "[" + std::to_string(i) + "] = " + std::to_string(values[i]) + "; it must be 0 or more");
}

void check(const LocalProblem& p) {
  if (p.dimension != 2 && p.dimension != 3 && p.dimension != 5)
    fail(p.name, "spacedim = " + std::to_string(p.dimension) + "; 2, 3 or 5 (with rolling) are possible");
  if (p.mu.empty()) fail(p.name, "mu is empty; at least one contact is needed");
  require_length(p.name, "q", p.q.size(), p.mu.size() * std::size_t(p.dimension));
  require_length(p.name, "mu_r", p.mu_roll.size(), p.dimension == 5 ? p.mu.size() : 0);
  require_finite(p.name, "q", p.q);
  require_coefficients(p.name, "mu", p.mu);
  require_coefficients(p.name, "mu_r", p.mu_roll);
}

void check_entries(const LocalProblem& p, const std::vector<Triplet>& w) {
  const Index rows = Index(p.q.size());
  for (const Triplet& t : w) {
    const std::string place = "W(" + std::to_string(t.row) + ", " + std::to_string(t.column) + ")";
    if (t.row < 0 || t.row >= rows || t.column < 0 || t.column >= rows)
      fail(p.name, place + " lies outside the matrix of " + std::to_string(rows) + " rows");
    if (!std::isfinite(t.value)) fail(p.name, place + " = " + std::to_string(t.value) + "; a finite number is needed");
  }
}

/// Block positions in order, the diagonal always among them.
std::vector<std::pair<Index, Index>> block_positions(const LocalProblem& p, const std::vector<Triplet>& w) {
  std::vector<std::pair<Index, Index>> position;
  for (Index i = 0; i < p.contact_count(); ++i) position.emplace_back(i, i);
  for (const Triplet& t : w)
    if (t.value != 0) position.emplace_back(t.row / p.dimension, t.column / p.dimension);
  std::sort(position.begin(), position.end());
  position.erase(std::unique(position.begin(), position.end()), position.end());
  return position;
}

void fill_blocks(LocalProblem& p, const std::vector<Triplet>& w) {
  const auto position = block_positions(p, w);
  const int d = p.dimension;
  p.w.first.assign(p.mu.size() + 1, 0);
  p.w.value.assign(position.size() * std::size_t(d * d), 0);
  p.diagonal.assign(p.mu.size(), 0);
  for (std::size_t k = 0; k < position.size(); ++k) {
    const auto [row, column] = position[k];
    p.w.column.push_back(column);
    p.w.first[row + 1] = Index(k + 1);
    if (row == column) p.diagonal[row] = k;
  }
  for (const Triplet& t : w) {
    if (t.value == 0) continue;
    const auto at = std::lower_bound(position.begin(), position.end(), std::pair(t.row / d, t.column / d));
    p.w.value[std::size_t(at - position.begin()) * d * d + (t.row % d) * d + t.column % d] += t.value;
  }
}

}  // namespace

LocalProblem make_problem(const std::string& name, int dimension, const std::vector<Triplet>& w, std::vector<double> q,
                          std::vector<double> mu, std::vector<double> mu_roll) {
  LocalProblem p;
  p.name = name;
  p.dimension = dimension;
  p.q = std::move(q);
  p.mu = std::move(mu);
  p.mu_roll = std::move(mu_roll);
  check(p);
  check_entries(p, w);
  fill_blocks(p, w);
  for (Index i = 0; i < p.contact_count(); ++i)
    if (const double w_nn = p.diagonal_block(i)[0]; !(w_nn > 0))
      fail(name, "contact " + std::to_string(i) + " has W_nn = " + std::to_string(w_nn) +
                     "; it must be positive (a body at the contact must be able to move)");
  return p;
}

void contact_velocity(const LocalProblem& problem, const std::vector<double>& r, Index contact, double* u) {
  const int d = problem.dimension;
  for (int a = 0; a < d; ++a) u[a] = problem.q[std::size_t(contact) * d + a];
  for (Index k = problem.w.first[contact]; k < problem.w.first[contact + 1]; ++k) {
    const double* const block = problem.w.value.data() + std::size_t(k) * d * d;
    const double* const rk = r.data() + std::size_t(problem.w.column[k]) * d;
    for (int a = 0; a < d; ++a)
      for (int b = 0; b < d; ++b) u[a] += block[a * d + b] * rk[b];
  }
}

std::vector<double> velocity(const LocalProblem& problem, const std::vector<double>& r) {
  if (!problem.is_whole) return velocity_by_bodies(problem, r);
  std::vector<double> u(problem.q.size());
  for (Index i = 0; i < problem.contact_count(); ++i)
    contact_velocity(problem, r, i, u.data() + std::size_t(i) * problem.dimension);
  return u;
}

namespace {

/// motion += B^T dr for the rows of one contact. D: rows of a contact.
template <int D>
void push(const BodyForm::Contact& c, const double* dr, std::vector<double>& motion) {
  for (int k = 0; k < 2; ++k) {
    if (c.body[k] < 0) continue;
    double* const y = motion.data() + std::size_t(c.body[k]) * BodyForm::kFreedoms;
    for (int a = 0; a < D; ++a)
      for (int f = 0; f < BodyForm::kFreedoms; ++f) y[f] += c.row[k][a][f] * dr[a];
  }
}
void push(const LocalProblem& p, Index contact, const double* dr, std::vector<double>& motion) {
  const BodyForm::Contact& c = p.bodies->contact[std::size_t(contact)];
  p.dimension == 3 ? push<3>(c, dr, motion) : push<5>(c, dr, motion);
}

/// Rows of B motion + q of one contact.
template <int D>
void read(const BodyForm::Contact& c, const double* q, const std::vector<double>& motion, double* u) {
  std::copy_n(q, D, u);
  for (int k = 0; k < 2; ++k) {
    if (c.body[k] < 0) continue;
    const double* const y = motion.data() + std::size_t(c.body[k]) * BodyForm::kFreedoms;
    for (int a = 0; a < D; ++a)
      for (int f = 0; f < BodyForm::kFreedoms; ++f) u[a] += c.row[k][a][f] * y[f];
  }
}
void read(const LocalProblem& p, Index contact, const std::vector<double>& motion, double* u) {
  const BodyForm::Contact& c = p.bodies->contact[std::size_t(contact)];
  const double* const q = p.q.data() + std::size_t(contact) * p.dimension;
  p.dimension == 3 ? read<3>(c, q, motion, u) : read<5>(c, q, motion, u);
}

}  // namespace

std::vector<double> body_motion(const LocalProblem& problem, const std::vector<double>& r) {
  std::vector<double> motion(std::size_t(problem.bodies->body_count) * BodyForm::kFreedoms, 0.0);
  for (Index i = 0; i < problem.contact_count(); ++i)
    push(problem, i, r.data() + std::size_t(i) * problem.dimension, motion);
  return motion;
}

std::vector<double> velocity_by_bodies(const LocalProblem& problem, const std::vector<double>& r) {
  const std::vector<double> motion = body_motion(problem, r);
  std::vector<double> u(problem.q.size());
  for (Index i = 0; i < problem.contact_count(); ++i)
    read(problem, i, motion, u.data() + std::size_t(i) * problem.dimension);
  return u;
}

ContactVelocities::ContactVelocities(const LocalProblem& problem, const std::vector<double>& r)
    : problem_(problem), r_(r) {
  if (!problem.is_whole) motion_ = body_motion(problem, r);
}

void ContactVelocities::at(Index contact, double* u) const {
  problem_.is_whole ? contact_velocity(problem_, r_, contact, u) : read(problem_, contact, motion_, u);
}

void ContactVelocities::changed(Index contact, const double* before) {
  if (problem_.is_whole) return;
  double dr[5];
  for (int a = 0; a < problem_.dimension; ++a) dr[a] = r_[std::size_t(contact) * problem_.dimension + a] - before[a];
  push(problem_, contact, dr, motion_);
}

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
