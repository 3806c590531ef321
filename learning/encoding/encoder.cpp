#include "learning/encoding/encoder.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/json/config.h"

namespace gonogo::learning {
namespace {

std::string short_number(double x) { return line("%.6g", x); }

unsigned gray_code(int bin) { return unsigned(bin) ^ (unsigned(bin) >> 1); }

int gray_inverse(unsigned code) {
  for (unsigned shift = 1; shift < 32; shift <<= 1) code ^= code >> shift;
  return int(code);
}

}  // namespace

std::string code_name(Code code) { return code_names()[std::size_t(code)]; }

std::vector<std::string> code_names() { return {"thermometer", "one_hot", "gray", "binary"}; }

Code code_from_name(const std::string& name) {
  const std::vector<std::string> names = code_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw InputError("code \"" + name + "\" does not exist; use thermometer, one_hot, gray or binary");
  return Code(found - names.begin());
}

int Encoder::bins_for_units(Code code, int units) {
  if (code == Code::thermometer) return units + 1;
  return code == Code::one_hot ? std::max(units, 1) : 1 << units;
}

Encoder Encoder::by_edges(std::string name, std::string unit, Code code, std::vector<double> edges, double lower,
                          double upper) {
  Encoder encoder;
  encoder.name_ = std::move(name);
  encoder.unit_ = std::move(unit);
  encoder.code_ = code;
  encoder.edges_ = std::move(edges);
  encoder.lower_ = lower;
  encoder.upper_ = upper;
  encoder.check();
  return encoder;
}

Encoder Encoder::by_range(std::string name, std::string unit, Code code, int bins, double lower, double upper) {
  if (bins < 1) throw InputError("variable " + name + ": " + std::to_string(bins) + " bins; at least 1 is needed");
  std::vector<double> edges;
  for (int k = 1; k < bins && lower < upper; ++k) edges.push_back(lower + (upper - lower) * k / bins);
  return by_edges(std::move(name), std::move(unit), code, std::move(edges), lower, upper);
}

Encoder Encoder::by_quantile(std::string name, std::string unit, Code code, int bins, std::vector<double> values) {
  std::erase_if(values, [](double x) { return std::isnan(x); });
  if (values.empty()) throw InputError("variable " + name + ": no known value to take quantiles of");
  std::sort(values.begin(), values.end());
  std::vector<std::size_t> gaps;  // places whose value is larger than the one before
  for (std::size_t i = 1; i < values.size(); ++i)
    if (values[i - 1] < values[i]) gaps.push_back(i);
  std::vector<double> edges;
  for (int k = 1; k < bins && !gaps.empty(); ++k) {
    const std::size_t wanted = values.size() * std::size_t(k) / std::size_t(bins);
    auto gap = std::lower_bound(gaps.begin(), gaps.end(), wanted);
    if (gap == gaps.end() || (gap != gaps.begin() && wanted - gap[-1] < *gap - wanted)) --gap;
    const double edge = values[*gap - 1] + (values[*gap] - values[*gap - 1]) / 2;
    const double last = edges.empty() ? values.front() : edges.back();
    if (edge > last && edge < values.back()) edges.push_back(edge);
  }
  // Repeated values may have left fewer bins than a power of two.
  if (has_all_words(code)) edges.resize(std::bit_floor(edges.size() + 1) - 1);
  return by_edges(std::move(name), std::move(unit), code, std::move(edges), values.front(), values.back());
}

Encoder Encoder::categorical(std::string name, std::vector<std::string> categories) {
  if (categories.empty()) throw InputError("variable " + name + ": a categorical variable needs at least one category");
  Encoder encoder;
  encoder.name_ = std::move(name);
  encoder.code_ = Code::one_hot;
  encoder.lower_ = -0.5;
  encoder.upper_ = double(categories.size()) - 0.5;
  for (std::size_t k = 1; k < categories.size(); ++k) encoder.edges_.push_back(double(k) - 0.5);
  encoder.categories_ = std::move(categories);
  encoder.check();
  return encoder;
}

void Encoder::check() const {
  const std::string where = "encoder of " + name_ + ": ";
  if (!std::isfinite(lower_) || !std::isfinite(upper_) || lower_ > upper_)
    throw InputError(where + "range " + short_number(lower_) + " to " + short_number(upper_) + " is not an interval");
  double last = lower_;
  for (double edge : edges_) {
    if (!(edge > last && edge < upper_))
      throw InputError(where + "edge " + short_number(edge) + " is not above the one before and inside the range");
    last = edge;
  }
  if (edges_.size() >= 4096) throw InputError(where + "more than 4096 bins");
  if (has_all_words(code_) && !std::has_single_bit(unsigned(bin_count())))
    throw InputError(where + "a " + (code_ == Code::gray ? "Gray" : "binary") + " code needs 2, 4, 8, ... bins, not " +
                     std::to_string(bin_count()));
  if (!categories_.empty() && (code_ != Code::one_hot || categories_.size() != std::size_t(bin_count())))
    throw InputError(where + "categories need a one_hot code with one bin each");
}

std::size_t Encoder::unit_count() const {
  if (edges_.empty()) return 0;
  if (code_ == Code::thermometer) return edges_.size();
  return code_ == Code::one_hot ? std::size_t(bin_count()) : std::size_t(std::bit_width(edges_.size()));
}

std::vector<std::string> Encoder::unit_labels() const {
  std::vector<std::string> labels;
  for (std::size_t k = 0; k < unit_count(); ++k) {
    if (code_ == Code::thermometer)
      labels.push_back(name_ + ">" + short_number(edges_[k]));
    else if (has_all_words(code_))
      labels.push_back(name_ + ":" + code_name(code_) + std::to_string(k));
    else
      labels.push_back(name_ + "=" + (categories_.empty() ? short_number(value(int(k))) : categories_[k]));
  }
  return labels;
}

int Encoder::bin_of(double x) const {
  GONOGO_ASSERT(!std::isnan(x));
  return int(std::upper_bound(edges_.begin(), edges_.end(), x) - edges_.begin());
}

double Encoder::value(int bin) const {
  const double left = bin == 0 ? lower_ : edges_[std::size_t(bin) - 1];
  const double right = bin == bin_count() - 1 ? upper_ : edges_[std::size_t(bin)];
  return left + (right - left) / 2;
}

double Encoder::resolution(int bin) const {
  return (bin == bin_count() - 1 ? upper_ : edges_[std::size_t(bin)]) - value(bin);
}

void Encoder::encode(int bin, std::span<Bit> units) const {
  GONOGO_ASSERT(units.size() == unit_count() && bin >= 0 && bin < bin_count());
  for (std::size_t k = 0; k < units.size(); ++k) {
    if (code_ == Code::thermometer)
      units[k] = k < std::size_t(bin);
    else if (code_ == Code::one_hot)
      units[k] = k == std::size_t(bin);
    else
      units[k] = ((code_ == Code::gray ? gray_code(bin) : unsigned(bin)) >> k) & 1;
  }
}

Encoder::Place Encoder::between(double x) const {
  Place place{bin_of(x), 0};
  if (!categories_.empty()) return place;
  if (x < value(place.left)) --place.left;
  if (place.left < 0) return {0, 0};
  if (place.left < bin_count() - 1)
    place.share = std::clamp((x - value(place.left)) / (value(place.left + 1) - value(place.left)), 0.0, 1.0);
  return place;
}

void Encoder::encode_smooth(double x, std::span<double> units) const {
  if (units.empty()) return;
  const auto [left, share] = between(x);
  std::vector<Bit> word(units.size());
  encode(left, word);
  for (std::size_t k = 0; k < units.size(); ++k) units[k] = word[k];
  if (share == 0) return;
  encode(left + 1, word);
  for (std::size_t k = 0; k < units.size(); ++k) units[k] += share * (double(word[k]) - units[k]);
}

DecodedBin Encoder::decode(std::span<const Bit> units, DecodeRule rule) const {
  GONOGO_ASSERT(units.size() == unit_count());
  if (units.empty()) return {0, true};
  if (has_all_words(code_)) {
    unsigned word = 0;
    for (std::size_t k = 0; k < units.size(); ++k) word |= unsigned(units[k]) << k;
    return {code_ == Code::gray ? gray_inverse(word) : int(word), true};
  }
  const auto ones = std::size_t(std::count(units.begin(), units.end(), Bit(1)));
  if (code_ == Code::thermometer) {
    const bool valid = std::is_sorted(units.rbegin(), units.rend());
    return valid || rule == DecodeRule::repair ? DecodedBin{int(ones), valid} : DecodedBin{};
  }
  if (ones == 0 || (ones > 1 && rule == DecodeRule::discard)) return {};
  std::size_t seen = 0, k = 0;
  for (; k < units.size(); ++k) {
    seen += units[k];
    if (seen == (ones + 1) / 2) break;
  }
  return {int(k), ones == 1};
}

Json Encoder::to_json() const {
  return Json::Object{{"name", name_},   {"unit", unit_},         {"code", code_name(code_)},       {"lower", lower_},
                      {"upper", upper_}, {"edges", Json(edges_)}, {"categories", Json(categories_)}};
}

Encoder Encoder::from_json(const Json& json, const std::string& source) {
  const Config config = Config::parse(json.dump(), source);
  Encoder encoder =
      by_edges(config.text("name"), config.text("unit"), code_from_name(config.choice("code", code_names())),
               config.numbers("edges"), config.number("lower"), config.number("upper"));
  encoder.categories_ = config.texts("categories");
  config.finish();
  encoder.check();
  return encoder;
}

}  // namespace gonogo::learning
