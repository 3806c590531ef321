#include "pipeline/lab/validate/fclib.h"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "base/error.h"
#include "base/file.h"
#include "sim/local_problem/read.h"

namespace gonogo::lab {
namespace fs = std::filesystem;

std::vector<fs::path> fclib_files(const std::vector<fs::path>& paths) {
  std::vector<fs::path> files;
  for (const fs::path& path : paths) {
    if (!fs::is_directory(path)) {
      if (!fs::exists(path)) throw InputError(path.string() + ": no such file or folder; check the path");
      files.push_back(path);
      continue;
    }
    const std::size_t before = files.size();
    for (const auto& entry : fs::directory_iterator(path))
      if (entry.path().extension() == ".hdf5" || entry.path().extension() == ".dat") files.push_back(entry.path());
    if (files.size() == before) throw InputError(path.string() + ": holds no .hdf5 or .dat file");
    std::sort(files.begin() + std::ptrdiff_t(before), files.end());
  }
  return files;
}

FclibResult solve_fclib(const fs::path& file, const sim::LocalSolveSettings& settings) {
  const sim::LocalProblem problem = sim::read_problem(file);
  const auto start = std::chrono::steady_clock::now();
  const sim::LocalSolution solution = sim::solve(problem, settings);
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;
  FclibResult result;
  result.name = file.filename().string();
  result.dimension = problem.dimension;
  result.contacts = problem.contact_count();
  result.iterations = solution.iterations;
  result.coulomb_error = sim::siconos_error(problem, solution.r, sim::Target::coulomb);
  result.ccp_error = sim::siconos_error(problem, solution.r, sim::Target::ccp);
  result.claimed_error = sim::claimed_error(solution);
  result.facets = solution.facets;
  result.refusal = solution.refusal;
  result.linear = solution.linear;
  result.ms = taken.count();
  result.solver = sim::solver_name(settings.solver);
  result.r = solution.r;
  return result;
}

void write_impulses(const fs::path& folder, const FclibResult& result) {
  std::string text;
  for (std::size_t k = 0; k < result.r.size(); ++k) {
    char word[32];
    std::snprintf(word, sizeof word, "%.17g", result.r[k]);
    text += word;
    text += (k + 1) % std::size_t(result.dimension) == 0 ? '\n' : ' ';
  }
  create_folder(folder);
  write_file_atomically(folder / (result.name + "." + result.solver + ".txt"), text);
}

}  // namespace gonogo::lab
