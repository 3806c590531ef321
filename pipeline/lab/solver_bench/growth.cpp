#include <cmath>
#include <limits>

#include "pipeline/lab/solver_bench/solver_bench.h"

namespace gonogo::lab {
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

/// Of `value` over contacts, where it is above 0.
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
      const std::string& scene = step_scene_names()[std::size_t(sizes.scene)];
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
    const std::string& scene = step_scene_names()[std::size_t(sizes.scene)];
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

}  // namespace gonogo::lab
