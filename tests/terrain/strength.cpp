// What a friction angle means by its test: conversions against stresses on planes, by a table's curves, and in files.
#include "terrain/soil/strength.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "base/files/file.h"
#include "base/units.h"
#include "terrain/soil/soil.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

namespace gonogo::terrain {
namespace {

const std::filesystem::path kShipped = std::filesystem::path(GONOGO_SOURCE_DIR) / "configs/soils";

/// Stress ratio on the plane that does not lengthen, by rotation: principal strain rates 1 and -k with the dilation
/// angle psi, sin(psi) = (k - 1) / (k + 1), and stresses at failure of the same axes.
double ratio_on_plane(double phi, double psi, double cohesion, double mean_stress) {
  const double k = (1 + std::sin(psi)) / (1 - std::sin(psi));
  const double away = std::atan(std::sqrt(1 / k));  // from the axis of compression to the plane's direction
  const double radius = mean_stress * std::sin(phi) + cohesion * std::cos(phi);
  const double normal = mean_stress - radius * std::cos(2 * away), shear = radius * std::sin(2 * away);
  return shear / normal;
}

Calibration table(bool with_shear) {
  Calibration c;
  c.grain_diameter = 0.03;
  c.packing = {{0.8, 0.56, 0}, {0.02, 0.63, 1}};
  c.contact = {{.friction = 0.1, .friction_angle = 15, .cohesion_gain = 0.1, .loosest_solid_fraction = 0.56},
               {.friction = 0.5, .friction_angle = 30, .cohesion_gain = 0.4, .loosest_solid_fraction = 0.56},
               {.friction = 0.9, .friction_angle = 45, .cohesion_gain = 0.6, .loosest_solid_fraction = 0.56}};
  const double triaxial[3][2] = {{15, 17}, {30, 36}, {45, 52}}, steady[3] = {14, 27, 33};
  const double peak[3][2] = {{14, 15}, {26, 28}, {36, 40}}, rest[3] = {13, 24, 30};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t p = 0; p < 2; ++p) {
      SoilResponse r;
      r.contact = k;
      r.packing = p;
      r.friction_angle = triaxial[k][p];
      r.steady_friction_angle = steady[k];
      if (with_shear) r.shear_peak = {peak[k][p], 0.3}, r.shear_steady = {rest[k], 0.3};
      c.response.push_back(r);
    }
  c.cohesion_gain = 0.4;
  return c;
}

MacroscopicSoil soil(double angle, StrengthTest test, Stage stage = Stage::peak, double density = 0,
                     double dilation = 0) {
  return {.friction_angle = angle,
          .cohesion = 1000,
          .bulk_density = 0,
          .relative_density = density,
          .meaning = {.test = test, .stage = stage, .dilation = dilation}};
}

}  // namespace

TEST_CASE("angles on the plane of shear are those of the plane that does not lengthen, and come back") {
  for (const double phi : {10.0, 20.0, 32.0, 45.0})
    for (const double psi : {-5.0, 0.0, 8.0, 15.0}) {
      CAPTURE(phi, psi);
      const double on_plane = angle_on_plane(phi, psi);
      CHECK(std::tan(to_radians(on_plane)) == Approx(ratio_on_plane(to_radians(phi), to_radians(psi), 0, 1)));
      CHECK(angle_of_triaxial(on_plane, psi) == Approx(phi));
      // With cohesion: the ratio at another mean stress gives the intercept.
      const double c = 0.3, k = (1 + std::sin(to_radians(psi))) / (1 - std::sin(to_radians(psi)));
      const double away = std::atan(std::sqrt(1 / k)),
                   radius = std::sin(to_radians(phi)) + c * std::cos(to_radians(phi));
      const double shear = radius * std::sin(2 * away), normal = 1 - radius * std::cos(2 * away);
      CHECK(shear == Approx(c * cohesion_on_plane(phi, psi) + normal * std::tan(to_radians(on_plane))));
    }
  CHECK(angle_of_triaxial(32) == Approx(38.67).margin(0.01));
  CHECK(angle_on_plane(30, 30) == Approx(30));  // a soil that dilates as much as it resists shows one angle
  CHECK_THROWS_AS(angle_of_triaxial(46), InputError);
}

