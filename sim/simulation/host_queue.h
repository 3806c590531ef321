// Steps on the host's cores, one after the other.
#pragma once
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

extern template class SimulationOn<Cpu>;  // compiled once, in cpu.cpp

}  // namespace gonogo::sim
