// Small dense problems, each solved by one thread or one block of threads in phases. A function of a Team does its
// member's share of a phase and calls sync() between phases. LoneThread is the host's team.
// Results do not depend on the size of the team, because no two members write the same number.
#pragma once
#include <cstddef>
#include <vector>

#include "base/parallel/for_each.h"

namespace gonogo {

/// The whole problem on one thread.
struct LoneThread {
  static constexpr bool kWholeRows = true;  // row by row, with the compiler's vector instructions
  GONOGO_HD Index rank() const { return 0; }
  GONOGO_HD Index size() const { return 1; }
  GONOGO_HD Index row() const { return 0; }
  GONOGO_HD Index rows() const { return 1; }
  GONOGO_HD Index column() const { return 0; }
  GONOGO_HD Index columns() const { return 1; }
  GONOGO_HD void sync() const {}
};

/// Members in rows and columns; neighbours stand in a row. Each team has a room of its own that its members share: on
/// the GPU, shared memory.
struct TeamShape {
  Index columns = 32, rows = 1;  // at most kMostInTeam members
  std::size_t room = 0;          // [bytes]
};
inline constexpr Index kMostInTeam = 512;

template <class Body>
void for_each_team(Cpu exec, Index count, const Body& body) {
  if (exec.threads <= 1 || count < 2) {
    for (Index i = 0; i < count; ++i) body(LoneThread{}, i);
    return;
  }
  FirstError error;
#pragma omp parallel for schedule(static) num_threads(exec.threads)
  for (Index i = 0; i < count; ++i) error.guard([&] { body(LoneThread{}, i); });
  error.rethrow();
}

/// A team's room as an array of other numbers.
template <class T>
GONOGO_HD T* room_of(double* room) {
  return reinterpret_cast<T*>(room);
}

/// body(team, i, room) for teams with a room, which holds anything when a team begins. room: double*.
template <class Body>
void for_each_team(Cpu exec, Index count, const TeamShape& shape, const Body& body) {
  const std::size_t numbers = (shape.room + sizeof(double) - 1) / sizeof(double);
  FirstError error;
#pragma omp parallel num_threads(exec.threads > 0 ? exec.threads : 1)
  {
    std::vector<double> room;
    error.guard([&] { room.resize(numbers); });
#pragma omp for schedule(static)
    for (Index i = 0; i < count; ++i) error.guard([&] { body(LoneThread{}, i, room.data()); });
  }
  error.rethrow();
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

/// A block of threads in rows and columns.
struct GridOfThreads {
  static constexpr bool kWholeRows = false;
  __device__ Index rank() const { return Index(threadIdx.y * blockDim.x + threadIdx.x); }
  __device__ Index size() const { return Index(blockDim.x * blockDim.y); }
  __device__ Index row() const { return Index(threadIdx.y); }
  __device__ Index rows() const { return Index(blockDim.y); }
  __device__ Index column() const { return Index(threadIdx.x); }
  __device__ Index columns() const { return Index(blockDim.x); }
  __device__ void sync() const { __syncthreads(); }
};

template <class Body>
__global__ void __launch_bounds__(kMostInTeam) run_team_in_room(const Index* halted, Body body) {
  extern __shared__ double room_of_team[];
  if (halted != nullptr && *halted != 0) return;
  body(GridOfThreads{}, Index(blockIdx.x), room_of_team);
}

template <class Body>
void for_each_team(Cuda exec, Index count, const TeamShape& shape, const Body& body) {
  constexpr std::size_t kWithoutAsking = 48 * 1024;
  if (count == 0) return;
  if (shape.room > kWithoutAsking)
    check_cuda(
        cudaFuncSetAttribute(run_team_in_room<Body>, cudaFuncAttributeMaxDynamicSharedMemorySize, int(shape.room)),
        "shared memory of a team");
  run_team_in_room<<<count, dim3(unsigned(shape.columns), unsigned(shape.rows)), shape.room, stream_of(exec)>>>(
      exec.halted, body);
  check_cuda(cudaGetLastError(), "kernel launch");
}
#endif

}  // namespace gonogo
