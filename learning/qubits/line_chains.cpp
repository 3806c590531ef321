#include "learning/qubits/line_chains.h"

#include <algorithm>

#include "base/error.h"

namespace gonogo::learning {

std::vector<Segment> segments(const HardwareGraph& graph, int u) {
  const auto all = lines(graph.size(), u);
  std::vector<Segment> result;
  for (std::size_t l = 0; l < all.size(); ++l) {
    bool open = false;
    for (std::size_t k = 0; k < all[l].size(); ++k) {
      const Qubit q = all[l][k];
      if (!graph.works(q)) {
        open = false;
        continue;
      }
      if (!open || !graph.coupled(all[l][k - 1], q)) result.push_back({l, {}});
      result.back().qubits.push_back(q);
      open = true;
    }
  }
  return result;
}

std::vector<std::vector<char>> crossings(const HardwareGraph& graph, const std::vector<Segment>& vertical,
                                         const std::vector<Segment>& horizontal) {
  constexpr std::size_t none = SIZE_MAX;
  std::vector<std::size_t> owner(graph.chip_size(), none);
  for (std::size_t b = 0; b < horizontal.size(); ++b)
    for (Qubit q : horizontal[b].qubits) owner[q] = b;
  std::vector<std::vector<char>> cross(vertical.size(), std::vector<char>(horizontal.size(), 0));
  for (std::size_t a = 0; a < vertical.size(); ++a)
    for (Qubit q : vertical[a].qubits)
      for (Qubit other : graph.neighbours(q))
        if (owner[other] != none) cross[a][owner[other]] = 1;
  return cross;
}

ChainCouplers::ChainCouplers(const HardwareGraph& graph, const std::vector<std::vector<Qubit>>& chains)
    : graph_(graph),
      chain_count_(chains.size()),
      owner_(graph.chip_size(), kNone),
      count_(chains.size() * chains.size(), 0) {
  for (std::size_t c = 0; c < chains.size(); ++c)
    for (Qubit q : chains[c]) owner_[q] = std::uint32_t(c);
  for (const auto& [a, b] : graph.couplers()) {
    if (owner_[a] == kNone || owner_[b] == kNone || owner_[a] == owner_[b]) continue;
    ++count(owner_[a], owner_[b]);
    ++count(owner_[b], owner_[a]);
  }
}

bool ChainCouplers::can_spare(Qubit q) const {
  const std::uint32_t chain = owner_[q];
  std::vector<std::uint32_t> others;
  for (Qubit neighbour : graph_.neighbours(q))
    if (owner_[neighbour] != kNone && owner_[neighbour] != chain) others.push_back(owner_[neighbour]);
  for (std::uint32_t other : others) {
    std::uint32_t lost = 0;
    for (std::uint32_t same : others) lost += same == other;
    if (count_[std::size_t(chain) * chain_count_ + other] == lost) return false;
  }
  return true;
}

void ChainCouplers::remove(Qubit q) {
  const std::uint32_t chain = owner_[q];
  owner_[q] = kNone;
  for (Qubit neighbour : graph_.neighbours(q)) {
    const std::uint32_t other = owner_[neighbour];
    if (other == kNone || other == chain) continue;
    --count(chain, other);
    --count(other, chain);
  }
}

void ChainCouplers::add(Qubit q, std::uint32_t chain) {
  GONOGO_ASSERT(owner_[q] == kNone);
  owner_[q] = chain;
  for (Qubit neighbour : graph_.neighbours(q)) {
    const std::uint32_t other = owner_[neighbour];
    if (other == kNone || other == chain) continue;
    ++count(chain, other);
    ++count(other, chain);
  }
}

namespace {

/// The longest cross of a vertical and a horizontal segment of line l; empty arms when no two of them are coupled.
Cross widest_cross(const HardwareGraph& graph, const std::vector<const Segment*>& vertical,
                   const std::vector<const Segment*>& horizontal) {
  Cross best;
  for (const Segment* v : vertical)
    for (const Segment* h : horizontal) {
      if (v->qubits.size() + h->qubits.size() <= best.arm[0].size() + best.arm[1].size()) continue;
      for (Qubit a : v->qubits)
        for (Qubit b : h->qubits)
          if (graph.coupled(a, b)) best = {{v->qubits, h->qubits}, {a, b}};
    }
  return best;
}

}  // namespace

std::vector<Cross> crosses(const HardwareGraph& graph) {
  const std::vector<Segment> part[2] = {segments(graph, 0), segments(graph, 1)};
  const std::size_t line_count = std::min(lines(graph.size(), 0).size(), lines(graph.size(), 1).size());
  std::vector<std::vector<const Segment*>> by_line[2];
  for (int u : {0, 1}) {
    by_line[u].resize(std::max(lines(graph.size(), 0).size(), lines(graph.size(), 1).size()));
    for (const Segment& s : part[u]) by_line[u][s.line].push_back(&s);
  }
  std::vector<Cross> result;
  for (std::size_t l = 0; l < line_count; ++l) {
    Cross cross = widest_cross(graph, by_line[0][l], by_line[1][l]);
    if (!cross.arm[0].empty()) result.push_back(std::move(cross));
  }
  return result;
}

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
