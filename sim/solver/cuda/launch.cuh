// The iteration on the GPU: one cooperative kernel takes all updates of a step, so that nothing waits for launches or
// for the host. Barriers across the grid stand where the stages of solve_host.h end; one block per multiprocessor keeps
// them cheap. A block is four teams of 256 threads, and a team works on one tile of contacts at a time. With B blocks
// and time running downward:
//
//            block 0                       block 1                             block B-1
//          +-----+-----+-----+-----+     +-----+------+------+------+         +-----+------+------+------+
//   teams  |  0  |  B  | 2B  | 3B  |     |  1  | B+1  | 2B+1 | 3B+1 |   ...   | B-1 | 2B-1 | 3B-1 | 4B-1 |
//          +-----+-----+-----+-----+     +-----+------+------+------+         +-----+------+------+------+
//
//     stage      unit of work                       reads -> writes
//     prepare    a contact, body, world: a thread   contacts, warm start -> records, impulses
//   ================================================== grid barrier ==================================
//     start      as `move`; Gauss-Seidel colours    impulses -> velocities
//   ================================================== grid barrier ==================================
//   +>update     a tile: a team, t takes t + 4B n   velocities of both bodies -> impulse, sums of the tile
//   |            a contact: a thread of the team    (Gauss-Seidel: once for each colour, barriers between)
//   |            a motor: a thread, last ones first
//   | ================================================ grid barrier ==================================
//   | move       a mechanism: a team, last first    impulses of all contacts -> velocities
//   |            a body: 4 threads; a hub: a warp
//   | decide     a world: a team                    sums of its tiles -> its next update
//   | ================================================ grid barrier, which counts the ended worlds ===
//   +-until all worlds have ended
//     measure    a tile of contacts or bodies       impulses, velocities -> contact store, sums of the tile
//   ================================================== grid barrier ==================================
//     add        a world: a team                    sums of its tiles -> WorldSums
//
// Where each tile has a team and each body its threads, a block keeps their records in shared memory through all
// updates (records.cuh); otherwise teams and threads take several, one after the other.
#pragma once
#include "base/parallel/device.h"
#include "sim/solver/cuda/kernel.cuh"
#include "sim/solver/jacobi_scan.h"
#include "sim/solver/penalty_method.h"

