// The iteration on the GPU: all updates of a step in one cooperative kernel, so that nothing waits for launches or for
// the host. One block per multiprocessor keeps the grid-wide barriers cheap, which stand where the stages of
// solve_host.h end; its threads work in teams of one tile each. Where all contacts have threads of their own, they stay
// on the multiprocessors (residence.cuh).
#pragma once
#include "base/device.h"
#include "sim/solver/cuda/kernel.cuh"
#include "sim/solver/jacobi_scan.h"

namespace gonogo::sim {

/// All iterations of a step.
template <bool turning, bool resident, bool in_substeps, Solver method>
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
/// the blocks have been given the memory for it.
template <bool turning, bool in_substeps, Solver method>
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
  if constexpr (method == Solver::apgd) {
    if (may_reside && all_fit) return iterate<turning, true, in_substeps, method>(views, team, work);
  }
  iterate<turning, false, in_substeps, method>(views, team, work);
}

inline bool is_accelerated(Solver solver) { return solver == Solver::apgd || solver == Solver::jacobi; }

inline void reserve_solver(const State<Cuda>& s, SolverStorage<Cuda>& own, const StepSettings& settings) {
  if (settings.solver == Solver::jacobi_scan) return reserve_scan(s, own.scan, settings);
  own.frame.resize(s.contact_capacity);
  own.cone.resize(s.contact_capacity);
  own.central.resize(s.contact_capacity);
  own.arms.resize(s.contact_capacity);
  own.pair.resize(s.contact_capacity);
  if (settings.substeps > 1 || !is_accelerated(settings.solver)) own.gap.resize(s.contact_capacity);
  for (auto& of_contact : own.linear) of_contact.resize(s.contact_capacity);
  if (s.turning || !is_accelerated(settings.solver)) {
    own.turn.resize(s.contact_capacity);
    for (auto& of_contact : own.angular) of_contact.resize(s.contact_capacity);
  }
  own.half.resize(2 * std::size_t(s.contact_capacity));
  own.of_body.resize(s.body_count);
  own.hub.resize(s.body_count);
  own.counter.resize(3);
  own.tile_sums.resize(tile_capacity(s));
  own.tile_measures.resize(tile_capacity(s));
  own.body_tile_measures.resize(s.world_of_body_tile.size());
  own.other_momentum.resize(s.world_count);
  own.motor_before.resize(s.mechanisms.motor.size());
  own.mechanism_slot.resize(s.mechanisms.gathered.size());
  own.mechanism_gathered.resize(s.mechanisms.gathered.size());
  if (settings.solver == Solver::gauss_seidel) own.colour.resize(s.contact_capacity);
  if (settings.solver != Solver::bb) return;
  own.velocity_before.resize(s.body_count);
  own.length.resize(s.world_count);
  own.spectral_sums.resize(tile_capacity(s));
}

/// One block per multiprocessor, and no more than there is work for: a barrier costs less with fewer.
inline Index grid_size(const State<Cuda>& s) {
  const Index work = std::max(tile_capacity(s), (s.body_count + kTileSize - 1) / kTileSize);
  return std::min<Index>(work, device_attribute(cudaDevAttrMultiProcessorCount));
}

/// The mechanism of a whole vehicle takes its team about as long as moving a million bodies takes all teams. Where such
/// teams are few they leave the bodies to the others, which would wait for them else. Nought where mechanisms are
/// small.
inline Index mechanism_teams(const State<Cuda>& s) {
  constexpr Index large = 6, few = 8;  // bodies; one team of so many
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

template <bool turning, bool in_substeps, Solver method = Solver::apgd>
void launch_solve(Cuda exec, State<Cuda>& s, SolverStorage<Cuda>& own, const StepSettings& settings) {
  const auto kernel = solve_kernel<turning, in_substeps, method>;
  SolveViews views = solve_views(exec, s, own, settings);
  constexpr std::size_t room = sizeof(Residence);
  const std::size_t offered = device_attribute(cudaDevAttrMaxSharedMemoryPerBlockOptin);
  // Whether the contacts fit too is known on the device only.
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

/// By Gauss-Seidel or spectral gradients; compiled apart, in methods.cu.
void solve_otherwise(Cuda exec, State<Cuda>& s, SolverStorage<Cuda>& own, const StepSettings& settings);
/// `jacobi_scan`; compiled apart, in scan.cu.
void solve_with_scans(Cuda exec, State<Cuda>& s, ScanStorage<Cuda>& own, const StepSettings& settings);

}  // namespace gonogo::sim
