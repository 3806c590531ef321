#include "learning/hardware/segments.h"

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

}  // namespace gonogo::learning
