// Frictional contact problems made by others, solved and judged by the error measure of Siconos.
#pragma once
#include <filesystem>
#include <vector>

#include "sim/local_problem/solve.h"

namespace gonogo::lab {

struct FclibResult {
  std::string name, solver;  // of the file; sim::solver_name
  int dimension = 0, contacts = 0, iterations = 0;
  double coulomb_error = 0, ccp_error = 0;  // sim::siconos_error of the impulses found, for both targets
  double claimed_error = 0;                 // sim::claimed_error for the target asked for
  int facets = 0;                           // of the LCP family; its lcp_error is the claimed error
  std::string refusal;                      // why the solver did not take the problem; empty: it did
  sim::LinearWork linear;
  double ms = 0;          // solving, without reading
  std::vector<double> r;  // the impulses [contacts * dimension]
};

/// Files as given; a folder stands for its .hdf5 and .dat files, by name. Throws InputError for a path that is neither
/// and for a folder without such files.
std::vector<std::filesystem::path> fclib_files(const std::vector<std::filesystem::path>& paths);

/// Throws InputError for a malformed file; not reaching the tolerance is a result.
FclibResult solve_fclib(const std::filesystem::path& file, const sim::LocalSolveSettings& settings);

/// Writes `folder`/NAME.SOLVER.txt: a line per contact with its `dimension` impulses, normal first, to the last bit.
/// Creates the folder. Throws as create_folder and write_file_atomically do.
void write_impulses(const std::filesystem::path& folder, const FclibResult& result);

}  // namespace gonogo::lab
