// Bearing capacities against closed forms and published exact solutions, and plates that contradict a shear strength.
#include "terrain/soil/bearing.h"

#include <filesystem>

#include "tests/support/catch.h"
#include "tests/support/message.h"

namespace gonogo::terrain {
namespace {

const std::filesystem::path kSoils = std::filesystem::path(GONOGO_SOURCE_DIR) / "configs/soils";

MacroscopicSoil soil(double angle, double cohesion) { return {.friction_angle = angle, .cohesion = cohesion}; }

std::optional<std::string> doubt(const char* file, std::size_t state) {
  const Calibration c = read_calibration(kSoils / "calibration_32mm.json");
  return plates_against_strength(read_soil(kSoils / file).states.at(state), &c);
}

}  // namespace

TEST_CASE("a rigid strip's exact capacity lies between the least and the most that a plate may show") {
  // Without weight: Prandtl's closed form, by its slip lines. 2 + pi; at 30 degrees (e^(pi tan 30) 3 - 1) / tan 30.
  struct Exact {
    double angle, strip;
  };
  for (const Exact& exact : {Exact{0, 5.1416}, Exact{30, 30.1396}}) {
    CAPTURE(exact.angle);
    const BearingRange may = bearing_range(soil(exact.angle, 1), 0, 0.1, 0);
    CHECK(may.least < exact.strip);
    CHECK(may.most > exact.strip);
    CHECK(may.most < 2 * exact.strip);
    CHECK(may.least > exact.strip / 5);
  }
  CHECK(bearing_range(soil(0, 1), 0, 0.1, 0).least == Approx(2 * 5.1416 / 3).epsilon(1e-4));
}

TEST_CASE("a plate carries more on stronger soil, deeper down, and on heavier soil") {
  const BearingRange one = bearing_range(soil(30, 1e3), 16e3, 0.1, 0.05);
  for (const BearingRange& more :
       {bearing_range(soil(32, 1e3), 16e3, 0.1, 0.05), bearing_range(soil(30, 2e3), 16e3, 0.1, 0.05),
        bearing_range(soil(30, 1e3), 18e3, 0.1, 0.05), bearing_range(soil(30, 1e3), 16e3, 0.1, 0.1)}) {
    CHECK(more.least > one.least);
    CHECK(more.most > one.most);
  }
  CHECK(one.least < one.most);
}

TEST_CASE("of the shipped soils LETE sand has plates too strong for its shear, wet Hanamoto loam ones too weak") {
  const auto lete = doubt("lete_sand.json", 0);
  REQUIRE(lete.has_value());
  CHECK(contains(*lete, "plates and shear contradict each other by limit analysis"));
  CHECK(contains(*lete, "carries at most"));
  const auto hanamoto = doubt("sandy_loam.json", 5);
  REQUIRE(hanamoto.has_value());
  CHECK(contains(*hanamoto, "carries at least"));
  for (const char* agrees : {"dry_sand.json", "lean_clay.json", "heavy_clay.json"}) {
    CAPTURE(agrees);
    CHECK(doubt(agrees, 0).value_or("") == "");
  }
  CHECK_FALSE(doubt("cmu_sand.json", 0).has_value());  // no plates
}

TEST_CASE("Ding's plates tell the test that his angle comes from: a shear box, not triaxial compression") {
  const Calibration c = read_calibration(kSoils / "calibration_32mm.json");
  SoilState s = read_soil(kSoils / "ding2011.json").states.at(0);
  CHECK(contains(plates_against_strength(s, &c).value_or(""), "carries at most"));
  s.meaning = {.test = StrengthTest::direct_shear};
  CHECK(plates_against_strength(s, &c).value_or("") == "");
}

TEST_CASE("plates a hundred times as strong, or weak, contradict the strength of any soil") {
  SoilState s = read_soil(kSoils / "dry_sand.json").states.at(0);
  CHECK_FALSE(plates_against_strength(s).has_value());
  const Bekker measured = *s.bekker;
  for (const double factor : {100.0, 0.01}) {
    for (SoilValue Bekker::*of : {&Bekker::k_c, &Bekker::k_phi}) {
      ((*s.bekker).*of).low = factor * (measured.*of).low;
      ((*s.bekker).*of).high = factor * (measured.*of).high;
    }
    const auto said = plates_against_strength(s);
    REQUIRE(said.has_value());
    CHECK(contains(*said, factor > 1 ? "at most" : "at least"));
  }
}

}  // namespace gonogo::terrain