TEST_CASE("a shear or residual angle becomes that of the grains that show it, by the table's curves") {
  const Calibration c = table(true);
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t p = 0; p < 2; ++p) {
      const SoilResponse& r = c.response[2 * k + p];
      const double density = double(p);
      CAPTURE(k, p);
      CHECK(
          as_triaxial(c, soil(r.shear_peak.degrees, StrengthTest::direct_shear, Stage::peak, density)).friction_angle ==
          Approx(r.friction_angle));
      CHECK(as_triaxial(c, soil(r.shear_steady.degrees, StrengthTest::ring_shear, Stage::residual, density))
                .friction_angle == Approx(r.friction_angle));
      CHECK(as_triaxial(c, soil(r.steady_friction_angle, StrengthTest::repose, Stage::peak, density)).friction_angle ==
            Approx(r.friction_angle));
      CHECK(on_shear_plane(c, soil(r.friction_angle, StrengthTest::triaxial, Stage::peak, density)).friction_angle ==
            Approx(r.shear_peak.degrees));
      const sim::PairLaw law =
          fit_soil(c, soil(r.shear_peak.degrees, StrengthTest::direct_shear, Stage::peak, density)).law;
      CHECK(law.friction == Approx(c.contact[k].friction));
    }
  // Cohesion on the plane is smaller by cos(phi) without dilation.
  CHECK(as_triaxial(c, soil(26, StrengthTest::direct_shear)).cohesion == Approx(1000 / std::cos(to_radians(30))));
}

TEST_CASE("without a curve, or with a dilation that was measured, the formula converts") {
  const Calibration plain = table(false);
  CHECK(as_triaxial(plain, soil(32, StrengthTest::ring_shear)).friction_angle == Approx(angle_of_triaxial(32)));
  CHECK(as_triaxial(table(true), soil(32, StrengthTest::direct_shear, Stage::peak, 0, 10)).friction_angle ==
        Approx(angle_of_triaxial(32, 10)));
  CHECK(as_triaxial(soil(36, StrengthTest::plane_strain)).friction_angle == Approx(32));
  CHECK(on_shear_plane(plain, soil(38.67, StrengthTest::triaxial)).friction_angle == Approx(32).margin(0.01));
  CHECK(as_triaxial(plain, soil(31, StrengthTest::triaxial)).friction_angle == 31);  // bit for bit
  CHECK(contains(input_error([&] { as_triaxial(soil(30, StrengthTest::plate)); }), "shows no friction angle"));
}

TEST_CASE("an angle is read back through a curve that falls, and goes on beyond its ends") {
  Calibration c = table(true);
  for (std::size_t p = 0; p < 2; ++p)
    c.response[2 + p].shear_peak.degrees = 38, c.response[4 + p].shear_peak.degrees = 34;
  double before = 0;
  for (double angle = 5; angle < 60; angle += 0.5) {
    const double triaxial = as_triaxial(c, soil(angle, StrengthTest::direct_shear)).friction_angle;
    CHECK(triaxial > before);
    before = triaxial;
  }
  CHECK(as_triaxial(c, soil(7, StrengthTest::direct_shear)).friction_angle == Approx(7.5));  // 15 of 14
  CHECK(as_triaxial(c, soil(40, StrengthTest::direct_shear)).friction_angle == Approx(49));  // 45 of 36
}

TEST_CASE("a file of schema 1 means triaxial compression; schema 2 refuses an angle without its test and says why") {
  const SoilFile ding = read_soil(kShipped / "ding2011.json");
  CHECK(ding.states[0].meaning.is_triaxial_peak());
  CHECK(ding.states[0].meaning.assumed);
  CHECK(ding.states[0].bekker->n.middle() == 1.1);
  const SoilFile lete = read_soil(kShipped / "lete_sand.json");
  CHECK(lete.states[0].meaning.test == StrengthTest::ring_shear);
  CHECK(lete.states[0].bekker->n.middle() == 0.793);
  const auto path = std::filesystem::temp_directory_path() / "gonogo-test-strength.json";
  const auto refused = [&](const std::string& tests, const std::string& more) {
    write_file_atomically(
        path, R"({"schema": "gonogo/soil/2", "name": "a", "about": "b", "states": [{"name": "c", "tests": [)" + tests +
                  R"(], "values": {)" + more +
                  R"("bulk_density_kg_per_m3": {"fixed": 1600, "source": "s"},
                                       "relative_density": {"fixed": 0.5, "source": "s"}}}]})");
    return input_error([&] { read_soil(path); });
  };
  const std::string angle = R"("friction_angle_deg": {"fixed": 32, "source": "s"})";
  const std::string without = refused("", angle + ", ");
  CHECK(contains(without, "does not say its test: as triaxial compression it is 32 deg, as direct or ring shear 38.7"));
  CHECK(contains(refused(R"({"test": "cone", "index_kPa": {"fixed": 500, "source": "s"}})", ""),
                 "none shows a friction angle"));
  CHECK(contains(refused(R"({"test": "plate", "n": {"fixed": 1, "source": "s"}})", ""), "k_c_kN_per_m_n_plus_1"));
  CHECK(contains(
      refused(R"({"test": "direct_shear", )" + angle + R"(, "cohesion_kPa": {"fixed": 1, "source": "s"}})", ""),
      "stage"));
  std::filesystem::remove(path);
}

}  // namespace gonogo::terrain
