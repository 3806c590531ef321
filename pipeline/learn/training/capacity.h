// How large a machine a dataset needs. Measures the cross-validated likelihood of held-out trials against code length,
// hidden units and connectivity. Reports the parameters, the qubits and the coverage of the bins beside it.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "base/json/json.h"

namespace gonogo::learn {

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

/// Trains one machine for each combination. An entry holds the numbers of visible and hidden units, couplers,
/// parameters and qubits, and the longest chain. It also holds the held-out loss of the outcomes, the gain over their
/// base rates [nat per trial], and the bin coverage. Machines of `variable_bits` name their variable. A combination
/// that does not fit on its graph holds the reason in place of the scores.
Json measure_capacity(const CapacityRequest& request);

/// The report as a table for people, and as CSV for programs.
std::string capacity_text(const Json& report);
std::string capacity_csv(const Json& report);

}  // namespace gonogo::learn
