#include "learning/sampler/exact.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/math/random.h"
#include "base/progress.h"
#include "learning/model/weights.h"
#include "learning/sampler/chains/bipartite.h"
#include "learning/sampler/chains/spins.h"

namespace gonogo::learning {
namespace {

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

namespace {

SampleSet sample_exactly(const Problem& problem, const SampleRequest& request, const SamplerSettings&) {
  if (!can_enumerate(problem)) return draw_from_tree(problem, request);
  const Problem qubo = to_qubo(problem);
  const Enumeration all(qubo);
  std::vector<double> cumulative(all.state_count());
  double sum = 0;
  for (std::size_t state = 0; state < cumulative.size(); ++state) cumulative[state] = sum += all.probability(state);
  const std::size_t n = problem.variable_count();
  const std::int8_t off = problem.vartype == Vartype::binary ? 0 : -1;
  SampleSet result = empty_rows(problem, request.reads);
  std::fill(result.values.begin(), result.values.end(), off);
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
    result.energies[read] = energy(problem, row);
  }
  return result;
}

}  // namespace

extern const SamplerKind kExact = {.name = "exact",
                                   .title = "Exact",
                                   .about = "Independent samples of small problems and of those of low treewidth.",
                                   .sample = sample_exactly};

namespace {

double log_sum(double x, double y) {
  const double high = std::max(x, y);
  return high + std::log1p(std::exp(std::min(x, y) - high));
}

double spin(std::size_t state, std::size_t bit) { return state >> bit & 1 ? 1 : -1; }

/// Bit of each of `part` in the table of `bucket_variable` and `rest`.
std::vector<std::size_t> places(const std::vector<std::uint32_t>& part, std::uint32_t variable,
                                const std::vector<std::uint32_t>& rest) {
  std::vector<std::size_t> result;
  for (std::uint32_t v : part)
    result.push_back(v == variable ? 0 : 1 + std::size_t(std::find(rest.begin(), rest.end(), v) - rest.begin()));
  return result;
}

/// Bits of `state` at `place`, packed.
std::size_t gather(std::size_t state, const std::vector<std::size_t>& place) {
  std::size_t result = 0;
  for (std::size_t k = 0; k < place.size(); ++k) result |= (state >> place[k] & 1) << k;
  return result;
}

}  // namespace

JunctionTree::JunctionTree(const Problem& problem) : problem_(problem) {
  const Problem ising = to_ising(problem);
  order(ising);
  eliminate(ising);
}

std::size_t JunctionTree::width() const {
  std::size_t width = 0;
  for (const Bucket& bucket : buckets_) width = std::max(width, bucket.rest.size());
  return width;
}

void JunctionTree::order(const Problem& ising) {
  const std::size_t n = ising.variable_count();
  std::vector<std::set<std::uint32_t>> neighbours(n);
  for (const Coupling& c : ising.couplings) {
    neighbours[c.a].insert(c.b);
    neighbours[c.b].insert(c.a);
  }
  std::vector<bool> gone(n, false);
  bucket_of_.resize(n);
  std::size_t entries = 0;
  for (std::size_t step = 0; step < n; ++step) {
    std::uint32_t next = UINT32_MAX;
    for (std::uint32_t v = 0; v < n; ++v)
      if (!gone[v] && (next == UINT32_MAX || neighbours[v].size() < neighbours[next].size())) next = v;
    const std::size_t width = neighbours[next].size();
    entries += width < 60 ? std::size_t(2) << width : kMaxTableEntries + 1;
    if (width >= 60 || entries > kMaxTableEntries)
      throw InputError("sampler exact: the problem is neither small nor of low treewidth (a table over " +
                       std::to_string(width + 1) + " variables would be needed); use another sampler");
    gone[next] = true;
    bucket_of_[next] = step;
    buckets_.push_back({next, {neighbours[next].begin(), neighbours[next].end()}, {}});
    for (std::uint32_t a : buckets_.back().rest) {
      neighbours[a].erase(next);
      for (std::uint32_t b : buckets_.back().rest)
        if (a != b) neighbours[a].insert(b);
    }
  }
  for (Bucket& bucket : buckets_)
    std::sort(bucket.rest.begin(), bucket.rest.end(),
              [&](std::uint32_t x, std::uint32_t y) { return bucket_of_[x] < bucket_of_[y]; });
}

void JunctionTree::eliminate(const Problem& ising) {
  for (Bucket& bucket : buckets_) bucket.log_weight.assign(std::size_t(2) << bucket.rest.size(), 0.0);
  for (std::uint32_t v = 0; v < ising.variable_count(); ++v) {
    auto& table = buckets_[bucket_of_[v]].log_weight;
    for (std::size_t state = 0; state < table.size(); ++state) table[state] -= ising.linear[v] * spin(state, 0);
  }
  for (const Coupling& c : ising.couplings) {
    const bool a_first = bucket_of_[c.a] < bucket_of_[c.b];
    Bucket& bucket = buckets_[bucket_of_[a_first ? c.a : c.b]];
    const std::size_t other = places({a_first ? c.b : c.a}, bucket.variable, bucket.rest)[0];
    for (std::size_t state = 0; state < bucket.log_weight.size(); ++state)
      bucket.log_weight[state] -= c.value * spin(state, 0) * spin(state, other);
  }
  log_z_ = -ising.offset;
  for (Bucket& bucket : buckets_) {  // the sum over the variable goes to the table of the next variable of its rest
    stop_if_cancelled();
    const auto sum = [&](std::size_t rest) {
      return log_sum(bucket.log_weight[2 * rest], bucket.log_weight[2 * rest + 1]);
    };
    if (bucket.rest.empty()) {
      log_z_ += sum(0);
      continue;
    }
    Bucket& parent = buckets_[bucket_of_[bucket.rest[0]]];
    const auto place = places(bucket.rest, parent.variable, parent.rest);
    for (std::size_t state = 0; state < parent.log_weight.size(); ++state)
      parent.log_weight[state] += sum(gather(state, place));
  }
}

std::vector<std::int8_t> JunctionTree::draw(std::uint64_t seed, std::uint64_t row) const {
  std::vector<std::int8_t> spins(buckets_.size(), -1);
  for (std::size_t k = buckets_.size(); k-- > 0;) {
    const Bucket& bucket = buckets_[k];
    std::size_t state = 0;
    for (std::size_t j = 0; j < bucket.rest.size(); ++j) state |= std::size_t(spins[bucket.rest[j]] > 0) << (j + 1);
    const double gain = bucket.log_weight[state] - bucket.log_weight[state | 1];
    if (random_unit(seed, row, bucket.variable) * (1 + std::exp(gain)) < 1) spins[bucket.variable] = 1;
  }
  return spins;
}

ExactMoments JunctionTree::moments() const {
  const std::size_t n = buckets_.size();
  ExactMoments moments;
  moments.log_z = log_z_;
  moments.mean.assign(n, 0);
  moments.pair_mean.assign(problem_.couplings.size(), 0);
  std::vector<std::vector<double>> p(n);  // probability of every state of each table
  std::vector<std::vector<std::size_t>> own(n);
  for (std::size_t k = 0; k < problem_.couplings.size(); ++k)
    own[std::min(bucket_of_[problem_.couplings[k].a], bucket_of_[problem_.couplings[k].b])].push_back(k);
  for (std::size_t k = n; k-- > 0;) {
    const Bucket& bucket = buckets_[k];
    std::vector<double> rest(std::size_t(1) << bucket.rest.size(), 0.0);
    if (bucket.rest.empty()) {
      rest[0] = 1;
    } else {
      const Bucket& parent = buckets_[bucket_of_[bucket.rest[0]]];
      const auto place = places(bucket.rest, parent.variable, parent.rest);
      const auto& from = p[bucket_of_[bucket.rest[0]]];
      for (std::size_t state = 0; state < from.size(); ++state) rest[gather(state, place)] += from[state];
    }
    p[k].resize(bucket.log_weight.size());
    for (std::size_t state = 0; state < p[k].size(); ++state) {
      const double other = bucket.log_weight[state ^ 1] - bucket.log_weight[state];
      p[k][state] = rest[state >> 1] / (1 + std::exp(other));
      moments.mean[bucket.variable] += p[k][state] * spin(state, 0);
    }
    for (std::size_t c : own[k]) {
      const Coupling& coupling = problem_.couplings[c];
      const auto place = places({coupling.a, coupling.b}, bucket.variable, bucket.rest);
      for (std::size_t state = 0; state < p[k].size(); ++state)
        moments.pair_mean[c] += p[k][state] * spin(state, place[0]) * spin(state, place[1]);
    }
  }
  if (problem_.vartype == Vartype::spin) return moments;
  for (std::size_t c = 0; c < problem_.couplings.size(); ++c) {
    const Coupling& k = problem_.couplings[c];
    moments.pair_mean[c] = (1 + moments.mean[k.a] + moments.mean[k.b] + moments.pair_mean[c]) / 4;
  }
  for (double& mean : moments.mean) mean = (1 + mean) / 2;
  return moments;
}

}  // namespace gonogo::learning
