#include "learning/sampler/junction_tree.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/cancel.h"
#include "base/error.h"
#include "base/random.h"

namespace gonogo::learning {
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
