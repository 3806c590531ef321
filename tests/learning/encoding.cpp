#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "base/error.h"
#include "learning/encoding/layout.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

std::vector<Bit> word(const Encoder& encoder, int bin) {
  std::vector<Bit> units(encoder.unit_count());
  encoder.encode(bin, units);
  return units;
}

}  // namespace

TEST_CASE("every code has an exact inverse and code words that differ") {
  const Code code = GENERATE(Code::thermometer, Code::one_hot, Code::gray, Code::binary);
  const Encoder encoder = Encoder::by_range("slope", "deg", code, 8, -10, 30);
  std::set<std::string> words;  // GCC 12 warns falsely about a set of vectors of bytes
  for (int bin = 0; bin < 8; ++bin) {
    const DecodedBin back = encoder.decode(word(encoder, bin));
    CHECK(back.valid);
    CHECK(back.bin == bin);
    CHECK(encoder.bin_of(encoder.value(bin)) == bin);
    CHECK(encoder.resolution(bin) == Approx(2.5));
    const auto bits = word(encoder, bin);
    words.insert(std::string(bits.begin(), bits.end()));
  }
  CHECK(words.size() == 8);
  CHECK(encoder.unit_count() == (code == Code::thermometer ? 7 : code == Code::one_hot ? 8 : 3));
  CHECK(Encoder::bins_for_units(code, int(encoder.unit_count())) == 8);
}

TEST_CASE("neighbouring bins differ in one unit of a thermometer or Gray code") {
  for (Code code : {Code::thermometer, Code::gray}) {
    const Encoder encoder = Encoder::by_range("x", "-", code, 16, 0, 1);
    for (int bin = 0; bin + 1 < 16; ++bin) {
      const auto a = word(encoder, bin), b = word(encoder, bin + 1);
      int different = 0;
      for (std::size_t k = 0; k < a.size(); ++k) different += a[k] != b[k];
      CHECK(different == 1);
    }
  }
}

TEST_CASE("a binary code is linear in the value, also between the middles of bins") {
  const Encoder encoder = Encoder::by_range("x", "-", Code::binary, 16, 0, 16);
  std::vector<double> units(4);
  for (double x = 0.5; x <= 15.5; x += 0.1) {
    encoder.encode_smooth(x, units);
    CHECK(units[0] + 2 * units[1] + 4 * units[2] + 8 * units[3] == Approx(x - 0.5).margin(1e-12));
  }
  CHECK_THROWS_AS(Encoder::by_range("x", "-", Code::binary, 12, 0, 3), InputError);
}

TEST_CASE("a value comes back within the stated resolution") {
  const Encoder encoder = Encoder::by_edges("cohesion", "kPa", Code::thermometer, {1, 3, 10, 40}, 0, 100);
  for (double x = 0; x <= 100; x += 0.37) {
    const int bin = encoder.bin_of(x);
    CHECK(std::abs(encoder.value(bin) - x) <= encoder.resolution(bin) + 1e-12);
  }
  CHECK(encoder.bin_of(-5) == 0);
  CHECK(encoder.bin_of(500) == 4);
}

TEST_CASE("units that are no code word are refused or repaired as stated") {
  const Encoder thermometer = Encoder::by_range("x", "-", Code::thermometer, 5, 0, 1);
  const std::vector<Bit> gap = {1, 0, 1, 0};
  CHECK(thermometer.decode(gap).bin == -1);
  CHECK_FALSE(thermometer.decode(gap, DecodeRule::repair).valid);
  CHECK(thermometer.decode(gap, DecodeRule::repair).bin == 2);
  const Encoder one_hot = Encoder::by_range("x", "-", Code::one_hot, 5, 0, 1);
  CHECK(one_hot.decode(std::vector<Bit>{0, 0, 0, 0, 0}, DecodeRule::repair).bin == -1);
  CHECK(one_hot.decode(std::vector<Bit>{1, 0, 1, 1, 0}).bin == -1);
  CHECK(one_hot.decode(std::vector<Bit>{1, 0, 1, 1, 0}, DecodeRule::repair).bin == 2);
}

TEST_CASE("smooth codes equal code words at the middles of bins and are continuous between") {
  const Code code = GENERATE(Code::thermometer, Code::one_hot, Code::gray, Code::binary);
  const Encoder encoder = Encoder::by_range("x", "-", code, 8, 2, 10);
  std::vector<double> units(encoder.unit_count()), before;
  for (int bin = 0; bin < 8; ++bin) {
    encoder.encode_smooth(encoder.value(bin), units);
    const auto exact = word(encoder, bin);
    for (std::size_t k = 0; k < units.size(); ++k) CHECK(units[k] == Approx(double(exact[k])).margin(1e-12));
  }
  for (double x = 1; x <= 11; x += 0.01) {
    encoder.encode_smooth(x, units);
    for (std::size_t k = 0; k < before.size(); ++k) CHECK(std::abs(units[k] - before[k]) < 0.0101);
    before = units;
  }
}

