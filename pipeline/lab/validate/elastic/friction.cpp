// Elastic bodies pressed and sheared, against closed forms.
//
// Hertz contact: a rigid sphere on an elastic half-space. Johnson, Contact Mechanics, 1985, section 3.4 and eq. (4.22)
// to (4.24):
//   a = (3 F R / (4 E*))^(1/3),  approach = a^2 / R,  p_0 = 3 F / (2 pi a^2),  p = p_0 sqrt(1 - r^2 / a^2)
#include <algorithm>
#include <numbers>

#include "base/format.h"
#include "pipeline/lab/validate/elastic/elastic.h"
#include "pipeline/lab/validate/elastic/parts.h"

namespace gonogo::lab {
namespace {

constexpr double kYoung = 1e9, kPoisson = 0.3;  // [Pa], [-]
constexpr double kRadius = 1, kContact = 0.05;  // of the sphere or of the pair of cylinders [m]; about a [m]
constexpr double kMu = 0.3;                     // friction where there is any
constexpr double kApproach = kContact * kContact / kRadius;
constexpr double kModulus = kYoung / (1 - kPoisson * kPoisson);
constexpr double kPenalty = 5e3 * kYoung;  // of the contact [Pa/m]: penetrates by 0.3 % of the approach

/// Half-space below y = 0 under the ball, half-width and depth `far` times the contact's radius.
el::Simulation pressed_half_space(el::Body body, const char* what) {
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
      .law = {.c_n = kPenalty},
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
      pressed_half_space({"block", el::make_box(places, down, places), {kYoung, kPoisson, 0}}, "3-D Hertz contact");
  return 4 * std::fabs(s.contact_force(0).y);  // a quarter is modelled
}

}  // namespace

CheckFigure elastic_hertz() {
  std::vector<double> down;
  for (const double x : el::graded(0, kContact, 200 * kContact, kContact / 20, 1.4)) down.insert(down.begin(), -x);
  const el::Mesh mesh = el::make_rectangle(el::graded(0, 1.5 * kContact, 200 * kContact, kContact / 40, 1.4), down);
  const el::Simulation s =
      pressed_half_space({"half-space", mesh, {kYoung, kPoisson, 0}, el::Plane::axisymmetric}, "Hertz contact");
  const double force = std::fabs(s.contact_force(0).y);
  const double a = std::cbrt(3 * force * kRadius / (4 * kModulus)), p0 = 3 * force / (2 * std::numbers::pi * a * a);
  report::PlotLine measured{.label = "finite elements", .points = true}, closed{.label = "Hertz"};
  CheckFigure figure = figure_of("elastic_hertz", "r_m,pressure_pa,hertz_pa\n");
  double highest = 0;
  for (const el::ContactPoint& p : s.contact_points()) {
    const double r = p.place.x, hertz = r < a ? p0 * std::sqrt(1 - r * r / (a * a)) : 0;
    highest = std::max(highest, p.pressure);
    figure.csv += line("%.6g,%.6g,%.6g\n", r, p.pressure, hertz);
    measured.add(r / a, p.pressure / p0);
    closed.add(r / a, hertz / p0);
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

// Cattaneo-Mindlin: two equal cylinders pressed together, then sheared by Q < mu P. The middle sticks, the edges slip:
//   c = a sqrt(1 - Q / (mu P)),  q = mu p_0 (sqrt(1 - x^2/a^2) - c/a sqrt(1 - x^2/c^2))
// Cattaneo 1938, Mindlin 1949; Johnson, Contact Mechanics, eq. (7.25) to (7.28). Equal materials, so that pressure
// moves no point of one surface over the other.

namespace {

constexpr double kFar = 30 * kContact;
constexpr double kPressed = 3.2e-3,
                 kSheared = 8e-4;  // displacements of the far sides [m], by trial, for c / a about 0.6

/// Flat below y = 0, or the same mirrored upwards with a round underside.
el::Mesh half(bool upper) {
  const auto x = el::mirrored(el::graded(0, 1.25 * kContact, kFar, kContact / 40, 1.4));
  const auto depth = el::graded(0, kContact / 2, kFar, kContact / 40, 1.4);
  std::vector<double> y = depth;
  if (!upper) {
    y.clear();
    for (const double d : depth) y.insert(y.begin(), -d);
  }
  return el::moved(el::make_rectangle(x, y), [upper](const Vec3d& p) {
    const double w = std::min(std::fabs(p.x), 3 * kContact);
    return upper ? Vec3d{p.x, p.y + w * w / (2 * kRadius) * (1 - p.y / kFar), 0} : p;
  });
}

el::Model two_cylinders() {
  el::Model model;
  model.body = {{"lower", half(false), {kYoung, kPoisson, 0}}, {"upper", half(true), {kYoung, kPoisson, 0}}};
  const auto fix = [&](int body, double y, int component, const el::OverTime& u) {
    model.fixed.push_back(
        {body, el::nodes_where(model.body[std::size_t(body)].mesh, [y](const Vec3d& x) { return near(x.y, y); }),
         component, u});
  };
  fix(0, -kFar, 0, [](double) { return 0.0; });
  fix(0, -kFar, 1, [](double) { return 0.0; });
  fix(1, kFar, 0, [](double t) { return t < 1 ? 0 : kSheared * (t - 1); });
  fix(1, kFar, 1, [](double t) { return -kPressed * std::min(t, 1.0); });
  const auto surface = [&](int body) {
    return el::faces_where(model.body[std::size_t(body)].mesh,
                           [](const Vec3d& x) { return std::fabs(x.x) < 1.25 * kContact && std::fabs(x.y) < 3e-3; });
  };
  el::Contact contact;
  contact.body = 1;
  contact.face = surface(1);
  contact.other = 0;
  contact.other_face = surface(0);
  contact.law = el::penalty_law(5e3 * kYoung, kMu, 2e-6);
  contact.points = 4;
  model.contact.push_back(contact);
  return model;
}

}  // namespace

CheckFigure elastic_mindlin() {
  el::Simulation s(two_cylinders());
  need_finished(s.statics({.end = 2, .step = 0.25}), "Cattaneo-Mindlin contact");
  const Vec3d force = s.contact_force(0);
  const auto& points = s.contact_points();
  const auto sticks = [](const el::ContactPoint& p) { return p.touch == el::Touch::stick; };
  const double a = (extent(points, 1, touches) + extent(points, -1, touches)) / 2;
  const double c = (extent(points, 1, sticks) + extent(points, -1, sticks)) / 2;
  const double load = force.y, pull = std::fabs(force.x), share = pull / (kMu * load);
  const double modulus = kYoung / (2 * (1 - kPoisson * kPoisson));
  const double hertz_a = std::sqrt(4 * load * kRadius / (std::numbers::pi * modulus));
  const double closed_c = hertz_a * std::sqrt(1 - share), p0 = 2 * load / (std::numbers::pi * hertz_a);
  report::PlotLine measured{.label = "finite elements", .points = true}, closed{.label = "Cattaneo-Mindlin"};
  CheckFigure figure = figure_of("elastic_mindlin", "x_m,pressure_pa,shear_pa,closed_shear_pa\n");
  const auto bell = [](double x, double w) { return std::fabs(x) < w ? std::sqrt(1 - x * x / (w * w)) : 0; };
  for (const el::ContactPoint& p : points) {
    const double x = p.place.x;
    const double q = kMu * p0 * (bell(x, hertz_a) - closed_c / hertz_a * bell(x, closed_c));
    figure.csv += line("%.6g,%.6g,%.6g,%.6g\n", x, p.pressure, std::fabs(p.shear.x), q);
    measured.add(x / hertz_a, std::fabs(p.shear.x) / (kMu * p0));
    closed.add(x / hertz_a, q / (kMu * p0));
  }
  figure.check = {
      {"mindlin_load_share", "Cattaneo-Mindlin: tangential load over mu P", 0.3, 0.9, share},
      {"mindlin_stick_ratio", "Cattaneo-Mindlin: stick half-width over closed form", 0.97, 1.03, c / closed_c},
      {"mindlin_contact_ratio", "Cattaneo-Mindlin: contact half-width over Hertz", 0.98, 1.02, a / hertz_a}};
  figure.plot = plot_of("Two equal cylinders, sheared", "x / a", "q / (mu p0)", {closed, measured});
  return figure;
}

// A block with friction slides to rest: Coulomb's closed forms are the stop at v_0 / (mu g) after v_0^2 / (2 mu g).
// Regularised friction of a rigid block leaves v = 2 epsilon / (1 + e^2) at that time, which falls in proportion to
// epsilon.

namespace {

constexpr double kGravity = 9.81, kSpeed = 1;        // [m/s^2], [m/s]
constexpr double kStop = kSpeed / (kMu * kGravity);  // [s]
constexpr double kWay = kSpeed * kSpeed / (2 * kMu * kGravity);

/// 0.2 m by 0.05 m on a rigid plane, at rest under gravity, then given the speed.
el::Simulation resting_block(double epsilon) {
  el::Model model{.body = {{"block", el::make_rectangle(el::even(0, 0.2, 16), el::even(0, 0.05, 4)), {1e9, 0.3, 2000}}},
                  .gravity = {0, -kGravity, 0}};
  el::Contact c;
  c.face = el::faces_where(model.body[0].mesh, [](const Vec3d& x) { return near(x.y, 0); });
  c.law = el::penalty_law(1e8, kMu, epsilon);
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

CheckFigure elastic_block() {
  const Slide s = slide(1e-3, 1.1 * kStop, 2e-3);
  CheckFigure figure = figure_of("elastic_block", "time_s,speed_m_s,way_m,coulomb_speed_m_s\n");
  report::PlotLine measured{.label = "finite elements", .points = true}, closed{.label = "Coulomb"};
  for (std::size_t i = 0; i < s.time.size(); ++i) {
    const double coulomb = std::max(0.0, kSpeed * (1 - s.time[i] / kStop));
    figure.csv += line("%.6g,%.6g,%.6g,%.6g\n", s.time[i], s.speed[i], s.way[i], coulomb);
    measured.add(s.time[i], s.speed[i]);
    closed.add(s.time[i], coulomb);
  }
  figure.check = {{"block_stop_ratio", "Block: time to stick over v / (mu g)", 0.99, 1.01, s.stop / kStop},
                  {"block_way_ratio", "Block: way to rest over v^2 / (2 mu g)", 0.99, 1.01, s.way.back() / kWay},
                  {"block_stick_halvings", "Block: steps shortened where slip turns to stick", 1, 1e4,
                   double(s.report.stick_halvings)}};
  figure.plot = plot_of("A block slides to rest", "time [s]", "speed [m/s]", {closed, measured});
  return figure;
}

CheckFigure elastic_epsilon() {
  CheckFigure figure = figure_of("elastic_epsilon", "epsilon_m_s,speed_left_m_s,closed_m_s\n");
  report::PlotLine measured{.label = "finite elements", .points = true}, closed{.label = "rigid block, closed form"};
  std::vector<double> left;
  for (const double epsilon : {0.16, 0.08, 0.04, 0.02}) {
    const double exact = 2 * epsilon / (1 + std::exp(2.0));
    left.push_back(slide(epsilon, 1.02 * kStop, 1e-3).left);
    figure.csv += line("%.6g,%.6g,%.6g\n", epsilon, left.back(), exact);
    measured.add(std::log10(epsilon), std::log10(std::fabs(left.back())));
    closed.add(std::log10(epsilon), std::log10(exact));
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
