// The visible units of a model: the units of all variables in order, then one unit per outcome (one-hot).
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "learning/encoding/encoder.h"
#include "learning/qubo/problem.h"

namespace gonogo::learning {

/// A decoded row of visible units.
struct DecodedRow {
  std::vector<double> values;       // [variable count]; NaN where the units give no bin
  std::vector<double> resolutions;  // [variable count]; each value is known to +- this
  std::optional<std::size_t> outcome;
  bool valid = false;  // every variable and the outcome had a code word
};

class VisibleLayout {
 public:
  VisibleLayout() = default;
  VisibleLayout(std::vector<Encoder> encoders, std::vector<std::string> outcomes);

  const std::vector<Encoder>& encoders() const { return encoders_; }
  const std::vector<std::string>& outcomes() const { return outcomes_; }
  std::size_t variable_count() const { return encoders_.size(); }
  std::size_t outcome_count() const { return outcomes_.size(); }
  /// First unit of a variable. Its units are consecutive.
  std::size_t offset(std::size_t variable) const { return offsets_[variable]; }
  std::size_t input_unit_count() const { return offsets_.back(); }  // units of all variables
  std::size_t unit_count() const { return input_unit_count() + outcome_count(); }
  /// Unique text for each visible unit: "slope_along>12.5", "outcome:no_go/traction".
  std::vector<std::string> unit_labels() const;
  /// Index of a variable. Throws InputError that lists the names.
  std::size_t variable_index(const std::string& name) const;

  /// Units of the variables, 0 for unknown (NaN) ones. units: [input_unit_count()].
  void encode(std::span<const double> variables, std::span<Bit> units) const;
  void encode_smooth(std::span<const double> variables, std::span<double> units) const;
  /// row: [unit_count()].
  DecodedRow decode(std::span<const Bit> row, DecodeRule rule = DecodeRule::discard) const;

  Json to_json() const;
  static VisibleLayout from_json(const Json& json, const std::string& source);

 private:
  std::vector<Encoder> encoders_;
  std::vector<std::string> outcomes_;
  std::vector<std::size_t> offsets_ = {0};  // [variable count + 1]
};

/// Penalty energy for units that are no code word: 0 for every code word, at least `strength` for all other words.
///
///   thermometer  strength sum_k u_(k+1) (1 - u_k)   for every unit that is on after one that is off
///   one_hot      strength (1 - sum_k u_k)^2         also for the outcome's units
///   gray, binary none: every word is a code word
///
/// Energies of code words do not change, so neither do their relative probabilities. The weight of any other row falls
/// by a factor of at least exp(strength). Source: Lucas, Front. Phys. 2:5 (2014), section 3 (one-hot); Chancellor,
/// Quantum Sci. Technol. 4:045004 (2019), equation 3 (thermometer, there "domain wall").
///
/// Adds the penalties to `qubo` (BINARY), whose first variables are the units of `layout`, for every variable, and for
/// the outcome, whose units are all free. fixed: [variable_count()], NaN for free units, as in clamp(). `strength` is
/// in the energy unit of the problem; throws InputError unless it is finite and not negative.
Problem with_code_penalty(const Problem& qubo, const VisibleLayout& layout, std::span<const double> fixed,
                          double strength);

}  // namespace gonogo::learning
