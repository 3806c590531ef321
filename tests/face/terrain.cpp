#include <gonogo/terrain.h>

#include <filesystem>

#include "tests/support/catch.h"

using namespace gonogo::api;

TEST_CASE("a table of the face gives grains of the friction angle asked for, and names its range") {
  const SoilTable table = SoilTable::read("calibration_90mm");
  CHECK(table.grain_diameter() == Approx(0.09));
  const Range angles = table.friction_angles();
  const SoilGrains soil = table.grains({.friction_angle = angles.middle(), .cohesion = 500});
  CHECK(soil.reached.friction_angle == Approx(angles.middle()).margin(0.1));
  CHECK(soil.reached.cohesion == Approx(500).epsilon(0.01));
  CHECK(soil.law.cohesion_pressure > 0);
  CHECK(soil.bed.grain_diameter == Approx(0.09));
  CHECK_THROWS_AS(table.grains({.friction_angle = 80}), InputError);
  CHECK_THROWS_AS(SoilTable::read("no_such_table"), InputError);
}

TEST_CASE("a bed of the face settles, is stored and read, and becomes a world") {
  const Bed bed = Bed::settle({.length = 1, .width = 0.6, .depth = 0.2, .seed = 3});
  CHECK(bed.surface() == Approx(0.2).margin(0.05));
  CHECK(bed.highest_point() > bed.surface());
  CHECK(bed.solid_fraction() > 0.5);
  CHECK(bed.solid_fraction() < 0.75);
  const auto file = std::filesystem::temp_directory_path() / "gonogo_face_bed.h5";
  bed.write(file);
  const Bed again = Bed::read(file);
  std::filesystem::remove(file);
  CHECK(again.highest_point() == bed.highest_point());
  CHECK(again.settings().seed == 3);
  CHECK(bed.tiled(2, 1).grain_count() == 2 * bed.grain_count());
  CHECK(bed.shifted(5).solid_fraction() == bed.solid_fraction());

  const World world = bed.world({.friction = 0.6}, {.friction = 0.6});
  CHECK(world.body_count() == bed.grain_count() + 1);
  Simulation simulation({world}, bed.step_settings());
  simulation.step(20);
  CHECK(simulation.report().contacts > bed.grain_count());
  CHECK(simulation.report().kinetic_energy < 1);
  CHECK_THROWS_AS(Bed::settle({.length = 0.05}), InputError);
}

TEST_CASE("soils of the face have names, textures and cone indices") {
  const auto states = read_soil("usda");
  REQUIRE(states.size() >= 12);
  for (const SoilState& s : states) {
    CHECK(s.friction_angle.low <= s.friction_angle.high);
    CHECK(s.middle().cohesion == Approx(s.cohesion.middle()));
  }
  CHECK(usda_texture(65, 25, 10) == "sandy loam");
  CHECK_THROWS_AS(usda_texture(65, 25, 30), InputError);
  CHECK(cone_index({.friction_angle = 20, .cohesion = 20e3}) > cone_index({.friction_angle = 20, .cohesion = 5e3}));
}
