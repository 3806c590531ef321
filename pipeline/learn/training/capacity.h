// How large a machine a dataset asks for: cross-validated likelihood of held-out trials against code length, hidden
// units and connectivity, beside the parameters and qubits that each costs and how well the trials cover the bins; and
// what each variable's own code is worth.
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
  std::optional<Config> learning, design;  // sections of a study; nothing: defaults
  std::uint64_t seed = 1;
  std::vector<int> bits;            // of every variable that the study's encoders do not name
  std::vector<std::size_t> hidden;  // units
  /// "full"; "sparse:0.3": this share of the pairs, drawn from the seed; or a hardware graph, "chimera:12" or
  /// "chimera:12,0.02" with a share of dead qubits: pairs without a coupler are masked.
  std::vector<std::string> connectivity;
  /// For each variable that varies and each of these lengths of its code (0: left out) one more machine, with the first
  /// bits, hidden units and connectivity above for all else.
  std::vector<int> variable_bits{};
};

/// One entry for each combination: visible and hidden units, weights (couplers between units), parameters, qubits and
/// longest chain on the graph, held-out loss [nat per trial] of outcomes, and the gain over the base rates of the
/// outcomes; trials in the emptiest bin and the share of pairs of bins of two variables without any trial. Machines of
/// `variable_bits` name their variable, whose bits theirs are. A combination that a graph cannot take has the reason in
/// place of the scores.
Json measure_capacity(const CapacityRequest& request);

/// The same as a table for people; `csv` for programs.
std::string capacity_text(const Json& report);
std::string capacity_csv(const Json& report);

}  // namespace gonogo::learn
