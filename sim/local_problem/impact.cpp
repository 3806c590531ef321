#include "sim/local_problem/impact.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "sim/local_problem/one_contact.h"

namespace gonogo::sim {
namespace {

/// Friction impulse of the restitution phase: the t in |t| <= bound for which v + A_tt t vanishes or opposes t. With t
/// =
/// -(A_tt + lambda)^-1 v the length falls with lambda: a bracketed root. size: 1 or 2; a: the contact's block, row
/// major.
std::array<double, 2> friction_within(const double* a, int dimension, const std::array<double, 2>& v, double bound) {
  const int size = dimension - 1;
  const auto at = [&](double lambda) -> std::array<double, 2> {
    if (size == 1) return {-v[0] / (a[3] + lambda), 0};
    const double xx = a[4] + lambda, xy = a[5], yx = a[7], yy = a[8] + lambda, det = xx * yy - xy * yx;
    return {-(yy * v[0] - xy * v[1]) / det, -(xx * v[1] - yx * v[0]) / det};
  };
  const auto length = [&](double lambda) {
    const auto t = at(lambda);
    return std::hypot(t[0], t[1]);
  };
  const double speed = std::hypot(v[0], v[1]);
  if (!(speed > 0) || !(bound > 0)) return {0, 0};
  if (length(0) <= bound) return at(0);
  double low = 0, high = speed / bound;  // A_tt is positive semidefinite: the length is at most speed / lambda
  for (int k = 0; k < 200 && high - low > 1e-16 * high; ++k) {
    const double middle = (low + high) / 2;
    (length(middle) > bound ? low : high) = middle;
  }
  return at(high);
}

class Impacts {
 public:
  Impacts(const LocalProblem& p, const ImpactSettings& settings) : p_(p), settings_(settings) {
    result_.r.assign(p.q.size(), 0.0);
    result_.u = p.q;
    list_reached();
  }

  /// The contact that approaches fastest, -1 for none above the tolerance.
  Index fastest() const {
    Index found = -1;
    double speed = settings_.tolerance;
    for (Index i = 0; i < p_.contact_count(); ++i)
      if (const double approach = -result_.u[at(i)]; approach > speed) {
        speed = approach;
        found = i;
      }
    return found;
  }

  void strike(Index i) {
    const double* const a = p_.diagonal_block(i);
    const double* const u = result_.u.data() + at(i);
    const double e = -u[0] > settings_.resting_speed ? settings_.restitution : 0;
    std::array<double, 3> dr{}, b{}, before{};
    std::copy_n(u, p_.dimension, before.begin());
    b = before;
    if (settings_.law == ImpactLaw::newton) b[0] *= 1 + e;
    solve_one_contact(p_, i, Target::coulomb, a, b.data(), dr.data());
    if (settings_.law == ImpactLaw::poisson && e > 0) restore(i, e, before, dr);
    add(i, dr);
    for (int row = 0; row < p_.dimension; ++row)
      result_.energy_gain += dr[row] * (before[row] + result_.u[at(i) + std::size_t(row)]) / 2;
    ++result_.strikes;
  }

  ImpactResult& result() { return result_; }

 private:
  std::size_t at(Index i) const { return std::size_t(i) * p_.dimension; }

  /// Adds the second phase to the impulse dr of the first.
  void restore(Index i, double e, const std::array<double, 3>& before, std::array<double, 3>& dr) const {
    const int d = p_.dimension;
    const double* const a = p_.diagonal_block(i);
    const double normal = e * dr[0];
    std::array<double, 2> slip{};
    for (int row = 1; row < d; ++row) {
      slip[row - 1] = before[row] + a[row * d] * normal;
      for (int column = 0; column < d; ++column) slip[row - 1] += a[row * d + column] * dr[column];
    }
    const auto friction = friction_within(a, d, slip, p_.mu[i] * normal);
    dr[0] += normal;
    for (int row = 1; row < d; ++row) dr[row] += friction[row - 1];
  }

  void add(Index i, const std::array<double, 3>& dr) {
    const int d = p_.dimension;
    for (int row = 0; row < d; ++row) result_.r[at(i) + std::size_t(row)] += dr[row];
    for (const auto& [contact, block] : reached_[i])
      for (int row = 0; row < d; ++row)
        for (int column = 0; column < d; ++column)
          result_.u[at(contact) + std::size_t(row)] +=
              p_.w.value[block * std::size_t(d * d) + std::size_t(row * d + column)] * dr[column];
  }

  /// Blocks of W by column: the contacts that feel a strike.
  void list_reached() {
    reached_.resize(p_.mu.size());
    for (Index i = 0; i < p_.contact_count(); ++i)
      for (Index k = p_.w.first[i]; k < p_.w.first[i + 1]; ++k)
        reached_[std::size_t(p_.w.column[k])].emplace_back(i, std::size_t(k));
  }

  const LocalProblem& p_;
  const ImpactSettings& settings_;
  std::vector<std::vector<std::pair<Index, std::size_t>>> reached_;
  ImpactResult result_;
};

}  // namespace

ImpactResult sequential_impacts(const LocalProblem& problem, const ImpactSettings& settings) {
  if (problem.dimension == 5)
    throw InputError(problem.name +
                     ": impacts with rolling friction are not possible; take a problem of dimension 2 or 3");
  if (!(settings.restitution >= 0 && settings.restitution <= 1))
    throw InputError("restitution = " + number_text(settings.restitution) + "; a number from 0 to 1 is needed");
  if (!(settings.tolerance > 0) || !(settings.resting_speed >= 0))
    throw InputError("tolerance and resting speed of impacts must be above 0, and 0 or more");
  Impacts impacts(problem, settings);
  ImpactResult& result = impacts.result();
  while (result.strikes < settings.max_strikes) {
    const Index i = impacts.fastest();
    if (i < 0) break;
    impacts.strike(i);
  }
  result.ended = impacts.fastest() < 0;
  return result;
}

}  // namespace gonogo::sim
