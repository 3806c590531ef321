// Ranks that are processes of an MPI job, started by mpirun.
#pragma once
#include "base/ranks/ranks.h"

namespace gonogo {

/// The ranks of the job that this process belongs to. The first call initialises MPI, the end of the process finalises
/// it.
std::unique_ptr<Ranks> mpi_ranks();

/// Ends all processes of the job, and this one, with this exit status. Call where a rank fails: the others would wait
/// for it.
[[noreturn]] void end_mpi_job(int status);

}  // namespace gonogo
