#include "sim/simulation/simulation.h"

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "base/format.h"
#include "sim/scene/check_scene.h"
#include "sim/simulation/layout/memory.h"
#include "sim/state/state.h"
#ifdef GONOGO_WITH_CUDA
#include <cuda_runtime_api.h>
#endif

namespace gonogo::sim {
namespace {

/// One Index counts all bodies, all bins, and all pairs that the search notes. The pairs are more than the shapes, and
/// more than the contacts that get room at first.
void check_totals(const std::vector<FlatWorld>& worlds, const WorldSize& room) {
  double bodies = 0, pairs = 0, bins = 0;
  for (const FlatWorld& world : worlds) {
    bodies += std::max(world.size().bodies, room.bodies);
    pairs += double(kNeighbourRows * kNotedPairs) * std::max(world.size().shapes, room.shapes);
    bins += std::max(world.size().bins, room.bins);
  }
  const std::pair<const char*, double> totals[] = {
      {"bodies", bodies}, {"places for pairs of shapes", pairs}, {"bins", bins}};
  for (const auto& [name, count] : totals)
    if (count >= std::numeric_limits<Index>::max())
      throw InputError("the batch needs " + std::to_string(std::int64_t(count)) + " " + name + ", more than " +
                       std::to_string(std::numeric_limits<Index>::max()) + "; use fewer worlds");
}

}  // namespace

void require_backend(Backend backend) {
  if (backend == Backend::cuda) require_cuda_device();
}

std::string description(const Fault& fault, double step) {
  if (fault.flags == 0) return {};
  std::string text = line("body %d in step %d (at %g s)", fault.body, fault.step, fault.step * step);
  const char* joint = " ";
  for (const auto& [flag, what] : {std::pair{flag_not_finite, "has a velocity or place that is no number"},
                                   {flag_too_fast, "crosses more than a bin in a step"},
                                   {flag_left_domain, "has left the domain"}}) {
    if ((fault.flags & flag) == 0) continue;
    text += joint;
    text += what;
    joint = ", ";
  }
  return text;
}

std::unique_ptr<Simulation> make_simulation(Backend backend, const Scene& scene, const StepSettings& settings,
                                            int threads, const WorldSize& room) {
  require_backend(backend);
  if (scene.empty()) throw InputError("the scene has no worlds");
  check_settings(settings);
  std::vector<FlatWorld> worlds;
  for (std::size_t w = 0; w < scene.size(); ++w) worlds.push_back(flatten(scene[w], WorldIndex(w), settings));
  check_totals(worlds, room);
  require_memory(backend == Backend::cuda, worlds, room, settings);
#ifdef GONOGO_WITH_CUDA
  if (backend == Backend::cuda) return make_cuda_simulation(std::move(worlds), settings, room);
#endif
  return make_cpu_simulation(std::move(worlds), settings, room, threads);
}

StepByStage& by_stage(Simulation& simulation) { return dynamic_cast<StepByStage&>(simulation); }

double copy_bandwidth(Backend backend, int threads) {
  require_backend(backend);
#ifdef GONOGO_WITH_CUDA
  if (backend == Backend::cuda) return cuda_copy_bandwidth();
#endif
  return cpu_copy_bandwidth(threads);
}

std::vector<std::string> cuda_device_names() {
  std::vector<std::string> names;
#ifdef GONOGO_WITH_CUDA
  int count = 0;
  if (cudaGetDeviceCount(&count) != cudaSuccess) return names;
  for (int k = 0; k < count; ++k) {
    cudaDeviceProp properties;
    if (cudaGetDeviceProperties(&properties, k) == cudaSuccess) names.push_back(properties.name);
  }
#endif
  return names;
}

int linked_gpus() {
  const int count = int(cuda_device_names().size());
#ifdef GONOGO_WITH_CUDA
  for (int k = 1; k < count; ++k)
    for (int other = 0; other < k; ++other)
      for (const auto& [from, to] : {std::pair{k, other}, {other, k}}) {
        int reaches = 0;
        if (cudaDeviceCanAccessPeer(&reaches, from, to) != cudaSuccess || reaches == 0) return k;
      }
#endif
  return count;
}

void require_cuda_device() {
#ifdef GONOGO_WITH_CUDA
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status == cudaSuccess && count > 0) return;
  throw InputError(std::string("no CUDA device answers on this machine (") +
                   (status != cudaSuccess ? cudaGetErrorString(status) : "there is none") +
                   "); ask for the cpu backend");
#else
  throw InputError("this program was built without CUDA; build the cuda-release preset or ask for the cpu backend");
#endif
}

void use_cuda_device(int index) {
  const std::size_t count = cuda_device_names().size();
  if (index < 0 || std::size_t(index) >= count)
    throw InputError("there is no GPU number " + std::to_string(index) + " (counted from 0); this machine has " +
                     std::to_string(count));
#ifdef GONOGO_WITH_CUDA
  if (const cudaError_t error = cudaSetDevice(index); error != cudaSuccess)
    throw DeviceError("GPU " + std::to_string(index) + ": " + cudaGetErrorString(error));
#endif
}

}  // namespace gonogo::sim
