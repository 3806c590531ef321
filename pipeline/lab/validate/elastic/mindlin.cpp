// Cattaneo-Mindlin: two equal cylinders pressed together, then sheared by Q < mu P. The middle sticks, the edges slip:
//   c = a sqrt(1 - Q / (mu P)),  q = mu p_0 (sqrt(1 - x^2/a^2) - c/a sqrt(1 - x^2/c^2))
// Cattaneo 1938, Mindlin 1949; Johnson, Contact Mechanics, eq. (7.25) to (7.28). Equal materials, so that pressure
// moves no point of one surface over the other.
#include <algorithm>
#include <numbers>

#include "base/line.h"
#include "pipeline/lab/validate/elastic/elastic.h"
#include "pipeline/lab/validate/elastic/parts.h"

namespace gonogo::lab {
namespace {

constexpr double kYoung = 1e9, kPoisson = 0.3, kFriction = 0.3;  // [Pa], [-], [-]
constexpr double kRadius = 1, kContact = 0.05;                   // of the pair [m]; about the half-width [m]
constexpr double kFar = 30 * kContact;
constexpr double kPress = 3.2e-3, kShear = 8e-4;  // displacements of the far sides [m], by trial, for c / a about 0.6

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
  fix(1, kFar, 0, [](double t) { return t < 1 ? 0 : kShear * (t - 1); });
  fix(1, kFar, 1, [](double t) { return -kPress * std::min(t, 1.0); });
  const auto surface = [&](int body) {
    return el::faces_where(model.body[std::size_t(body)].mesh,
                           [](const Vec3d& x) { return std::fabs(x.x) < 1.25 * kContact && std::fabs(x.y) < 3e-3; });
  };
  el::Contact contact;
  contact.body = 1;
  contact.face = surface(1);
  contact.other = 0;
  contact.other_face = surface(0);
  contact.law = el::penalty_law(5e3 * kYoung, kFriction, 2e-6);
  contact.points = 4;
  model.contact.push_back(contact);
  return model;
}

}  // namespace

ElasticFigure elastic_mindlin() {
  el::Simulation s(two_cylinders());
  need_finished(s.statics({.end = 2, .step = 0.25}), "Cattaneo-Mindlin contact");
  const Vec3d force = s.contact_force(0);
  const auto& points = s.contact_points();
  const auto sticks = [](const el::ContactPoint& p) { return p.touch == el::Touch::stick; };
  const double a = (extent(points, 1, touches) + extent(points, -1, touches)) / 2;
  const double c = (extent(points, 1, sticks) + extent(points, -1, sticks)) / 2;
  const double load = force.y, pull = std::fabs(force.x), share = pull / (kFriction * load);
  const double modulus = kYoung / (2 * (1 - kPoisson * kPoisson));
  const double hertz_a = std::sqrt(4 * load * kRadius / (std::numbers::pi * modulus));
  const double closed_c = hertz_a * std::sqrt(1 - share), p0 = 2 * load / (std::numbers::pi * hertz_a);
  report::PlotLine measured{.label = "finite elements", .points = true}, closed{.label = "Cattaneo-Mindlin"};
  ElasticFigure figure = figure_of("elastic_mindlin", "x_m,pressure_pa,shear_pa,closed_shear_pa\n");
  const auto bell = [](double x, double w) { return std::fabs(x) < w ? std::sqrt(1 - x * x / (w * w)) : 0; };
  for (const el::ContactPoint& p : points) {
    const double x = p.place.x;
    const double q = kFriction * p0 * (bell(x, hertz_a) - closed_c / hertz_a * bell(x, closed_c));
    figure.csv += line("%.6g,%.6g,%.6g,%.6g\n", x, p.pressure, std::fabs(p.shear.x), q);
    measured.x.push_back(x / hertz_a);
    measured.y.push_back(std::fabs(p.shear.x) / (kFriction * p0));
    closed.x.push_back(x / hertz_a);
    closed.y.push_back(q / (kFriction * p0));
  }
  figure.check = {
      {"mindlin_load_share", "Cattaneo-Mindlin: tangential load over mu P", 0.3, 0.9, share},
      {"mindlin_stick_ratio", "Cattaneo-Mindlin: stick half-width over closed form", 0.97, 1.03, c / closed_c},
      {"mindlin_contact_ratio", "Cattaneo-Mindlin: contact half-width over Hertz", 0.98, 1.02, a / hertz_a}};
  figure.plot = plot_of("Two equal cylinders, sheared", "x / a", "q / (mu p0)", {closed, measured});
  return figure;
}

}  // namespace gonogo::lab
