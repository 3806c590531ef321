#include "learning/encoding/layout.h"

#include <cmath>
#include <limits>

#include "base/error.h"

namespace gonogo::learning {

VisibleLayout::VisibleLayout(std::vector<Encoder> encoders, std::vector<std::string> outcomes)
    : encoders_(std::move(encoders)), outcomes_(std::move(outcomes)) {
  if (outcomes_.size() == 1) throw InputError("a model needs at least two outcomes, or none to be a plain density");
  for (const Encoder& encoder : encoders_) offsets_.push_back(offsets_.back() + encoder.unit_count());
}

std::vector<std::string> VisibleLayout::unit_labels() const {
  std::vector<std::string> labels;
  for (const Encoder& encoder : encoders_)
    for (std::string& label : encoder.unit_labels()) labels.push_back(std::move(label));
  for (const std::string& outcome : outcomes_) labels.push_back("outcome:" + outcome);
  return labels;
}

std::size_t VisibleLayout::variable_index(const std::string& name) const {
  std::string known;
  for (std::size_t i = 0; i < encoders_.size(); ++i) {
    if (encoders_[i].name() == name) return i;
    known += (i ? ", " : "") + encoders_[i].name();
  }
  throw InputError("variable \"" + name + "\" is not in this model; it has: " + known);
}

void VisibleLayout::encode(std::span<const double> variables, std::span<Bit> units) const {
  GONOGO_ASSERT(variables.size() == variable_count() && units.size() == input_unit_count());
  for (std::size_t i = 0; i < encoders_.size(); ++i) {
    const auto part = units.subspan(offsets_[i], encoders_[i].unit_count());
    if (std::isnan(variables[i]))
      std::fill(part.begin(), part.end(), Bit(0));
    else
      encoders_[i].encode(encoders_[i].bin_of(variables[i]), part);
  }
}

void VisibleLayout::encode_smooth(std::span<const double> variables, std::span<double> units) const {
  GONOGO_ASSERT(variables.size() == variable_count() && units.size() == input_unit_count());
  for (std::size_t i = 0; i < encoders_.size(); ++i) {
    const auto part = units.subspan(offsets_[i], encoders_[i].unit_count());
    if (std::isnan(variables[i]))
      std::fill(part.begin(), part.end(), 0.0);
    else
      encoders_[i].encode_smooth(variables[i], part);
  }
}

DecodedRow VisibleLayout::decode(std::span<const Bit> row, DecodeRule rule) const {
  GONOGO_ASSERT(row.size() == unit_count());
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  DecodedRow result;
  result.valid = true;
  for (std::size_t i = 0; i < encoders_.size(); ++i) {
    const Encoder& encoder = encoders_[i];
    const DecodedBin decoded = encoder.decode(row.subspan(offsets_[i], encoder.unit_count()), rule);
    result.values.push_back(decoded.bin < 0 ? unknown : encoder.value(decoded.bin));
    result.resolutions.push_back(decoded.bin < 0 ? unknown : encoder.resolution(decoded.bin));
    result.valid = result.valid && decoded.valid;
  }
  std::size_t on = 0;
  for (std::size_t y = 0; y < outcome_count(); ++y) {
    if (!row[input_unit_count() + y]) continue;
    if (on++ == 0) result.outcome = y;
  }
  if (on != 1) {
    result.outcome.reset();
    result.valid = false;
  }
  return result;
}

Json VisibleLayout::to_json() const {
  Json json;
  Json encoders = Json::array();
  for (const Encoder& encoder : encoders_) encoders.push_back(encoder.to_json());
  json["schema"] = "gonogo/layout/1";
  json["variables"] = std::move(encoders);
  json["outcomes"] = Json(outcomes_);
  return json;
}

VisibleLayout VisibleLayout::from_json(const Json& json, const std::string& source) {
  const Json* schema = json.is_object() ? json.find("schema") : nullptr;
  if (!schema || !schema->is_string() || schema->string() != "gonogo/layout/1")
    throw InputError(source + ": schema: expected \"gonogo/layout/1\"; this program cannot read another one");
  std::vector<Encoder> encoders;
  for (const Json& item : json.at("variables").items()) encoders.push_back(Encoder::from_json(item, source));
  std::vector<std::string> outcomes;
  for (const Json& item : json.at("outcomes").items()) outcomes.push_back(item.string());
  return VisibleLayout(std::move(encoders), std::move(outcomes));
}

}  // namespace gonogo::learning
