// Embedding of problems on qubits. A variable becomes a chain: qubits that strong couplings hold together.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "learning/hardware/graph.h"
#include "learning/qubo/problem.h"
#include "learning/qubo/sidecar.h"

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

/// Couples every visible variable (0 ... visible - 1) with every hidden one (visible ...). Visible variables are on
/// vertical lines, hidden ones on horizontal lines. Each takes the unbroken part of its line that couples the most
/// pairs; the lines with the fewest crossings stay unused. Deterministic. Throws InputError when there are too few
/// lines.
Embedding embed_biclique(const HardwareGraph& graph, std::size_t visible, std::size_t hidden);

/// The same for a long side and a short one. Variables of the short side (the last `narrow`) are on crosses of a
/// vertical and a horizontal line, those of the long side on the lines that are left, of both directions.
/// Deterministic. Throws InputError when there are too few lines.
Embedding embed_crossed_biclique(const HardwareGraph& graph, std::size_t wide, std::size_t narrow);

/// The first of the two unless a side is longer than the lines of a direction. Variables of the left side come first.
Embedding embed_two_sides(const HardwareGraph& graph, std::size_t left, std::size_t right);

/// Couples every variable with every other. Variable v is on parts of a vertical line and of the horizontal line of the
/// same number, joined where they cross (Choi, arXiv:1001.3116; Boothby, King, Roy, arXiv:1507.04774). Deterministic.
Embedding embed_clique(const HardwareGraph& graph, std::size_t variables);

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
