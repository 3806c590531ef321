#include "pipeline/lab/bench/solver_bench.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <map>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/progress.h"
#include "sim/local_problem/read.h"

namespace gonogo::lab {

Profile performance_profile(const std::vector<std::vector<double>>& cost) {
  Profile profile;
  std::vector<std::vector<double>> ratio = cost;
  const std::size_t problems = cost.empty() ? 0 : cost[0].size();
  profile.tau = {1};
  for (std::size_t p = 0; p < problems; ++p) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& of_solver : cost) least = std::min(least, of_solver[p]);
    for (auto& of_solver : ratio) {
      of_solver[p] = std::isfinite(of_solver[p]) ? of_solver[p] / least : std::numeric_limits<double>::infinity();
      if (std::isfinite(of_solver[p])) profile.tau.push_back(of_solver[p]);
    }
  }
  std::sort(profile.tau.begin(), profile.tau.end());
  profile.tau.erase(std::unique(profile.tau.begin(), profile.tau.end()), profile.tau.end());
  for (const auto& of_solver : ratio) {
    std::vector<double> share;
    for (const double tau : profile.tau)
      share.push_back(double(std::count_if(of_solver.begin(), of_solver.end(), [&](double x) { return x <= tau; })) /
                      double(problems));
    profile.share.push_back(share);
  }
  return profile;
}

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

template <class Value>
double first_at(const SolverRun& run, double tolerance, Value value) {
  for (const sim::TracePoint& point : run.trace)
    if (point.error <= tolerance) return value(point);
  return kNever;
}

SolverRun run_solver(const std::string& name, const sim::LocalProblem& problem, sim::LocalSolveSettings settings,
                     const sim::StepProblem* step) {
  settings.keeps_trace = true;
  const sim::LocalSolution x = sim::solve(problem, settings);
  SolverRun run{.problem = name,
                .solver = sim::solver_name(settings.solver),
                .refusal = x.refusal,
                .contacts = problem.contact_count(),
                .iterations = x.iterations,
                .error = x.error,
                .lcp_error = x.lcp_error,
                .linear = x.linear,
                .trace = x.trace};
  if (step) run.motion = step->motion(x.r);
  return run;
}

void check(const SolverBench& bench) {
  for (std::size_t k = 0; k + 1 < bench.tolerances.size(); ++k)
    if (!(bench.tolerances[k] > bench.tolerances[k + 1])) throw InputError("tolerances must fall, from coarse to fine");
  for (const SceneSizes& sizes : bench.scenes)
    if (!std::is_sorted(sizes.bodies.begin(), sizes.bodies.end(), std::less_equal<int>()))
      throw InputError("numbers of bodies must grow, from few to many");
  if (bench.scenes.empty() && !bench.engine_solvers.empty())
    throw InputError("the engine's solvers take scenes, not problems from files; name a scene");
}

sim::LocalSolveSettings settings_of(const SolverBench& bench, sim::LocalSolver solver) {
  sim::LocalSolveSettings settings = bench.settings;
  settings.solver = solver;
  settings.tolerance = bench.tolerances.back();
  return settings;
}

/// Runs as they end.
class Runs {
 public:
  explicit Runs(const SolverBenchWatch& watch) : watch_(watch) {}

  void begin(const std::string& what) const {
    stop_if_cancelled();
    watch_.begins(what);
  }
  void add(SolverRun run) {
    runs_.push_back(std::move(run));
    watch_.ended(runs_.back());
  }
  std::vector<SolverRun> all() && { return std::move(runs_); }

 private:
  const SolverBenchWatch& watch_;
  std::vector<SolverRun> runs_;
};

class SceneRuns {
 public:
  SceneRuns(const SolverBench& bench, StepScene scene, Runs& runs) : bench_(bench), scene_(scene), runs_(runs) {}

  void run(int bodies) {
    runs_.begin("settling " + step_scene_name(scene_) + " " + std::to_string(bodies));
    const SceneStep step = settled_step(scene_, bodies, bench_.threads, bench_.backend);
    const sim::StepProblem problem = step_problem(step, bench_.most_whole);
    for (const sim::LocalSolver solver : bench_.solvers) {
      sim::LocalSolveSettings settings = settings_of(bench_, solver);
      if (bench_.is_warm && sim::takes_start(solver)) settings.start = warm_start(step, problem);
      add(sim::solver_name(solver), step, problem,
          [&] { return run_solver(step.name, problem.local(), settings, &problem); });
    }
    for (const sim::Iteration solver : bench_.engine_solvers)
      add(engine_run_name(solver), step, problem,
          [&] { return engine_run(step, problem, solver, bench_.settings, bench_.threads, bench_.backend); });
  }

