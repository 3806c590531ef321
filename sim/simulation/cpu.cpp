// The engine on the host's cores.
#include <cstring>

#include "sim/simulation/host_queue.h"

namespace gonogo::sim {

template void sort_into_bins(Cpu, State<Cpu>&);
template void find_contacts(Cpu, State<Cpu>&, const StepSettings&);
template class SimulationOn<Cpu>;

std::unique_ptr<Simulation> make_cpu_simulation(std::vector<FlatWorld> worlds, const StepSettings& settings,
                                                const WorldSize& room, int threads) {
  return std::make_unique<SimulationOn<Cpu>>(Cpu{threads}, std::move(worlds), settings, room);
}

double cpu_copy_bandwidth(int threads) {
  constexpr std::size_t count = std::size_t(1) << 26;  // bytes; more than caches hold
  constexpr std::size_t block = 1 << 16;
  constexpr int copies = 8;
  std::vector<std::uint8_t> from(count), to(count);
  const auto copy = [&](Index k) { std::memcpy(&to[std::size_t(k) * block], &from[std::size_t(k) * block], block); };
  double best = 0;
  for (int k = 0; k < copies; ++k) {
    const auto start = std::chrono::steady_clock::now();
    for_each_index(Cpu{threads}, Index(count / block), copy, 0);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    best = std::max(best, 2.0 * double(count) / taken.count());
  }
  return best;
}

}  // namespace gonogo::sim
