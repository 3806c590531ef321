// Hertz contact: a rigid sphere on an elastic half-space. Johnson, Contact Mechanics, 1985, section 3.4 and eq. (4.22)
// to (4.24):
//   a = (3 F R / (4 E*))^(1/3),  approach = a^2 / R,  p_0 = 3 F / (2 pi a^2),  p = p_0 sqrt(1 - r^2 / a^2)
#include <algorithm>
#include <numbers>

#include "base/line.h"
#include "pipeline/lab/validate/elastic/elastic.h"
#include "pipeline/lab/validate/elastic/parts.h"

namespace gonogo::lab {
namespace {

constexpr double kYoung = 1e9, kPoisson = 0.3, kRadius = 1, kContact = 0.05;  // [Pa], [-], [m], [m] about a
constexpr double kApproach = kContact * kContact / kRadius;
constexpr double kModulus = kYoung / (1 - kPoisson * kPoisson);
constexpr double kStiffness = 5e3 * kYoung;  // of the contact [Pa/m]: penetrates by 0.3 % of the approach

/// Half-space below y = 0 under the ball, half-width and depth `far` times the contact's radius.
el::Simulation pressed(el::Body body, const char* what) {
  const bool solid = el::dimension_of(body.mesh.kind) == 3;
  const el::Box box = el::box_of(body.mesh);
  el::Model model;
  const auto fix = [&](int component, const el::At& at) {
    model.fixed.push_back({0, el::nodes_where(body.mesh, at), component});
  };
  fix(0, [](const Vec3d& x) { return near(x.x, 0); });
  fix(1, [&](const Vec3d& x) { return near(x.y, box.low.y); });
  if (solid) fix(2, [](const Vec3d& x) { return near(x.z, 0); });
  el::Contact c{
      .face = el::faces_where(
          body.mesh, [](const Vec3d& x) { return near(x.y, 0) && x.x < 1.4 * kContact && x.z < 1.4 * kContact; }),
      .law = {.c_n = kStiffness},
      .points = solid ? 2 : 4};
  c.shape = {.kind = el::RigidKind::ball, .point = {0, kRadius, 0}, .radius = kRadius, .displacement = [](double t) {
               return Vec3d{0, -kApproach * t, 0};
             }};
  model.contact.push_back(c);
  model.body = {std::move(body)};
  el::Simulation s(std::move(model));
  need_finished(s.statics({.end = 1, .step = 1}), what);
  return s;
}

/// Force of the whole sphere, by its approach.
double force_in_space() {
  const auto places = el::graded(0, 1.2 * kContact, 60 * kContact, kContact / 5, 1.7);
  std::vector<double> down;
  for (const double x : el::graded(0, kContact / 2, 60 * kContact, kContact / 5, 1.7)) down.insert(down.begin(), -x);
  const el::Simulation s =
      pressed({"block", el::make_box(places, down, places), {kYoung, kPoisson, 0}}, "3-D Hertz contact");
  return 4 * std::fabs(s.contact_force(0).y);  // a quarter is modelled
}

}  // namespace

ElasticFigure elastic_hertz() {
  std::vector<double> down;
  for (const double x : el::graded(0, kContact, 200 * kContact, kContact / 20, 1.4)) down.insert(down.begin(), -x);
  const el::Mesh mesh = el::make_rectangle(el::graded(0, 1.5 * kContact, 200 * kContact, kContact / 40, 1.4), down);
  const el::Simulation s =
      pressed({"half-space", mesh, {kYoung, kPoisson, 0}, el::Plane::axisymmetric}, "Hertz contact");
  const double force = std::fabs(s.contact_force(0).y);
  const double a = std::cbrt(3 * force * kRadius / (4 * kModulus)), p0 = 3 * force / (2 * std::numbers::pi * a * a);
  report::PlotLine measured{.label = "finite elements", .points = true}, closed{.label = "Hertz"};
  ElasticFigure figure = figure_of("elastic_hertz", "r_m,pressure_pa,hertz_pa\n");
  double highest = 0;
  for (const el::ContactPoint& p : s.contact_points()) {
    const double r = p.place.x, hertz = r < a ? p0 * std::sqrt(1 - r * r / (a * a)) : 0;
    highest = std::max(highest, p.pressure);
    figure.csv += line("%.6g,%.6g,%.6g\n", r, p.pressure, hertz);
    measured.x.push_back(r / a);
    measured.y.push_back(p.pressure / p0);
    closed.x.push_back(r / a);
    closed.y.push_back(hertz / p0);
  }
  const double in_space = force_in_space(),
               by_approach = 4.0 / 3 * kModulus * std::sqrt(kRadius) * std::pow(kApproach, 1.5);
  figure.check = {
      {"hertz_pressure_ratio", "Hertz contact: highest pressure over closed form", 0.98, 1.02, highest / p0},
      {"hertz_radius_ratio", "Hertz contact: radius over closed form", 0.98, 1.02,
       extent(s.contact_points(), 1, touches) / a},
      {"hertz_approach_ratio", "Hertz contact: approach over closed form", 0.98, 1.02, kApproach / (a * a / kRadius)},
      {"hertz_force_ratio_h8", "Hertz contact, coarse 3-D hexahedra: force over closed form", 0.94, 1.06,
       in_space / by_approach}};
  figure.plot = plot_of("Rigid sphere on an elastic half-space", "r / a", "p / p0", {closed, measured});
  return figure;
}

}  // namespace gonogo::lab
