// One variable <-> binary units. A variable is cut into bins; each bin has one code word.
//
//   thermometer  b units for b + 1 bins: unit k is on when x lies above edge k. Keeps order; robust to single errors.
//   one_hot      b units for b bins: unit k is on when x lies in bin k. The only code for categories.
//   gray         b units for 2^b bins, reflected binary code: fewest units, neighbours differ in one unit.
//
// The inverse is exact on bins; a value is known to half a bin (`resolution`).
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/json/json.h"

namespace gonogo::learning {

using Bit = std::uint8_t;  // 0 or 1

enum class Code { thermometer, one_hot, gray };

std::string code_name(Code code);
/// Throws InputError naming the codes that exist.
Code code_from_name(const std::string& name);

/// What to do with units that are no code word.
enum class DecodeRule {
  discard,  // no bin: answers condition on valid codes and report how many were not
  repair    // thermometer: count of ones; one_hot: middle one of those that are on (none on: no bin)
};

struct DecodedBin {
  int bin = -1;        // -1: none
  bool valid = false;  // the units were a code word
};

class Encoder {
 public:
  /// `bins` equal bins over [lower, upper]. One bin (lower == upper or bins == 1) needs no unit: a variable held fixed.
  static Encoder by_range(std::string name, std::string unit, Code code, int bins, double lower, double upper);
  /// Bins with equally many of `values` (not-a-number ignored); fewer bins when values repeat.
  static Encoder by_quantile(std::string name, std::string unit, Code code, int bins, std::vector<double> values);
  /// Given inner edges, strictly increasing inside (lower, upper).
  static Encoder by_edges(std::string name, std::string unit, Code code, std::vector<double> edges, double lower,
                          double upper);
  /// Values 0, 1, ... stand for the categories; always one_hot.
  static Encoder categorical(std::string name, std::vector<std::string> categories);

  /// Bins that `units` units can tell apart: units + 1, units, 2^units.
  static int bins_for_units(Code code, int units);

  const std::string& name() const { return name_; }
  const std::string& unit() const { return unit_; }
  Code code() const { return code_; }
  double lower() const { return lower_; }
  double upper() const { return upper_; }
  const std::vector<double>& edges() const { return edges_; }
  const std::vector<std::string>& categories() const { return categories_; }
  int bin_count() const { return int(edges_.size()) + 1; }
  std::size_t unit_count() const;
  std::vector<std::string> unit_labels() const;

  /// Bin of a number; values outside [lower, upper] fall into the end bins. x must not be not-a-number.
  int bin_of(double x) const;
  /// Middle of a bin [unit], and half its width: the value is known to +- resolution.
  double value(int bin) const;
  double resolution(int bin) const;

  /// Code word of a bin. units: [unit_count()].
  void encode(int bin, std::span<Bit> units) const;
  /// Code words of the two bins whose middles enclose x, mixed linearly: each unit in [0, 1], continuous in x and equal
  /// to the code word at the middle of a bin. Categories are not mixed.
  void encode_smooth(double x, std::span<double> units) const;
  DecodedBin decode(std::span<const Bit> units, DecodeRule rule = DecodeRule::discard) const;

  Json to_json() const;
  /// `source` names the file in messages. Throws InputError for anything to_json() would not write.
  static Encoder from_json(const Json& json, const std::string& source);

 private:
  Encoder() = default;
  void check() const;
  std::string name_, unit_;
  Code code_ = Code::thermometer;
  double lower_ = 0, upper_ = 0;  // [unit]
  std::vector<double> edges_;     // inner edges, increasing
  std::vector<std::string> categories_;
};

}  // namespace gonogo::learning
