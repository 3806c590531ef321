// The visible units of a model: the units of all variables in order, then one unit per outcome (one-hot).
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "learning/encoding/encoder.h"

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

}  // namespace gonogo::learning