 private:
  template <class Run>
  void add(const std::string& solver, const SceneStep& step, const sim::StepProblem& problem, Run run) {
    runs_.begin(step.name + ", " + solver);
    SolverRun done;
    if (const double taken = taken_[solver]; taken > bench_.skip_after)
      done = {.problem = step.name,
              .solver = solver,
              .refusal = solver + " was not run, since fewer bodies took it " + number_text(taken) + " s",
              .contacts = problem.local().contact_count(),
              .error = kNever};
    else
      done = run();
    if (!done.trace.empty()) taken_[solver] = done.trace.back().seconds;
    done.scene = step_scene_name(scene_);
    done.bodies = step.bodies;
    runs_.add(std::move(done));
  }

  const SolverBench& bench_;
  StepScene scene_;
  Runs& runs_;
  std::map<std::string, double> taken_;  // by solver, at the latest size [s]
};

}  // namespace

double SolverRun::seconds_to(double tolerance) const {
  return first_at(*this, tolerance, [](const sim::TracePoint& p) { return p.seconds; });
}
double SolverRun::iterations_to(double tolerance) const {
  return first_at(*this, tolerance, [](const sim::TracePoint& p) { return double(p.iteration); });
}

std::vector<std::string> run_names(const SolverBench& bench) {
  std::vector<std::string> names;
  for (const sim::LocalSolver solver : bench.solvers) names.push_back(sim::solver_name(solver));
  for (const sim::Iteration solver : bench.engine_solvers) names.push_back(engine_run_name(solver));
  return names;
}

std::size_t run_count(const SolverBench& bench) {
  std::size_t problems = bench.files.size();
  for (const SceneSizes& sizes : bench.scenes) problems += sizes.bodies.size();
  return problems * run_names(bench).size();
}

std::vector<SolverRun> bench_solvers(const SolverBench& bench, const SolverBenchWatch& watch) {
  check(bench);
  Runs runs(watch);
  for (const auto& file : bench.files) {
    const sim::LocalProblem problem = sim::read_problem(file);
    for (const sim::LocalSolver solver : bench.solvers) {
      runs.begin(file.filename().string() + ", " + sim::solver_name(solver));
      runs.add(run_solver(file.filename().string(), problem, settings_of(bench, solver), nullptr));
    }
    for (const sim::Iteration solver : bench.engine_solvers)
      runs.add({.problem = file.filename().string(),
                .solver = engine_run_name(solver),
                .refusal = engine_run_name(solver) + " refuses a problem from a file; it takes scenes",
                .contacts = problem.contact_count(),
                .error = kNever});
  }
  for (const SceneSizes& sizes : bench.scenes) {
    SceneRuns scene_runs(bench, sizes.scene, runs);
    for (const int bodies : sizes.bodies) scene_runs.run(bodies);
  }
  return std::move(runs).all();
}

Profile time_profile(const SolverBench& bench, const std::vector<SolverRun>& runs, double tolerance) {
  constexpr double kClock = 1e-6;  // s: shorter times are the clock's noise
  const std::size_t count = run_names(bench).size();
  std::vector<std::vector<double>> cost(count);
  for (std::size_t k = 0; k < runs.size(); ++k)
    cost[k % count].push_back(std::max(runs[k].seconds_to(tolerance), kClock));
  return performance_profile(cost);
}

