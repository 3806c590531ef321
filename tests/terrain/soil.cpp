// Beds, their files and the calibration's inverse.
#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "base/files/file.h"
#include "terrain/soil/calibration.h"
#include "terrain/soil_test/strength_test.h"
#include "tests/support/catch.h"

namespace gonogo::terrain {
namespace {

BedSpec small_bed() {
  BedSpec spec = shear_cell(0.09, 0.1, 3);
  spec.depth = 0.36;
  return spec;
}

Calibration table() {
  Calibration c;
  c.grain_diameter = 0.09;
  c.packing = {{0.8, 0.57, 0}, {0.02, 0.63, 1}};
  c.contact = {{0.1, 0, 15, 0.3, 0.1, 0.01}, {0.5, 0.1, 22, 0.4, 0.1, 0.01}, {0.9, 0.5, 30, 1, 0.1, 0.01}};
  c.cohesion_gain = 0.1;
  return c;
}

std::filesystem::path scratch(const std::string& name) {
  auto folder = std::filesystem::temp_directory_path() / ("gonogo-test-" + name);
  std::filesystem::remove_all(folder);
  return folder;
}

}  // namespace

TEST_CASE("a settled packing is dense, at rest, and overlaps by less than a hundredth of a grain") {
  const Packing p = settle_packing(small_bed(), 1);
  // Random packings of spheres lie between 0.55 (loose, frictional) and 0.64 (random close).
  CHECK(p.solid_fraction > 0.55);
  CHECK(p.solid_fraction < 0.66);
  CHECK(p.residual_speed < 0.01);
  double deepest = 0;
  for (std::size_t i = 0; i < p.grain.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Grain &a = p.grain[i], &b = p.grain[j];
      const double dx = std::remainder(a.position.x - b.position.x, p.spec.length);
      const double dy = std::remainder(a.position.y - b.position.y, p.spec.width);
      const double dz = a.position.z - b.position.z;
      deepest = std::max(deepest, a.radius + b.radius - std::sqrt(dx * dx + dy * dy + dz * dz));
    }
  CHECK(deepest < 0.01 * p.spec.grain_diameter);
}

TEST_CASE("a packing has the same bits for any number of threads and after a trip through its file") {
  const Packing one = settle_packing(small_bed(), 1), two = settle_packing(small_bed(), 2);
  const auto folder = scratch("packing");
  write_packing(folder / "p.h5", one);
  const Packing read = read_packing(folder / "p.h5");
  REQUIRE(one.grain.size() == two.grain.size());
  REQUIRE(one.grain.size() == read.grain.size());
  for (std::size_t i = 0; i < one.grain.size(); ++i) {
    CHECK(one.grain[i].position.x == two.grain[i].position.x);
    CHECK(one.grain[i].position.z == two.grain[i].position.z);
    CHECK(one.grain[i].position.y == read.grain[i].position.y);
    CHECK(one.grain[i].radius == read.grain[i].radius);
  }
  CHECK(read.spec.hash() == one.spec.hash());
  CHECK(read.surface == one.surface);
  std::filesystem::remove_all(folder);
}

TEST_CASE("a damaged packing in the cache is settled again to the same bits") {
  const auto folder = scratch("packing-cache");
  const Packing first = cached_packing(small_bed(), folder, 1);
  const auto path = packing_path(small_bed(), folder);
  const std::string whole = read_file(path);
  std::ofstream(path, std::ios::binary) << whole.substr(0, whole.size() / 2);
  CHECK_THROWS_AS(read_packing(path), InputError);
  const Packing again = cached_packing(small_bed(), folder, 1);
  CHECK(again.grain.back().position.z == first.grain.back().position.z);
  CHECK(read_file(path) == whole);
  std::filesystem::remove_all(folder);
}

TEST_CASE("a shift moves a packing without changing any distance") {
  const Packing p = settle_packing(small_bed(), 1), q = shifted(p, 17);
  const auto distance = [](const Packing& b, std::size_t i, std::size_t j) {
    const double dx = std::remainder(b.grain[i].position.x - b.grain[j].position.x, b.spec.length);
    const double dy = std::remainder(b.grain[i].position.y - b.grain[j].position.y, b.spec.width);
    return std::hypot(dx, dy);
  };
  CHECK(p.grain[0].position.x != q.grain[0].position.x);
  for (std::size_t i = 1; i < p.grain.size(); i += 7)
    CHECK(distance(p, 0, i) == Approx(distance(q, 0, i)).margin(1e-12));
}

TEST_CASE("the calibration's inverse reproduces its nodes, lies between them, and refuses what grains cannot reach") {
  const Calibration c = table();
  CHECK(contact_law(c, {22, 0}, 0).friction == Approx(0.5));
  CHECK(contact_law(c, {22, 0}, 0).rolling_friction == Approx(0.1));
  CHECK(contact_law(c, {26, 0}, 0).friction == Approx(0.7));
  CHECK(contact_law(c, {15, 500}, 0).cohesion_pressure == Approx(5000));
  CHECK(contact_law(c, {30, 0}, 0).friction == Approx(0.9));
  CHECK_THROWS_AS(contact_law(c, {14.9, 0}, 0), InputError);
  CHECK_THROWS_AS(contact_law(c, {30.1, 0}, 0), InputError);
  CHECK_THROWS_AS(contact_law(c, {std::nan(""), 0}, 0), InputError);
  CHECK(packing_level(c, {20, 0, 0, 0.4}) == 0);
  CHECK(packing_level(c, {20, 0, 0, 0.6}) == 1);
}

TEST_CASE("the calibration that ships is monotone and comes back from its file") {
  const Calibration c =
      read_calibration(std::filesystem::path(GONOGO_SOURCE_DIR) / "configs/soils/calibration_90mm.json");
  for (std::size_t k = 1; k < c.contact.size(); ++k)
    CHECK(c.contact[k].friction_angle >= c.contact[k - 1].friction_angle);
  CHECK(c.cohesion_gain > 5 * c.cohesion_gain_error);
  const auto folder = scratch("calibration");
  write_calibration(folder / "c.json", c);
  CHECK(read_calibration(folder / "c.json").contact.back().friction_angle == c.contact.back().friction_angle);
  std::filesystem::remove_all(folder);
}

TEST_CASE("grains with friction resist shear more than slippery ones, and cohesion adds strength") {
  const Packing cell = settle_packing(shear_cell(0.09, 0.25, 1), 1);
  ShearSettings settings;
  settings.travel = 1;
  const auto shear = [&](float friction, float cohesion) {
    const sim::PairLaw law{friction, 0, cohesion};
    return shear_test(cell, {law, law}, settings);
  };
  const ShearResult slippery = shear(0.1f, 0), rough = shear(0.5f, 0), sticky = shear(0.1f, 30e3f);
  CHECK(slippery.normal_stress == Approx(settings.normal_stress).epsilon(0.02));  // the plate's weight is carried
  CHECK(rough.shear_stress > 1.1 * slippery.shear_stress);
  // The shipped table measured a gain of 0.096 +- 0.006 for these grains, from 18 pairs of tests; one pair scatters
  // more.
  const double gain = (sticky.shear_stress - slippery.shear_stress) / 30e3;
  CHECK(gain > 0.04);
  CHECK(gain < 0.16);
}

}  // namespace gonogo::terrain
