// Elastic bodies at rest: patch test, Newton's residuals, two published benchmarks.
//
// Patch test: displacements that are linear in space, given on the boundary of a distorted mesh, must come out exactly
// inside (Irons 1966; Hughes, The Finite Element Method, section 4.6).

#include <algorithm>
#include <numbers>

#include "base/format.h"
#include "pipeline/lab/validate/elastic/elastic.h"
#include "pipeline/lab/validate/elastic/parts.h"

namespace gonogo::lab {
namespace {

struct PatchMesh {
  std::string name;
  el::ElementKind kind;
  el::Plane plane = el::Plane::strain;
};

constexpr int kCells = 4;

/// Inner nodes move by up to a fifth of a cell, always the same way.
el::Mesh distorted(el::ElementKind kind) {
  const std::vector<double> p = el::even(0, 1, kCells);
  el::Mesh mesh = el::dimension_of(kind) == 2 ? el::make_rectangle(p, p, kind) : el::make_box(p, p, p, kind);
  const bool solid = el::dimension_of(kind) == 3;
  int n = 0;
  for (Vec3d& x : mesh.node) {
    const auto inner = [](double c) { return c > 1e-9 && c < 1 - 1e-9; };
    const auto shift = [&] { return 0.2 / kCells * std::sin(12.9898 * ++n); };
    if (!inner(x.x) || !inner(x.y) || (solid && !inner(x.z))) continue;
    x += Vec3d{shift(), shift(), solid ? shift() : 0};
  }
  return mesh;
}

Vec3d linear(const Vec3d& x, bool axisymmetric, bool solid) {
  if (axisymmetric) return Vec3d{2e-3 * x.x, -1e-3 * x.y + 4e-4, 0};
  return {1e-3 * x.x + 2e-3 * x.y - 5e-4 * x.z, -3e-4 * x.x + 8e-4 * x.y + 7e-4 * x.z,
          solid ? 6e-4 * x.x - 2e-4 * x.y + 9e-4 * x.z : 0};
}

/// Largest error of a displacement, over the largest displacement.
double error_of(const PatchMesh& patch) {
  const bool axisymmetric = patch.plane == el::Plane::axisymmetric, solid = el::dimension_of(patch.kind) == 3;
  el::Model model{.body = {{"patch", distorted(patch.kind), {2e11, 0.3, 0}, patch.plane}}};
  const el::Mesh& mesh = model.body[0].mesh;
  for (const Index n : el::nodes_of(el::boundary_faces(mesh)))
    for (int c = 0; c < el::dimension_of(patch.kind); ++c) {
      const Vec3d u = linear(mesh.node[std::size_t(n)], axisymmetric, solid);
      const double value = c == 0 ? u.x : c == 1 ? u.y : u.z;
      model.fixed.push_back({0, {n}, c, [value](double t) { return value * t; }});
    }
  el::Simulation s(model);
  need_finished(s.statics({.end = 1, .step = 1, .newton = {.tolerance = 1e-14}}), "patch " + patch.name);
  double error = 0, largest = 0;
  for (std::size_t n = 0; n < mesh.node.size(); ++n) {
    const Vec3d u = linear(s.model().body[0].mesh.node[n], axisymmetric, solid);
    error = std::max(error, length(s.displacement(0, Index(n)) - u));
    largest = std::max(largest, length(u));
  }
  return error / largest;
}

}  // namespace

CheckFigure elastic_patch() {
  const std::vector<PatchMesh> patches{{"t3", el::ElementKind::t3},
                                       {"q4", el::ElementKind::q4},
                                       {"t3_plane_stress", el::ElementKind::t3, el::Plane::stress},
                                       {"q4_plane_stress", el::ElementKind::q4, el::Plane::stress},
                                       {"q4_axisymmetric", el::ElementKind::q4, el::Plane::axisymmetric},
                                       {"t4", el::ElementKind::t4},
                                       {"h8", el::ElementKind::h8}};
  CheckFigure figure = figure_of("elastic_patch", "element,relative_error\n");
  report::PlotLine line_of{.label = "error", .points = true};
  for (const PatchMesh& p : patches) {
    const double error = error_of(p);
    figure.csv += p.name + line(",%.3e\n", error);
    figure.check.push_back({"patch_error_" + p.name, "Patch test, " + p.name + ": relative error", 0, 1e-12, error});
    line_of.add(double(line_of.x.size()), std::log10(std::max(error, 1e-18)));
  }
  figure.plot = plot_of("Patch test", "element: t3, q4, plane stress t3, q4, axisymmetric q4, t4, h8",
                        "log10 of the relative error", {line_of});
  return figure;
}

// Newton's residuals of one contact step, with friction and a power law: near the solution each is below a constant
// times the square of the one before.

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

CheckFigure elastic_newton() {
  el::Simulation s = block();
  const el::MarchReport r = s.statics({.end = 1, .step = 1, .newton = {.max_iterations = 60, .tolerance = 1e-13}});
  need_finished(r, "contact step");
  const std::vector<double>& residual = r.step.back().residual;
  CheckFigure figure = figure_of("elastic_newton", "iteration,relative_residual\n");
  report::PlotLine l{.label = "relative residual"};
  double order = 0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    figure.csv += line("%zu,%.6e\n", i, residual[i]);
    l.add(double(i), std::log10(std::max(residual[i], 1e-18)));
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

// Two published benchmarks.
//   plate   A square plate pressed along a rigid plane, friction 1: parts open, slip and stick. From the French group
//   GRECO;
//           Feijoo, Barbosa & Zouain; figures and 5 % scatter of codes from Code_Aster V6.04.128 (SSNV128).
//   roller  Steel roller on an aluminium block: NAFEMS, Konter, Advanced Finite Element Contact Benchmarks, 2006,
//   no. 1.
//           MARC's figures with friction 0.1 from Code_Aster V6.03.154 (SSNP154).

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

constexpr double kRollerLoad = 35e3, kRoller = 0.05, kThickness = 1e-3;  // [N], [m], [m]

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
                       return Vec3d{0, -kRollerLoad / 2 / (kRoller * kThickness) * t, 0};
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

CheckFigure elastic_plate() {
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
  CheckFigure figure = figure_of("elastic_plate", "x_m,displacement_m\n");
  report::PlotLine ours{.label = "finite elements"}, theirs{.label = "mean of codes, 5 %", .points = true};
  const el::Mesh& mesh = s.model().body[0].mesh;
  for (const Index n : el::nodes_where(mesh, [](const Vec3d& x) { return near(x.y, 0); })) {
    const double x = mesh.node[std::size_t(n)].x, u = s.displacement(0, n).x;
    figure.csv += line("%.6g,%.6g\n", x, u);
    ours.add(1e3 * x, 1e6 * u);
    for (const Published& p : published) {
      if (!near(p.x, x)) continue;
      figure.check.push_back({std::string("plate_") + p.point,
                              std::string("Plate, point ") + p.point + ": displacement over the mean of codes", 0.95,
                              1.05, u / p.u});
      theirs.add(1e3 * x, 0.95e6 * p.u);
      theirs.upper.push_back(1.05e6 * p.u);
    }
  }
  figure.plot = plot_of("Plate pressed along a rigid plane", "x [mm]", "displacement along x [um]", {ours, theirs});
  return figure;
}

CheckFigure elastic_roller() {
  el::Simulation s = pressed_roller();
  need_finished(s.statics({.end = 1, .step = 0.1}), "roller on a block");
  const double modulus = 1 / ((1 - 0.09) / 70e9 + (1 - 0.09) / 210e9);
  const double a = std::sqrt(4 * kRollerLoad / kThickness * kRoller / (std::numbers::pi * modulus));
  const double p0 = 2 * kRollerLoad / kThickness / (std::numbers::pi * a);
  CheckFigure figure = figure_of("elastic_roller", "x_m,pressure_pa,hertz_pa\n");
  report::PlotLine ours{.label = "finite elements, friction 0.1", .points = true}, hertz{.label = "Hertz"};
  double highest = 0;
  for (const el::ContactPoint& p : s.contact_points()) {
    const double closed = p.place.x < a ? p0 * std::sqrt(1 - p.place.x * p.place.x / (a * a)) : 0;
    highest = std::max(highest, p.pressure);
    figure.csv += line("%.6g,%.6g,%.6g\n", p.place.x, p.pressure, closed);
    ours.add(1e3 * p.place.x, 1e-6 * p.pressure);
    hertz.add(1e3 * p.place.x, 1e-6 * closed);
  }
  const el::Mesh& mesh = s.model().body[0].mesh;
  const Index b = el::nodes_where(mesh, [](const Vec3d& x) { return near(x.x, 0) && near(x.y, 0); })[0];
  figure.check = {
      {"roller_load_ratio", "Roller: contact force over the load", 0.999, 1.001,
       s.contact_force(0).y / (kRollerLoad / 2)},
      {"roller_pressure_ratio", "Roller: highest pressure over MARC's 3,542.7 MPa", 0.97, 1.03, highest / 3542.7e6},
      {"roller_displacement_ratio", "Roller: displacement below the roller over MARC's -1.3026 mm", 0.97, 1.03,
       s.displacement(0, b).y / -1.3026e-3},
      {"roller_width_ratio", "Roller: half-width over Hertz", 0.97, 1.03, extent(s.contact_points(), 1, touches) / a}};
  figure.plot = plot_of("Steel roller on an aluminium block, 35 kN", "x [mm]", "pressure [MPa]", {hertz, ours});
  return figure;
}

}  // namespace gonogo::lab
