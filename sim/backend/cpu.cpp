// The engine on the host's cores.
#include "sim/backend/simulation_on.h"
#include "sim/solver/solve_host.h"

namespace gonogo::sim {

template <>
class StepQueue<Cpu> {
 public:
  explicit StepQueue(Cpu exec) : exec_(exec) {}
  void advance(State<Cpu>& s, const StepSettings& settings, Index count) {
    for (Index i = 0; i < count; ++i) {
      step(exec_, s, settings);
      s.parity = 1 - s.parity;
    }
  }
  void forget() {}
  template <class Stage>
  void run(const Stage& stage) {
    stage(exec_);
  }

 private:
  Cpu exec_;
};

template class SimulationOn<Cpu>;

std::unique_ptr<Simulation> make_cpu_simulation(std::vector<FlatWorld> worlds, const StepSettings& settings,
                                                const WorldSize& room, int threads) {
  return std::make_unique<SimulationOn<Cpu>>(Cpu{threads}, std::move(worlds), settings, room);
}

}  // namespace gonogo::sim
