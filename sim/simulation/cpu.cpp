// The engine on the host's cores.
#include <cstring>

#include "sim/simulation/simulation_on.h"
#include "sim/solver/host_blocks.h"
#include "sim/solver/solve_host.h"

namespace gonogo::sim {

template <>
class StepQueue<Cpu> {
 public:
  explicit StepQueue(Cpu exec) : exec_(exec) {}
  void advance(State<Cpu>& s, const StepSettings& settings, Index count) {
    for (Index i = 0; i < count; ++i) {
      step(exec_, s, solver_, settings);
      s.parity = 1 - s.parity;
    }
  }
  StageTimes timed_step(State<Cpu>& s, const StepSettings& settings) {
    StageTimes times;
    step_by_stage(exec_, s, solver_, settings, StageClock(times, [] {}));
    s.parity = 1 - s.parity;
    return times;
  }
  StageTimes timed_search(State<Cpu>& s, const StepSettings& settings) {
    StageTimes times;
    search_by_stage(exec_, s, settings, StageClock(times, [] {}));
    return times;
  }
  void forget() {}
  template <class Stage>
  void run(const Stage& stage) {
    stage(exec_);
  }

  static int gpu() { return -1; }

  static double traffic(const State<Cpu>& s, const StepSettings& settings, Index contacts) {
    if (is_penalty(settings.contact)) return penalty_traffic(s, contacts);
    if (settings.iteration == Iteration::jacobi_scan) return scan_traffic(s, contacts);
    return double(contacts) * host_bytes_per_contact() + double(s.body_count) * host_bytes_per_body();
  }

 private:
  Cpu exec_;
  SolverStorage<Cpu> solver_;
};

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
