// The engine on a GPU: the same stages, queued as graphs.
#include "sim/backend/simulation_on.h"
#include "sim/solver/solve_cuda.cuh"

namespace gonogo::sim {

/// Steps are recorded once as graphs, one for each contact store that a step may write, and replayed many at a time;
/// the host looks only now and then how far they came.
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
      const Index queued = std::min(count - done, kMostQueued), parity = s.parity;
      for (Index i = 0; i < queued; ++i) {
        launch(s, settings);
        s.parity = 1 - s.parity;
      }
      const Progress progress = s.progress.read(0);
      s.progress.write(0, Progress{0, progress.contact_total, 0});
      done += progress.steps;
      if (progress.halted == 0) continue;
      s.parity = (parity + progress.steps) % 2;
      reserve_contacts(s, progress.contact_total + progress.contact_total / 2);
      forget();
    }
  }

  /// Outside of steps.
  template <class Stage>
  void run(const Stage& stage) {
    stage(Cuda{exec_.stream});
    check_cuda(cudaStreamSynchronize(stream_of(exec_)), "stage");
  }

  /// After buffers have moved or kernels have to be chosen anew.
  void forget() {
    for (cudaGraphExec_t& graph : graph_) {
      if (graph != nullptr) cudaGraphExecDestroy(graph);
      graph = nullptr;
    }
    prepared_ = false;
  }

 private:
  static constexpr Index kMostQueued = 64, kSideStreams = 2;

  void launch(State<Cuda>& s, const StepSettings& settings) {
    if (!prepared_) {  // taken step by step: scratch memory is allocated on the way
      reserve_solver(s, settings);
      step(exec_, s, settings);
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
    step(exec_, s, settings);
    check_cuda(cudaStreamEndCapture(stream_of(exec_), &graph), "end capture");
    check_cuda(cudaGraphInstantiate(&executable, graph, 0), "graph");
    check_cuda(cudaGraphDestroy(graph), "graph");
    return executable;
  }

  Cuda exec_;
  SideStream side_[kSideStreams];
  cudaGraphExec_t graph_[2] = {nullptr, nullptr};
  bool prepared_ = false;
};

template class SimulationOn<Cuda>;

std::unique_ptr<Simulation> make_cuda_simulation(std::vector<FlatWorld> worlds, const StepSettings& settings,
                                                 const WorldSize& room) {
  return std::make_unique<SimulationOn<Cuda>>(Cuda{}, std::move(worlds), settings, room);
}

}  // namespace gonogo::sim
