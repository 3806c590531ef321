#include "pipeline/map/soils/soil_of_numbers.h"

#include <algorithm>
#include <cctype>
#include <sstream>

#include "base/error.h"
#include "base/format.h"
#include "terrain/soil/bearing.h"
#include "terrain/soil/evidence.h"
#include "terrain/soil/soil.h"

namespace gonogo::map {

namespace {

constexpr double kMostAngle = 60, kMostCohesion = 100;  // [deg], [kPa]
constexpr double kMostIndex = 1e4;                      // of a cone [kPa]
constexpr double kUsualDensity = 1600;                  // of soil that plates were pressed into [kg/m^3]

[[noreturn]] void refuse(const std::string& text, const std::string& what) {
  throw InputError("\"" + text + "\": " + what +
                   "; give for example \"direct_shear:phi=31,c=0.5\", \"triaxial:phi=34,c=1\", \"repose:phi=30\", "
                   "\"cone:index=414,soil=CL\", \"unconfined:strength=60,phi=10\" or "
                   "\"bevameter:n=1.1,k_c=0.99,k_phi=1528,c=1.04,phi=28,K=25\" [deg, kPa, kN/m^(n+1), kN/m^(n+2), mm]");
}

/// A text such as "triaxial:phi=34,c=1,soil=SM", taken apart. What is taken is no longer there.
class TestNumbers {
 public:
  TestNumbers(std::string text, std::size_t colon) : text_(std::move(text)), test_(text_.substr(0, colon)) {
    std::istringstream entries(text_.substr(colon + 1));
    for (std::string entry; std::getline(entries, entry, ',');) add(entry);
  }

  const std::string& text() const { return text_; }
  const std::string& test() const { return test_; }
  const std::string& kind_of_soil() const { return kind_of_soil_; }

  std::optional<double> take(const std::string& key, double most) {
    const auto found = left_.find(key);
    if (found == left_.end()) return std::nullopt;
    const double value = found->second;
    left_.erase(found);
    if (!(value >= 0 && value <= most)) refuse(text_, line("%s %g is not between 0 and %g", key.c_str(), value, most));
    return value;
  }

  double need(const std::string& key, const std::string& what, double most) {
    const auto value = take(key, most);
    if (!value) refuse(text_, "has no " + what + " " + key);
    return *value;
  }

  void finish() const {
    if (!left_.empty()) refuse(text_, "\"" + left_.begin()->first + "\" is not known");
  }

 private:
  void add(const std::string& entry) {
    const auto equals = entry.find('=');
    const std::string key = entry.substr(0, equals),
                      value = equals == std::string::npos ? "" : entry.substr(equals + 1);
    if (key == "soil") {
      kind_of_soil_ = kind(value);
    } else if (const auto number = parsed<double>(value)) {
      left_[key] = *number;
    } else {
      refuse(text_, "\"" + entry + "\" is no number by name");
    }
  }

  /// A class of the USCS or a USDA texture, in its usual spelling.
  std::string kind(const std::string& name) const {
    for (const auto* known : {&terrain::uscs_classes(), &terrain::usda_textures()})
      for (const std::string& one : *known)
        if (std::equal(one.begin(), one.end(), name.begin(), name.end(),
                       [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); }))
          return one;
    refuse(text_, "\"" + name + "\" is neither a class of the USCS with mineral grains (" +
                      join_words(terrain::uscs_classes()) + ") nor a USDA texture");
  }

