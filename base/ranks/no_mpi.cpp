#include <cstdlib>

#include "base/ranks/ranks.h"

namespace gonogo {

std::unique_ptr<Ranks> mpi_ranks() {
  throw InputError("this program was built without MPI; configure it with -DGONOGO_MPI=ON, or start it without ranks");
}

void end_mpi_job(int status) { std::_Exit(status); }

bool knows_mpi() { return false; }

}  // namespace gonogo
