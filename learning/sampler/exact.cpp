#include "learning/sampler/exact.h"

#include <algorithm>
#include <cmath>

#include "base/cancel.h"
#include "base/error.h"
#include "base/random.h"
#include "learning/sampler/bipartite.h"
#include "learning/sampler/junction_tree.h"
#include "learning/sampler/spins.h"

namespace gonogo::learning {
namespace {

double softplus(double x) { return std::max(x, 0.0) + std::log1p(std::exp(-std::abs(x))); }
double sigmoid(double x) { return 1 / (1 + std::exp(-x)); }

/// The enumerated variables (`outer`) and the ones that are independent given them (`inner`).
class Enumeration {
 public:
  explicit Enumeration(const Problem& qubo) : qubo_(qubo) {
    if (const auto sides = split_in_two(qubo)) {
      const bool left = sides->left.size() <= sides->right.size();
      outer_ = left ? sides->left : sides->right;
      inner_ = left ? sides->right : sides->left;
    } else {
      for (std::uint32_t i = 0; i < qubo.variable_count(); ++i) outer_.push_back(i);
    }
    GONOGO_ASSERT(outer_.size() <= kMaxEnumerated);
    fill();
  }

  std::size_t state_count() const { return std::size_t(1) << outer_.size(); }
  double log_z() const { return log_z_; }
  /// Probability of a state of the outer variables.
  double probability(std::size_t state) const { return std::exp(log_weight_[state] - log_z_); }

  /// Fields of the inner variables in a state: P(inner j = 1 | state) = sigmoid(field[j]).
  void fields(std::size_t state, std::vector<double>& field) const {
    field = inner_bias_;
    for (std::size_t i = 0; i < outer_.size(); ++i) {
      if (!(state >> i & 1)) continue;
      for (std::size_t j = 0; j < inner_.size(); ++j) field[j] += weight_[i * inner_.size() + j];
    }
  }
  const std::vector<std::uint32_t>& outer() const { return outer_; }
  const std::vector<std::uint32_t>& inner() const { return inner_; }

 private:
  void fill() {
    std::vector<std::int64_t> place(qubo_.variable_count(), -1);
    for (std::size_t i = 0; i < outer_.size(); ++i) place[outer_[i]] = std::int64_t(i);
    std::vector<std::size_t> inner_place(qubo_.variable_count());
    for (std::size_t j = 0; j < inner_.size(); ++j) {
      inner_place[inner_[j]] = j;
      inner_bias_.push_back(-qubo_.linear[inner_[j]]);
    }
    weight_.assign(outer_.size() * inner_.size(), 0);
    std::vector<Coupling> among_outer;
    for (const Coupling& c : qubo_.couplings) {
      if (place[c.a] >= 0 && place[c.b] >= 0)
        among_outer.push_back({std::uint32_t(place[c.a]), std::uint32_t(place[c.b]), c.value});
      else if (place[c.a] >= 0)
        weight_[std::size_t(place[c.a]) * inner_.size() + inner_place[c.b]] = -c.value;
      else
        weight_[std::size_t(place[c.b]) * inner_.size() + inner_place[c.a]] = -c.value;
    }
    log_weight_.resize(state_count());
    std::vector<double> field;
    double highest = -INFINITY;
    for (std::size_t state = 0; state < state_count(); ++state) {
      if (state % 65536 == 0) stop_if_cancelled();
      double value = -qubo_.offset;
      for (std::size_t i = 0; i < outer_.size(); ++i)
        if (state >> i & 1) value -= qubo_.linear[outer_[i]];
      for (const Coupling& c : among_outer)
        if ((state >> c.a & 1) && (state >> c.b & 1)) value -= c.value;
      fields(state, field);
      for (double f : field) value += softplus(f);
      log_weight_[state] = value;
      highest = std::max(highest, value);
    }
    double sum = 0;
    for (double value : log_weight_) sum += std::exp(value - highest);
    log_z_ = highest + std::log(sum);
  }

