// SPIKE by teams on a GPU.
#include "base/parallel/device.h"
#include "sim/local_problem/banded/team_spike_on.h"

namespace gonogo::sim {
namespace {

struct WaitForGpu {
  void operator()() const { check_cuda(cudaDeviceSynchronize(), "SPIKE by teams"); }
};

void require_gpu() {
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status != cudaSuccess || count == 0)
    throw InputError(std::string("SPIKE by teams: no GPU answers on this machine (") +
                     (status != cudaSuccess ? cudaGetErrorString(status) : "there is none") + ")");
}

/// Each team's room has to fit into one multiprocessor.
void require_room(const TeamSpikePlan& plan, std::size_t scalar) {
  const std::size_t k = std::size_t(plan.all.half);
  const std::size_t ring = (k + 1 + std::size_t(kTile)) * (3 * k + 1) * scalar, pair = 3 * k * k * scalar + 4 * k;
  const std::size_t wanted = std::max(ring, pair);
  const std::size_t offered = std::size_t(device_attribute(cudaDevAttrMaxSharedMemoryPerBlockOptin));
  if (wanted > offered)
    throw InputError("SPIKE by teams: " + std::to_string(plan.all.half) + " off-diagonals need " +
                     std::to_string(wanted) + " bytes of one multiprocessor, which offers " + std::to_string(offered));
}

}  // namespace

std::unique_ptr<TeamSpike> make_team_spike_on_gpu(const TeamSpikePlan& plan, const std::vector<double>& a,
                                                  bool is_single) {
  require_gpu();
  require_room(plan, is_single ? sizeof(float) : sizeof(double));
  return make_team_spike(Cuda{}, plan, a, is_single, WaitForGpu{});
}

}  // namespace gonogo::sim
