// Scenes of many bodies: what they are made of and what they measure.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "base/error.h"
#include "pipeline/bench/collide.h"
#include "pipeline/bench/drum.h"
#include "pipeline/bench/silo.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/many.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::pipeline;
using namespace gonogo::test;

TEST_CASE("a tank laid out from blocks holds the spheres asked for, inside of its walls, and steps take time") {
  TankSpec spec;
  spec.spheres = 3100;
  spec.layers = 6;
  const ManyScene scene = shaken_tank(spec, 20, sim::Backend::cpu, 1);
  CHECK(scene.world.body.size() == 3101);
  CHECK(std::size_t(std::count_if(scene.world.shape.begin(), scene.world.shape.end(),
                                  [](const sim::Shape& s) { return s.type == sim::ShapeType::sphere; })) == 3100);
  ManyRun run;
  run.repeats = 3;
  const ManyResult r = run_many(scene, run);
  CHECK(r.contacts > 2.5 * 3100);
  CHECK(r.contacts < 4.5 * 3100);
  CHECK(r.residual_m_per_s < 0.01);
  CHECK(r.ms_per_step > 0);
  for (const sim::Stage stage : {sim::Stage::bins, sim::Stage::contacts, sim::Stage::lists, sim::Stage::solve})
    CHECK(r.stages.of(stage) > 0);
  CHECK(r.ns_per_contact_iteration == Approx(r.ms_per_step * 1e6 / (double(r.contacts) * 20)));
}

TEST_CASE("a search by itself in a tank counts the contacts of a step there") {
  CollideBench request;
  request.tank.spheres = 1500;
  request.repeats = 3;
  const CollideBenchResult r = bench_collide(request);
  const auto simulation = sim::make_simulation(sim::Backend::cpu, {tank_world(request.tank, sim::Backend::cpu, 1)},
                                               many_step_settings(request.tank.of, 1), 1);
  simulation->advance(1);
  CHECK(r.contacts == simulation->report(0).contact_count);
  CHECK(r.ms_per_search > 0);
}

TEST_CASE("the mixing index is 0 for what is apart and 1 for what was mixed by draw") {
  Draw draw(821);
  std::vector<Vec3d> position;
  std::vector<bool> apart, mixed;
  for (int i = 0; i < 100'000; ++i) {
    position.push_back(draw.in_box({-1, -1, -1}, {1, 1, 1}));
    apart.push_back(position.back().x < 0);
    mixed.push_back(draw.below(2) == 0);
  }
  const double cube = 2.0 / 16;  // the plane between the kinds falls between cubes
  CHECK(lacey_index(position, apart, cube) == Approx(0).margin(1e-9));
  CHECK(lacey_index(position, mixed, cube) == Approx(1).margin(0.01));
}

TEST_CASE("a turning drum mixes, a standing one does not; pictures and frames of it are written") {
  DrumSpec spec;
  spec.spheres = 700;
  spec.froude = 0.3;
  const TemporaryFolder folder;
  ManyRun run;
  run.repeats = 0;
  run.vtk = folder.path() / "vtk";
  run.every = 0.5;
#ifdef GONOGO_WITH_PICTURES
  run.picture = folder.path() / "drum.png";
#endif
  const double turned = value_of(run_many(drum_scene(spec, 20), run), "mixing_index");
  CHECK(std::filesystem::exists(run.vtk / "spheres.pvd"));
  CHECK(std::filesystem::exists(run.vtk / "spheres_000001.vtp"));
  if (!run.picture.empty()) CHECK(std::filesystem::file_size(run.picture) > 10'000);
  spec.froude = 1e-8;
  ManyScene still = drum_scene(spec, 20);
  still.duration = 0.6;
  run.vtk.clear(), run.picture.clear();
  const double stood = value_of(run_many(still, run), "mixing_index");
  std::printf("mixing index after a turn %.3f, of a drum that stands %.3f\n", turned, stood);
  CHECK(stood < 0.35);
  CHECK(turned > stood + 0.15);
}

#ifdef GONOGO_WITH_PICTURES
TEST_CASE("a run can be shown as a video, where there is ffmpeg") {
  TankSpec spec;
  spec.spheres = 200;
  const TemporaryFolder folder;
  ManyRun run;
  run.repeats = 0;
  run.every = 0.04;
  run.video = folder / "tank.mp4";
  ManyScene scene = shaken_tank(spec, 10, sim::Backend::cpu, 1);
  if (std::system("ffmpeg -version > /dev/null 2>&1") == 0) {
    run_many(scene, run);
    CHECK(std::filesystem::file_size(run.video) > 5000);
  } else {
    CHECK_THROWS_AS(run_many(scene, run), InputError);
  }
}
#endif
