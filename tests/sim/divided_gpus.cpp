// Worlds divided over the GPUs of this machine, by hand: do they give the bits of one GPU, and how fast are they?
//   divided_gpus check [<parts>...]                     200 steps of each world of divided_scenes.h; default 1 2 4
//   divided_gpus speed <spheres> <steps> <parts>...     a lattice at rest, 50 iterations a step
// Parts in excess of the GPUs share them.
#include <chrono>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "base/ranks/ranks.h"
#include "sim/simulation/parts/divided.h"
#include "tests/sim/divided_scenes.h"

namespace {

using namespace gonogo;
using namespace gonogo::sim;

constexpr Index kSteps = 200;

int gpu_count() { return int(cuda_device_names().size()); }

/// The step after which bodies first differ, or -1.
std::vector<std::string> states(Simulation& simulation, const test::DividedScene& scene) {
  std::vector<std::string> after;
  for (Index k = 0; k < kSteps; k += 10) {
    test::take_steps(simulation, scene, k, 10);
    test::ByteList bytes;
    bytes.add(simulation.bodies(0));
    after.push_back(bytes.text());
  }
  after.push_back(test::all_bytes(simulation, scene));
  return after;
}

bool check(const char* name, const std::vector<int>& parts) {
  const test::DividedScene scene = test::divided_scene(name);
  const auto whole = make_simulation(Backend::cuda, {scene.world}, scene.settings, 1);
  const std::vector<std::string> expected = states(*whole, scene);
  std::printf("%s: %d contacts, flags %d\n", name, whole->report(0).contact_count, whole->report(0).flags);
  bool all_same = true;
  for (const int count : parts) {
    std::vector<std::string> found;
    run_in_threads(count, [&](Ranks& ranks) {
      use_cuda_device(ranks.rank() % gpu_count());
      const auto divided = make_divided_simulation(Backend::cuda, scene.world, scene.settings, 1, ranks);
      std::vector<std::string> mine = states(*divided, scene);
      if (ranks.rank() == 0) found = std::move(mine);
    });
    std::size_t same = 0;
    while (same < expected.size() && found[same] == expected[same]) ++same;
    all_same = all_same && same == expected.size();
    if (same == expected.size())
      std::printf("  %d parts: the same bits\n", count);
    else
      std::printf("  %d parts: DIFFERENT at look %zu of %zu\n", count, same, expected.size());
    std::fflush(stdout);
  }
  return all_same;
}

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Spheres that touch their neighbours on a lattice, in an open box without walls.
SceneWorld lattice(Index spheres) {
  SceneWorld w;
  int side = 1;
  while (double(side) * side * side < spheres) ++side;
  w.size = {0.01 * side + 0.1, 0.01 * side + 0.1, 0.01 * side + 0.1};
  w.set_law(0, 0, {Real(0.5), 0, 0});
  test::add_plane(w);
  for (Index k = 0; k < spheres; ++k)
    w.add_sphere((test::grid_place(k, side, side) + Vec3d{0.5, 0.5, 0.5}) * 0.00999 + Vec3d{0, 0, 1e-6}, Real(0.005),
                 2600, 0);
  return w;
}

void time_steps(Simulation& simulation, Index steps, int parts, bool speaks, double& one) {
  simulation.advance(3);
  const double start = seconds();
  simulation.advance(steps);
  const double taken = (seconds() - start) / steps;
  const StepReport report = simulation.report(0);
  if (!speaks) return;
  if (one == 0) one = taken;
  std::printf("  %d parts: %.3f ms per step, %.2f times the first; %d contacts, flags %d\n", parts, taken * 1e3,
              one / taken, report.contact_count, report.flags);
  std::fflush(stdout);
}

void speed(Index spheres, Index steps, const std::vector<int>& parts) {
  StepSettings settings;
  settings.iterations = 50;
  settings.step = Real(2e-4);
  double one = 0;
  const double start = seconds();
  const FlatWorld flat = flatten(lattice(spheres), 0, settings);
  std::printf("%d spheres, made in %.1f s\n", spheres, seconds() - start);
  for (const int count : parts) {
    if (count == 0) {
      std::vector<FlatWorld> alone{flat};
      const auto simulation = make_cuda_simulation(std::move(alone), settings, {});
      time_steps(*simulation, steps, 0, true, one);
      continue;
    }
    run_in_threads(count, [&](Ranks& ranks) {
      use_cuda_device(ranks.rank() % gpu_count());
      const auto divided = make_divided_cuda_simulation(flat, settings, ranks);
      time_steps(*divided, steps, count, ranks.rank() == 0, one);
    });
  }
}

int run(const std::vector<std::string>& words) {
  require_backend(Backend::cuda);
  std::printf("%d GPUs\n", gpu_count());
  std::vector<int> parts;
  const bool checks = words.at(0) == "check";
  for (std::size_t k = checks ? 1 : 3; k < words.size(); ++k) parts.push_back(std::stoi(words[k]));
  if (!checks) {
    speed(std::stoi(words.at(1)), std::stoi(words.at(2)), parts);
    return 0;
  }
  if (parts.empty()) parts = {1, 2, 4};
  bool all_same = true;
  for (const char* name : {"tank", "wheel", "wheel-substeps", "mixing"}) all_same = check(name, parts) && all_same;
  return all_same ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "divided_gpus: %s\n", error.what());
    return 2;
  }
}
