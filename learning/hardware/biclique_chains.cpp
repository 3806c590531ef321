#include "learning/hardware/biclique_chains.h"

#include <algorithm>

namespace gonogo::learning {
namespace {

constexpr std::size_t kRoot = SIZE_MAX;
constexpr std::size_t kMaxLengthRatio = 2;  // chains at most, over the longest at the start: long ones break more often

/// An unused qubit on its shortest way from the chain, and the new partners along this way.
struct Reached {
  Qubit qubit;
  std::size_t before;                   // place of the last one on the way, or kRoot
  std::size_t length;                   // of the chain with this way
  std::vector<std::uint32_t> partners;  // ascending
};

}  // namespace

BicliqueChains::BicliqueChains(const HardwareGraph& graph, std::size_t visible, Chains chains)
    : graph_(graph), visible_(visible), chains_(std::move(chains)), couplers_(graph, chains_) {
  for (const auto& chain : chains_) longest_ = std::max(longest_, kMaxLengthRatio * chain.size());
}

std::size_t BicliqueChains::coupled_pairs() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < visible_; ++i)
    for (std::size_t j = visible_; j < chains_.size(); ++j) count += couplers_.coupled(i, j);
  return count;
}

BicliqueChains::Growth BicliqueChains::best_growth(std::size_t chain) {
  Growth growth;
  bool any = false;
  for (std::size_t other = 0; other < chains_.size() && !any; ++other) any = wanted(chain, other);
  if (!any) return growth;
  std::vector<char> seen(graph_.chip_size(), 0);
  std::vector<Reached> tree;
  std::size_t best = kRoot;
  const auto visit = [&](Qubit q, std::size_t before) {
    if (seen[q] || couplers_.owner(q) != ChainCouplers::kNone) return;
    const bool first = before == kRoot;
    const std::size_t length = 1 + (first ? chains_[chain].size() : tree[before].length);
    if (length > longest_) return;
    seen[q] = 1;
    Reached here{q, before, length, first ? std::vector<std::uint32_t>() : tree[before].partners};
    for (Qubit next : graph_.neighbours(q)) {
      const std::uint32_t other = couplers_.owner(next);
      if (other == ChainCouplers::kNone || !wanted(chain, other)) continue;
      const auto place = std::lower_bound(here.partners.begin(), here.partners.end(), other);
      if (place == here.partners.end() || *place != other) here.partners.insert(place, other);
    }
    growth.reached.push_back(q);
    if (here.partners.size() > growth.gain) {
      growth.gain = here.partners.size();
      best = tree.size();
    }
    tree.push_back(std::move(here));
  };
  for (Qubit q : chains_[chain])
    for (Qubit next : graph_.neighbours(q)) visit(next, kRoot);
  for (std::size_t k = 0; k < tree.size(); ++k)
    for (Qubit next : graph_.neighbours(tree[k].qubit)) visit(next, k);
  looks_ += tree.size();
  for (std::size_t k = best; k != kRoot; k = tree[k].before) growth.path.push_back(tree[k].qubit);
  std::reverse(growth.path.begin(), growth.path.end());
  return growth;
}

void BicliqueChains::grow(std::size_t chain, const Growth& growth) {
  for (Qubit q : growth.path) {
    couplers_.add(q, std::uint32_t(chain));
    chains_[chain].push_back(q);
  }
}

void BicliqueChains::lengthen() {
  std::vector<Growth> growth;
  for (std::size_t c = 0; c < chains_.size(); ++c) growth.push_back(best_growth(c));
  while (true) {
    const auto largest = std::max_element(growth.begin(), growth.end(), [](const Growth& a, const Growth& b) {
      return a.gain != b.gain ? a.gain < b.gain : a.path.size() > b.path.size();
    });
    if (largest == growth.end() || largest->gain == 0) return;
    const Growth done = *largest;
    grow(std::size_t(largest - growth.begin()), done);
    // Others have to look again where their ways led over these qubits or past them.
    std::vector<char> changed(graph_.chip_size(), 0);
    for (Qubit q : done.path) {
      changed[q] = 1;
      for (Qubit next : graph_.neighbours(q)) changed[next] = 1;
    }
    const auto is_changed = [&](Qubit q) { return changed[q] != 0; };
    for (std::size_t c = 0; c < chains_.size(); ++c)
      if (std::any_of(growth[c].reached.begin(), growth[c].reached.end(), is_changed) ||
          std::any_of(chains_[c].begin(), chains_[c].end(), is_changed))
        growth[c] = best_growth(c);
  }
}

bool BicliqueChains::is_end(Qubit q) const {
  std::size_t same = 0;
  for (Qubit next : graph_.neighbours(q)) same += couplers_.owner(next) == couplers_.owner(q);
  return same == 1;
}

void BicliqueChains::trim() {
  for (auto& chain : chains_)
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t k = chain.size(); k-- > 0;)
        if (is_end(chain[k]) && couplers_.can_spare(chain[k])) {
          couplers_.remove(chain[k]);
          chain.erase(chain.begin() + std::ptrdiff_t(k));
          changed = true;
        }
    }
}

}  // namespace gonogo::learning
