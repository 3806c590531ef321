// A block with friction slides to rest: Coulomb's closed forms are the stop at v_0 / (mu g) after v_0^2 / (2 mu g).
// Regularised friction of a rigid block leaves v = 2 epsilon / (1 + e^2) at that time, which falls in proportion to
// epsilon.
#include <algorithm>

#include "base/line.h"
#include "pipeline/lab/validate/elastic/elastic.h"
#include "pipeline/lab/validate/elastic/parts.h"

namespace gonogo::lab {
namespace {

constexpr double kFriction = 0.3, kGravity = 9.81, kSpeed = 1;  // [-], [m/s^2], [m/s]
constexpr double kStop = kSpeed / (kFriction * kGravity);       // [s]
constexpr double kWay = kSpeed * kSpeed / (2 * kFriction * kGravity);

/// 0.2 m by 0.05 m on a rigid plane, at rest under gravity, then given the speed.
el::Simulation resting_block(double epsilon) {
  el::Model model;
  model.body = {{"block", el::make_rectangle(el::even(0, 0.2, 16), el::even(0, 0.05, 4)), {1e9, 0.3, 2000}}};
  model.gravity = {0, -kGravity, 0};
  el::Contact c;
  c.face = el::faces_where(model.body[0].mesh, [](const Vec3d& x) { return near(x.y, 0); });
  c.law = el::penalty_law(1e8, kFriction, epsilon);
  c.shape.displacement = [](double) { return Vec3d{0, 1e-7, 0}; };  // touches from the start
  model.contact.push_back(c);
  el::Simulation s(std::move(model));
  need_finished(s.statics({.end = 1, .step = 1}), "block at rest");
  s.set_velocity(0, [](const Vec3d&) { return Vec3d{kSpeed, 0, 0}; });
  return s;
}

struct Slide {
  std::vector<double> time, speed, way;  // of the centre of mass
  el::MarchReport report;
  double stop = 0;  // first time when no point slips [s]
  double left = 0;  // speed at the closed-form stop [m/s]
};

Slide slide(double epsilon, double until, double step) {
  el::Simulation s = resting_block(epsilon);
  Slide found;
  const double start = s.state().time;
  double way = 0, last = kSpeed, before = start;
  found.report = s.newmark({.end = start + until,
                            .step = step,
                            .stick_step = step / 32,
                            .newmark = el::hht(-0.1),
                            .watch = [&](const el::Simulation& now) {
                              const double t = now.state().time - start, v = now.mean_velocity(0).x;
                              way += (v + last) / 2 * (now.state().time - before);
                              if (t >= kStop && (found.time.empty() || found.time.back() < kStop)) {
                                const double past = found.time.empty() ? 0 : found.time.back();
                                found.left = last + (v - last) * (kStop - past) / (t - past);
                              }
                              const auto& points = now.contact_points();
                              const bool slips = std::any_of(points.begin(), points.end(),
                                                             [](const auto& p) { return p.touch == el::Touch::slip; });
                              if (!slips && found.stop == 0) found.stop = t;
                              if (slips) found.stop = 0;
                              found.time.push_back(t);
                              found.speed.push_back(v);
                              found.way.push_back(way);
                              last = v;
                              before = now.state().time;
                              return true;
                            }});
  need_finished(found.report, "sliding block");
  return found;
}

}  // namespace

ElasticFigure elastic_block() {
  const Slide s = slide(1e-3, 1.1 * kStop, 2e-3);
  ElasticFigure figure = figure_of("elastic_block", "time_s,speed_m_s,way_m,coulomb_speed_m_s\n");
  report::PlotLine measured{.label = "finite elements", .points = true}, closed{.label = "Coulomb"};
  for (std::size_t i = 0; i < s.time.size(); ++i) {
    const double coulomb = std::max(0.0, kSpeed * (1 - s.time[i] / kStop));
    figure.csv += line("%.6g,%.6g,%.6g,%.6g\n", s.time[i], s.speed[i], s.way[i], coulomb);
    measured.x.push_back(s.time[i]);
    measured.y.push_back(s.speed[i]);
    closed.x.push_back(s.time[i]);
    closed.y.push_back(coulomb);
  }
  figure.check = {{"block_stop_ratio", "Block: time to stick over v / (mu g)", 0.99, 1.01, s.stop / kStop},
                  {"block_way_ratio", "Block: way to rest over v^2 / (2 mu g)", 0.99, 1.01, s.way.back() / kWay},
                  {"block_stick_halvings", "Block: steps shortened where slip turns to stick", 1, 1e4,
                   double(s.report.stick_halvings)}};
  figure.plot = plot_of("A block slides to rest", "time [s]", "speed [m/s]", {closed, measured});
  return figure;
}

ElasticFigure elastic_epsilon() {
  ElasticFigure figure = figure_of("elastic_epsilon", "epsilon_m_s,speed_left_m_s,closed_m_s\n");
  report::PlotLine measured{.label = "finite elements", .points = true}, closed{.label = "rigid block, closed form"};
  std::vector<double> left;
  for (const double epsilon : {0.16, 0.08, 0.04, 0.02}) {
    const double exact = 2 * epsilon / (1 + std::exp(2.0));
    left.push_back(slide(epsilon, 1.02 * kStop, 1e-3).left);
    figure.csv += line("%.6g,%.6g,%.6g\n", epsilon, left.back(), exact);
    measured.x.push_back(std::log10(epsilon));
    measured.y.push_back(std::log10(std::fabs(left.back())));
    closed.x.push_back(std::log10(epsilon));
    closed.y.push_back(std::log10(exact));
  }
  const double order = std::log(left.front() / left.back()) / std::log(8.0);
  figure.check = {{"epsilon_order", "Regularised friction: order of the error in epsilon", 0.95, 3, order},
                  {"epsilon_error", "Regularised friction at the least epsilon: speed left at Coulomb's stop, m/s", 0,
                   0.01, std::fabs(left.back())}};
  figure.plot = plot_of("Regularised friction tends to Coulomb's", "log10 epsilon [m/s]",
                        "log10 of the speed left [m/s]", {closed, measured}, false);
  return figure;
}

}  // namespace gonogo::lab
