// Scenes of many bodies: what they are made of and what they measure.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "base/error.h"
#include "base/files/shipped.h"
#include "base/units.h"
#include "pipeline/lab/scenes/collapse.h"
#include "pipeline/lab/scenes/drum.h"
#include "pipeline/lab/scenes/scene.h"
#include "pipeline/lab/scenes/screen.h"
#include "pipeline/lab/scenes/silo.h"
#include "pipeline/lab/scenes/tank.h"
#include "pipeline/report/figure/captioned.h"
#include "sim/simulation/layout/memory.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/refused.h"
#include "tests/support/run_scene.h"
#include "tests/support/same_bits.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::report;
using namespace gonogo::lab;
using namespace gonogo::test;

TEST_CASE("a tank laid out from tiles holds the spheres asked for, inside of its walls, and steps take time") {
  TankSpec spec;
  spec.of.count = 3100;
  spec.layers = 6;
  const ManyScene scene = shaken_tank(spec, {.iterations = 20});
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

TEST_CASE("a tank that does not fit into the GPUs is refused before its first step and writes nothing") {
  const TemporaryFolder folder;
  const ManyScene scene = shaken_tank({.of = {.count = 1200}, .layers = 6}, {.iterations = 20});
  ManyRun run;
  run.vtk = folder / "frames";
  const sim::PlantedMemory small(1e5);
  for (const int gpus : {1, 2}) {
    run.on.gpus = gpus;
    CHECK_THROWS_AS(run_many(scene, run), OutOfMemory);
  }
  CHECK(std::filesystem::is_empty(folder.path()));
}

TEST_CASE("every solver is timed in the same tank") {
  using sim::Iteration;
  const TankSpec spec{.of = {.count = 1200}, .layers = 6};
  const ManyScene usual = shaken_tank(spec, {.iterations = 40});
  ManyRun run;
  run.repeats = 3;
  const double contacts = double(run_many(usual, run).contacts);
  for (const Iteration iteration :
       {Iteration::jacobi, Iteration::jacobi_scan, Iteration::gauss_seidel, Iteration::bb}) {
    const ManyScene scene = shaken_tank(spec, {.solver = {.iteration = iteration}, .iterations = 40});
    CHECK(scene.settings.iteration == iteration);
    bool same = true;
    for (std::size_t b = 0; b < usual.world.body.size(); ++b)
      same = same && length(scene.world.body[b].position - usual.world.body[b].position) == 0;
    CHECK(same);
    const ManyResult r = run_many(scene, run);
    CHECK(double(r.contacts) == Approx(contacts).epsilon(0.05));
    CHECK(r.residual_m_per_s < 0.02);
    CHECK(r.ns_per_contact_iteration_solver > 0);
    CHECK(r.bandwidth_share > 0);
  }
}

TEST_CASE("penalty contact runs the same tank in steps of its own, about as dense and as quiet") {
  using sim::ContactLaw;
  TankSpec spec{.of = {.count = 1200}, .layers = 6};
  spec.seconds = 0.02;
  ManyScene usual = shaken_tank(spec, {.iterations = 40});
  set_penalty(usual, {});
  CHECK(usual.settings.step == Real(2e-3));
  ManyRun run;
  run.repeats = 3;
  run.steps_per_sample = 2;
  for (const ContactLaw contact : {ContactLaw::spring_damper, ContactLaw::hertz}) {
    ManyScene scene = shaken_tank(spec, {.solver = {.contact = contact}});
    set_penalty(scene, {});
    CHECK(scene.settings.step < usual.settings.step / 5);
    scene.measure = [&](sim::Simulation& simulation) -> std::vector<SceneNumber> {
      double sum = 0;
      for (const sim::BodyState& b : simulation.bodies(0)) sum += b.position.z;
      return {{"mean_height", sum / 1200}};
    };
    ManyScene beside = usual;
    beside.measure = scene.measure;
    const ManyResult r = run_many(scene, run), other = run_many(beside, run);
    CHECK(r.measured[0].value == Approx(other.measured[0].value).epsilon(0.02));
    CHECK(r.contacts > 1.5 * 1200);
    CHECK(r.bandwidth_share > 0);
  }
}

TEST_CASE("a long tank holds the spheres asked for, and its floor is as long as asked for") {
  TankSpec spec{.of = {.count = 2500}, .layers = 3, .length_over_width = 3};
  const sim::SceneWorld world = tank_world(spec, {});
  CHECK(world.body.size() == 2501);
  CHECK(world.size.x / world.size.y == Approx(3).epsilon(0.2));
  double reach = 0;
  for (const sim::BodyState& b : world.body) reach = std::max(reach, b.position.x / world.size.x);
  CHECK(reach > 0.9);
}

TEST_CASE("the solver's share of the copy bandwidth is that of the records it moves") {
  const ManyScene scene = shaken_tank({.of = {.count = 1500}}, {.iterations = 10});
  ManyRun run;
  run.repeats = 3;
  const ManyResult r = run_many(scene, run);
  // An update moves more than the impulses of its contacts, twice, and less than a kilobyte for each.
  const double moved = r.bandwidth_share * r.copy_bandwidth * r.stages.of(sim::Stage::solve) / r.iterations;
  CHECK(moved > 64.0 * double(r.contacts));
  CHECK(moved < 1000.0 * double(r.contacts));
}

TEST_CASE("a search by itself in a tank counts the contacts of a step there") {
  CollideBench request;
  request.tank.of.count = 1500;
  request.repeats = 3;
  const CollideBenchResult r = bench_collide(request);
  const auto simulation = sim::make_simulation(sim::Backend::cpu, {tank_world(request.tank, {})},
                                               many_step_settings(request.tank.of, 1), 1);
  simulation->advance(1);
  CHECK(r.contacts == simulation->report(0).contact_count);
  CHECK(r.ms_per_search > 0);
}

TEST_CASE("a seed is a packing of the column: the same one gives the same bits, another one another heap") {
  const auto heap = [](const CollapseSpec& spec) {
    ManyScene scene = collapse_scene(spec, {.iterations = 20});
    scene.duration -= spec.spread_time - 0.3;
    std::vector<sim::BodyState> bodies;
    scene.measure = [&](sim::Simulation& simulation) -> std::vector<SceneNumber> {
      bodies = simulation.bodies(0);
      return {};
    };
    run_on_one_core(scene);
    return bodies;
  };
  CollapseSpec spec;
  spec.of.count = 300;
  const std::vector<sim::BodyState> first = heap(spec);
  CHECK(same_bits(first, heap(spec)));
  spec.of.seed = 1;
  CHECK(same_bits(first, heap(spec)));
  spec.of.seed = 2;
  const std::vector<sim::BodyState> other = heap(spec);
  REQUIRE(other.size() == first.size());
  std::size_t elsewhere = 0;
  for (std::size_t b = 0; b < 300; ++b)
    elsewhere += length(other[b].position - first[b].position) > 0.1 * spec.of.diameter;
  CHECK(elsewhere > 150);
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
  spec.of.count = 700;
  spec.froude = 0.3;
  const TemporaryFolder folder;
  ManyRun run;
  run.repeats = 0;
  run.vtk = folder.path() / "vtk";
  run.every = 0.5;
  if (report::pictures_available()) run.picture = folder.path() / "drum.png";
  const ManyResult drum = run_many(drum_scene(spec, {.iterations = 20}), run);
  const double turned = value_of(drum, "mixing_index");
  REQUIRE(drum.watched.size() == 9);  // at the start and after each eighth of the turn
  CHECK(drum.watched.back()[0].value == Approx(1).margin(0.01));
  CHECK(drum.watched.front()[1].value == Approx(0).margin(0.01));
  CHECK(drum.watched.back()[1].value == Approx(turned));
  CHECK(std::filesystem::exists(run.vtk / "spheres.pvd"));
  CHECK(std::filesystem::exists(run.vtk / "spheres_000001.vtp"));
  if (!run.picture.empty()) CHECK(std::filesystem::file_size(run.picture) > 10'000);
  spec.froude = 1e-8;
  ManyScene still = drum_scene(spec, {.iterations = 20});
  still.duration = 0.6;
  run.vtk.clear();
  run.picture.clear();
  const double stood = value_of(run_many(still, run), "mixing_index");
  std::printf("mixing index after a turn %.3f, of a drum that stands %.3f\n", turned, stood);
  CHECK(stood < 0.35);
  CHECK(turned > stood + 0.15);
}

TEST_CASE("a screen's deck moves as its crank and rod say; small spheres fall through, large ones never") {
  ScreenSpec spec;
  spec.of.count = 400;
  spec.shaken = 2;
  ManyScene scene = screen_scene(spec, {.iterations = 30});
  const ScreenParts parts = screen_parts(spec);
  const auto look = scene.watch;
  const Vec3d start = scene.world.body[parts.deck].position;
  const double r = spec.crank(), l = parts.rod_length;
  double worst = 0, stroke = 0, aside = 0, turned = 0, before = 0;
  scene.watch_every = 0.006;
  scene.watch = [&](sim::Simulation& simulation, double time) {
    const Quat q = simulation.body(0, parts.crank).orientation;
    const double angle = 2 * std::atan2(q.y, q.w);
    const Vec3d moved = simulation.body(0, parts.deck).position - start;
    const double along = dot(moved, parts.stroke);
    // Slider and crank: r cos a + sqrt(l^2 - r^2 sin^2 a), from where a is 0.
    const double expected = r * std::cos(angle) + std::sqrt(l * l - std::pow(r * std::sin(angle), 2)) - r - l;
    worst = std::max(worst, std::fabs(along - expected));
    aside = std::max(aside, length(moved - along * parts.stroke));
    stroke = std::max(stroke, -along);
    if (time > 1.2) turned += std::fabs(std::remainder(angle - before, 2 * kPi));
    before = angle;
    return look(simulation, time);
  };
  ManyRun run;
  run.repeats = 0;
  const ManyResult shaken = run_many(scene, run);
  std::printf("screen: deck off the slider-crank by %.2e m, aside by %.2e m, stroke %.5f m; efficiency %.3f\n", worst,
              aside, stroke, value_of(shaken, "newton_efficiency"));
  // A step turns the crank by a; the deck follows the chord, off the arc by about a^2 r.
  CHECK(worst < 1.5 * r * std::pow(spec.crank_speed() * scene.settings.step, 2));
  CHECK(aside < 0.005 * r);
  CHECK(stroke == Approx(2 * r).epsilon(0.01));
  CHECK(turned / (scene.duration - 1.2) == Approx(spec.crank_speed()).epsilon(0.02));
  CHECK(value_of(shaken, "large_through") == 0);
  CHECK(value_of(shaken, "newton_efficiency") > 0.8);
  CHECK(value_of(shaken, "large_over") > 0);
  spec.throw_number = 0;
  const ManyResult still = run_many(screen_scene(spec, {.iterations = 30}), run);
  std::printf("screen: large ones over %.3f, on a deck that stands still %.3f; efficiency there %.3f\n",
              value_of(shaken, "large_over"), value_of(still, "large_over"), value_of(still, "newton_efficiency"));
  CHECK(value_of(still, "large_over") < value_of(shaken, "large_over") - 0.1);
  CHECK(value_of(still, "newton_efficiency") < value_of(shaken, "newton_efficiency"));
}

TEST_CASE("pebbles carry the weight of a tracked vehicle at rest, and it drives off") {
  PebblesSpec spec;
  spec.vehicle = shipped_file("vehicles", "vehicle", "m113");
  spec.tank.of.count = 1000;
  spec.tank.of.diameter = 0.25;
  spec.tank.layers = 2;
  spec.driven = 1;
  ManyRun run;
  run.repeats = 0;
  const ManyResult r = run_many(pebbles_scene(spec, {.iterations = 50}), run);
  // Let down, it sways on its springs: the mean over 0.6 s before its belts begin to move.
  double load = 0, stood_at = 0;
  int looks = 0;
  for (const std::vector<SceneNumber>& look : r.watched)
    if (look[0].value > 1.05 && look[0].value < 1.65) {
      load += look[4].value;
      stood_at = look[1].value;
      ++looks;
    }
  std::printf("pebbles: load over weight at rest %.3f; then way %.3f m, speed %.3f m/s, slip %.3f\n", load / looks,
              value_of(r, "way_m") - stood_at, value_of(r, "speed_m_per_s"), value_of(r, "slip"));
  CHECK(load / looks == Approx(1).margin(0.05));
  CHECK(value_of(r, "way_m") > stood_at + 0.005);
  CHECK(value_of(r, "speed_m_per_s") > 0.04);
}

TEST_CASE("a floor too small for the vehicle and a vehicle without tracks are refused") {
  PebblesSpec spec;
  spec.vehicle = shipped_file("vehicles", "vehicle", "hmmwv");
  spec.tank.of.count = 500;
  refused([&] { pebbles_scene(spec, {}); }, "no tracks");
  spec.vehicle = shipped_file("vehicles", "vehicle", "m113");
  refused([&] { pebbles_scene(spec, {}); }, "--diameter");
}

TEST_CASE("what a scene does not watch cannot be plotted") {
  ManyRun run;
  run.plot = "tank.png";
  refused([&] { run_many(shaken_tank({.of = {.count = 200}}, {}), run); }, "--plot");
}

TEST_CASE("a run can be shown as a video, where the build has pictures and there is ffmpeg") {
  TankSpec spec;
  spec.of.count = 200;
  const TemporaryFolder folder;
  ManyRun run;
  run.repeats = 0;
  run.every = 0.04;
  run.video = folder / "tank.mp4";
  ManyScene scene = shaken_tank(spec, {.iterations = 10});
  if (report::pictures_available() && std::system("ffmpeg -version > /dev/null 2>&1") == 0) {
    run_many(scene, run);
    CHECK(std::filesystem::file_size(run.video) > 5000);
  } else {
    CHECK_THROWS_AS(run_many(scene, run), InputError);
  }
}

TEST_CASE("videos run as fast as things went, but not in less than six seconds nor below five pictures a second") {
  CHECK(frame_rate(100, 0.1) == Approx(10));    // 10 s
  CHECK(frame_rate(60, 0.02) == Approx(10));    // 1.2 s become 6
  CHECK(frame_rate(7, 0.02) == Approx(5));      // too few for more
  CHECK(frame_rate(1000, 0.02) == Approx(50));  // 20 s
}
