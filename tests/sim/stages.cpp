// Steps taken stage by stage, and the search for contacts by itself.
#include "sim/simulation/simulation.h"

#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

/// Spheres over a floor, near enough to meet each other at once.
SceneWorld heap() {
  Draw draw(812);
  SceneWorld w = open_world({Real(0.4), Real(0.1), 0});
  add_plane(w);
  for (int k = 0; k < 600; ++k) w.add_sphere(draw.in_box({0, 0, 0.05}, {0.7, 0.7, 0.7}), 0.05f, 2600, 0);
  return w;
}

void check_same_bits(Simulation& a, Simulation& b) {
  const auto first = a.bodies(0), second = b.bodies(0);
  REQUIRE(first.size() == second.size());
  std::size_t same = 0;
  for (std::size_t i = 0; i < first.size(); ++i)
    same += length(first[i].position - second[i].position) == 0 && length(first[i].velocity - second[i].velocity) == 0;
  CHECK(same == first.size());
}

}  // namespace

TEST_CASE("a step taken stage by stage ends with the bits of any other, and its stages take time") {
  for (const Backend backend : backends()) {
    const SceneWorld world = heap();
    const auto usual = simulate(backend, world, settings_with(20)),
               staged = simulate(backend, world, settings_with(20));
    StageTimes sum;
    for (int k = 0; k < 12; ++k) {
      usual->advance(1);
      if (k % 3 == 2) {
        staged->advance(1);  // the two ways may follow each other
        continue;
      }
      const StageTimes times = by_stage(*staged).timed_step();
      for (int stage = 0; stage < kStageCount; ++stage) sum.seconds[stage] += times.seconds[stage];
    }
    check_same_bits(*usual, *staged);
    CHECK(staged->report(0).time == usual->report(0).time);
    CHECK(staged->report(0).contact_count == usual->report(0).contact_count);
    for (const Stage stage : {Stage::bins, Stage::contacts, Stage::lists, Stage::solve, Stage::integrate})
      CHECK(sum.of(stage) > 0);
  }
}

TEST_CASE("a search by itself finds what the next step finds, and leaves no trace in it") {
  for (const Backend backend : backends()) {
    const SceneWorld world = heap();
    const auto usual = simulate(backend, world, settings_with(20)),
               searched = simulate(backend, world, settings_with(20));
    for (int k = 0; k < 6; ++k) {
      const SearchReport search = by_stage(*searched).timed_search();
      CHECK(searched->contacts(0).empty());
      // From a snapshot taken behind a search a world goes on with its impulses.
      if (k == 3) searched->restore(0, searched->snapshot(0));
      searched->advance(1);
      usual->advance(1);
      CHECK(search.contact_count == searched->report(0).contact_count);
      CHECK(search.times.of(Stage::contacts) > 0);
      CHECK(search.times.of(Stage::solve) == 0);
    }
    CHECK(usual->report(0).contact_count > 600);
    check_same_bits(*usual, *searched);
  }
}

TEST_CASE("memory copies at a speed that memory has") {
  for (const Backend backend : backends()) {
    const double bandwidth = copy_bandwidth(backend, 1);
    CHECK(bandwidth > 1e8);
    CHECK(bandwidth < 1e14);
  }
}
