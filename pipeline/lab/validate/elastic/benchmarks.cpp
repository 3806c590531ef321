// Two published benchmarks.
//   plate   A square plate pressed along a rigid plane, friction 1: parts open, slip and stick. From the French group
//   GRECO;
//           Feijoo, Barbosa & Zouain; figures and 5 % scatter of codes from Code_Aster V6.04.128 (SSNV128).
//   roller  Steel roller on an aluminium block: NAFEMS, Konter, Advanced Finite Element Contact Benchmarks, 2006,
//   no. 1.
//           MARC's figures with friction 0.1 from Code_Aster V6.03.154 (SSNP154).
#include <algorithm>
#include <numbers>

#include "base/line.h"
#include "pipeline/lab/validate/elastic/elastic.h"
#include "pipeline/lab/validate/elastic/parts.h"

namespace gonogo::lab {
namespace {

el::Simulation pressed_plate() {
  constexpr double side = 0.04;
  el::Model model;
  model.body = {{"plate", el::make_rectangle(el::even(0, side, 32), el::even(0, side, 32)), {1.3e11, 0.2, 0}}};
  const el::Mesh& mesh = model.body[0].mesh;
  model.fixed = {{0, el::nodes_where(mesh, [](const Vec3d& x) { return near(x.x, side); }), 0}};
  model.traction = {{0, el::faces_where(mesh, [](const Vec3d& x) { return near(x.y, side); }),
                     [](double t) {
                       return Vec3d{0, -5e7 * t, 0};
                     }},
                    {0, el::faces_where(mesh, [](const Vec3d& x) { return near(x.x, 0); }), [](double t) {
                       return Vec3d{15e7 * t, 0, 0};
                     }}};
  el::Contact contact;
  contact.face = el::faces_where(mesh, [](const Vec3d& x) { return near(x.y, 0); });
  contact.law = el::penalty_law(2e15, 1, 1e-7);
  contact.shape.displacement = [](double) { return Vec3d{0, 1e-9, 0}; };  // touches from the start
  model.contact.push_back(contact);
  return el::Simulation(std::move(model));
}

constexpr double kLoad = 35e3, kRoller = 0.05, kThickness = 1e-3;  // [N], [m], [m]

/// Half of roller and block, cut at x = 0; the roller's lower half. Starts with a small overlap, so that the load is
/// held.
el::Simulation pressed_roller() {
  constexpr double cell = 0.25e-3, wide = 8e-3;
  const double du = cell / (kRoller / std::numbers::sqrt2);
  std::vector<double> up, down;
  for (const double v : el::graded(0, 12 * du, 1, du, 1.4)) up.push_back(v - 1);
  for (const double v : el::graded(0, 12 * cell, 0.2, cell, 1.4)) down.insert(down.begin(), -v);
  const el::Mesh disc =
      el::moved(el::make_quarter_disc(kRoller, el::graded(0, wide / cell * du, 1, du, 1.3), up), [](const Vec3d& x) {
        return x + Vec3d{0, kRoller, 0};
      });
  const el::Mesh block = el::make_rectangle(el::graded(0, wide, 0.1, cell, 1.3), down);
  el::Model model;
  model.body = {{"block", block, {70e9, 0.3, 0}, el::Plane::strain, kThickness},
                {"roller", disc, {210e9, 0.3, 0}, el::Plane::strain, kThickness}};
  const auto middle = [](const Vec3d& x) { return near(x.x, 0); };
  const auto bottom = el::nodes_where(block, [](const Vec3d& x) { return near(x.y, -0.2); });
  model.fixed = {{0, el::nodes_where(block, middle), 0}, {1, el::nodes_where(disc, middle), 0}, {0, bottom, 1}};
  model.traction = {{1, el::faces_where(disc, [](const Vec3d& x) { return near(x.y, kRoller); }), [](double t) {
                       return Vec3d{0, -kLoad / 2 / (kRoller * kThickness) * t, 0};
                     }}};
  const auto low = [](const Vec3d& x) { return x.x < 8e-3 && std::fabs(x.y) < 1e-3; };
  el::Contact contact;
  contact.body = 1;
  contact.face = el::faces_where(disc, low);
  contact.other = 0;
  contact.other_face = el::faces_where(block, low);
  contact.law = el::penalty_law(2e15, 0.1, 1e-7);
  contact.points = 4;
  contact.reach = 1e-3;
  model.contact.push_back(contact);
  el::Simulation s(std::move(model));
  s.set_displacement(1, [](const Vec3d&) { return Vec3d{0, -2e-5, 0}; });
  return s;
}

}  // namespace

ElasticFigure elastic_plate() {
  el::Simulation s = pressed_plate();
  need_finished(s.statics({.end = 1, .step = 0.1}), "plate along a rigid plane");
  struct Published {
    const char* point;
    double x, u;  // [m]
  };
  constexpr Published published[] = {{"A", 0, 2.86e-5},
                                     {"B", 1.25e-3, 2.72e-5},
                                     {"C", 5e-3, 2.28e-5},
                                     {"D", 7.5e-3, 1.98e-5},
                                     {"E", 11.25e-3, 1.5e-5}};
  ElasticFigure figure = figure_of("elastic_plate", "x_m,displacement_m\n");
  report::PlotLine ours{.label = "finite elements"}, theirs{.label = "mean of codes, 5 %", .points = true};
  const el::Mesh& mesh = s.model().body[0].mesh;
  for (const Index n : el::nodes_where(mesh, [](const Vec3d& x) { return near(x.y, 0); })) {
    const double x = mesh.node[std::size_t(n)].x, u = s.displacement(0, n).x;
    figure.csv += line("%.6g,%.6g\n", x, u);
    ours.x.push_back(1e3 * x);
    ours.y.push_back(1e6 * u);
    for (const Published& p : published) {
      if (!near(p.x, x)) continue;
      figure.check.push_back({std::string("plate_") + p.point,
                              std::string("Plate, point ") + p.point + ": displacement over the mean of codes", 0.95,
                              1.05, u / p.u});
      theirs.x.push_back(1e3 * x);
      theirs.y.push_back(0.95e6 * p.u);
      theirs.upper.push_back(1.05e6 * p.u);
    }
  }
  figure.plot = plot_of("Plate pressed along a rigid plane", "x [mm]", "displacement along x [um]", {ours, theirs});
  return figure;
}

ElasticFigure elastic_roller() {
  el::Simulation s = pressed_roller();
  need_finished(s.statics({.end = 1, .step = 0.1}), "roller on a block");
  const double modulus = 1 / ((1 - 0.09) / 70e9 + (1 - 0.09) / 210e9);
  const double a = std::sqrt(4 * kLoad / kThickness * kRoller / (std::numbers::pi * modulus));
  const double p0 = 2 * kLoad / kThickness / (std::numbers::pi * a);
  ElasticFigure figure = figure_of("elastic_roller", "x_m,pressure_pa,hertz_pa\n");
  report::PlotLine ours{.label = "finite elements, friction 0.1", .points = true}, hertz{.label = "Hertz"};
  double highest = 0;
  for (const el::ContactPoint& p : s.contact_points()) {
    const double closed = p.place.x < a ? p0 * std::sqrt(1 - p.place.x * p.place.x / (a * a)) : 0;
    highest = std::max(highest, p.pressure);
    figure.csv += line("%.6g,%.6g,%.6g\n", p.place.x, p.pressure, closed);
    ours.x.push_back(1e3 * p.place.x);
    ours.y.push_back(1e-6 * p.pressure);
    hertz.x.push_back(1e3 * p.place.x);
    hertz.y.push_back(1e-6 * closed);
  }
  const el::Mesh& mesh = s.model().body[0].mesh;
  const Index b = el::nodes_where(mesh, [](const Vec3d& x) { return near(x.x, 0) && near(x.y, 0); })[0];
  figure.check = {
      {"roller_load_ratio", "Roller: contact force over the load", 0.999, 1.001, s.contact_force(0).y / (kLoad / 2)},
      {"roller_pressure_ratio", "Roller: highest pressure over MARC's 3,542.7 MPa", 0.97, 1.03, highest / 3542.7e6},
      {"roller_displacement_ratio", "Roller: displacement below the roller over MARC's -1.3026 mm", 0.97, 1.03,
       s.displacement(0, b).y / -1.3026e-3},
      {"roller_width_ratio", "Roller: half-width over Hertz", 0.97, 1.03, extent(s.contact_points(), 1, touches) / a}};
  figure.plot = plot_of("Steel roller on an aluminium block, 35 kN", "x [mm]", "pressure [MPa]", {hertz, ours});
  return figure;
}

}  // namespace gonogo::lab
