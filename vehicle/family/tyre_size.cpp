#include "vehicle/family/tyre_size.h"

#include <cmath>
#include <regex>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"

namespace gonogo::vehicle {
namespace {

constexpr const char* kExamples = "37x12.50R16.5, 395/85R20, 16.00R20, LT285/70R17, 25x8-12, or 0.5x0.2 in metres";
constexpr double kMillimetre = 1e-3;
/// Section height over width of sizes that name the width alone. Michelin's XZL in 14.00R20 is 1.255 m in diameter and
/// in 16.00R20 1.343 m: 1.05 and 1.03.
constexpr double kConventionalAspect = 1.04;

[[noreturn]] void refuse(const std::string& text, const std::string& why) {
  throw InputError("tyre size \"" + text + "\": " + why + "; write it as " + kExamples);
}

double number_in(const std::smatch& match, std::size_t part) { return std::stod(match[part].str()); }

TyreSize with_rim(double diameter, double width, double rim, const std::string& rule) {
  TyreSize t = bare_wheel(diameter, width);
  t.rim = rim;
  t.rule = rule;
  return t;
}

TyreSize flotation(const std::smatch& m) {
  TyreSize t = with_rim(number_in(m, 1) * kInch, number_in(m, 2) * kInch, number_in(m, 3) * kInch,
                        "diameter, section width and rim in inches");
  t.light_duty = number_in(m, 3) <= 14 && number_in(m, 1) < 31;
  return t;
}

TyreSize metric(const std::smatch& m) {
  const double width = number_in(m, 1) * kMillimetre, rim = number_in(m, 3) * kInch;
  TyreSize t = with_rim(rim + 2 * width * number_in(m, 2) / 100, width, rim,
                        "rim in inches and twice the section height, which is width times aspect ratio");
  t.truck = width > 0.3;
  return t;
}

TyreSize conventional(const std::smatch& m) {
  const double width = number_in(m, 1) * kInch, rim = number_in(m, 2) * kInch;
  TyreSize t =
      with_rim(rim + 2 * kConventionalAspect * width, width, rim,
               line("rim and section width in inches; the section is %.2f times as high as wide, as Michelin's XZL",
                    kConventionalAspect));
  t.truck = true;
  return t;
}

TyreSize dimensions_of(const std::string& text) {
  static const std::string number = "([0-9]+(?:\\.[0-9]+)?)";
  static const auto ignoring_case = std::regex::icase | std::regex::ECMAScript;
  static const std::regex inches("(?:LT|P)?" + number + "x" + number + "(?:Z?R|-|B|D)" + number + "(?:LT|NHS|C)?",
                                 ignoring_case),
      millimetres("(?:LT|P)?" + number + "/" + number + "(?:Z?R|-|B|D)" + number + "(?:LT|C)?", ignoring_case),
      width_alone(number + "(?:R|-)" + number + "(?:LT|C)?", ignoring_case),
      metres(number + "x" + number, ignoring_case);
  std::string plain;
  for (const char c : text)
    if (c != ' ') plain += c;
  std::smatch m;
  if (std::regex_match(plain, m, inches)) return flotation(m);
  if (std::regex_match(plain, m, millimetres)) return metric(m);
  if (std::regex_match(plain, m, width_alone)) return conventional(m);
  if (std::regex_match(plain, m, metres)) return bare_wheel(number_in(m, 1), number_in(m, 2));
  refuse(text, "cannot be read");
}

}  // namespace

TyreSize bare_wheel(double diameter, double width) {
  TyreSize t;
  t.diameter = diameter;
  t.section_width = width;
  t.rule = "diameter and width in metres, without a tyre";
  return t;
}

TyreSize read_tyre_size(const std::string& text) {
  TyreSize t = dimensions_of(text);
  t.text = text;
  const auto in = [](double x, double low, double high) { return x >= low && x <= high; };
  if (!in(t.diameter, 0.05, 4))
    refuse(text, "makes a diameter of " + number_text(t.diameter) + " m; allowed are 0.05 to 4 m");
  if (!in(t.section_width / t.diameter, 0.05, 1.5))
    refuse(text, "makes a wheel " + number_text(t.section_width) + " m wide and " + number_text(t.diameter) +
                     " m high; the width may be 0.05 to 1.5 of the diameter");
  if (t.pneumatic() && !in(t.section_height() / t.section_width, 0.2, 1.3))
    refuse(text, "makes a section " + number_text(t.section_height()) + " m high and " + number_text(t.section_width) +
                     " m wide; its height may be 0.2 to 1.3 of the width");
  return t;
}

double load_limit(const TyreSize& t, double pressure) {
  const double aspect = t.section_height() / t.section_width;
  const double section = (0.34848 + 0.6497 * aspect) * t.section_width / kMillimetre;
  return kGravity * 6.67e-5 * std::sqrt(pressure / 1e3) * std::pow(section, 1.39) * (t.rim / kMillimetre + section);
}

double largest_inflation(const TyreSize& t) { return 1e3 * (t.light_duty ? 150 : t.truck ? 830 : 550); }

double load_of_index(int load_index) { return 45 * std::pow(10.0, load_index / 80.0); }

double radial_stiffness(const TyreSize& t, double pressure) {
  const double width = t.section_width / kMillimetre, aspect = 100 * t.section_height() / t.section_width;
  const double ring = std::sqrt((1.03 - 0.004 * aspect) * width * (width * aspect / 50 + t.rim / kMillimetre));
  return (0.00028 * pressure / 1e3 * ring + 3.45) * kGravity / kMillimetre;
}

}  // namespace gonogo::vehicle
