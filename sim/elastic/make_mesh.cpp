#include "sim/elastic/make_mesh.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/line.h"

namespace gonogo::sim::elastic {
namespace {

void check_places(const std::vector<double>& p, const char* what) {
  if (p.size() < 2) throw InputError(std::string(what) + ": needs at least 2 places");
  for (std::size_t i = 1; i < p.size(); ++i)
    if (!(p[i] > p[i - 1]))
      throw InputError(std::string(what) + line(": place %zu is %g after %g; places must grow", i, p[i], p[i - 1]));
}

void check_kind(ElementKind kind, int dimension) {
  if (dimension_of(kind) != dimension)
    throw InputError("elements " + name_of(kind) + " do not fill a " + std::to_string(dimension) + "-D mesh; use " +
                     (dimension == 2 ? "t3 or q4" : "t4 or h8"));
}

}  // namespace

std::vector<double> even(double from, double to, int count) {
  if (!(from < to) || count < 1)
    throw InputError(
        line("even places from %g to %g in %d steps: needs from < to and at least 1 step", from, to, count));
  std::vector<double> p;
  for (int i = 0; i <= count; ++i) p.push_back(from + (to - from) * i / count);
  return p;
}

std::vector<double> graded(double from, double fine_until, double to, double first, double ratio) {
  if (!(from < fine_until && fine_until < to && first > 0 && ratio > 1 && ratio <= 3))
    throw InputError(line("graded places %g, %g, %g, step %g, ratio %g: needs from < fine_until < to, step above 0, ",
                          from, fine_until, to, first, ratio) +
                     "ratio above 1 and at most 3");
  std::vector<double> p = even(from, fine_until, std::max(1, int(std::lround((fine_until - from) / first))));
  double step = p[1] - p[0];
  while (p.back() + 1.5 * (step *= ratio) < to) p.push_back(p.back() + step);
  p.push_back(to);
  return p;
}

std::vector<double> mirrored(const std::vector<double>& places) {
  std::vector<double> p;
  for (auto it = places.rbegin(); it != places.rend(); ++it) p.push_back(-*it);
  for (const double x : places)
    if (x > p.back()) p.push_back(x);
  return p;
}

Mesh make_rectangle(const std::vector<double>& x, const std::vector<double>& y, ElementKind kind) {
  check_places(x, "x of a rectangle");
  check_places(y, "y of a rectangle");
  check_kind(kind, 2);
  Mesh mesh;
  mesh.kind = kind;
  for (const double b : y)
    for (const double a : x) mesh.node.push_back({a, b, 0});
  const Index row = Index(x.size());
  for (Index j = 0; j + 1 < Index(y.size()); ++j)
    for (Index i = 0; i + 1 < row; ++i) {
      const Index a = j * row + i, b = a + 1, c = b + row, d = a + row;
      if (kind == ElementKind::q4) {
        mesh.element.push_back({a, b, c, d});
      } else if ((i + j) % 2 == 0) {
        mesh.element.push_back({a, b, c});
        mesh.element.push_back({a, c, d});
      } else {
        mesh.element.push_back({a, b, d});
        mesh.element.push_back({b, c, d});
      }
    }
  return mesh;
}

Mesh make_box(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& z,
              ElementKind kind) {
  check_places(x, "x of a box");
  check_places(y, "y of a box");
  check_places(z, "z of a box");
  check_kind(kind, 3);
  Mesh mesh;
  mesh.kind = kind;
  for (const double c : z)
    for (const double b : y)
      for (const double a : x) mesh.node.push_back({a, b, c});
  // Six tetrahedra about the diagonal from corner 0 to corner 6.
  static constexpr int kuhn[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6},
                                     {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
  const Index row = Index(x.size()), plane = row * Index(y.size());
  for (Index k = 0; k + 1 < Index(z.size()); ++k)
    for (Index j = 0; j + 1 < Index(y.size()); ++j)
      for (Index i = 0; i + 1 < row; ++i) {
        const Index a = k * plane + j * row + i;
        const std::array<Index, 8> h{a,         a + 1,         a + 1 + row,         a + row,
                                     a + plane, a + 1 + plane, a + 1 + row + plane, a + row + plane};
        if (kind == ElementKind::h8)
          mesh.element.push_back(h);
        else
          for (const auto& t : kuhn) mesh.element.push_back({h[t[0]], h[t[1]], h[t[2]], h[t[3]]});
      }
  return mesh;
}

Mesh make_ring_sector(const std::vector<double>& radius, const std::vector<double>& angle, ElementKind kind) {
  if (radius.empty() || !(radius[0] > 0)) throw InputError("radii of a ring: the first must be above 0 m");
  return moved(make_rectangle(radius, angle, kind), [](const Vec3d& p) {
    return Vec3d{p.x * std::cos(p.y), p.x * std::sin(p.y), 0};
  });
}

Mesh make_cylinder_sector(const std::vector<double>& radius, const std::vector<double>& angle,
                          const std::vector<double>& z, ElementKind kind) {
  if (radius.empty() || !(radius[0] > 0)) throw InputError("radii of a cylinder: the first must be above 0 m");
  return moved(make_box(radius, angle, z, kind), [](const Vec3d& p) {
    return Vec3d{p.x * std::cos(p.y), p.x * std::sin(p.y), p.z};
  });
}

Mesh make_quarter_disc(double radius, const std::vector<double>& across, const std::vector<double>& up) {
  if (!(radius > 0)) throw InputError(line("radius of a disc is %g m; it must be above 0", radius));
  if (across.empty() || up.empty() || across.front() != 0 || across.back() != 1 || up.front() != -1 || up.back() != 0)
    throw InputError("quarter disc: places across must run from 0 to 1 and up from -1 to 0");
  return moved(make_rectangle(across, up), [radius](const Vec3d& p) {
    return Vec3d{radius * p.x * std::sqrt(1 - p.y * p.y / 2), radius * p.y * std::sqrt(1 - p.x * p.x / 2), 0};
  });
}

Mesh moved(Mesh mesh, const std::function<Vec3d(const Vec3d&)>& to) {
  for (Vec3d& x : mesh.node) x = to(x);
  return mesh;
}

}  // namespace gonogo::sim::elastic
