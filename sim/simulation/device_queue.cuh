// Steps on a GPU, recorded as graphs and queued.
#pragma once
#include "sim/simulation/simulation_on.h"
#include "sim/solver/cuda/launch.cuh"
#include "sim/solver/cuda/records.cuh"

namespace gonogo::sim {

/// Records a step as two graphs, one for each contact store that it may write, and replays up to kMaxQueued of them
/// before the host reads their progress.
template <>
class StepQueue<Cuda> {
 public:
  explicit StepQueue(Cuda exec) : exec_(exec) {
    cudaStream_t stream = nullptr;
    check_cuda(cudaStreamCreate(&stream), "stream");
    exec_ = {stream, nullptr, side_, kSideStreams};
  }
  ~StepQueue() {
    forget();
    cudaStreamDestroy(stream_of(exec_));
  }
  StepQueue(const StepQueue&) = delete;
  StepQueue& operator=(const StepQueue&) = delete;

  void advance(State<Cuda>& s, const StepSettings& settings, Index count) {
    exec_.halted = &s.progress.data()->halted;
    for (Index done = 0; done < count;) {
      const Index queued = std::min(count - done, kMaxQueued), parity = s.parity;
      for (Index i = 0; i < queued; ++i) {
        launch(s, settings);
        s.parity = 1 - s.parity;
      }
      const Progress progress = collected(s);
      done += progress.steps;
      if (progress.halted == 0) continue;
      s.parity = (parity + progress.steps) % 2;
      make_room(s, progress);
    }
  }

  StageTimes timed_step(State<Cuda>& s, const StepSettings& settings) {
    const StageTimes times = timed(s, [&](Cuda exec, const auto& clock) {
      reserve_solver(s, solver_, settings);
      step_by_stage(exec, s, solver_, settings, clock);
    });
    s.parity = 1 - s.parity;
    return times;
  }

  StageTimes timed_search(State<Cuda>& s, const StepSettings& settings) {
    return timed(s, [&](Cuda exec, const auto& clock) { search_by_stage(exec, s, settings, clock); });
  }

  /// Runs work between steps.
  template <class Stage>
  void run(const Stage& stage) {
    stage(Cuda{exec_.stream});
    check_cuda(cudaStreamSynchronize(stream_of(exec_)), "stage");
  }

  /// Number of the device that this thread works on.
  static int gpu() {
    int device = 0;
    check_cuda(cudaGetDevice(&device), "device");
    return device;
  }

  static double traffic(const State<Cuda>& s, const StepSettings& settings, Index contacts) {
    if (is_penalty(settings.contact)) return penalty_traffic(s, contacts);
    if (settings.iteration == Iteration::jacobi_scan) return scan_traffic(s, contacts);
    return double(contacts) * bytes_per_contact(s.turning) + double(s.body_count) * bytes_per_body();
  }

  /// Call after buffers have moved or other kernels are needed.
  void forget() {
    for (cudaGraphExec_t& graph : graph_) {
      if (graph != nullptr) cudaGraphExecDestroy(graph);
      graph = nullptr;
    }
    prepared_ = false;
  }

 private:
  static constexpr Index kMaxQueued = 64, kSideStreams = 2;

  /// Runs stages one after the other in one stream, again after an overflow of the contact buffers.
  template <class Stages>
  StageTimes timed(State<Cuda>& s, const Stages& stages) {
    for (;;) {
      StageTimes times;
      stages(Cuda{exec_.stream, &s.progress.data()->halted},
             StageClock(times, [this] { check_cuda(cudaStreamSynchronize(stream_of(exec_)), "stage"); }));
      const Progress progress = collected(s);
      if (progress.halted == 0) return times;
      make_room(s, progress);
    }
  }

  /// Progress since the last call.
  static Progress collected(State<Cuda>& s) {
    const Progress progress = s.progress.read(0);
    s.progress.write(0, Progress{0, progress.contact_total, 0});
    return progress;
  }

  void make_room(State<Cuda>& s, const Progress& progress) {
    reserve_contacts(s, roomier(progress.contact_total));
    forget();
  }

  void launch(State<Cuda>& s, const StepSettings& settings) {
    if (!prepared_) {  // the first step is not recorded, because it allocates scratch memory
      reserve_solver(s, solver_, settings);
      step(exec_, s, solver_, settings);
      prepared_ = true;
      return;
    }
    cudaGraphExec_t& graph = graph_[s.parity];
    if (graph == nullptr) graph = recorded(s, settings);
    check_cuda(cudaGraphLaunch(graph, stream_of(exec_)), "graph launch");
  }

  cudaGraphExec_t recorded(State<Cuda>& s, const StepSettings& settings) {
    cudaGraph_t graph = nullptr;
    cudaGraphExec_t executable = nullptr;
    check_cuda(cudaStreamBeginCapture(stream_of(exec_), cudaStreamCaptureModeThreadLocal), "begin capture");
    step(exec_, s, solver_, settings);
    check_cuda(cudaStreamEndCapture(stream_of(exec_), &graph), "end capture");
    check_cuda(cudaGraphInstantiate(&executable, graph, 0), "graph");
    check_cuda(cudaGraphDestroy(graph), "graph");
    return executable;
  }

  Cuda exec_;
  SolverStorage<Cuda> solver_;
  SideStream side_[kSideStreams];
  cudaGraphExec_t graph_[2] = {nullptr, nullptr};
  bool prepared_ = false;
};

// Compiled once, in cuda.cu.
extern template void sort_into_bins(Cuda, State<Cuda>&);
extern template void find_contacts(Cuda, State<Cuda>&, const StepSettings&);
extern template void build_incidence(Cuda, State<Cuda>&);
extern template void prepare_motion(Cuda, State<Cuda>&, const StepSettings&);
extern template void apply_forces(Cuda, State<Cuda>&, const StepSettings&);
extern template void finish_step(Cuda, State<Cuda>&, const StepSettings&);
extern template class SimulationOn<Cuda>;

}  // namespace gonogo::sim
