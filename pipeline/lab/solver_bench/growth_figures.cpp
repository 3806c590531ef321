#include "pipeline/lab/solver_bench/growth_figures.h"

#include <algorithm>
#include <cmath>

#include "base/file.h"
#include "base/line.h"
#include "pipeline/report/figure/line_plot.h"

namespace gonogo::lab {
namespace {

namespace fs = std::filesystem;

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
  report::LinePlot plot;
  plot.title = title;
  plot.x_label = "log10 bodies";
  plot.y_label = label;
  plot.from_zero = false;
  for (const std::string& solver : solvers) {
    report::PlotLine curve{.label = solver};
    for (const SolverRun* run : runs)
      if (const double value = cost(*run); run->solver == solver && std::isfinite(value)) {
        curve.x.push_back(std::log10(double(run->bodies)));
        curve.y.push_back(std::log10(std::max(value, 1e-6)));
      }
    if (curve.x.size() > 1) plot.lines.push_back(curve);
  }
  if (!plot.lines.empty()) report::draw_line_plot(path, plot);
}

}  // namespace

void write_growth(const fs::path& folder, const SolverBench& bench, const std::vector<SolverRun>& runs) {
  write_file_atomically(folder / "growth.csv", growth_csv(growth(bench, runs)));
  write_file_atomically(folder / "linear.csv", linear_csv(linear_growth(bench, runs)));
  write_file_atomically(folder / "motion.csv", motion_csv(runs));
  const std::vector<std::string> solvers = run_names(bench);
  for (const SceneSizes& sizes : bench.scenes) {
    const std::string& scene = step_scene_names()[std::size_t(sizes.scene)];
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

}  // namespace gonogo::lab
