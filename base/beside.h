// Runs two independent pieces of work at the same time: on the GPU in two streams, on the host one after the other.
#pragma once
#include "base/for_each.h"

namespace gonogo {

/// Work that follows waits for both. `main` may call this again; `side` may not.
template <class Main, class Side>
void beside(Cpu exec, const Main& main, const Side& side) {
  side(exec);
  main(exec);
}

#ifdef __CUDACC__
/// A second stream, and the events that order it with the first. Copies share it.
class SideStream {
 public:
  SideStream() {
    check_cuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "stream");
    for (cudaEvent_t* event : {&fork_, &join_})
      check_cuda(cudaEventCreateWithFlags(event, cudaEventDisableTiming), "event");
  }
  ~SideStream() {
    cudaEventDestroy(fork_);
    cudaEventDestroy(join_);
    cudaStreamDestroy(stream_);
  }
  SideStream(const SideStream&) = delete;
  SideStream& operator=(const SideStream&) = delete;

  cudaStream_t stream() const { return stream_; }
  void fork(cudaStream_t from) { follow(stream_, from, fork_); }
  void join(cudaStream_t to) { follow(to, stream_, join_); }

 private:
  static void follow(cudaStream_t later, cudaStream_t earlier, cudaEvent_t event) {
    check_cuda(cudaEventRecord(event, earlier), "event");
    check_cuda(cudaStreamWaitEvent(later, event, 0), "event");
  }

  cudaStream_t stream_ = nullptr;
  cudaEvent_t fork_ = nullptr, join_ = nullptr;
};

/// Runs one after the other where there is no side stream.
template <class Main, class Side>
void beside(Cuda exec, const Main& main, const Side& side) {
  if (exec.side_count == 0) {
    side(exec);
    main(exec);
    return;
  }
  SideStream& second = static_cast<SideStream*>(exec.side)[0];
  second.fork(stream_of(exec));
  side(Cuda{second.stream(), exec.halted, nullptr, 0});
  main(Cuda{exec.stream, exec.halted, static_cast<SideStream*>(exec.side) + 1, exec.side_count - 1});
  second.join(stream_of(exec));
}
#endif

}  // namespace gonogo
