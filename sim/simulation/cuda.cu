// The engine on a GPU: steps are recorded as CUDA graphs and queued.
#include "sim/simulation/device_queue.cuh"

namespace gonogo::sim {

template void sort_into_bins(Cuda, State<Cuda>&);
template void find_contacts(Cuda, State<Cuda>&, const StepSettings&);
template void build_incidence(Cuda, State<Cuda>&);
template void prepare_motion(Cuda, State<Cuda>&, const StepSettings&);
template void apply_forces(Cuda, State<Cuda>&, const StepSettings&);
template void finish_step(Cuda, State<Cuda>&, const StepSettings&);
template class SimulationOn<Cuda>;

double cuda_copy_bandwidth() {
  constexpr std::size_t count = std::size_t(1) << 30;  // bytes; far more than the cache holds
  constexpr int copies = 20;
  Buffer<std::uint8_t, Cuda> from(count), to(count);
  cudaEvent_t start = nullptr, end = nullptr;
  check_cuda(cudaEventCreate(&start), "event");
  check_cuda(cudaEventCreate(&end), "event");
  for (int k = -1; k < copies; ++k) {  // the first one warms up
    if (k == 0) check_cuda(cudaEventRecord(start), "event");
    check_cuda(cudaMemcpyAsync(to.data(), from.data(), count, cudaMemcpyDeviceToDevice), "copy");
  }
  check_cuda(cudaEventRecord(end), "event");
  check_cuda(cudaEventSynchronize(end), "event");
  float milliseconds = 0;
  check_cuda(cudaEventElapsedTime(&milliseconds, start, end), "event");
  cudaEventDestroy(start);
  cudaEventDestroy(end);
  return 2e3 * double(count) * copies / double(milliseconds);
}

std::unique_ptr<Simulation> make_cuda_simulation(std::vector<FlatWorld> worlds, const StepSettings& settings,
                                                 const WorldSize& room) {
  return std::make_unique<SimulationOn<Cuda>>(Cuda{}, std::move(worlds), settings, room);
}

}  // namespace gonogo::sim
