// Patch test: displacements that are linear in space, given on the boundary of a distorted mesh, must come out exactly
// inside (Irons 1966; Hughes, The Finite Element Method, section 4.6).
#include <algorithm>

#include "base/line.h"
#include "pipeline/lab/validate/elastic/elastic.h"
#include "pipeline/lab/validate/elastic/parts.h"

namespace gonogo::lab {
namespace {

struct Patch {
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
double error_of(const Patch& patch) {
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

ElasticFigure elastic_patch() {
  const std::vector<Patch> patches{{"t3", el::ElementKind::t3},
                                   {"q4", el::ElementKind::q4},
                                   {"t3_plane_stress", el::ElementKind::t3, el::Plane::stress},
                                   {"q4_plane_stress", el::ElementKind::q4, el::Plane::stress},
                                   {"q4_axisymmetric", el::ElementKind::q4, el::Plane::axisymmetric},
                                   {"t4", el::ElementKind::t4},
                                   {"h8", el::ElementKind::h8}};
  ElasticFigure figure = figure_of("elastic_patch", "element,relative_error\n");
  report::PlotLine line_of{.label = "error", .points = true};
  for (const Patch& p : patches) {
    const double error = error_of(p);
    figure.csv += p.name + line(",%.3e\n", error);
    figure.check.push_back({"patch_error_" + p.name, "Patch test, " + p.name + ": relative error", 0, 1e-12, error});
    line_of.x.push_back(double(line_of.x.size()));
    line_of.y.push_back(std::log10(std::max(error, 1e-18)));
  }
  figure.plot = plot_of("Patch test", "element: t3, q4, plane stress t3, q4, axisymmetric q4, t4, h8",
                        "log10 of the relative error", {line_of});
  return figure;
}

}  // namespace gonogo::lab
