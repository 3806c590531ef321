// Newton's residuals of one contact step, with friction and a power law: near the solution each is below a constant
// times the square of the one before.
#include <algorithm>

#include "base/line.h"
#include "pipeline/lab/validate/elastic/elastic.h"
#include "pipeline/lab/validate/elastic/parts.h"

namespace gonogo::lab {
namespace {

/// A block of 0.2 m by 0.1 m, into which a ball is pushed and dragged in one step.
el::Simulation block() {
  el::Model model;
  model.body = {{"block", el::make_rectangle(el::even(-0.1, 0.1, 40), el::even(-0.1, 0, 20)), {1e7, 0.3, 0}}};
  const el::Mesh& mesh = model.body[0].mesh;
  const auto bottom = el::nodes_where(mesh, [](const Vec3d& x) { return near(x.y, -0.1); });
  model.fixed = {{0, bottom, 0}, {0, bottom, 1}};
  el::Contact c{.face = el::faces_where(mesh, [](const Vec3d& x) { return near(x.y, 0); }),
                .law = {.c_n = 1e12, .m_n = 2, .c_t = 4e11, .m_t = 2, .epsilon = 1e-3}};
  c.shape = {.kind = el::RigidKind::ball, .point = {0, 0.1, 0}, .radius = 0.1, .displacement = [](double t) {
               return Vec3d{2e-3 * t, -2e-3 * t, 0};
             }};
  model.contact.push_back(c);
  return el::Simulation(std::move(model));
}

}  // namespace

ElasticFigure elastic_newton() {
  el::Simulation s = block();
  const el::MarchReport r = s.statics({.end = 1, .step = 1, .newton = {.max_iterations = 60, .tolerance = 1e-13}});
  need_finished(r, "contact step");
  const std::vector<double>& residual = r.step.back().residual;
  ElasticFigure figure = figure_of("elastic_newton", "iteration,relative_residual\n");
  report::PlotLine l{.label = "relative residual"};
  double order = 0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    figure.csv += line("%zu,%.6e\n", i, residual[i]);
    l.x.push_back(double(i));
    l.y.push_back(std::log10(std::max(residual[i], 1e-18)));
    if (i < 2 || residual[i - 2] > 0.1 || residual[i] < 1e-12) continue;  // far away; round-off
    order = std::max(order, std::log(residual[i] / residual[i - 1]) / std::log(residual[i - 1] / residual[i - 2]));
  }
  figure.check = {
      {"newton_order", "Newton near the solution: order of the last residuals above round-off", 1.8, 3, order},
      {"newton_iterations", "Newton: iterations of the step", 1, 30, double(r.step.back().iterations)},
      {"newton_halved_steps", "Newton: steps that had to be halved", 0, 0, double(r.newton_failures)}};
  figure.plot = plot_of("Newton's method on a contact step with friction", "iteration",
                        "log10 of the relative residual", {l}, false);
  return figure;
}

}  // namespace gonogo::lab
