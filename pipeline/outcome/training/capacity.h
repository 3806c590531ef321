// How large a machine a dataset needs. Measures the cross-validated likelihood of held-out trials against code length,
// hidden units and connectivity. Reports the parameters, the qubits and the coverage of the bins beside it.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "base/json/json.h"

namespace gonogo::outcome {

struct CapacityRequest {
  std::filesystem::path dataset;
  std::optional<Config> learning, design;  // sections of a study; none: defaults
  std::uint64_t seed = 1;
  std::vector<int> bits;            // code lengths of variables that the study's encoders do not name
  std::vector<std::size_t> hidden;  // numbers of hidden units
  /// "full"; "sparse:0.3" for this share of the pairs, drawn from the seed; or a hardware graph. "chimera:12,0.02" is a
  /// graph with this share of dead qubits. Pairs without a coupler are masked.
  std::vector<std::string> connectivity;
  /// Adds one machine for each variable that varies and each of these code lengths of it (0: left out). Everything else
  /// follows the first entry of bits, hidden and connectivity.
  std::vector<int> variable_bits{};
};

/// How well trials cover the bins of a layout.
struct BinCoverage {
  std::size_t fewest = 0;  // trials in the emptiest bin of any variable
  double empty_pairs = 0;  // share of the pairs of bins of two variables without a trial
};

struct Capacity {
  std::size_t trials = 0;
  double base_loss = 0;  // what a machine without weights reaches at best [nat per trial]

  /// One machine. One that does not fit on its graph has the reason in place of what follows it.
  struct Machine {
    int bits = 0;
    std::size_t hidden = 0, visible = 0;  // units
    std::string connectivity;
    BinCoverage coverage;
    std::string impossible;  // reason; empty where it fits
    std::size_t couplers = 0, parameters = 0, epochs = 0;
    std::size_t qubits = 0, longest_chain = 0;  // 0: not on a graph
    double held_out_loss = 0, gain = 0;         // of the outcomes, and over their base rates [nat per trial]
    std::string variable;                       // of `variable_bits`; empty: all variables alike
  };
  std::vector<Machine> machines;
};

/// Trains one machine for each combination, then those of `variable_bits`.
Capacity measure_capacity(const CapacityRequest& request);

Json to_json(const Capacity& capacity);
/// As a table for people, and as CSV for programs.
std::string capacity_text(const Capacity& capacity);
std::string capacity_csv(const Capacity& capacity);

}  // namespace gonogo::outcome
