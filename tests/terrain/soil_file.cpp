// Soil files: those that ship, what is refused, and the fits kept in them.
#include "terrain/soil/soil.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "base/error.h"
#include "base/files/file.h"
#include "base/units.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

namespace gonogo::terrain {
namespace {

const std::filesystem::path kSoils = std::filesystem::path(GONOGO_SOURCE_DIR) / "configs/soils";

/// The dry sand that ships with one text exchanged for another, as a file.
std::filesystem::path altered(const std::string& from, const std::string& to) {
  std::string text = read_file(kSoils / "dry_sand.json");
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  auto path = std::filesystem::temp_directory_path() / "gonogo-test-soil.json";
  write_file_atomically(path, text.replace(at, from.size(), to));
  return path;
}

}  // namespace

TEST_CASE("every soil that ships is read, and every number in it has a source or says that it has none") {
  int soils = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kSoils)) {
    if (entry.path().filename().string().rfind("calibration_", 0) == 0 || entry.path().extension() != ".json") continue;
    CAPTURE(entry.path().string());
    const SoilFile soil = read_soil(entry.path());
    for (const SoilState& s : soil.states)
      for (const SoilValue* v : {&s.friction_angle, &s.cohesion, &s.bulk_density, &s.relative_density})
        CHECK((v->source.empty() != v->no_source.empty() && v->low <= v->high));
    ++soils;
  }
  CHECK(soils == 11);
}

TEST_CASE("the USDA file has each of the twelve textures dry, moist and wet, and weaker clay when wet") {
  const SoilFile usda = read_soil(kSoils / "usda.json");
  std::set<std::string> textures;
  for (const SoilState& s : usda.states) textures.insert(s.texture + ", " + s.moisture);
  CHECK(usda.states.size() == 36);
  CHECK(textures.size() == 36);
  const auto cohesion = [&](const std::string& name) {
    for (const SoilState& s : usda.states)
      if (s.name == name) return s.cohesion.middle();
    return -1.0;
  };
  CHECK(cohesion("clay, wet") < cohesion("clay, moist"));
  CHECK(cohesion("clay, moist") < cohesion("clay, dry"));
}

TEST_CASE("a soil file with a number out of range, without a source, or with an unknown key is refused") {
  CHECK_NOTHROW(read_soil(altered("28", "29")));
  CHECK_THROWS_AS(read_soil(altered("28", "88")), InputError);
  CHECK_THROWS_AS(read_soil(altered("\"fixed\": 28", "\"range\": [30, 28]")), InputError);
  CHECK_THROWS_AS(read_soil(altered("\"no_source\": \"no", "\"note\": \"no")), InputError);
  CHECK_THROWS_AS(read_soil(altered("\"water_percent\"", "\"water\"")), InputError);
  CHECK_THROWS_AS(read_soil(altered("gonogo/soil/2", "gonogo/soil/9")), InputError);
}

TEST_CASE("a strength without its test says what each would mean, and an organic class is refused by name") {
  const std::string missing = input_error([] { read_soil(altered("\"test\": \"ring_shear\",", "")); });
  CHECK(contains(missing,
                 "states[0].tests[0].test: is missing beside a friction angle: as triaxial compression it is 28"));
  CHECK(contains(missing, "as direct or ring shear 32.1 deg of triaxial compression"));
  CHECK(contains(input_error([] { read_soil(altered("\"water_percent\": 0", "\"uscs\": \"OH\"")); }),
                 "an organic class"));
}

TEST_CASE("a fit keeps contact law and mismatch in the soil's file, and says why a soil is refused") {
  const auto path = altered("28", "28");
  const Calibration c = read_calibration(kSoils / "calibration_90mm.json");
  write_fits(path, "calibration_90mm.json", c);
  write_fits(path, "calibration_90mm.json", c);  // in place of the first
  const SoilFile soil = read_soil(path);
  REQUIRE(soil.fits.members().size() == 1);
  const Json& fit = soil.fits.at("calibration_90mm.json").items().at(0);
  CHECK(fit.at("mismatch").at("friction_angle_deg").number() == Approx(0).margin(1e-6));
  // The gain lies between those of the contact levels around the grains that were found.
  const double cohesion = fit.at("triaxial_cohesion_kPa").number();  // of 1.04 on the plane of shear
  CHECK(cohesion == Approx(1.04 / std::cos(fit.at("triaxial_friction_angle_deg").number() * kDegree)));
  const double gain = 1e3 * cohesion / fit.at("cohesion_pressure_Pa").number(), friction = fit.at("friction").number();
  const auto stronger = std::find_if(c.contact.begin(), c.contact.end(),
                                     [&](const ContactLevel& level) { return level.friction >= friction; });
  REQUIRE((stronger != c.contact.begin() && stronger != c.contact.end()));
  CHECK(gain >= std::prev(stronger)->cohesion_gain);
  CHECK(gain <= stronger->cohesion_gain);
  SoilState steep = soil.states.at(0);
  steep.friction_angle.low = steep.friction_angle.high = 40;  // 57 of triaxial compression
  CHECK(fit_record(c, steep).at("refused").string().find("choose one between") != std::string::npos);
  std::filesystem::remove(path);
}

}  // namespace gonogo::terrain
