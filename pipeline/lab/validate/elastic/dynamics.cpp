// Elastic bodies in motion: a wave along a bar, and integrators on a vibrating plate.
//
// A step of stress runs along a bar at c = sqrt(E / rho) (nu = 0) and moves the material at sigma / (rho c).

#include <algorithm>

#include "base/format.h"
#include "pipeline/lab/validate/elastic/elastic.h"
#include "pipeline/lab/validate/elastic/parts.h"

namespace gonogo::lab {

CheckFigure elastic_wave() {
  constexpr double kYoung = 2e11, kDensity = 7800, kLength = 1, kStress = 1e6;  // [Pa], [kg/m^3], [m], [Pa]
  constexpr int kElements = 400;
  const double c = std::sqrt(kYoung / kDensity), plateau = kStress / (kDensity * c), cell = kLength / kElements;
  el::Model model;
  model.body = {{"bar", el::make_rectangle(el::even(0, kLength, kElements), {0, cell}), {kYoung, 0, kDensity}}};
  const el::Mesh& mesh = model.body[0].mesh;
  model.traction = {{0, el::faces_where(mesh, [](const Vec3d& x) { return near(x.x, 0); }), [](double) {
                       return Vec3d{kStress, 0, 0};
                     }}};
  const auto node_at = [&](double x) {
    return el::nodes_where(mesh, [x](const Vec3d& p) { return near(p.x, x) && near(p.y, 0); })[0];
  };
  const Index station[2] = {node_at(kLength / 4), node_at(3 * kLength / 4)};
  el::Simulation s(model);
  const double step = 0.9 * s.critical_step().by_iteration;
  report::PlotLine line_of[2] = {{.label = "at L / 4"}, {.label = "at 3 L / 4"}};
  CheckFigure figure = figure_of("elastic_wave", "time_s,velocity_quarter_m_s,velocity_three_quarters_m_s\n");
  double arrival[2] = {0, 0};  // when each station passes half the closed-form velocity [s]
  double last[2] = {0, 0};
  need_finished(s.central_difference({.end = 0.95 * kLength / c,
                                      .step = step,
                                      .watch =
                                          [&](const el::Simulation& now) {
                                            const double t = now.state().time;
                                            double v[2];
                                            for (int i = 0; i < 2; ++i) {
                                              v[i] = now.velocity(0, station[i]).x;
                                              if (arrival[i] == 0 && v[i] >= plateau / 2)
                                                arrival[i] = t - step * (v[i] - plateau / 2) / (v[i] - last[i]);
                                              last[i] = v[i];
                                              line_of[i].add(1e6 * t, v[i] / plateau);
                                            }
                                            figure.csv += line("%.6g,%.6g,%.6g\n", t, v[0], v[1]);
                                            return true;
                                          }}),
                "wave along a bar");
  const double speed = kLength / 2 / (arrival[1] - arrival[0]);
  figure.check = {{"wave_speed_ratio", "Bar: speed of a wave over sqrt(E / rho)", 0.99, 1.01, speed / c}};
  figure.plot = plot_of("Step of stress along a bar", "time [us]", "v rho c / sigma", {line_of[0], line_of[1]});
  return figure;
}

// Integrators on a vibrating plate: energy of Newmark's method, and the bound of central differences.

namespace {

/// A cantilever of 0.4 m by 0.1 m, bent by an initial velocity; rubber-like.
el::Simulation cantilever() {
  el::Model model;
  model.body = {{"beam", el::make_rectangle(el::even(0, 0.4, 16), el::even(0, 0.1, 4)), {1e7, 0.3, 1000}}};
  const auto root = el::nodes_where(model.body[0].mesh, [](const Vec3d& x) { return near(x.x, 0); });
  model.fixed = {{0, root, 0}, {0, root, 1}};
  el::Simulation s(std::move(model));
  s.set_velocity(0, [](const Vec3d& x) { return Vec3d{0, 2 * x.x * x.x, 0}; });
  return s;
}

/// Energy over the first energy, every step.
std::vector<double> energies(const el::NewmarkSettings& newmark, int steps, double step) {
  el::Simulation s = cantilever();
  const double first = s.energy().total();
  std::vector<double> over{1};
  need_finished(s.newmark({.end = steps * step,
                           .step = step,
                           .newmark = newmark,
                           .watch =
                               [&](const el::Simulation& now) {
                                 over.push_back(now.energy().total() / first);
                                 return true;
                               }}),
                "vibrating beam");
  return over;
}

/// Largest displacement after each step [m].
std::vector<double> amplitudes(double share) {
  el::Simulation s = cantilever();
  std::vector<double> amplitude;
  s.central_difference({.end = 1e9,
                        .step = share * s.critical_step().by_iteration,
                        .refuse_above_critical = false,
                        .watch = [&](const el::Simulation& now) {
                          double largest = 0;
                          for (const double u : now.state().u) largest = std::max(largest, std::fabs(u));
                          amplitude.push_back(largest);
                          return amplitude.size() < 3000 && largest < 1e30;
                        }});
  return amplitude;
}

report::PlotLine over_steps(const std::string& label, const std::vector<double>& y, double (*of)(double)) {
  report::PlotLine l{.label = label};
  for (std::size_t i = 0; i < y.size(); ++i) {
    l.add(double(i), of(y[i]));
  }
  return l;
}

}  // namespace

CheckFigure elastic_energy() {
  constexpr int steps = 1000;
  constexpr double step = 5e-4;  // [s], a hundredth of the first period
  const auto kept = energies({}, steps, step), lost = energies(el::hht(-0.1), steps, step);
  double drift = 0;
  CheckFigure figure = figure_of("elastic_energy", "step,conservative,hht\n");
  for (std::size_t i = 0; i < kept.size(); ++i) {
    drift = std::max(drift, std::fabs(kept[i] - 1));
    figure.csv += line("%zu,%.12f,%.12f\n", i, kept[i], lost[i]);
  }
  figure.check = {
      {"newmark_energy_drift", "Newmark, beta 1/4, gamma 1/2: largest energy drift of 1,000 steps", 0, 1e-6, drift},
      {"hht_energy_left", "HHT, alpha -0.1: energy left after 1,000 steps, below 1", 0.01, 0.999, lost.back()}};
  const auto same = [](double x) { return x; };
  figure.plot = plot_of("Energy of a vibrating beam", "step", "energy over the first",
                        {over_steps("beta 1/4, gamma 1/2", kept, same), over_steps("HHT, alpha -0.1", lost, same)});
  return figure;
}

CheckFigure elastic_critical() {
  auto below = amplitudes(0.95), above = amplitudes(1.05);
  const double first = *std::max_element(below.begin(), below.begin() + 100);  // both start alike
  for (std::vector<double>* run : {&below, &above})
    for (double& x : *run) x /= first;
  const auto largest = [](const std::vector<double>& x) { return *std::max_element(x.begin(), x.end()); };
  CheckFigure figure = figure_of("elastic_critical", "step,at_0.95,at_1.05\n");
  for (std::size_t i = 0; i < std::min(below.size(), above.size()); ++i)
    figure.csv += line("%zu,%.6g,%.6g\n", i, below[i], above[i]);
  int refused = 0;
  try {
    el::Simulation s = cantilever();
    s.central_difference({.end = 1, .step = 1.05 * s.critical_step().by_iteration});
  } catch (const InputError&) {
    refused = 1;
  }
  const el::CriticalStep step = cantilever().critical_step();
  figure.check = {
      {"central_growth_at_0.95", "Central differences at 0.95 of the critical step: largest growth", 0, 20,
       largest(below)},
      {"central_growth_at_1.05", "Central differences at 1.05 of it: largest growth", 1e6, 1e300, largest(above)},
      {"central_refused_at_1.05", "Central differences at 1.05 of it: refused, 1 is yes", 1, 1, double(refused)},
      {"central_step_over_wave", "Critical step over least height over wave speed", 0.5, 1.5,
       step.by_iteration / step.by_wave}};
  const auto log = [](double x) { return std::log10(std::max(x, 1e-3)); };
  figure.plot =
      plot_of("Central differences about the critical step", "step", "log10 of the largest displacement over the first",
              {over_steps("0.95 of it", below, log), over_steps("1.05 of it", above, log)}, false);
  return figure;
}

}  // namespace gonogo::lab
