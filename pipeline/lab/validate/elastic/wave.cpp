// A step of stress runs along a bar at c = sqrt(E / rho) (nu = 0) and moves the material at sigma / (rho c).
#include "base/line.h"
#include "pipeline/lab/validate/elastic/elastic.h"
#include "pipeline/lab/validate/elastic/parts.h"

namespace gonogo::lab {
namespace {

constexpr double kYoung = 2e11, kDensity = 7800, kLength = 1, kStress = 1e6;  // [Pa], [kg/m^3], [m], [Pa]
constexpr int kElements = 400;

/// Times at which two stations pass half the closed-form velocity.
struct Arrivals {
  double at[2] = {0, 0};
};

}  // namespace

ElasticFigure elastic_wave() {
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
  ElasticFigure figure = figure_of("elastic_wave", "time_s,velocity_quarter_m_s,velocity_three_quarters_m_s\n");
  Arrivals arrival;
  double last[2] = {0, 0};
  need_finished(s.central_difference({.end = 0.95 * kLength / c,
                                      .step = step,
                                      .watch =
                                          [&](const el::Simulation& now) {
                                            const double t = now.state().time;
                                            double v[2];
                                            for (int i = 0; i < 2; ++i) {
                                              v[i] = now.velocity(0, station[i]).x;
                                              if (arrival.at[i] == 0 && v[i] >= plateau / 2)
                                                arrival.at[i] = t - step * (v[i] - plateau / 2) / (v[i] - last[i]);
                                              last[i] = v[i];
                                              line_of[i].x.push_back(1e6 * t);
                                              line_of[i].y.push_back(v[i] / plateau);
                                            }
                                            figure.csv += line("%.6g,%.6g,%.6g\n", t, v[0], v[1]);
                                            return true;
                                          }}),
                "wave along a bar");
  const double speed = kLength / 2 / (arrival.at[1] - arrival.at[0]);
  figure.check = {{"wave_speed_ratio", "Bar: speed of a wave over sqrt(E / rho)", 0.99, 1.01, speed / c}};
  figure.plot = plot_of("Step of stress along a bar", "time [us]", "v rho c / sigma", {line_of[0], line_of[1]});
  return figure;
}

}  // namespace gonogo::lab
