// The calibration run: its journal, its table, and what it says of soils.
#include "terrain/soil_test/calibrate.h"

#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/units.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo::terrain {
namespace {

std::filesystem::path scratch(const std::string& name) {
  auto folder = std::filesystem::temp_directory_path() / ("gonogo-test-" + name);
  std::filesystem::remove_all(folder);
  return folder;
}

CalibrationRun coarse_run(const std::filesystem::path& folder) {
  CalibrationRun run;
  run.grain_diameter = 0.1;
  run.seeds = run.angle_seeds = 1;
  run.numerics = {2e-3, 1, 10, 0.1};
  run.journal = folder / "journal.json";
  return run;
}

/// Made-up results: the sine of the friction angle is 1/4 of the sliding friction after the peak and 1/3 at it, more in
/// looser packings, and cohesion is a tenth of its ratio; from the second seed on the sine is larger by 0.01. On the
/// plane of shear the tangent is half the sliding friction at the peak, a third after it. Beds that settle with their
/// own laws are the looser the rougher.
std::vector<double> made_up(const std::string& test) {
  const auto number_after = [&](const std::string& word) {
    return std::stod(test.substr(test.find(word) + word.size()));
  };
  const double friction = number_after("friction ");
  if (test.rfind("loosest", 0) == 0) return {0.6 - 0.1 * friction};
  const double settled = number_after("settled at ");
  if (test.rfind("plate", 0) == 0) return {1e6 * friction, 0.8, 1e-4, 0.64 - 0.07 * settled};
  if (test.rfind("shear", 0) == 0) return {friction / 2, friction / 3, 1e-4};
  const double cohesion = 0.1 * number_after("cohesion "), more = number_after("seed ") > 1 ? 0.01 : 0;
  // Mohr and Coulomb: s1 (1 - sin) = s3 (1 + sin) + 2 c cos.
  const auto axial = [&](double sine) { return (1 + sine + 2 * cohesion * std::sqrt(1 - sine * sine)) / (1 - sine); };
  return {axial(friction / 4), 1, axial(friction / 3 + settled / 10 + more), 1, 1e-4};
}

void fill(const CalibrationRun& run, const std::string& but) {
  TestJournal journal(run.journal, journal_maker(run));
  for (const std::string& name : calibration_tests(run))
    if (name != but) journal.add(name, made_up(name));
}

/// Contact law in the packing that the soil's density asks for.
sim::PairLaw law_of(const Calibration& c, const MacroscopicSoil& soil) {
  return contact_law(c, soil, packing_level(c, soil));
}

/// What a refused request says; empty when it is not refused.
template <class Request>
std::string refusal(Request request) {
  try {
    request();
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a table is what its tests measured") {
  const auto folder = scratch("calibrate-table");
  const CalibrationRun run = coarse_run(folder);
  fill(run, "");
  const Calibration c = calibrate(run);
  REQUIRE(c.contact.size() == 11);
  REQUIRE(c.contact[5].friction == 0.5);
  CHECK(c.packing.front().solid_fraction == Approx(0.64 - 0.07 * 0.8));
  CHECK(c.packing.front().relative_density == Approx(0).margin(1e-12));
  CHECK(c.packing.back().relative_density == Approx(1));
  const auto degrees = [](double sine) { return to_degrees(std::asin(sine)); };
  CHECK(c.response[5 * 3 + 1].steady_friction_angle == Approx(degrees(0.5 / 4)));
  CHECK(c.response[5 * 3 + 1].friction_angle == Approx(degrees(0.5 / 3 + 0.025)));
  CHECK(c.response[5 * 3 + 1].shear_peak.degrees == Approx(to_degrees(std::atan(0.5 / 2))));
  CHECK(c.response[5 * 3 + 1].shear_steady.degrees == Approx(to_degrees(std::atan(0.5 / 3))));
  CHECK(c.contact[5].friction_angle ==
        Approx((degrees(0.5 / 3 + 0.08) + degrees(0.5 / 3 + 0.025) + degrees(0.5 / 3 + 0.002)) / 3));
  CHECK(c.contact[5].cohesion_gain == Approx(0.1));
  CHECK(c.response[5 * 3 + 1].sinkage_modulus == Approx(0.5e6));
  // Grains without rolling friction do not settle more loosely than the library's loosest packing, rough ones do.
  CHECK(c.contact[3].loosest_solid_fraction == c.packing.front().solid_fraction);
  CHECK(c.contact[4].loosest_solid_fraction == Approx(0.56));
  CHECK(c.contact[8].loosest_solid_fraction == Approx(0.52));
  write_calibration(folder / "table.json", c);
  const Calibration again = read_calibration(folder / "table.json");
  CHECK(again.response[5].sinkage_modulus == c.response[5].sinkage_modulus);
  CHECK(again.response[7].shear_steady.degrees == c.response[7].shear_steady.degrees);
  CHECK(again.contact[6].friction_angle == c.contact[6].friction_angle);
  CHECK(again.contact[6].loosest_solid_fraction == c.contact[6].loosest_solid_fraction);
  std::filesystem::remove_all(folder);
}

TEST_CASE("cones are added to a finished table, which keeps all else, and are read back") {
  const auto folder = scratch("calibrate-cones");
  CalibrationRun run = coarse_run(folder);
  fill(run, "");
  Calibration c = calibrate(run);
  const Calibration before = c;
  run.seeds = 2;
  {
    // Gradients are 100 times the sliding friction, 10 % more in the second packing; two of the dense level 3 fail.
    TestJournal journal(run.journal, journal_maker(run));
    for (const ContactLevel& l : c.contact)
      for (const double settled : {0.8, 0.25, 0.02})
        for (int seed = 1; seed <= run.seeds; ++seed) {
          const bool fails = l.friction == 0.3 && settled == 0.02;
          const std::string name =
              line("cone friction %g rolling %g settled at %g seed %d", l.friction, l.rolling_friction, settled, seed);
          journal.add(name, fails ? std::vector<double>{} : std::vector<double>{100 * l.friction + 2 * seed, 1e-4});
        }
  }
  add_cones(c, run);
  CHECK(c.response[5 * 3 + 1].cone_gradient == Approx(53));
  CHECK(c.response[5 * 3 + 1].cone_gradient_error == Approx(1));
  CHECK(c.response[3 * 3 + 2].cone_gradient == 0);
  CHECK(c.provenance.at("failed_cones").number() == 2);
  const double between = before.response[5 * 3].friction_angle / 2 + before.response[6 * 3].friction_angle / 2;
  CHECK(cone_gradient(c, between, 0) == Approx(std::sqrt(53.0 * 63)).epsilon(1e-3));
  CHECK(cone_gradient(c, before.response[3 * 3 + 2].friction_angle, 2) == 0);
  CHECK(cone_gradient(before, between, 0) == 0);
  write_calibration(folder / "table.json", c);
  CHECK(contains(read_file(folder / "table.json"), "gonogo/calibration/7"));
  const Calibration again = read_calibration(folder / "table.json");
  CHECK(again.response[7].cone_gradient == c.response[7].cone_gradient);
  CHECK(again.response[7].shear_steady.degrees == before.response[7].shear_steady.degrees);
  Calibration old = before;
  for (SoilResponse& r : old.response) r.shear_peak = {};
  CHECK(refusal([&] { add_cones(old, run); }).find("its version is below 6") != std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST_CASE("further specimens count for friction angles alone") {
  const auto folder = scratch("calibrate-angles");
  CalibrationRun run = coarse_run(folder);
  run.angle_seeds = 3;
  fill(run, "");
  const Calibration c = calibrate(run);
  const double mean_sine = 0.5 / 3 + 0.025 + 0.02 / 3;
  CHECK(c.response[5 * 3 + 1].friction_angle == Approx(to_degrees(std::asin(mean_sine))));
  CHECK(c.response[5 * 3 + 1].friction_angle_error > 0);
  CHECK(c.response[5 * 3 + 1].cohesion_gain == Approx(0.1));
  CHECK(c.response[5 * 3 + 1].sinkage_modulus_error == 0);  // of one specimen
  std::filesystem::remove_all(folder);
}

TEST_CASE("a table of a range of contact levels has what the whole table has there") {
  const auto folder = scratch("calibrate-range");
  CalibrationRun run = coarse_run(folder);
  fill(run, "");
  const Calibration whole = calibrate(run);
  run.friction_range = {0.5, 0.7};
  CHECK(calibration_tests(run).size() < calibration_tests(coarse_run(folder)).size() / 3);
  const Calibration part = calibrate(run);
  REQUIRE(part.contact.size() == 3);
  CHECK(part.packing.front().solid_fraction == whole.packing.front().solid_fraction);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(part.contact[k].friction == whole.contact[k + 5].friction);
    CHECK(part.contact[k].friction_angle == whole.contact[k + 5].friction_angle);
    CHECK(part.contact[k].loosest_solid_fraction == whole.contact[k + 5].loosest_solid_fraction);
    for (std::size_t p = 0; p < 3; ++p)
      CHECK(part.response[3 * k + p].friction_angle == whole.response[3 * (k + 5) + p].friction_angle);
  }
  run.friction_range = {0.65, 0.7};
  CHECK(refusal([&] { calibrate(run); }).find("leaves 1 contact levels") != std::string::npos);
  std::filesystem::remove_all(folder);
}

TEST_CASE("one changed digit in a journal of soil tests is refused") {
  const TemporaryFolder folder;
  const auto path = folder / "journal.json";
  TestJournal(path, "maker").add("triaxial", {0.25, 31.5});
  const std::string whole = read_file(path);
  for (const char* number : {"0.25", "31.5"}) {
    std::string bytes = whole;
    bytes[bytes.find(number) + 3] ^= 1;
    write_file_atomically(path, bytes);
    CHECK(contains(input_error([&] { TestJournal(path, "maker"); }), "does not match the rest of the file"));
  }
  write_file_atomically(path, whole);
  CHECK(TestJournal(path, "maker").find("triaxial") == std::vector<double>{0.25, 31.5});
}

TEST_CASE("a run that goes on does only what its journal lacks, and has the bits of one that was never interrupted") {
  const auto folder = scratch("calibrate-resume");
  const CalibrationRun run = coarse_run(folder);
  const std::string lacking = calibration_tests(run).front();
  fill(run, lacking);
  calibrate(run);
  const TestJournal first(run.journal, journal_maker(run));
  const auto measured = first.find(lacking);
  REQUIRE(measured.has_value());
  const double sine = (measured->at(2) - measured->at(3)) / (measured->at(2) + measured->at(3));
  CHECK(sine > 0.1);  // a real test of slippery grains, not a made-up one: 0.05 / 3 + 0.08 there
  CHECK(sine < 0.4);
  std::filesystem::remove(run.journal);
  fill(run, lacking);
  calibrate(run);
  CHECK(TestJournal(run.journal, journal_maker(run)).find(lacking) == measured);
  const std::string before = read_file(run.journal);
  calibrate(run);  // nothing left to do
  CHECK(read_file(run.journal) == before);
  CalibrationRun other = run;
  other.grain_diameter = 0.2;
  CHECK_THROWS_AS(calibrate(other), InputError);
  other = run;
  other.numerics.substeps = 14;  // another solver, another soil
  CHECK_THROWS_AS(calibrate(other), InputError);
  std::filesystem::remove_all(folder);
}

TEST_CASE("a soil is met by the friction angles of its own packing") {
  Calibration c;
  c.grain_diameter = 0.03;
  c.packing = {{0.8, 0.57, 0}, {0.02, 0.63, 1}};
  c.contact = {{0.1, 0, 13, 0, 0.1, 0}, {0.5, 0.2, 28, 0, 0.1, 0}, {0.9, 0.6, 33, 0, 0.1, 0}};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t p = 0; p < 2; ++p) {
      SoilResponse r;
      r.contact = k;
      r.packing = p;
      r.friction_angle = p == 0 ? 11 + 10 * double(k) : k == 2 ? 35 : 15 + 20 * double(k);
      c.response.push_back(r);
    }
  CHECK(law_of(c, {25, 0, 0, 0.9}).friction == Approx(0.3f));
  CHECK(law_of(c, {26, 0, 0, 0.2}).rolling_friction == Approx(0.4f));
  CHECK(fit_soil(c, {25, 0, 0, 0.9}).friction_angle == Approx(25));
  CHECK(reachable_angles(c, std::size_t(1)).highest == 35);
  CHECK(reachable_angles(c).lowest == 15);  // in every packing
  CHECK(reachable_angles(c).highest == 31);
  CHECK(refusal([&] { law_of(c, {36, 0, 0, 0.9}); }).find("between 15 and 35") != std::string::npos);
  // A table without them has one angle for all packings.
  for (SoilResponse& r : c.response) r.friction_angle = 0;
  CHECK(law_of(c, {28, 0, 0, 0.9}).friction == Approx(0.5f));
  CHECK(law_of(c, {28, 0, 0, 0.2}).friction == Approx(0.5f));
}

TEST_CASE("relative density counts from the loosest bed of a soil's own grains") {
  Calibration c;
  c.grain_diameter = 0.03;
  c.packing = {{0.8, 0.58, 0}, {0.25, 0.6, 0.4}, {0.02, 0.63, 1}};
  c.contact = {{0.1, 0, 15, 0, 0.1, 0}, {0.5, 0.2, 25, 0, 0.1, 0}, {0.9, 0.6, 35, 0, 0.1, 0}};
  CHECK(packing_level(c, {30, 0, 0, 0.35}) == 1);  // one count for all grains: those of the library
  c.contact[0].loosest_solid_fraction = 0.58;
  c.contact[1].loosest_solid_fraction = 0.57;
  c.contact[2].loosest_solid_fraction = 0.53;
  // At 30 degrees grains settle at 0.55: the three packings have relative densities 0.408, 0.656 and 1.
  const SoilFit f = fit_soil(c, {30, 0, 0, 0.5});
  CHECK(f.packing == 0);
  CHECK(f.relative_density == Approx((1 / 0.55 - 1 / 0.58) / (1 / 0.55 - 1 / 0.63)));
  CHECK(packing_level(c, {30, 0, 0, 0.35}) == 0);
  CHECK(packing_level(c, {30, 0, 0, 0.55}) == 1);
  CHECK(packing_level(c, {30, 0, 0, 0.9}) == 2);
  // At 15 degrees nothing changes.
  CHECK(packing_level(c, {15, 0, 0, 0.35}) == 1);
}

TEST_CASE("a soil within reach is met in friction angle, cohesion and density; others are refused with the reach") {
  const auto folder = scratch("calibrate-fit");
  const CalibrationRun run = coarse_run(folder);
  fill(run, "");
  const Calibration c = calibrate(run);
  const SoilFit f = fit_soil(c, {10, 2e3, 1500, 1});
  CHECK(f.friction_angle == Approx(10));
  CHECK(f.cohesion == Approx(2e3));
  CHECK(double(f.law.cohesion_pressure) == Approx(2e4));
  CHECK(f.bulk_density == Approx(1500));
  CHECK(f.grain_density == Approx(1500 / (0.64 - 0.07 * 0.02)));
  CHECK(f.packing == 2);
  CHECK(f.sinkage_exponent == Approx(0.8));
  CHECK(fit_soil(c, {10, 2e3}).grain_density == Approx(2650));
  CHECK(refusal([&] { fit_soil(c, {50, 0}); }).find("outside what grains") != std::string::npos);
  CHECK(refusal([&] { fit_soil(c, {10, 0, 400, 0}); }).find("choose one between") != std::string::npos);
  Calibration unsure = c;
  for (ContactLevel& l : unsure.contact) l.cohesion_gain_error = 0.05;
  CHECK(refusal([&] { fit_soil(unsure, {10, 2e3}); }).find("50 per cent") != std::string::npos);
  CHECK_NOTHROW(fit_soil(unsure, {10, 0}));
  std::filesystem::remove_all(folder);
}

TEST_CASE("cohesion is met up to twice the stress under a wheel, and refused above it with how close the grains come") {
  Calibration c;
  c.grain_diameter = 0.03;
  c.packing = {{0.8, 0.57, 0}, {0.02, 0.63, 1}};
  c.contact = {{0.1, 0, 14, 0, 0.1, 0}, {0.5, 0.2, 30, 0, 0.5, 0}};
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t p = 0; p < 2; ++p) {
      SoilResponse r;
      r.contact = k;
      r.packing = p;
      r.friction_angle = k == 0 ? 14 : 30;
      c.response.push_back(r);
    }
  // Half-way along the line 0.3 Pa of cohesion come from 1 Pa between grains: 220 kPa there give 66.
  CHECK(reachable_cohesion(c, 22, 0) == Approx(66e3));
  CHECK(reachable_cohesion(c, 14, 1) == Approx(22e3));
  CHECK(reachable_cohesion(c, 30, 1) == Approx(110e3));
  CHECK(double(law_of(c, {22, 65.9e3, 0, 0}).cohesion_pressure) == Approx(65.9e3 / 0.3));
  CHECK(fit_soil(c, {22, 65.9e3, 0, 0}).cohesion == Approx(65.9e3));
  for (const auto& refused : {refusal([&] {
                                law_of(c, {22, 66.1e3, 0, 0});
                              }),
                              refusal([&] {
                                fit_soil(c, {22, 66.1e3, 0, 0});
                              })}) {
    CHECK(refused.find("cohesion 66100 Pa at friction angle 22 deg") != std::string::npos);
    CHECK(refused.find("choose at most 66000 Pa") != std::string::npos);
  }
  CHECK(refusal([&] { law_of(c, {22, 0, 0, 0}); }).empty());
}

TEST_CASE("of the shipped soils lean clay with little water is out of reach of every table, loose soils are not") {
  const std::filesystem::path soils = std::filesystem::path(GONOGO_SOURCE_DIR) / "configs/soils";
  for (const char* table : {"calibration_10mm.json", "calibration_32mm.json", "calibration_90mm.json"}) {
    const Calibration c = read_calibration(soils / table);
    const MacroscopicSoil lean_clay{20, 68.95e3, 0, 0.5}, sandy_loam{20, 4.83e3, 0, 0.5}, hanamoto{22, 13.79e3, 0, 0.5};
    const std::string refused = refusal([&] { fit_soil(c, lean_clay); });
    CHECK(refused.find("cohesion 68950 Pa") != std::string::npos);
    CHECK(refused.find("its tests went to 1 times") != std::string::npos);
    CHECK(fit_soil(c, sandy_loam).cohesion == Approx(4.83e3));
    CHECK(fit_soil(c, hanamoto).cohesion == Approx(13.79e3));
  }
}

TEST_CASE("triaxial compression and simple shear of the shipped tables end in the same strength") {
  const std::filesystem::path soils = std::filesystem::path(GONOGO_SOURCE_DIR) / "configs/soils";
  for (const char* table : {"calibration_10mm.json", "calibration_32mm.json", "calibration_90mm.json"}) {
    const Calibration c = read_calibration(soils / table);
    CHECK(numerics_by_table(c, table) == usual_numerics(c.grain_diameter));
    REQUIRE(c.response.size() == 33);
    for (const SoilResponse& r : c.response) {
      // Without dilation the plane of shear of a triaxial test has tan(phi_s) = sin(phi_t).
      const double on_plane = to_degrees(std::atan(std::sin(to_radians(r.steady_friction_angle))));
      CHECK(r.shear_steady.degrees == Approx(on_plane).margin(2 + 3 * r.shear_steady.error));
      CHECK(r.shear_peak.degrees > r.shear_steady.degrees);
      CHECK(r.friction_angle > r.steady_friction_angle);
    }
  }
}

TEST_CASE(
    "at their peaks both tests of the 32 mm table agree through the dilation that shear cells show, but for the "
    "roughest") {
  // Rise of the plate over its travel around the peak, 4 to 8 cells of the middle packing (docs/log/creep.md).
  struct Dilation {
    double friction, angle, error;
  };
  constexpr Dilation kMeasured[] = {{0.05, 0.2, 0.5}, {0.1, 1.5, 0.6}, {0.2, 1.6, 0.6}, {0.3, 2.1, 0.7},
                                    {0.4, 3.8, 0.9},  {0.5, 4.7, 0.8}, {0.6, 7.2, 1.1}, {0.7, 8.3, 0.9},
                                    {0.8, 8.6, 1.6},  {0.9, 9.2, 1.1}};
  const Calibration c =
      read_calibration(std::filesystem::path(GONOGO_SOURCE_DIR) / "configs/soils/calibration_32mm.json");
  for (std::size_t k = 0; k < std::size(kMeasured); ++k) {
    const Dilation& psi = kMeasured[k];
    const SoilResponse& r = c.response[3 * k + 1];
    CAPTURE(psi.friction);
    REQUIRE(c.contact[k].friction == psi.friction);
    const auto on_plane = [&](double dilation) { return angle_on_plane(r.friction_angle, dilation); };
    const double error = std::hypot(r.shear_peak.error, on_plane(psi.angle + psi.error) - on_plane(psi.angle));
    CHECK(r.shear_peak.degrees == Approx(on_plane(psi.angle)).margin(2 + 3 * error));
  }
}

TEST_CASE("beds of the shipped trefoils harden with density and end in one critical state, and stand for GRC-1") {
  const std::filesystem::path soils = std::filesystem::path(GONOGO_SOURCE_DIR) / "configs/soils";
  const Calibration c = read_calibration(soils / "calibration_32mm_trefoil.json");
  CHECK(c.shape == GrainShape::trefoil);
  REQUIRE(c.packing.size() == 3);
  for (std::size_t k = 0; k < c.contact.size(); ++k) {
    const SoilResponse &loose = c.response[3 * k], &middle = c.response[3 * k + 1], &dense = c.response[3 * k + 2];
    CHECK(loose.friction_angle + 3 < middle.friction_angle);
    CHECK(middle.friction_angle + 5 < dense.friction_angle);
    for (const SoilResponse* r : {&loose, &middle, &dense})
      CHECK(r->steady_friction_angle == Approx(loose.steady_friction_angle).margin(1));
  }
  const SoilFit grc1 = fit_soil(c, {38.4, 0, 1760, 0.59});
  CHECK(c.packing[grc1.packing].settle_friction == 0.25);
  CHECK(grc1.friction_angle == Approx(38.4));
  CHECK(grc1.bulk_density == Approx(1760));
  CHECK(grc1.law.rolling_friction == 0);
  CHECK(double(grc1.law.friction) == Approx(0.565).margin(0.01));
}

}  // namespace gonogo::terrain
