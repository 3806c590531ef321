#include "learning/encoding/layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/error.h"
#include "base/format.h"

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

namespace {

class Penalty {
 public:
  Penalty(const Problem& qubo, double strength) : result_(qubo), strength_(strength) {
    for (const Coupling& c : qubo.couplings) coupling_[{c.a, c.b}] = c.value;
  }

  void add(Code code, std::uint32_t first, std::uint32_t count) {
    if (code == Code::thermometer)
      add_order(first, count);
    else if (code == Code::one_hot && count > 0)
      add_one(first, count);
  }

  Problem problem() && {
    result_.couplings.clear();
    for (const auto& [pair, value] : coupling_) result_.couplings.push_back({pair.first, pair.second, value});
    return std::move(result_);
  }

 private:
  void add_order(std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t k = 1; k < count; ++k) {
      result_.linear[first + k] += strength_;
      coupling_[{first + k - 1, first + k}] -= strength_;
    }
  }

  /// (1 - sum u)^2 = 1 - sum u + 2 sum_(a<b) u_a u_b, because u^2 = u.
  void add_one(std::uint32_t first, std::uint32_t count) {
    result_.offset += strength_;
    for (std::uint32_t a = 0; a < count; ++a) {
      result_.linear[first + a] -= strength_;
      for (std::uint32_t b = a + 1; b < count; ++b) coupling_[{first + a, first + b}] += 2 * strength_;
    }
  }

  Problem result_;
  double strength_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> coupling_;
};

}  // namespace

Problem with_code_penalty(const Problem& qubo, const VisibleLayout& layout, std::span<const double> fixed,
                          double strength) {
  GONOGO_ASSERT(qubo.vartype == Vartype::binary && fixed.size() == qubo.variable_count() &&
                layout.unit_count() <= fixed.size());
  if (!std::isfinite(strength) || strength < 0)
    throw InputError("penalty of words that are no code words: " + number_text(strength) +
                     "; it must be an energy of at least 0 (0: none)");
  if (strength == 0) return qubo;
  Penalty penalty(qubo, strength);
  const auto add = [&](Code code, std::size_t first, std::size_t count) {
    const auto units = fixed.subspan(first, count);
    if (std::all_of(units.begin(), units.end(), [](double x) { return std::isnan(x); }))
      penalty.add(code, std::uint32_t(first), std::uint32_t(count));
  };
  for (std::size_t v = 0; v < layout.variable_count(); ++v)
    add(layout.encoders()[v].code(), layout.offset(v), layout.encoders()[v].unit_count());
  add(Code::one_hot, layout.input_unit_count(), layout.outcome_count());
  return std::move(penalty).problem();
}

}  // namespace gonogo::learning
