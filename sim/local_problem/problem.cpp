#include "sim/local_problem/problem.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "sim/local_problem/body_form.h"

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

}  // namespace gonogo::sim
