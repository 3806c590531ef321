// Bicliques with one long side: the variables of the short side are on crosses, those of the long side on what is left
// of the lines of both directions. C12 holds K(96 - 2 b, b).
#include <algorithm>

#include "base/error.h"
#include "learning/hardware/biclique_chains.h"
#include "learning/hardware/crosses.h"
#include "learning/hardware/embedding.h"

namespace gonogo::learning {
namespace {

std::vector<Qubit> qubits_of(const Cross& cross) {
  std::vector<Qubit> chain = cross.arm[0];
  chain.insert(chain.end(), cross.arm[1].begin(), cross.arm[1].end());
  return chain;
}

/// The longest crosses; among equals the first, so that they lie together and the other chains can be short.
Chains short_side(const HardwareGraph& graph, std::size_t count) {
  std::vector<Cross> all = crosses(graph);
  std::stable_sort(all.begin(), all.end(), [](const Cross& a, const Cross& b) {
    return a.arm[0].size() + a.arm[1].size() > b.arm[0].size() + b.arm[1].size();
  });
  Chains chains;
  for (std::size_t k = 0; k < std::min(count, all.size()); ++k) chains.push_back(qubits_of(all[k]));
  return chains;
}

/// A segment outside the crosses, and how many of them it can be coupled with.
struct Candidate {
  const Segment* segment = nullptr;
  std::size_t crosses = 0;
};

/// The best segment of every line of both directions, best first.
std::vector<Candidate> candidates(const HardwareGraph& graph, const std::vector<Segment>& segments,
                                  const Chains& crosses) {
  constexpr std::size_t kNone = SIZE_MAX;
  std::vector<std::size_t> owner(graph.chip_size(), kNone);
  for (std::size_t c = 0; c < crosses.size(); ++c)
    for (Qubit q : crosses[c]) owner[q] = c;
  std::vector<Candidate> result;
  for (const Segment& segment : segments) {
    const auto used = [&](Qubit q) { return owner[q] != kNone; };
    if (std::any_of(segment.qubits.begin(), segment.qubits.end(), used)) continue;
    std::vector<char> met(crosses.size(), 0);
    for (Qubit q : segment.qubits)
      for (Qubit next : graph.neighbours(q))
        if (used(next)) met[owner[next]] = 1;
    const Candidate here{&segment, std::size_t(std::count(met.begin(), met.end(), 1))};
    const bool same_line = !result.empty() && result.back().segment->line == segment.line;
    if (!same_line)
      result.push_back(here);
    else if (here.crosses > result.back().crosses)
      result.back() = here;
  }
  return result;
}

}  // namespace

Embedding embed_crossed_biclique(const HardwareGraph& graph, std::size_t wide, std::size_t narrow) {
  const Chains shorter = short_side(graph, narrow);
  const std::vector<Segment> vertical = segments(graph, 0), horizontal = segments(graph, 1);
  std::vector<Candidate> all = candidates(graph, vertical, shorter);
  for (const Candidate& c : candidates(graph, horizontal, shorter)) all.push_back(c);
  if (shorter.size() < narrow || all.size() < wide)
    throw InputError("graph " + graph.name() + ": sides of " + std::to_string(wide) + " and " + std::to_string(narrow) +
                     " variables do not fit; beside " + std::to_string(shorter.size()) +
                     " variables on crosses it has " + std::to_string(all.size()) + " lines");
  std::stable_sort(all.begin(), all.end(),
                   [](const Candidate& a, const Candidate& b) { return a.crosses > b.crosses; });
  Chains start;
  for (std::size_t k = 0; k < wide; ++k) start.push_back(all[k].segment->qubits);
  start.insert(start.end(), shorter.begin(), shorter.end());
  BicliqueChains chains(graph, wide, std::move(start));
  chains.lengthen();
  chains.trim();
  Embedding embedding;
  embedding.chains = chains.chains();
  VariablePairs pairs;
  for (std::size_t i = 0; i < wide; ++i)
    for (std::size_t j = 0; j < narrow; ++j) pairs.emplace_back(std::uint32_t(i), std::uint32_t(wide + j));
  for (auto& chain : embedding.chains) std::sort(chain.begin(), chain.end());
  embedding.uncoupled = uncoupled_pairs(graph, embedding.chains, pairs);
  return embedding;
}

Embedding embed_two_sides(const HardwareGraph& graph, std::size_t left, std::size_t right) {
  const std::size_t line_count = std::min(lines(graph.size(), 0).size(), lines(graph.size(), 1).size());
  if (std::max(left, right) <= line_count) return embed_biclique(graph, left, right);
  if (left >= right) return embed_crossed_biclique(graph, left, right);
  Embedding found = embed_crossed_biclique(graph, right, left);
  std::rotate(found.chains.begin(), found.chains.begin() + std::ptrdiff_t(right), found.chains.end());
  for (auto& [a, b] : found.uncoupled) {
    const std::uint32_t of_right = a + std::uint32_t(left);
    a = b - std::uint32_t(right);
    b = of_right;
  }
  std::sort(found.uncoupled.begin(), found.uncoupled.end());
  return found;
}

}  // namespace gonogo::learning
