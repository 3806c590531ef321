// Problems laid onto qubits: a variable becomes a chain of coupled qubits that a strong coupling holds together.
#pragma once
#include <cstdint>
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
  VariablePairs uncoupled;  // wanted pairs between whose chains there is no coupler
};

/// Throws InputError unless every chain is a connected, non-empty set of working qubits that no other chain uses.
void check_chains(const HardwareGraph& graph, const Chains& chains);

/// Those of `pairs` between whose chains there is no coupler.
VariablePairs uncoupled_pairs(const HardwareGraph& graph, const Chains& chains, const VariablePairs& pairs);

/// Every visible variable (0 ... visible - 1) with every hidden one (visible ...): visible ones on vertical lines,
/// hidden ones on horizontal lines, each on the unbroken part of its line that keeps most pairs; lines that cross
/// fewest others are left over. Deterministic. Throws InputError when there are not enough lines.
Embedding embed_biclique(const HardwareGraph& graph, std::size_t visible, std::size_t hidden);

/// Every variable with every other: variable v on parts of a vertical line and of the horizontal line that lies alike,
/// joined where they cross (Choi, arXiv:1001.3116; Boothby, King, Roy, arXiv:1507.04774). Deterministic.
Embedding embed_clique(const HardwareGraph& graph, std::size_t variables);

struct HeuristicSettings {
  std::uint64_t seed = 1;
  std::size_t tries = 10, rounds = 60;
};

/// Any pairs: chains grow along cheapest paths, overlaps are allowed first and made dearer round after round (Cai,
/// Macready, Roy, arXiv:1406.2741). A function of its arguments. Throws InputError when no try ends without overlaps.
Embedding embed_heuristic(const HardwareGraph& graph, std::size_t variables, const VariablePairs& pairs,
                          const HeuristicSettings& settings = {});

/// "biclique" for problems whose variables fall into two sides, "clique", "heuristic"; "auto" takes the first of them
/// that couples every pair, otherwise the one of the first two that couples most.
Embedding embed(const HardwareGraph& graph, const Problem& problem, const std::string& method,
                const HeuristicSettings& settings = {});

/// 1.414 root(mean J^2) root(mean number of neighbours): balances the torque that its neighbours exert on a chain
/// (dwave-system, uniform_torque_compensation). 1 without couplings, also when all of them are 0. For SPIN problems.
double torque_compensation(const Problem& ising, double prefactor = 1.414);
/// Largest |h| or |J|.
double largest_coefficient(const Problem& ising);

struct EmbeddedProblem {
  Problem problem;         // over qubits, SPIN
  EmbeddingRecord record;  // its source lacks the couplings that had to be masked
};

/// Linear biases in equal parts over the qubits of a chain, couplings in equal parts over the couplers between chains,
/// -chain_strength on every coupler inside a chain; the offset makes unbroken rows have the source's energies.
/// Couplings of uncoupled pairs are taken out of the source. A BINARY problem is converted first.
EmbeddedProblem embed_problem(const Problem& problem, const HardwareGraph& graph, const Embedding& embedding,
                              double chain_strength);

}  // namespace gonogo::learning
