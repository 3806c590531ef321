// Small dense problems that one thread or one block of threads works through in phases. A function of a Team does its
// share of every phase and calls sync() between phases; LoneThread is the host's team. Results do not depend on the
// size of the team, because no two members work on the same number.
#pragma once
#include "base/for_each.h"

namespace gonogo {

/// The whole problem on one thread. Eight neighbouring columns at once let the compiler use vector instructions.
struct LoneThread {
  static constexpr int kLanes = 8;
  GONOGO_HD Index rank() const { return 0; }
  GONOGO_HD Index size() const { return 1; }
  GONOGO_HD void sync() const {}

  /// f(row, first column of kLanes) for all cells of the rectangle; columns are multiples of kLanes.
  template <class F>
  GONOGO_HD void for_each_cell(Index first_row, Index end_row, Index first_column, Index end_column, const F& f) const {
    for (Index row = first_row; row < end_row; ++row)
      for (Index column = first_column; column < end_column; column += kLanes) f(row, column);
  }
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
  static constexpr int kLanes = 1;
  __device__ Index rank() const { return Index(threadIdx.x); }
  __device__ Index size() const { return Index(blockDim.x); }
  __device__ void sync() const { __syncthreads(); }

  template <class F>
  __device__ void for_each_cell(Index first_row, Index end_row, Index first_column, Index end_column,
                                const F& f) const {
    const Index columns = end_column - first_column, cells = (end_row - first_row) * columns;
    for (Index cell = rank(); cell < cells; cell += size())
      f(first_row + cell / columns, first_column + cell % columns);
  }
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
