#include <algorithm>

#include "base/error.h"
#include "learning/hardware/embedding.h"
#include "learning/hardware/segments.h"

namespace gonogo::learning {
namespace {

/// One segment for each line of either direction, and how many chosen segments of the other direction each crosses.
class Choice {
 public:
  explicit Choice(const HardwareGraph& graph) : side_{segments(graph, 0), segments(graph, 1)} {
    cross_ = crossings(graph, side_[0], side_[1]);
    for (int u : {0, 1}) {
      parts_[u].resize(lines(graph.size(), u).size());
      for (std::size_t s = 0; s < side_[u].size(); ++s) parts_[u][side_[u][s].line].push_back(s);
      for (std::size_t l = 0; l < parts_[u].size(); ++l)
        if (!parts_[u][l].empty()) chosen_[u].push_back(longest(u, l));
    }
  }
  std::size_t line_count(int u) const { return chosen_[u].size(); }
  const Segment& segment(int u, std::size_t k) const { return side_[u][chosen_[u][k]]; }

  /// Each line takes the segment that crosses most of the other direction's chosen ones, until nothing changes.
  void improve() {
    bool changed = true;
    for (int round = 0; changed && round < 50; ++round) {
      changed = false;
      for (int u : {0, 1})
        for (std::size_t& s : chosen_[u])
          for (std::size_t other : parts_[u][side_[u][s].line])
            if (crossed(u, other) > crossed(u, s)) {
              s = other;
              changed = true;
            }
    }
  }

  /// Leaves out, one after the other, lines that cross fewest; among equals the last, so that the rest lies together.
  void reduce(std::size_t vertical, std::size_t horizontal) {
    const std::size_t wanted[2] = {vertical, horizontal};
    while (chosen_[0].size() > vertical || chosen_[1].size() > horizontal) {
      int side = -1;
      std::size_t worst = 0;
      double least = 2;
      for (int u : {0, 1}) {
        if (chosen_[u].size() <= wanted[u]) continue;
        for (std::size_t k = 0; k < chosen_[u].size(); ++k) {
          const double share =
              double(crossed(u, chosen_[u][k])) / double(std::max<std::size_t>(1, chosen_[1 - u].size()));
          if (share > least) continue;
          least = share, side = u, worst = k;
        }
      }
      chosen_[side].erase(chosen_[side].begin() + std::ptrdiff_t(worst));
    }
  }

 private:
  std::size_t longest(int u, std::size_t line) const {
    std::size_t best = parts_[u][line][0];
    for (std::size_t s : parts_[u][line])
      if (side_[u][s].qubits.size() > side_[u][best].qubits.size()) best = s;
    return best;
  }
  std::size_t crossed(int u, std::size_t s) const {
    std::size_t count = 0;
    for (std::size_t other : chosen_[1 - u]) count += std::size_t(u == 0 ? cross_[s][other] : cross_[other][s]);
    return count;
  }

  std::vector<Segment> side_[2];
  std::vector<std::vector<std::size_t>> parts_[2];  // segments of each line
  std::vector<std::size_t> chosen_[2];              // by line
  std::vector<std::vector<char>> cross_;
};

/// Takes off the ends of straight chains what couples to nobody that is not coupled elsewhere.
void trim_ends(const HardwareGraph& graph, Chains& chains) {
  ChainCouplers couplers(graph, chains);
  for (auto& chain : chains) {
    while (chain.size() > 1 && couplers.can_spare(chain.back())) {
      couplers.remove(chain.back());
      chain.pop_back();
    }
    while (chain.size() > 1 && couplers.can_spare(chain.front())) {
      couplers.remove(chain.front());
      chain.erase(chain.begin());
    }
  }
}

}  // namespace

Embedding embed_biclique(const HardwareGraph& graph, std::size_t visible, std::size_t hidden) {
  Choice choice(graph);
  if (visible > choice.line_count(0) || hidden > choice.line_count(1))
    throw InputError("graph " + graph.name() + ": " + std::to_string(visible) + " visible and " +
                     std::to_string(hidden) + " hidden variables do not fit; it has " +
                     std::to_string(choice.line_count(0)) + " vertical and " + std::to_string(choice.line_count(1)) +
                     " horizontal lines");
  choice.improve();
  choice.reduce(visible, hidden);
  choice.improve();
  Embedding embedding;
  for (std::size_t k = 0; k < visible; ++k) embedding.chains.push_back(choice.segment(0, k).qubits);
  for (std::size_t k = 0; k < hidden; ++k) embedding.chains.push_back(choice.segment(1, k).qubits);
  trim_ends(graph, embedding.chains);
  VariablePairs pairs;
  for (std::size_t i = 0; i < visible; ++i)
    for (std::size_t j = 0; j < hidden; ++j) pairs.emplace_back(std::uint32_t(i), std::uint32_t(visible + j));
  for (auto& chain : embedding.chains) std::sort(chain.begin(), chain.end());
  embedding.uncoupled = uncoupled_pairs(graph, embedding.chains, pairs);
  return embedding;
}

}  // namespace gonogo::learning
