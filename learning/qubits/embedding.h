// Embedding of problems on qubits. A variable becomes a chain: qubits that strong couplings hold together.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "learning/formats/format.h"
#include "learning/qubits/graph.h"
#include "learning/qubo/problem.h"

namespace gonogo::learning {

using Chains = std::vector<std::vector<Qubit>>;  // chains[v]: qubits of variable v, ascending
using VariablePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;  // (a < b), ascending

struct Embedding {
  Chains chains;
  VariablePairs uncoupled;  // wanted pairs whose chains no coupler joins
};

/// Throws InputError unless chains are connected, disjoint, non-empty sets of working qubits.
void check_chains(const HardwareGraph& graph, const Chains& chains);

/// The `pairs` whose chains no coupler joins.
VariablePairs uncoupled_pairs(const HardwareGraph& graph, const Chains& chains, const VariablePairs& pairs);

struct HeuristicSettings {
  std::uint64_t seed = 1;
  std::size_t tries = 10, rounds = 60;
  double time_limit_s = 60;
  /// Called after every variable that was laid; may be empty.
  std::function<void(std::size_t attempt, std::size_t round)> watch = {};
};

/// Couples given pairs. Chains grow along cheapest paths; overlaps are allowed at first, at a cost that rises each
/// round (Cai, Macready, Roy, arXiv:1406.2741). Deterministic, but for the time limit. Throws InputError when no try
/// ends without overlaps, at once when counts show that none can, and when the time is over.
Embedding embed_heuristic(const HardwareGraph& graph, std::size_t variables, const VariablePairs& pairs,
                          const HeuristicSettings& settings = {});

/// `method`: "biclique" (bipartite problems, on crosses where a side is too long), "clique", "heuristic", or "auto".
/// "auto" takes a biclique if one fits; otherwise the clique or the heuristic, the first that couples every pair, or
/// the clique if none does.
Embedding embed(const HardwareGraph& graph, const Problem& problem, const std::string& method,
                const HeuristicSettings& settings = {});

/// Chain strength prefactor * sqrt(mean J^2) * sqrt(mean degree), which balances the torque of neighbours on a chain
/// (dwave-system, uniform_torque_compensation). 1 when all couplings are 0. For SPIN problems.
double torque_compensation(const Problem& ising, double prefactor = 1.414);
/// Largest |h| or |J|.
double largest_coefficient(const Problem& ising);

struct EmbeddedProblem {
  Problem problem;         // over qubits, SPIN
  EmbeddingRecord record;  // its source has no couplings of uncoupled pairs
};

/// Divides linear biases equally over the qubits of a chain, and couplings over the couplers between two chains.
/// Couplers inside chains get -chain_strength. The offset makes energies of unbroken rows equal to the source's.
/// Couplings of uncoupled pairs are removed from the source. A BINARY problem is converted first.
EmbeddedProblem embed_problem(const Problem& problem, const HardwareGraph& graph, const Embedding& embedding,
                              double chain_strength);

}  // namespace gonogo::learning
