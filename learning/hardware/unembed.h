// From rows over qubits back to rows over variables, and the other things a machine does to a problem: gauges, ranges.
#pragma once
#include <optional>
#include <string>

#include "learning/hardware/embedding.h"
#include "learning/qubo/sample_set.h"

namespace gonogo::learning {

enum class BrokenChains {
  weighted_random,  // a chain takes the value of one of its qubits, drawn evenly: the choice for sampling, no ties
  majority_vote,    // the value of most of its qubits; ties go up, as in Ocean, which favours +1 on even chains
  discard,          // rows with a broken chain are left out
  minimize_energy   // broken chains one after the other, the one with the largest |local field| first, downhill
};
BrokenChains broken_chains_named(const std::string& name);

struct Unembedded {
  SampleSet samples;  // SPIN rows over the source's variables, energies of the source; info says policy and break rates
  std::vector<double> chain_break_fraction;  // [row of `samples`] share of broken chains
  std::vector<double> chain_break_rate;      // [variable] share of reads in which the chain is broken
  std::vector<double> qubit_break_rate;      // [qubit, in the order of chains] share of reads in which it differs from
                                             // most of its chain; a half where the chain is split evenly
};

/// `answer`: SPIN rows whose labels are the qubits of the record's chains, gauge already undone. Draws of
/// weighted_random depend on (seed, row, variable). Throws InputError when a qubit has no column or rows are BINARY.
Unembedded unembed(const SampleSet& answer, const EmbeddingRecord& record, BrokenChains policy, std::uint64_t seed);

/// Signs +1 and -1, evenly drawn; a function of the seed.
std::vector<std::int8_t> random_gauge(std::size_t variables, std::uint64_t seed);
/// h_i g_i, J_ij g_i g_j: the same energies for rows with the signs turned. SPIN problems only.
Problem apply_gauge(const Problem& ising, const std::vector<std::int8_t>& gauge);
SampleSet apply_gauge(const SampleSet& samples, const std::vector<std::int8_t>& gauge);

/// Coefficients that a machine takes.
struct CoefficientRanges {
  double h_low = -2, h_high = 2, j_low = -1, j_high = 1;        // D-Wave 2X and 2000Q
  std::optional<std::pair<double, double>> per_qubit_coupling;  // limits of the sum of a qubit's couplings
};

/// Factor that auto_scale multiplies a problem with: the largest that keeps every coefficient in range. 1 for a problem
/// of zeros.
double auto_scale_factor(const Problem& ising, const CoefficientRanges& ranges);
/// E -> factor E.
Problem scaled(const Problem& problem, double factor);
/// Throws InputError naming the first coefficient out of range, the range, and the factor that would help.
void check_ranges(const Problem& ising, const CoefficientRanges& ranges);

}  // namespace gonogo::learning
