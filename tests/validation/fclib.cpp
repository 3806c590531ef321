// Problems made by others: every one solved to the Siconos error that its users ask for.
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "sim/law/contact_law.h"
#include "sim/local_problem/methods/solve.h"
#include "sim/local_problem/read.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::sim;

namespace {

std::vector<std::filesystem::path> problems() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(GONOGO_SOURCE_DIR "/tests/data/fclib")) {
    const auto kind = entry.path().extension();
    if (kind == ".dat" || kind == ".hdf5") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The error, printed with what it took.
double solve_file(const std::filesystem::path& file, const LocalSolveSettings& settings) {
  const LocalProblem problem = read_problem(file);
  const LocalSolution x = solve(problem, settings);
  const double error = siconos_error(problem, x.r, settings.target);
  std::printf("%-34s %3d contacts, %-4s %-7s: error %.2e after %d iterations\n", file.filename().c_str(),
              problem.contact_count(), solver_name(settings.solver), name_of(settings.target), error, x.iterations);
  std::fflush(stdout);
  return error;
}

}  // namespace

TEST_CASE(
    "two methods solve every problem by others to 1e-8, with exact Coulomb friction, and as its convex relaxation") {
  const auto files = problems();
  REQUIRE(files.size() == 11);
  for (const auto& file : files)
    for (const Target target : {Target::coulomb, Target::ccp}) {
      INFO(file.filename());
      for (const LocalSolver solver : {local_solver("ppa"), local_solver("pdip")})
        CHECK(solve_file(file, {solver, target, 1e-8, 0}) <= 1e-8);
    }
}

TEST_CASE("first-order solvers reach 1e-4 with exact Coulomb friction on all but the problems kept for being hard") {
  for (const auto& file : problems()) {
    INFO(file.filename());
    const std::string name = file.filename();
    // 20000 sweeps of Gauss-Seidel end at 1.3e-4 and 1.8e-4, 100000 gradients on RockPile at 1.0e-4.
    const bool rocks = name == "RockPile_tob1.dat", boxes = name == "fclib_local_problem_test.hdf5";
    const double gradients = rocks ? 1e-3 : 1e-4, sweeps = rocks || boxes ? 1e-3 : 1e-4;
    CHECK(solve_file(file, {local_solver("apgd"), Target::coulomb, gradients, 0}) <= gradients);
    CHECK(solve_file(file, {local_solver("nsgs"), Target::coulomb, sweeps, 0}) <= sweeps);
  }
}

TEST_CASE("alternating directions reach 1e-8 on all problems but the rock pile, there 1e-5") {
  for (const auto& file : problems()) {
    INFO(file.filename());
    const double error = file.filename() == "RockPile_tob1.dat" ? 1e-5 : 1e-8;
    CHECK(solve_file(file, {local_solver("admm"), Target::coulomb, error, 0}) <= error);
  }
}
