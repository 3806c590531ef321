// Worlds divided over ranks in threads of this process; divided_mpi.cpp does the same with processes.
#include "sim/simulation/parts/divided.h"

#include "base/ranks/ranks.h"
#include "sim/simulation/parts/part.h"
#include "sim/simulation/parts/tile_cut.h"
#include "tests/sim/divided_scenes.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/message.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

constexpr Index kSteps = 200;

std::string in_one_piece(const DividedScene& scene, Index steps) {
  const auto simulation = make_simulation(Backend::cpu, {scene.world}, scene.settings, 1);
  take_steps(*simulation, scene, 0, steps);
  CHECK(simulation->report(0).flags == 0);
  return all_bytes(*simulation, scene);
}

/// What each rank says.
std::vector<std::string> divided(const DividedScene& scene, Index steps, int count) {
  std::vector<std::string> bytes(static_cast<std::size_t>(count));
  run_in_threads(count, [&](Ranks& ranks) {
    const auto simulation = make_divided_simulation(scene.world, scene.settings, 1, ranks);
    take_steps(*simulation, scene, 0, steps);
    bytes[std::size_t(ranks.rank())] = all_bytes(*simulation, scene);
  });
  return bytes;
}

}  // namespace

TEST_CASE("a world divided over one to four ranks has the bits of one in one piece") {
  for (const char* name : {"tank", "wheel", "wheel-substeps", "mixing"}) {
    const DividedScene scene = divided_scene(name);
    const std::string whole = in_one_piece(scene, kSteps);
    for (const int count : {1, 2, 3, 4})
      for (const std::string& part : divided(scene, kSteps, count)) {
        INFO(name << " over " << count);
        CHECK(part == whole);
      }
  }
}