namespace gonogo::sim {

/// All iterations of a step.
template <bool turning, bool resident, bool in_substeps, Iteration method>
GONOGO_DEVICE void iterate(const SolveViews& views, const Team& team, MechanismWork& work) {
  GridBarrier grid(views.barrier);
  SolveKernel<turning, resident, in_substeps, method> kernel(views, team, work);
  kernel.prepare();
  grid.wait();
  kernel.hold_bodies();
  kernel.colour_contacts();
  kernel.move_bodies(-1);
  kernel.move_mechanisms(-1);
  grid.wait();
  Index k = 0;
  for (bool ended = false; !ended; ++k) {
    kernel.update_contacts(k, grid);
    kernel.update_motors(k);
    grid.wait();
    kernel.move_mechanisms(k);
    kernel.move_bodies(k);
    kernel.decide(k);
    ended = grid.wait(views.momentum[0].size);
  }
  kernel.measure(k);
  grid.wait();
  kernel.add_measures(k);
}

/// From the warm start in the step's contact store to the velocities and impulses at the end of the step. `may_reside`:
/// the launch has given each block the shared memory of a Residence.
template <bool turning, bool in_substeps, Iteration method>
__global__ void __launch_bounds__(kBlockSize) solve_kernel(const __grid_constant__ SolveViews views, bool may_reside) {
  __shared__ double scratch[kTeamsPerBlock][kTileSize / 32];
  __shared__ __align__(16) std::uint8_t work_bytes[kTeamsPerBlock][sizeof(MechanismWork)];
  if (*views.halted != 0) return;
  const Index in_block = threadIdx.x / kTileSize;
  const Team team{in_block, Index(threadIdx.x % kTileSize), Index(in_block * gridDim.x + blockIdx.x),
                  Index(kTeamsPerBlock * gridDim.x), scratch[in_block]};
  MechanismWork& work = *reinterpret_cast<MechanismWork*>(work_bytes[in_block]);
  const bool all_fit = views.tiles.count() <= team.count && kLanesPerBody * views.mass.size <= team.count * kTileSize &&
                       views.projection.mechanism.size <= Index(gridDim.x);
  if constexpr (method == Iteration::apgd) {
    if (may_reside && all_fit) return iterate<turning, true, in_substeps, method>(views, team, work);
  }
  iterate<turning, false, in_substeps, method>(views, team, work);
}

/// Sizes the buffers for the present capacity. Call before the first step and after buffers have grown.
inline void reserve_solver(const State<Cuda>& s, SolverStorage<Cuda>& own, const StepSettings& settings) {
  reserve_grid(s, own, settings);
}

/// One block per multiprocessor, or fewer where there is less work: fewer blocks make a barrier cheaper.
inline Index grid_size(const State<Cuda>& s) {
  const Index work = std::max(tile_capacity(s), (s.body_count + kTileSize - 1) / kTileSize);
  return std::min<Index>(work, device_attribute(cudaDevAttrMultiProcessorCount));
}

/// Teams that move only their mechanism. The mechanism of a whole vehicle takes its team about as long as a million
/// bodies take all teams. If few teams have such mechanisms, the others move the bodies. 0 where mechanisms are small.
inline Index mechanism_teams(const State<Cuda>& s) {
  constexpr Index large = 6, few = 8;  // bodies of a mechanism; teams per mechanism
  const Index count = s.mechanisms.mechanism.size();
  return s.mechanisms.body.size() >= large * count && few * count <= kTeamsPerBlock * grid_size(s) ? count : 0;
}

inline SolveViews solve_views(Cuda exec, State<Cuda>& s, SolverStorage<Cuda>& own, const StepSettings& settings) {
  return {step_views(exec, s, settings),
          state_views(s),
          mechanism_views(s.mechanisms, own, mechanism_teams(s)),
          record_views(own),
          iteration_views(s, own),
          method_views(own)};
}

template <bool turning, bool in_substeps, Iteration method = Iteration::apgd>
void launch_solve(Cuda exec, State<Cuda>& s, SolverStorage<Cuda>& own, const StepSettings& settings) {
  const auto kernel = solve_kernel<turning, in_substeps, method>;
  SolveViews views = solve_views(exec, s, own, settings);
  constexpr std::size_t room = sizeof(Residence);
  const std::size_t offered = device_attribute(cudaDevAttrMaxSharedMemoryPerBlockOptin);
  // Whether the contacts fit too only the device knows.
  bool may_reside = is_accelerated(method) && kLanesPerBody * s.body_count <= kBlockSize * grid_size(s) &&
                    offered >= room + kTeamsPerBlock * sizeof(MechanismWork) + 1024;
  if (may_reside)
    check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, int(room)),
               "shared memory of the solver");
  void* arguments[] = {&views, &may_reside};
  check_cuda(cudaLaunchCooperativeKernel(kernel, dim3(grid_size(s)), dim3(kBlockSize), arguments, may_reside ? room : 0,
                                         stream_of(exec)),
             "solver launch");
}

/// Gauss-Seidel or spectral gradients. In methods.cu, so that it compiles beside the others.
void solve_otherwise(Cuda exec, State<Cuda>& s, SolverStorage<Cuda>& own, const StepSettings& settings);
/// `jacobi_scan`. In scan.cu, for the same reason.
void solve_with_scans(Cuda exec, State<Cuda>& s, ScanStorage<Cuda>& own, const StepSettings& settings);
/// The penalty family. In penalty.cu.
void push_apart(Cuda exec, State<Cuda>& s, PenaltyStorage<Cuda>& own, const StepSettings& settings);

inline void solve(Cuda exec, State<Cuda>& s, SolverStorage<Cuda>& own, const StepSettings& settings) {
  if (is_penalty(settings.contact)) return push_apart(exec, s, own.penalty, settings);
  if (settings.iteration == Iteration::jacobi_scan) return solve_with_scans(exec, s, own.scan, settings);
  clear(exec, own.counter.view());
  const bool in_substeps = settings.substeps > 1;
  if (!is_accelerated(settings.iteration))
    solve_otherwise(exec, s, own, settings);
  else if (s.turning)
    in_substeps ? launch_solve<true, true>(exec, s, own, settings) : launch_solve<true, false>(exec, s, own, settings);
  else
    in_substeps ? launch_solve<false, true>(exec, s, own, settings)
                : launch_solve<false, false>(exec, s, own, settings);
}

}  // namespace gonogo::sim