namespace {

/// Seconds of the processor, or by the clock where a GPU works.
double seconds_now(sim::Backend backend) {
  if (backend == sim::Backend::cpu) return double(std::clock()) / CLOCKS_PER_SEC;
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

std::string engine_run_name(sim::Iteration solver) { return std::string("engine_") + name_of(solver); }

SolverRun engine_run(const SceneStep& step, const sim::StepProblem& problem, sim::Iteration solver,
                     const sim::LocalSolveSettings& settings, int threads, sim::Backend backend) {
  constexpr int kPatience = 10;  // runs without a lower error
  const sim::LocalProblem& local = problem.local();
  const int max = settings.max_iterations > 0 ? settings.max_iterations : 10000;
  std::vector<double> best(local.q.size(), 0.0);
  SolverRun run{.problem = step.name,
                .solver = engine_run_name(solver),
                .refusal = "",
                .contacts = local.contact_count(),
                .error = sim::siconos_error(local, best, settings.target)};
  run.trace.push_back({0, 0, run.error});
  int in_vain = 0;
  for (double next = 5; next <= max && run.error > settings.tolerance && in_vain < kPatience; next *= 1.5) {
    stop_if_cancelled();
    sim::StepSettings with = step.settings;
    with.iteration = solver;
    with.iterations = run.iterations = int(next);
    with.target = settings.target;
    const auto simulation = sim::make_simulation(backend, {step.world}, with, threads);
    const double start = seconds_now(backend);
    simulation->advance(1);
    const double seconds = seconds_now(backend) - start;
    const std::vector<double> r = problem.impulses(simulation->contacts(0), simulation->impulses(0));
    const double error = sim::siconos_error(local, r, settings.target);
    in_vain = error < 0.9 * run.error ? 0 : in_vain + 1;
    if (error < run.error) {
      run.error = error;
      best = r;
    }
    run.trace.push_back({run.iterations, seconds, run.error});
  }
  run.motion = problem.motion(best);
  return run;
}

namespace {

/// Slope of y over x by least squares; NaN below two points.
double slope(const std::vector<double>& x, const std::vector<double>& y) {
  if (x.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  double mean_x = 0, mean_y = 0, xy = 0, xx = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    mean_x += x[k] / double(x.size());
    mean_y += y[k] / double(x.size());
  }
  for (std::size_t k = 0; k < x.size(); ++k) {
    xy += (x[k] - mean_x) * (y[k] - mean_y);
    xx += (x[k] - mean_x) * (x[k] - mean_x);
  }
  return xy / xx;
}

/// Exponent of `value` over contacts, where it is above 0.
template <class Value>
double exponent(const std::vector<const SolverRun*>& runs, Value value) {
  std::vector<double> x, y;
  for (const SolverRun* run : runs)
    if (const double v = value(run->linear); v > 0) {
      x.push_back(std::log(double(run->contacts)));
      y.push_back(std::log(v));
    }
  return slope(x, y);
}

}  // namespace

std::vector<LinearGrowth> linear_growth(const SolverBench& bench, const std::vector<SolverRun>& runs) {
  std::vector<LinearGrowth> out;
  for (const SceneSizes& sizes : bench.scenes)
    for (const std::string& solver : run_names(bench)) {
      const std::string scene = step_scene_name(sizes.scene);
      std::vector<const SolverRun*> with_factors;
      for (const SolverRun& run : runs)
        if (run.scene == scene && run.solver == solver && run.linear.bytes > 0) with_factors.push_back(&run);
      if (with_factors.empty()) continue;
      out.push_back({.scene = scene,
                     .solver = solver,
                     .bytes_exponent = exponent(with_factors, [](const auto& w) { return double(w.bytes); }),
                     .setup_exponent = exponent(with_factors, [](const auto& w) { return w.setup_ms; }),
                     .solve_exponent = exponent(with_factors, [](const auto& w) { return w.solve_ms; }),
                     .rank_exponent = exponent(with_factors, [](const auto& w) { return double(w.rank); })});
    }
  return out;
}

std::vector<Growth> growth(const SolverBench& bench, const std::vector<SolverRun>& runs) {
  constexpr double kClock = 1e-6;  // s
  std::vector<Growth> out;
  for (const SceneSizes& sizes : bench.scenes) {
    const std::string scene = step_scene_name(sizes.scene);
    for (const std::string& solver : run_names(bench))
      for (const double tolerance : bench.tolerances) {
        std::vector<double> bodies, seconds, iterations;
        for (const SolverRun& run : runs) {
          const double taken = run.seconds_to(tolerance);
          if (run.scene != scene || run.solver != solver || !std::isfinite(taken)) continue;
          bodies.push_back(std::log(double(run.bodies)));
          seconds.push_back(std::log(std::max(taken, kClock)));
          iterations.push_back(std::log(std::max(run.iterations_to(tolerance), 1.0)));
        }
        out.push_back({.scene = scene,
                       .solver = solver,
                       .tolerance = tolerance,
                       .sizes = int(bodies.size()),
                       .seconds_exponent = slope(bodies, seconds),
                       .iterations_exponent = slope(bodies, iterations)});
      }
  }
  return out;
}

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
  for (std::size_t k = 0; k < result.r.size(); ++k)
    text += line("%.17g", result.r[k]) + ((k + 1) % std::size_t(result.dimension) == 0 ? '\n' : ' ');
  create_folder(folder);
  write_file_atomically(folder / (result.name + "." + result.solver + ".txt"), text);
}

}  // namespace gonogo::lab
