// Rows over qubits back to rows over variables; gauges; coefficient ranges.
#pragma once
#include <optional>
#include <string>

#include "learning/qubits/embedding.h"
#include "learning/qubo/sample_set.h"

namespace gonogo::learning {

enum class BrokenChains {
  weighted_random,  // the value of a random qubit of the chain: for sampling; has no ties
  majority_vote,    // the value of most qubits; ties become +1, as in Ocean, a bias on even chains
  discard,          // drops rows with a broken chain
  minimize_energy   // sets broken chains by their local fields, the largest |field| first
};
BrokenChains broken_chains_named(const std::string& name);

struct Unembedded {
  SampleSet samples;                         // SPIN rows and energies of the source; info has policy and break rates
  std::vector<double> chain_break_fraction;  // [row of `samples`] share of broken chains
  std::vector<double> chain_break_rate;      // [variable] share of reads in which the chain is broken
  std::vector<double> qubit_break_rate;      // [qubit, in the order of chains] share of reads in which it differs from
                                             // the majority of its chain; 1/2 where the chain is split evenly
};

/// `answer`: SPIN rows labelled by the qubits of the record's chains, with the gauge undone. weighted_random depends on
/// (seed, row, variable) alone. Throws InputError when a qubit has no column or rows are BINARY.
Unembedded unembed(const SampleSet& answer, const EmbeddingRecord& record, BrokenChains policy, std::uint64_t seed);

/// Fair random signs +1 and -1. Deterministic in the seed.
std::vector<std::int8_t> random_gauge(std::size_t variables, std::uint64_t seed);
/// h_i g_i, J_ij g_i g_j: rows with signs flipped by the gauge keep their energies. SPIN problems only.
Problem apply_gauge(const Problem& ising, const std::vector<std::int8_t>& gauge);
SampleSet apply_gauge(const SampleSet& samples, const std::vector<std::int8_t>& gauge);

/// Allowed coefficients of a machine.
struct CoefficientRanges {
  double h_low = -2, h_high = 2, j_low = -1, j_high = 1;        // D-Wave 2X and 2000Q
  std::optional<std::pair<double, double>> per_qubit_coupling;  // limits of the sum of a qubit's couplings, if any
};

/// Largest factor that keeps every coefficient in range, as auto_scale uses. 1 for a problem of zeros.
double auto_scale_factor(const Problem& ising, const CoefficientRanges& ranges);
/// The problem with all energies times `factor`.
Problem scaled(const Problem& problem, double factor);
/// Throws InputError with the first coefficient out of range, the range, and a factor that would help.
void check_ranges(const Problem& ising, const CoefficientRanges& ranges);

}  // namespace gonogo::learning