  std::string text_, test_, kind_of_soil_;
  std::map<std::string, double> left_;
};

SoilSample sample_of(const TestNumbers& n, double angle, double cohesion, const terrain::AngleMeaning& meaning) {
  SoilSample sample;
  sample.source = n.text();
  sample.texture = n.kind_of_soil();
  const auto fixed = [&n](double value) { return Spread{Spread::Kind::fixed, value, value, n.text(), {}}; };
  sample.values["friction_angle"] = fixed(angle);
  sample.values["friction_angle"].meaning = meaning;
  sample.values["cohesion"] = fixed(cohesion);
  return sample;
}

/// Against its shear strength, what the plates of a bevameter say.
std::optional<std::string> doubt_of_plates(TestNumbers& n, double angle, double cohesion) {
  const auto value = [](double x) { return terrain::SoilValue{x, x, "", "", ""}; };
  terrain::SoilState state;
  state.bekker = {value(n.need("n", "number", 3)), value(n.need("k_c", "number", 1e5)),
                  value(n.need("k_phi", "number", 1e6))};
  n.need("K", "number", 1e3);
  state.friction_angle = value(angle);
  state.cohesion = value(cohesion);
  state.meaning = {terrain::StrengthTest::ring_shear};
  state.bulk_density = value(kUsualDensity);
  return terrain::plates_against_strength(state);
}

/// Cohesion and friction angle of an envelope, or an angle of repose.
SoilSample of_envelope(TestNumbers& n, Soil& soil) {
  const bool bevameter = n.test() == "bevameter";
  const terrain::AngleMeaning meaning{bevameter ? terrain::StrengthTest::ring_shear
                                                : terrain::strength_test_of(n.test())};
  const auto angle = n.take("phi", kMostAngle);
  if (!angle)
    refuse(n.text(), "has no friction angle phi, and " + n.test() + " alone tells no strength of a wheel's soil");
  const bool heap = meaning.test == terrain::StrengthTest::repose;
  const double cohesion = heap ? n.take("c", kMostCohesion).value_or(0) : n.need("c", "cohesion", kMostCohesion);
  if (bevameter)
    if (const auto doubt = doubt_of_plates(n, *angle, cohesion)) soil.doubts.push_back(*doubt);
  terrain::as_triaxial(terrain::MacroscopicSoil{*angle, 0, 0, 0, meaning});  // refuses tests without an angle
  return sample_of(n, *angle, cohesion, meaning);
}

SoilSample of_unconfined(TestNumbers& n) {
  const double strength = n.need("strength", "compressive strength", 2 * kMostCohesion),
               angle = n.need("phi", "friction angle", kMostAngle);
  return sample_of(n, angle, terrain::cohesion_of_unconfined(strength, angle), {});
}

/// One sample with a friction angle, else several that are alternatives.
std::vector<SoilSample> of_cone(TestNumbers& n) {
  const double index = n.need("index", "cone index", kMostIndex);
  if (n.kind_of_soil().empty() || !terrain::is_fine_grained(n.kind_of_soil()))
    refuse(n.text(),
           "a cone index tells a strength in fine-grained soil alone; name its class or texture, such as "
           "soil=CL, and give coarse soil a friction angle by another test");
  const auto angle = n.take("phi", 45);
  std::vector<SoilSample> samples;
  for (double phi = angle.value_or(0); phi <= angle.value_or(30); phi += 5) {
    if (!angle && 1e3 * index < terrain::cone_index(0, phi)) break;
    const double cohesion = terrain::cohesion_of_cone(1e3 * index, phi) / 1e3;
    if (cohesion > kMostCohesion) continue;
    samples.push_back(sample_of(n, phi, cohesion, {}));
    samples.back().cone_index = 1e3 * index;
    samples.back().alternative = int(samples.size()) - 1;
  }
  if (samples.empty())
    refuse(n.text(),
           line("the index means a cohesion beyond the %g kPa that maps take; at %g deg that is an index of %.0f "
                "kPa, and firmer soil needs no cone index",
                kMostCohesion, angle.value_or(30), terrain::cone_index(1e3 * kMostCohesion, angle.value_or(30)) / 1e3));
  return samples;
}

}  // namespace

std::optional<Soil> soil_of_numbers(const std::string& text) {
  const auto colon = text.find(':');
  const std::string test = text.substr(0, colon);
  const auto& tests = terrain::strength_test_names();
  if (colon == std::string::npos || (test != "bevameter" && std::find(tests.begin(), tests.end(), test) == tests.end()))
    return std::nullopt;
  TestNumbers n(text, colon);
  const auto density = n.take("density", 1);
  Soil soil{.name = text, .draws = kSoilDraws};
  soil.samples = test == "cone"         ? of_cone(n)
                 : test == "unconfined" ? std::vector{of_unconfined(n)}
                                        : std::vector{of_envelope(n, soil)};
  n.finish();
  soil.texture = n.kind_of_soil();
  if (density)
    for (SoilSample& sample : soil.samples)
      sample.values["relative_density"] = {Spread::Kind::fixed, *density, *density, text, {}};
  return soil;
}

}  // namespace gonogo::map
