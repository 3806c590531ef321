// Small dense problems, each solved by one thread or one block of threads in phases. A function of a Team does its
// member's share of a phase and calls sync() between phases. LoneThread is the host's team.
// Results do not depend on the size of the team, because no two members write the same number.
#pragma once
#include "base/for_each.h"

namespace gonogo {

/// The whole problem on one thread.
struct LoneThread {
  static constexpr bool kWholeRows = true;  // row by row, with the compiler's vector instructions
  GONOGO_HD Index rank() const { return 0; }
  GONOGO_HD Index size() const { return 1; }
  GONOGO_HD void sync() const {}
};

template <class Body>
void for_each_team(Cpu exec, Index count, const Body& body) {
  if (exec.threads <= 1 || count < 2) {
    for (Index i = 0; i < count; ++i) body(LoneThread{}, i);
    return;
  }
#pragma omp parallel for schedule(static) num_threads(exec.threads)
  for (Index i = 0; i < count; ++i) body(LoneThread{}, i);
}

#ifdef __CUDACC__
/// All threads of a block on one problem; neighbouring threads take neighbouring columns.
struct BlockOfThreads {
  static constexpr bool kWholeRows = false;
  __device__ Index rank() const { return Index(threadIdx.x); }
  __device__ Index size() const { return Index(blockDim.x); }
  __device__ void sync() const { __syncthreads(); }
};

inline constexpr Index kThreadsPerTeam = 256;

template <class Body>
__global__ void run_team(const Index* halted, Body body) {
  if (halted != nullptr && *halted != 0) return;
  body(BlockOfThreads{}, Index(blockIdx.x));
}

template <class Body>
void for_each_team(Cuda exec, Index count, const Body& body) {
  if (count == 0) return;
  run_team<<<count, kThreadsPerTeam, 0, stream_of(exec)>>>(exec.halted, body);
  check_cuda(cudaGetLastError(), "kernel launch");
}
#endif

}  // namespace gonogo
