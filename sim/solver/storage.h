// Arrays that a solver keeps for itself, apart from the State that all stages of a step share.
#pragma once

namespace gonogo::sim {

/// A backend holds one beside its State and hands both to solve(). Specialised by host_blocks.h and cuda/records.cuh.
template <class Exec>
struct SolverStorage;

}  // namespace gonogo::sim
