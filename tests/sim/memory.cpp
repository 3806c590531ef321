// What a batch takes of a GPU's memory. The oracle: bytes that the CPU engine asks operator new for, whose arrays have
// the same sizes.
#include "sim/simulation/layout/memory.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <memory>
#include <new>

#include "sim/simulation/host_queue.h"
#include "sim/simulation/parts/divided.h"
#include "sim/solver/grid_storage.h"
#include "tests/sim/divided_scenes.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

namespace {

std::atomic<std::int64_t> live{0};  // bytes

void* taken(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  live += std::int64_t(malloc_usable_size(memory));
  return memory;
}

void given_back(void* memory) {
  if (memory != nullptr) live -= std::int64_t(malloc_usable_size(memory));
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) { return taken(std::malloc(size)); }
void* operator new(std::size_t size, std::align_val_t at) {
  const auto unit = std::size_t(at);
  return taken(std::aligned_alloc(unit, (size + unit - 1) / unit * unit));
}
void operator delete(void* memory) noexcept { given_back(memory); }
void operator delete(void* memory, std::size_t) noexcept { given_back(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { given_back(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { given_back(memory); }

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

/// Bytes that the engine holds before its first step, with the arrays that the solver of a GPU would add.
double held(std::vector<FlatWorld> worlds, const StepSettings& settings) {
  const std::int64_t before = live;  // with the worlds, which the engine keeps
  const auto simulation = make_cpu_simulation(std::move(worlds), settings, {}, 1);
  GridStorage<Cpu> solver;
  reserve_grid(dynamic_cast<SimulationOn<Cpu>&>(*simulation).arrays().state, solver, settings);
  return double(live - before);
}

bool turns(const std::vector<FlatWorld>& worlds, const StepSettings& settings) {
  return needs_turning(worlds.front().world, settings);
}

std::vector<FlatWorld> flat(const SceneWorld& world, const StepSettings& settings, int count) {
  std::vector<FlatWorld> worlds;
  for (int w = 0; w < count; ++w) worlds.push_back(flatten(world, w, settings));
  return worlds;
}

/// Spheres in a long row, so that halos are small.
DividedScene long_bed() {
  DividedScene scene;
  scene.world.size = {12, 0.2, 0.3};
  add_plane(scene.world);
  for (int k = 0; k < 3000; ++k)
    scene.world.add_sphere((grid_place(k, 300, 5) + Vec3d{0.5, 0.5, 0.5}) * 0.04, Real(0.019), 2600, 0);
  scene.settings.iterations = 5;
  return scene;
}

/// Free bytes that a GPU loses to a batch and its first step.
double lost_to(const DividedScene& scene) {
  const double before = *free_memory(true);
  const auto simulation = make_simulation(Backend::cuda, {scene.world}, scene.settings, 1);
  simulation->advance(1);
  return before - *free_memory(true);
}

/// The sentence with which memory is found wanting; empty where it suffices.
template <class Code>
std::string memory_error(const Code& code) {
  try {
    code();
  } catch (const OutOfMemory& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("the bytes of a batch are those that its arrays then take") {
  constexpr double beside = 40e3;  // malloc's rounding, the simulation itself, lists of places
  std::vector<StepSettings> all;
  const DividedScene scene = divided_scene("tank");
  for (const Iteration iteration : {Iteration::apgd, Iteration::bb, Iteration::gauss_seidel, Iteration::jacobi_scan}) {
    all.push_back(scene.settings);
    all.back().iteration = iteration;
  }
  all.push_back(scene.settings);
  all.back().substeps = 3;
  for (const StepSettings& settings : all)
    for (const int count : {1, 3}) {
      std::vector<FlatWorld> worlds = flat(scene.world, settings, count);
      const double counted = device_bytes(places_for(worlds, {}), settings, turns(worlds, settings));
      const double real = held(std::move(worlds), settings);
      CAPTURE(name_of(settings.method()), settings.substeps, count, counted, real);
      CHECK(counted > 1e6 * count);
      CHECK(std::abs(real - counted) < beside);
    }
}

TEST_CASE("a GPU loses about the bytes that were counted") {
  if (backends().size() == 1) return;  // no GPU here
  DividedScene scene;
  scene.world.size = {8.1, 8.1, 0.8};
  scene.settings.iterations = 5;
  add_plane(scene.world);
  for (int k = 0; k < 500'000; ++k)
    scene.world.add_sphere((grid_place(k, 200, 200) + Vec3d{0.5, 0.5, 0.5}) * 0.04, Real(0.019), 2600, 0);
  lost_to(long_bed());  // what any first batch takes: context, kernels
  const std::vector<FlatWorld> worlds = flat(scene.world, scene.settings, 1);
  const double counted = device_bytes(places_for(worlds, {}), scene.settings, turns(worlds, scene.settings));
  const double lost = lost_to(scene);
  CAPTURE(counted, lost);
  CHECK(counted > 2e8);
  CHECK(lost < 1.1 * counted + 64e6);
  CHECK(lost > 0.9 * counted - 64e6);
}

TEST_CASE("a part takes the bytes of its bodies as a world of their own") {
  const DividedScene scene = divided_scene("tank");
  std::vector<FlatWorld> worlds = flat(scene.world, scene.settings, 1);
  const FlatWorld& whole = worlds.front();
  const Snapshot at = start_of(whole);
  for (const int count : {1, 2, 4}) {
    double most = 0;
    for (int p = 0; p < count; ++p) {
      std::vector<FlatWorld> part{restricted(whole, part_of(whole, at, borders(whole, at, count), p))};
      most = std::max(most, held(std::move(part), scene.settings));
    }
    CHECK(std::abs(bytes_of_parts(whole, at, scene.settings, count) - most) < 40e3);
  }
}

TEST_CASE("a world too large for a GPU is refused before its first step with the number of GPUs that would do") {
  const DividedScene scene = long_bed();
  const std::vector<FlatWorld> worlds = flat(scene.world, scene.settings, 1);
  const Snapshot at = start_of(worlds.front());
  const auto bytes = [&](int count) { return bytes_of_parts(worlds.front(), at, scene.settings, count); };
  REQUIRE(bytes(1) > bytes(2));
  REQUIRE(bytes(2) > 1.15 * bytes(3));
  const auto alone = [&] { make_simulation(Backend::cpu, {scene.world}, scene.settings, 1); };
  const auto over = [&](int count) {
    return [&, count] { make_team_simulation(Backend::cpu, scene.world, scene.settings, count)->advance(1); };
  };
  CHECK(memory_error(alone) == "");  // the host's memory is not watched
  {
    const PlantedMemory suffices(bytes(1));
    CHECK(memory_error(alone) == "");
  }
  {
    const PlantedMemory for_two(1.1 * bytes(2));
    REQUIRE(bytes(1) > 1.1 * bytes(2));
    const std::string said = memory_error(alone);
    CHECK(contains(said, "out of GPU memory: the world needs 0."));
    CHECK(contains(said, "GiB are free; 2 GPUs of this kind would do"));
    CHECK(memory_error(over(2)) == "");
  }
  {
    const PlantedMemory for_three(1.1 * bytes(3));
    CHECK(contains(memory_error(over(2)), "the largest of 2 parts of the world needs 0."));
    CHECK(contains(memory_error(over(2)), "3 GPUs of this kind would do"));
    CHECK(memory_error(over(3)) == "");
  }
}

TEST_CASE("where no number of GPUs would do or a method runs on one that is said") {
  DividedScene scene = long_bed();
  const PlantedMemory tiny(1000);
  const auto make = [&](const Scene& worlds) { make_simulation(Backend::cpu, worlds, scene.settings, 1); };
  CHECK(contains(memory_error([&] { make({scene.world}); }), "no number of GPUs of this kind up to 8 would do: make "));
  CHECK(contains(memory_error([&] { make({scene.world, scene.world}); }), "the batch of 2 worlds needs 0."));
  scene.settings.iteration = Iteration::bb;
  CHECK(
      contains(memory_error([&] { make({scene.world}); }), "the method bb runs on one GPU only: make the bed smaller"));
}
