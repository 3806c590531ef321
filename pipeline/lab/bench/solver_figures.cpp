#include "pipeline/lab/bench/solver_figures.h"

#include <algorithm>
#include <cmath>

#include "base/files/file.h"
#include "base/format.h"
#include "pipeline/report/figure/chart.h"

namespace gonogo::lab {
namespace {

namespace fs = std::filesystem;

std::string curves_csv(const std::vector<SolverRun>& runs) {
  std::string csv = "problem,contacts,solver,iteration,seconds,error\n";
  for (const SolverRun& run : runs)
    for (const sim::TracePoint& p : run.trace)
      csv += line("%s,%d,%s,%d,%.6g,%.6g\n", run.problem.c_str(), run.contacts, run.solver.c_str(), p.iteration,
                  p.seconds, p.error);
  return csv;
}

std::string times_csv(const SolverBench& bench, const std::vector<SolverRun>& runs) {
  std::string csv =
      "problem,bodies,contacts,solver,tolerance,seconds,iterations,final_error,lcp_error,inner_iterations,setup_ms,"
      "solve_ms,bytes,rank,builds,multiply_adds\n";
  for (const SolverRun& run : runs)
    for (const double tolerance : bench.tolerances) {
      const double seconds = run.seconds_to(tolerance);
      csv += line("%s,%d,%d,%s,%g,", run.problem.c_str(), run.bodies, run.contacts, run.solver.c_str(), tolerance);
      csv += std::isfinite(seconds) ? line("%.6g,%.0f,", seconds, run.iterations_to(tolerance)) : ",,";
      csv += line("%.6g,%.6g,%ld,%.6g,%.6g,%zu,%td,%ld,%.6g\n", run.error, run.lcp_error, run.linear.inner_iterations,
                  run.linear.setup_ms, run.linear.solve_ms, run.linear.bytes, run.linear.rank, run.linear.builds,
                  run.linear.multiply_adds);
    }
  return csv;
}

/// Steps of a profile over log2 tau, as corners.
report::PlotLine steps(const std::string& label, const std::vector<double>& tau, const std::vector<double>& share) {
  report::PlotLine out{.label = label};
  for (std::size_t k = 0; k < tau.size(); ++k) {
    if (k > 0) out.x.push_back(std::log2(tau[k])), out.y.push_back(share[k - 1]);
    out.add(std::log2(tau[k]), share[k]);
  }
  return out;
}

/// Errors of all solvers of a problem over `abscissa`, both as logarithms.
template <class Abscissa>
void draw_curves(const fs::path& path, const std::string& label, const std::vector<const SolverRun*>& runs,
                 Abscissa abscissa) {
  report::LinePlot plot{.title = runs.front()->problem, .x_label = label, .y_label = "log10 error", .from_zero = false};
  for (const SolverRun* run : runs) {
    report::PlotLine curve{.label = run->solver};
    for (const sim::TracePoint& p : run->trace)
      if (abscissa(p) > 0 && p.error > 0) {
        curve.add(std::log10(abscissa(p)), std::log10(std::max(p.error, 1e-16)));
      }
    if (!curve.x.empty()) plot.lines.push_back(curve);
  }
  if (!plot.lines.empty()) report::draw_line_plot(path, plot);
}

/// "filling 1001" has a space, which file names should not.
std::string file_name(std::string problem) {
  std::replace(problem.begin(), problem.end(), ' ', '_');
  return problem;
}

std::string growth_csv(const std::vector<Growth>& rows) {
  std::string csv = "scene,solver,tolerance,sizes,seconds_exponent,iterations_exponent\n";
  for (const Growth& g : rows) {
    csv += line("%s,%s,%g,%d,", g.scene.c_str(), g.solver.c_str(), g.tolerance, g.sizes);
    csv += g.sizes > 1 ? line("%.3g,%.3g\n", g.seconds_exponent, g.iterations_exponent) : ",\n";
  }
  return csv;
}

std::string linear_csv(const std::vector<LinearGrowth>& rows) {
  std::string csv = "scene,solver,bytes_exponent,setup_exponent,solve_exponent,rank_exponent\n";
  for (const LinearGrowth& g : rows) {
    csv += g.scene + "," + g.solver;
    for (const double value : {g.bytes_exponent, g.setup_exponent, g.solve_exponent, g.rank_exponent})
      csv += std::isfinite(value) ? line(",%.3g", value) : ",";
    csv += "\n";
  }
  return csv;
}

std::string motion_csv(const std::vector<SolverRun>& runs) {
  std::string csv = "problem,bodies,solver,error,kinetic_energy_J,momentum_x_N_s,momentum_y_N_s,momentum_z_N_s\n";
  for (const SolverRun& run : runs) {
    if (run.scene.empty() || !run.refusal.empty()) continue;
    const Vec3d& p = run.motion.momentum;
    csv += line("%s,%d,%s,%.3g,%.9g,%.9g,%.9g,%.9g\n", run.problem.c_str(), run.bodies, run.solver.c_str(), run.error,
                run.motion.kinetic_energy, p.x, p.y, p.z);
  }
  return csv;
}

/// `cost` over bodies, both as logarithms; a line per solver.
template <class Cost>
void draw_growth(const fs::path& path, const std::string& title, const std::string& label,
                 const std::vector<std::string>& solvers, const std::vector<const SolverRun*>& runs, Cost cost) {
  report::LinePlot plot{.title = title, .x_label = "log10 bodies", .y_label = label, .from_zero = false};
  for (const std::string& solver : solvers) {
    report::PlotLine curve{.label = solver};
    for (const SolverRun* run : runs)
      if (const double value = cost(*run); run->solver == solver && std::isfinite(value)) {
        curve.add(std::log10(double(run->bodies)), std::log10(std::max(value, 1e-6)));
      }
    if (curve.x.size() > 1) plot.lines.push_back(curve);
  }
  if (!plot.lines.empty()) report::draw_line_plot(path, plot);
}

/// growth.csv, linear.csv and motion.csv; a plot of time and one of iterations per scene and tolerance, where two sizes
/// are reached.
void write_growth(const fs::path& folder, const SolverBench& bench, const std::vector<SolverRun>& runs) {
  write_file_atomically(folder / "growth.csv", growth_csv(growth(bench, runs)));
  write_file_atomically(folder / "linear.csv", linear_csv(linear_growth(bench, runs)));
  write_file_atomically(folder / "motion.csv", motion_csv(runs));
  const std::vector<std::string> solvers = run_names(bench);
  for (const SceneSizes& sizes : bench.scenes) {
    const std::string scene = step_scene_name(sizes.scene);
    std::vector<const SolverRun*> of_scene;
    for (const SolverRun& run : runs)
      if (run.scene == scene) of_scene.push_back(&run);
    for (const double tolerance : bench.tolerances) {
      const std::string title = line("%s, error %g", scene.c_str(), tolerance);
      draw_growth(folder / line("seconds_%s_%g.png", scene.c_str(), tolerance), title, "log10 processor time [s]",
                  solvers, of_scene, [&](const SolverRun& run) { return run.seconds_to(tolerance); });
      draw_growth(folder / line("iterations_%s_%g.png", scene.c_str(), tolerance), title, "log10 iterations", solvers,
                  of_scene, [&](const SolverRun& run) { return run.iterations_to(tolerance); });
    }
  }
}

}  // namespace

void write_solver_times(const fs::path& folder, const SolverBench& bench, const std::vector<SolverRun>& runs) {
  create_folder(folder);
  write_file_atomically(folder / "times.csv", times_csv(bench, runs));
}

void write_solver_curves(const fs::path& folder, const std::vector<SolverRun>& runs) {
  create_folder(folder);
  write_file_atomically(folder / "curves.csv", curves_csv(runs));
}

void write_solver_bench(const fs::path& folder, const SolverBench& bench, const std::vector<SolverRun>& runs) {
  write_solver_times(folder, bench, runs);
  write_solver_curves(folder, runs);
  const std::vector<std::string> names = run_names(bench);
  std::string csv = "tolerance,solver,tau,share\n";
  for (const double tolerance : bench.tolerances) {
    const Profile profile = time_profile(bench, runs, tolerance);
    report::LinePlot plot;
    plot.title = line("Share of problems ended at error %g", tolerance);
    plot.x_label = "log2 (time / that of the fastest)";
    plot.y_label = "share of problems";
    for (std::size_t s = 0; s < names.size(); ++s) {
      const std::string& name = names[s];
      for (std::size_t k = 0; k < profile.tau.size(); ++k)
        csv += line("%g,%s,%.6g,%.6g\n", tolerance, name.c_str(), profile.tau[k], profile.share[s][k]);
      plot.lines.push_back(steps(name, profile.tau, profile.share[s]));
    }
    report::draw_line_plot(folder / line("profile_%g.png", tolerance), plot);
  }
  write_file_atomically(folder / "profile.csv", csv);
  const std::size_t per_problem = names.size();
  for (std::size_t first = 0; first < runs.size(); first += per_problem) {
    std::vector<const SolverRun*> of_problem;
    for (std::size_t k = first; k < first + per_problem; ++k) of_problem.push_back(&runs[k]);
    const std::string name = file_name(runs[first].problem);
    draw_curves(folder / ("curve_" + name + ".png"), "log10 processor time [s]", of_problem,
                [](const sim::TracePoint& p) { return std::max(p.seconds, 1e-6); });
    draw_curves(folder / ("iterations_" + name + ".png"), "log10 iterations", of_problem,
                [](const sim::TracePoint& p) { return double(p.iteration); });
  }
  if (!bench.scenes.empty()) write_growth(folder, bench, runs);
}

}  // namespace gonogo::lab