  const Problem& qubo_;
  std::vector<std::uint32_t> outer_, inner_;
  std::vector<double> weight_;  // [outer x inner]
  std::vector<double> inner_bias_, log_weight_;
  double log_z_ = 0;
};

/// Moments in {0, 1} to moments in {-1, +1}.
void to_spin_moments(const Problem& problem, ExactMoments& moments) {
  for (std::size_t k = 0; k < problem.couplings.size(); ++k) {
    const Coupling& c = problem.couplings[k];
    moments.pair_mean[k] = 4 * moments.pair_mean[k] - 2 * moments.mean[c.a] - 2 * moments.mean[c.b] + 1;
  }
  for (double& mean : moments.mean) mean = 2 * mean - 1;
}

bool can_enumerate(const Problem& problem) {
  const auto sides = split_in_two(to_qubo(problem));
  return (sides ? std::min(sides->left.size(), sides->right.size()) : problem.variable_count()) <= kMaxEnumerated;
}

SampleSet draw_from_tree(const Problem& problem, const SampleRequest& request) {
  const JunctionTree tree(problem);
  SampleSet rows = empty_rows(problem, request.reads);
  for (std::size_t r = 0; r < request.reads; ++r) set_row(rows, r, problem, tree.draw(request.seed, r));
  return rows;
}

}  // namespace

ExactMoments exact_moments(const Problem& problem) {
  if (!can_enumerate(problem)) return JunctionTree(problem).moments();
  const Problem qubo = to_qubo(problem);
  const Enumeration all(qubo);
  ExactMoments moments;
  moments.log_z = all.log_z();
  moments.mean.assign(qubo.variable_count(), 0);
  moments.pair_mean.assign(qubo.couplings.size(), 0);
  std::vector<double> field, chance(qubo.variable_count());
  for (std::size_t state = 0; state < all.state_count(); ++state) {
    const double p = all.probability(state);
    all.fields(state, field);
    for (std::size_t i = 0; i < all.outer().size(); ++i) chance[all.outer()[i]] = double(state >> i & 1);
    for (std::size_t j = 0; j < all.inner().size(); ++j) chance[all.inner()[j]] = sigmoid(field[j]);
    for (std::size_t i = 0; i < chance.size(); ++i) moments.mean[i] += p * chance[i];
    for (std::size_t k = 0; k < qubo.couplings.size(); ++k)
      moments.pair_mean[k] += p * chance[qubo.couplings[k].a] * chance[qubo.couplings[k].b];
  }
  if (problem.vartype == Vartype::spin) to_spin_moments(qubo, moments);
  return moments;
}

SampleSet ExactSampler::sample(const Problem& problem, const SampleRequest& request) const {
  if (!can_enumerate(problem)) return draw_from_tree(problem, request);
  const Problem qubo = to_qubo(problem);
  const Enumeration all(qubo);
  std::vector<double> cumulative(all.state_count());
  double sum = 0;
  for (std::size_t state = 0; state < cumulative.size(); ++state) cumulative[state] = sum += all.probability(state);
  const std::size_t n = problem.variable_count();
  const std::int8_t off = problem.vartype == Vartype::binary ? 0 : -1;
  SampleSet result;
  result.vartype = problem.vartype;
  result.labels = problem.labels;
  result.values.assign(request.reads * n, off);
  result.occurrences.assign(request.reads, 1);
  std::vector<double> field;
  for (std::size_t read = 0; read < request.reads; ++read) {
    const auto row = std::span(result.values).subspan(read * n, n);
    const double u = random_unit(request.seed, read, 0) * sum;
    const auto found = std::upper_bound(cumulative.begin(), cumulative.end() - 1, u);
    const std::size_t state = std::size_t(found - cumulative.begin());
    for (std::size_t i = 0; i < all.outer().size(); ++i)
      if (state >> i & 1) row[all.outer()[i]] = 1;
    all.fields(state, field);
    for (std::size_t j = 0; j < all.inner().size(); ++j)
      if (random_unit(request.seed, read, j + 1) < sigmoid(field[j])) row[all.inner()[j]] = 1;
    result.energies.push_back(energy(problem, row));
  }
  return result;
}

}  // namespace gonogo::learning
