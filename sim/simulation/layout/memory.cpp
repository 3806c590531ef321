#include "sim/simulation/layout/memory.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/format.h"
#include "sim/simulation/layout/batch_arrays.h"
#include "sim/solver/grid_storage.h"
#ifdef GONOGO_WITH_CUDA
#include <cuda_runtime_api.h>
#endif

namespace gonogo::sim {
namespace {

/// What is not counted takes less than this share: scratch memory, what parts send one another.
constexpr double kSpare = 0.05;

std::atomic<double> planted{std::numeric_limits<double>::quiet_NaN()};  // [bytes]

std::string sentence(const std::string& what, double needed, double free, const std::string& remedy) {
  constexpr double gib = 1 << 30;
  return "out of GPU memory: " + what + line(" needs %.3g GiB and %.3g GiB are free; ", needed / gib, free / gib) +
         remedy;
}

WorldSize size_of(const FlatWorld& world, const Part& part) {
  WorldSize size = world.size();
  size.bodies = Index(part.body.size());
  size.shapes = ShapeIndex(shapes_in_world(world, part).size());
  return size;
}

bool is_turning(const std::vector<FlatWorld>& worlds, const StepSettings& settings) {
  return std::any_of(worlds.begin(), worlds.end(),
                     [&](const FlatWorld& w) { return needs_turning(w.world, settings); });
}

}  // namespace

double device_bytes(const std::vector<WorldSize>& places, const StepSettings& settings, bool turning) {
  const std::size_t before = Tally::bytes;
  BatchArrays<Tally> arrays(places, settings);
  arrays.state.turning = turning;
  GridStorage<Tally> solver;
  reserve_grid(arrays.state, solver, settings);
  return double(Tally::bytes - before);
}

std::optional<double> free_memory(bool on_gpu) {
  if (const double bytes = planted; !std::isnan(bytes)) return bytes;
#ifdef GONOGO_WITH_CUDA
  std::size_t unused = 0, total = 0;
  if (on_gpu && cudaMemGetInfo(&unused, &total) == cudaSuccess) return double(unused);
#else
  (void)on_gpu;
#endif
  return std::nullopt;
}

PlantedMemory::PlantedMemory(double bytes) { planted = bytes; }
PlantedMemory::~PlantedMemory() { planted = std::numeric_limits<double>::quiet_NaN(); }

double bytes_of_parts(const FlatWorld& world, const Snapshot& at, const StepSettings& settings, int count) {
  const std::vector<BodyIndex> border = borders(world, at, count);
  const bool turning = needs_turning(world.world, settings);
  double most = 0;
  for (int p = 0; p < count; ++p)
    most = std::max(most, device_bytes({size_of(world, part_of(world, at, border, p))}, settings, turning));
  return most;
}

int gpus_that_do(const FlatWorld& world, const Snapshot& at, const StepSettings& settings, double free) {
  const double all = device_bytes({world.size()}, settings, needs_turning(world.world, settings));
  for (int count = 2; count <= kMaxGpus; ++count) {
    if (all > count * free) continue;  // together, parts are no smaller than the world
    if (bytes_of_parts(world, at, settings, count) * (1 + kSpare) <= free) return count;
  }
  return 0;
}

std::string memory_sentence(const std::string& what, double needed, double free, int gpus) {
  return sentence(what, needed, free,
                  gpus > 0 ? std::to_string(gpus) + " GPUs of this kind would do"
                           : "no number of GPUs of this kind up to " + std::to_string(kMaxGpus) +
                                 " would do: make the bed smaller or its grains larger");
}

void require_memory(bool on_gpu, const std::vector<FlatWorld>& worlds, const WorldSize& room,
                    const StepSettings& settings) {
  const std::optional<double> free = free_memory(on_gpu);
  if (!free) return;
  const double needed = device_bytes(places_for(worlds, room), settings, is_turning(worlds, settings));
  if (needed <= *free) return;
  const FlatWorld& world = worlds.front();
  if (worlds.size() > 1)
    throw OutOfMemory(sentence("the batch of " + std::to_string(worlds.size()) + " worlds", needed, *free,
                               "use fewer worlds or a smaller bed"));
  if (device_bytes({world.size()}, settings, is_turning(worlds, settings)) <= *free)
    throw OutOfMemory(sentence("room for " + std::to_string(room.bodies) + " bodies in a world", needed, *free,
                               "leave room for fewer"));
  if (!can_be_divided(settings))
    throw OutOfMemory(sentence("the world", needed, *free,
                               std::string("the method ") + name_of(settings.method()) +
                                   " runs on one GPU only: make the bed smaller or its grains larger"));
  throw OutOfMemory(memory_sentence("the world", needed, *free, gpus_that_do(world, start_of(world), settings, *free)));
}

}  // namespace gonogo::sim
