#include <algorithm>

#include "base/error.h"
#include "learning/hardware/crosses.h"
#include "learning/hardware/embedding.h"
#include "learning/hardware/segments.h"

namespace gonogo::learning {
namespace {

Chains chains_of(const std::vector<Cross>& crosses) {
  Chains chains;
  for (const Cross& cross : crosses) {
    auto& chain = chains.emplace_back(cross.arm[0]);
    chain.insert(chain.end(), cross.arm[1].begin(), cross.arm[1].end());
    std::sort(chain.begin(), chain.end());
  }
  return chains;
}

VariablePairs all_pairs(std::size_t count) {
  VariablePairs pairs;
  for (std::uint32_t a = 0; a < count; ++a)
    for (std::uint32_t b = a + 1; b < count; ++b) pairs.emplace_back(a, b);
  return pairs;
}

/// Leaves out, one after the other, the cross that misses most others; among equals the last.
void reduce(const HardwareGraph& graph, std::vector<Cross>& crosses, std::size_t wanted) {
  while (crosses.size() > wanted) {
    std::vector<std::size_t> missed(crosses.size(), 0);
    for (const auto& [a, b] : uncoupled_pairs(graph, chains_of(crosses), all_pairs(crosses.size()))) {
      ++missed[a];
      ++missed[b];
    }
    std::size_t worst = crosses.size() - 1;
    for (std::size_t k = crosses.size(); k-- > 0;)
      if (missed[k] > missed[worst]) worst = k;
    // without misses all of the surplus goes at once
    if (missed[worst] == 0)
      crosses.resize(wanted);
    else
      crosses.erase(crosses.begin() + std::ptrdiff_t(worst));
  }
}

/// Takes qubits off one end of an arm while the pairs of chains keep a coupler.
void trim_arm(ChainCouplers& couplers, std::vector<Qubit>& arm, Qubit joint, bool front) {
  while (arm.size() > 1) {
    const Qubit q = front ? arm.front() : arm.back();
    if (q == joint || !couplers.can_spare(q)) return;
    couplers.remove(q);
    if (front)
      arm.erase(arm.begin());
    else
      arm.pop_back();
  }
}

}  // namespace

Embedding embed_clique(const HardwareGraph& graph, std::size_t variables) {
  std::vector<Cross> chosen = crosses(graph);
  if (chosen.size() < variables)
    throw InputError("graph " + graph.name() + ": " + std::to_string(variables) +
                     " variables that are all coupled do not fit; at most " + std::to_string(chosen.size()) + " do");
  reduce(graph, chosen, variables);
  // Two lines cross twice. The vertical arm of the earlier with the horizontal arm of the later is the crossing that is
  // kept where both exist: first the tops of the vertical arms and the right ends of the horizontal ones go.
  ChainCouplers couplers(graph, chains_of(chosen));
  for (Cross& cross : chosen) trim_arm(couplers, cross.arm[0], cross.joint[0], true);
  for (Cross& cross : chosen) trim_arm(couplers, cross.arm[1], cross.joint[1], false);
  for (Cross& cross : chosen) trim_arm(couplers, cross.arm[0], cross.joint[0], false);
  for (Cross& cross : chosen) trim_arm(couplers, cross.arm[1], cross.joint[1], true);
  Embedding embedding;
  embedding.chains = chains_of(chosen);
  embedding.uncoupled = uncoupled_pairs(graph, embedding.chains, all_pairs(variables));
  return embedding;
}

}  // namespace gonogo::learning
