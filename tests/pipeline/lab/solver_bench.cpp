// Performance profiles against a table worked out by hand, and the files of a bench.
#include "pipeline/lab/bench/solver_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/files/file.h"
#include "base/units.h"
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
  bench.solvers = {sim::local_solver("nsgs"), sim::local_solver("pdip"), sim::local_solver("qp")};
  int calls = 0;
  const auto runs = bench_solvers(bench, {.ended = [&](const SolverRun&) { ++calls; }});
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
  int seen = 0;
  const auto stop = [&](const SolverRun&) {
    if (++seen == 2) throw Cancelled();
  };
  CHECK_THROWS_AS(bench_solvers(bench, {.ended = stop}), Cancelled);
  CHECK(seen == 2);
  bench.tolerances = {1e-6, 1e-3};
  refused([&] { bench_solvers(bench); }, "tolerances must fall");
}

TEST_CASE("in a column of spheres each contact carries the weight above it") {
  const int count = 12;
  const SceneStep step = settled_step(step_scene("stack"), count, 1);
  const sim::StepProblem problem = step_problem(step);
  REQUIRE(problem.local().contact_count() == count);
  CHECK(step.bodies == count);
  const sim::LocalSolution x =
      sim::solve(problem.local(), {sim::local_solver("pdip_bodies"), sim::Target::ccp, 1e-9, 0});
  CHECK(x.error <= 1e-9);
  std::vector<double> normal;
  for (std::size_t k = 0; k < x.r.size(); k += 3) normal.push_back(x.r[k]);
  std::sort(normal.begin(), normal.end());
  for (int k = 0; k < count; ++k)  // what the engine left undone in float moves some
    CHECK(normal[std::size_t(k)] == Approx((10 + k) * kGravity * 1e-3).epsilon(1e-2));
  CHECK(problem.motion(x.r).kinetic_energy < 1e-6);
}

TEST_CASE("all solvers agree on momentum and kinetic energy after a step of a scene") {
  SolverBench bench;
  for (const StepScene scene : {step_scene("filling"), step_scene("drafting"), step_scene("wheel")})
    bench.scenes.push_back({scene, {40}});
  bench.solvers = {sim::local_solver("apgd"), sim::local_solver("anderson"), sim::local_solver("pdip"),
                   sim::local_solver("pdip_bodies")};
  bench.engine_solvers = {sim::Iteration::apgd};
  bench.tolerances = {1e-3, 1e-6};
  bench.settings.target = sim::Target::ccp;
  const auto runs = bench_solvers(bench);
  const std::size_t per_problem = run_names(bench).size();
  REQUIRE(runs.size() == 3 * per_problem);
  for (std::size_t first = 0; first < runs.size(); first += per_problem) {
    const sim::StepMotion& expected = runs[first + 2].motion;
    for (std::size_t k = first; k < first + per_problem; ++k) {
      const SolverRun& run = runs[k];
      const bool is_engine = run.solver == "engine_apgd";
      INFO(run.problem << " " << run.solver << " error " << run.error);
      CHECK(run.contacts > 20);
      CHECK(run.error <= (is_engine ? 1e-4 : 1e-6));
      const double allowed = is_engine ? 1e-2 : 1e-4;
      CHECK(run.motion.kinetic_energy == Approx(expected.kinetic_energy).epsilon(allowed));
      CHECK(length(run.motion.momentum - expected.momentum) <= allowed * length(expected.momentum));
    }
  }
}

TEST_CASE("a bench without W runs the solvers that need none, to the same motion, and the others refuse") {
  SolverBench bench;
  bench.scenes = {{step_scene("filling"), {40}}};
  bench.solvers = {sim::local_solver("apgd"), sim::local_solver("nsgs"), sim::local_solver("pdip"),
                   sim::local_solver("ppa")};
  bench.tolerances = {1e-4};
  bench.settings.target = sim::Target::ccp;
  const auto with = bench_solvers(bench);
  bench.most_whole = 0;
  const auto without = bench_solvers(bench);
  REQUIRE(without.size() == 4);
  for (std::size_t k = 0; k < 3; ++k) {
    INFO(without[k].solver);
    CHECK(without[k].error <= 1e-4);
    CHECK(without[k].motion.kinetic_energy == Approx(with[0].motion.kinetic_energy).epsilon(1e-2));
  }
  CHECK(with[3].refusal.empty());
  CHECK(without[3].refusal.find("without its matrix W") != std::string::npos);
}

TEST_CASE("a warm start is nearer to the solution than nothing") {
  const SceneStep step = settled_step(step_scene("stack"), 8, 1);
  const sim::StepProblem problem = step_problem(step);
  const std::vector<double> cold(problem.local().q.size(), 0.0), warm = warm_start(step, problem);
  CHECK(10 * sim::siconos_error(problem.local(), warm, sim::Target::ccp) <
        sim::siconos_error(problem.local(), cold, sim::Target::ccp));
}

TEST_CASE("growth is the slope of the logarithms") {
  SolverBench bench;
  bench.scenes = {{step_scene("stack"), {10, 100, 1000}}};
  bench.solvers = {sim::local_solver("nsgs")};
  bench.tolerances = {1e-3};
  std::vector<SolverRun> runs;
  for (const int bodies : {10, 100, 1000})
    runs.push_back({.problem = "stack",
                    .solver = "nsgs",
                    .refusal = "",
                    .scene = "stack",
                    .bodies = bodies,
                    .trace = {{bodies * bodies, 1e-3 * std::pow(bodies, 1.5), 1e-4}}});
  const std::vector<Growth> found = growth(bench, runs);
  REQUIRE(found.size() == 1);
  CHECK(found[0].sizes == 3);
  CHECK(found[0].seconds_exponent == Approx(1.5));
  CHECK(found[0].iterations_exponent == Approx(2));
  runs[2].trace.clear();
  runs[1].trace.clear();
  CHECK(std::isnan(growth(bench, runs)[0].seconds_exponent));
}

TEST_CASE("a solver that took too long is not run on more bodies, and the files of scenes say so") {
  SolverBench bench;
  bench.scenes = {{step_scene("stack"), {5, 20, 30}}};
  bench.solvers = {sim::local_solver("pdip"), sim::local_solver("apgd")};
  bench.settings.target = sim::Target::ccp;
  bench.skip_after = 0;
  const auto runs = bench_solvers(bench);
  REQUIRE(runs.size() == 6);
  CHECK(runs[0].error <= 1e-8);
  CHECK(runs[4].refusal.find("was not run") != std::string::npos);
  const TemporaryFolder folder;
  write_solver_bench(folder.path(), bench, runs);
  const std::string motion = read_file(folder / "motion.csv"), grown = read_file(folder / "growth.csv");
  CHECK(motion.find("stack 5,5,pdip,") != std::string::npos);
  CHECK(std::count(grown.begin(), grown.end(), '\n') == 1 + 2 * 3);
  bench.scenes[0].bodies = {20, 5};
  refused([&] { bench_solvers(bench); }, "must grow");
  refused([] { settled_step(step_scene("stack"), 2000, 1); }, "stack: bodies = 2000");
  refused([] { step_scene("pile"); }, "pile");
}