TEST_CASE("the ones of a smooth thermometer code count the value linearly") {
  const Encoder encoder = Encoder::by_range("x", "-", Code::thermometer, 9, 0, 9);
  std::vector<double> units(8);
  for (double x = 0.5; x <= 8.5; x += 0.1) {
    encoder.encode_smooth(x, units);
    double sum = 0;
    for (double unit : units) sum += unit;
    CHECK(sum == Approx(x - 0.5).margin(1e-12));
  }
}

TEST_CASE("quantile bins hold equally many values, and repeated values make fewer bins") {
  std::vector<double> values;
  for (int i = 0; i < 100; ++i) values.push_back(i * i);
  values.push_back(kUnknown);
  const Encoder encoder = Encoder::by_quantile("x", "-", Code::thermometer, 4, values);
  std::vector<int> count(4, 0);
  for (int i = 0; i < 100; ++i) ++count[std::size_t(encoder.bin_of(i * i))];
  CHECK(count == std::vector<int>{25, 25, 25, 25});
  CHECK(Encoder::by_quantile("x", "-", Code::thermometer, 4, {1, 1, 1, 1, 1, 1, 2, 2}).bin_count() == 2);
  std::vector<double> rare(1000, 0.0);
  rare[17] = rare[400] = 1;
  for (const Code code : {Code::thermometer, Code::one_hot, Code::gray, Code::binary}) {
    const Encoder flag = Encoder::by_quantile("x", "-", code, 8, rare);
    CHECK(flag.bin_count() == 2);
    CHECK(flag.unit_count() > 0);
    CHECK(flag.bin_of(0) == 0);
    CHECK(flag.bin_of(1) == 1);
  }
  std::vector<double> middle(100, 5.0);  // most values equal, some on either side
  middle[0] = 1;
  middle[1] = 9;
  CHECK(Encoder::by_quantile("x", "-", Code::thermometer, 4, middle).edges() == std::vector<double>{3, 7});
  CHECK(Encoder::by_quantile("x", "-", Code::gray, 8, {1, 2, 3, 4, 5, 6}).bin_count() == 4);
  CHECK(Encoder::by_quantile("x", "-", Code::thermometer, 4, {3, 3, 3}).unit_count() == 0);
}

TEST_CASE("a layout encodes and decodes rows, with fixed, categorical and unknown variables") {
  const VisibleLayout layout({Encoder::by_range("slope", "deg", Code::thermometer, 4, 0, 40),
                              Encoder::by_range("depth", "m", Code::thermometer, 4, 0.3, 0.3),
                              Encoder::categorical("texture", {"sand", "loam", "clay"})},
                             {"go", "slow_go", "no_go/traction"});
  CHECK(layout.unit_count() == 3 + 0 + 3 + 3);
  CHECK(layout.unit_labels()[0] == "slope>10");
  CHECK(layout.unit_labels()[4] == "texture=loam");
  CHECK(layout.unit_labels().back() == "outcome:no_go/traction");
  std::vector<Bit> row(layout.unit_count());
  layout.encode(std::vector<double>{27, 0.3, 2}, std::span(row).first(layout.input_unit_count()));
  CHECK(row == std::vector<Bit>{1, 1, 0, 0, 0, 1, 0, 0, 0});
  CHECK_FALSE(layout.decode(row).valid);  // no outcome yet
  row[7] = 1;
  const DecodedRow decoded = layout.decode(row);
  CHECK(decoded.valid);
  CHECK(decoded.outcome == std::size_t(1));
  CHECK(decoded.values[0] == Approx(25));
  CHECK(decoded.values[2] == Approx(2));
  row[8] = 1;
  CHECK_FALSE(layout.decode(row).outcome.has_value());
  layout.encode(std::vector<double>{kUnknown, 0.3, 0}, std::span(row).first(6));
  CHECK(row[0] + row[1] + row[2] == 0);
}

TEST_CASE("a layout survives its JSON to the bit, and damaged JSON is refused") {
  const VisibleLayout layout({Encoder::by_range("slope", "deg", Code::gray, 8, -1.0 / 3, 40.1),
                              Encoder::categorical("texture", {"sand", "loam"})},
                             {"go", "no_go/traction"});
  const std::string text = layout.to_json().dump();
  const VisibleLayout back = VisibleLayout::from_json(Json::parse(text, "layout"), "layout");
  CHECK(back.to_json().dump() == text);
  CHECK(back.encoders()[0].edges() == layout.encoders()[0].edges());
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string damaged = text;
    damaged.replace(damaged.find(from), from.size(), to);
    CHECK_THROWS_AS(VisibleLayout::from_json(Json::parse(damaged, "layout"), "layout"), InputError);
  };
  refused("gonogo/layout/1", "gonogo/layout/9");
  refused("\"gray\"", "\"grey\"");
  refused("\"lower\":", "\"lowest\":");
  refused("[\"sand\",\"loam\"]", "[\"sand\"]");
  CHECK_THROWS_AS(Encoder::by_edges("x", "-", Code::thermometer, {2, 1}, 0, 3), InputError);
  CHECK_THROWS_AS(Encoder::by_range("x", "-", Code::gray, 6, 0, 3), InputError);
  CHECK_THROWS_AS(Encoder::by_range("x", "-", Code::thermometer, 6, 0, kUnknown), InputError);
}
