// Performance profiles against a table worked out by hand, and the files of a bench.
#include "pipeline/lab/solver_bench/solver_bench.h"

#include <cmath>
#include <limits>

#include "base/file.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::lab;

TEST_CASE("a profile is the share of problems within a factor of the fastest") {
  const double never = std::numeric_limits<double>::infinity();
  // Ratios: first solver 1, 2, 1, -; second 2, 1, -, -: the last problem is ended by none.
  const Profile profile = performance_profile({{1, 4, 3, never}, {2, 2, never, never}});
  CHECK(profile.tau == std::vector<double>{1, 2});
  CHECK(profile.share == std::vector<std::vector<double>>{{0.5, 0.75}, {0.25, 0.5}});
}

TEST_CASE("a bench knows when each solver reached each error, and writes curves that say the same") {
  SolverBench bench;
  bench.files = {GONOGO_SOURCE_DIR "/tests/data/fclib/Rover1040.dat"};
  bench.solvers = {sim::LocalSolver::nsgs, sim::LocalSolver::pdip, sim::LocalSolver::qp};
  int calls = 0;
  const auto runs = bench_solvers(bench, [&] { ++calls; });
  REQUIRE(runs.size() == 3);
  CHECK(calls == 3);
  for (const SolverRun& run : {runs[0], runs[1]}) {
    CHECK(run.error <= 1e-8);
    CHECK(run.seconds_to(1e-3) <= run.seconds_to(1e-6));
    CHECK(run.seconds_to(1e-8) < 10);
    CHECK(run.iterations_to(1e-8) <= run.iterations);
    for (std::size_t k = 1; k < run.trace.size(); ++k) {
      CHECK(run.trace[k].error <= run.trace[k - 1].error);
      CHECK(run.trace[k].seconds >= run.trace[k - 1].seconds);
    }
  }
  CHECK(!runs[2].refusal.empty());
  CHECK(std::isinf(runs[2].seconds_to(1e-3)));
  const Profile profile = time_profile(bench, runs, 1e-8);
  CHECK(profile.share[2].back() == 0);
  CHECK(profile.share[0].front() + profile.share[1].front() == 1);
  const TemporaryFolder folder;
  write_solver_bench(folder.path(), bench, runs);
  const std::string curves = read_file(folder / "curves.csv"), times = read_file(folder / "times.csv");
  CHECK(curves.find("Rover1040.dat,5,pdip,0,") != std::string::npos);
  CHECK(std::count(times.begin(), times.end(), '\n') == 1 + 3 * 3);
  CHECK(read_file(folder / "profile.csv").find("1e-08,qp,1,0\n") != std::string::npos);
  bench.tolerances = {1e-6, 1e-3};
  refused([&] { bench_solvers(bench, [] {}); }, "tolerances must fall");
}
