// The contract of solve(), which takes a step from its contacts to impulses and velocities at its end. Each execution
// space has its own, in solve_host.h and cuda/launch.cuh:
//
//   void solve(Exec exec, State<Exec>& s, SolverStorage<Exec>& own, const StepSettings& settings);
//
// In, from the stages before: contacts with their lists and tiles, the maps of the mechanisms, the motors, and
//   velocity                     of every body at the step's start
//   velocity_change              of every body by gravity, spin and forces in a substep
//   store[parity].impulse        warm start of the contacts; a penalty law reads the other store's history instead
//   mechanisms.motor_impulse     warm start of the motors
// Out:
//   velocity                     of every body at the step's end; a fixed body keeps its own
//   store[parity].impulse        of the last substep, inside the cone; a penalty law writes store[parity].history too
//   mechanisms.motor_impulse, mechanisms.gathered
//   contact                      step sizes, biases and, in substeps, gaps
//   momentum, free_velocity, extrapolated_velocity, substep_velocity, earlier_velocity, world_sums
// Nothing else of the State is written: positions and orientations stay those of the step's start. A penalty law leaves
// contacts, momentum and the velocities of substeps as they are. `own` keeps nothing from step to step; solve() sizes
// it on the host, reserve_solver() on the GPU. No array of a State or of `own` aliases another.
#pragma once

namespace gonogo::sim {

/// Arrays that a solver keeps for itself, apart from the State that all stages of a step share. A backend holds one
/// beside its State. Specialised by host_blocks.h and cuda/records.cuh.
template <class Exec>
struct SolverStorage;

}  // namespace gonogo::sim
