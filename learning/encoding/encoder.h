// Encodes a variable in binary units. Its range is divided into bins; each bin has one code word.
//
//   thermometer  b units for b + 1 bins: unit k is on when x is above edge k. Keeps the order; robust to single errors.
//   one_hot      b units for b bins: unit k is on when x is in bin k. The only code for categories.
//   gray         b units for 2^b bins, reflected binary code. Fewest units; neighbours differ in one unit.
//   binary       b units for 2^b bins, unit k is worth 2^k. Fewest units; the value is linear in them.
//
// Every word of a Gray or binary code is a code word.
//
// Decoding gives the bin exactly, and the value to half a bin (`resolution`).
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/json/json.h"

namespace gonogo::learning {

using Bit = std::uint8_t;  // 0 or 1

enum class Code { thermometer, one_hot, gray, binary };

std::string code_name(Code code);
/// Throws InputError that lists the codes.
Code code_from_name(const std::string& name);
/// The names of all codes.
std::vector<std::string> code_names();
/// Whether the code needs a power of two of bins, and then has no invalid words.
inline bool has_all_words(Code code) { return code == Code::gray || code == Code::binary; }

/// Treatment of units that are no code word.
enum class DecodeRule {
  discard,  // no bin: answers are conditional on valid codes, and report the share of others
  repair    // thermometer: number of ones; one_hot: the middle one of the units that are on (no bin if none)
};

struct DecodedBin {
  int bin = -1;        // -1: none
  bool valid = false;  // the units were a code word
};

class Encoder {
 public:
  /// `bins` equal bins over [lower, upper]. With one bin (lower == upper or bins == 1) the variable is fixed and has no
  /// units.
  static Encoder by_range(std::string name, std::string unit, Code code, int bins, double lower, double upper);
  /// Bins with equally many of `values`, NaN ignored, as far as their ties allow: edges lie between different values,
  /// so that a rare value among many equal ones keeps a bin. Repeated values may give fewer bins.
  static Encoder by_quantile(std::string name, std::string unit, Code code, int bins, std::vector<double> values);
  /// Bins between the given inner edges, which increase strictly inside (lower, upper).
  static Encoder by_edges(std::string name, std::string unit, Code code, std::vector<double> edges, double lower,
                          double upper);
  /// Values 0, 1, ... are the categories. The code is one_hot.
  static Encoder categorical(std::string name, std::vector<std::string> categories);

  /// Number of bins of `units` units: units + 1, units, 2^units, 2^units.
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

  /// Bin of x, which must not be NaN. Values outside [lower, upper] belong to the end bins.
  int bin_of(double x) const;
  /// Middle of a bin and half of its width [unit].
  double value(int bin) const;
  double resolution(int bin) const;

  /// Code word of a bin. units: [unit_count()].
  void encode(int bin, std::span<Bit> units) const;
  /// Between the middles of two bins: `share` of left + 1, and the rest of left.
  struct Place {
    int left = 0;
    double share = 0;  // in [0, 1]; 0 at the last bin
  };
  /// Place of x, which must not be NaN. Categories are not between each other.
  Place between(double x) const;
  /// Linear interpolation between the code words of the two bins whose middles enclose x. Units are in [0, 1],
  /// continuous in x, and equal to the code word at the middle of a bin. Categories are not interpolated.
  void encode_smooth(double x, std::span<double> units) const;
  DecodedBin decode(std::span<const Bit> units, DecodeRule rule = DecodeRule::discard) const;

  Json to_json() const;
  /// `source` is the file's name in messages. Throws InputError for JSON that to_json() would not write.
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

// Values inside a bin.

/// The value at the share u, in [0, 1), of a bin's width [unit]. Categories have no width.
inline double value_inside(const Encoder& encoder, int bin, double u) {
  return encoder.categories().empty() ? encoder.value(bin) + (2 * u - 1) * encoder.resolution(bin) : encoder.value(bin);
}

}  // namespace gonogo::learning
