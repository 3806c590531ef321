#include "sim/elastic/mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/error.h"
#include "base/format.h"

namespace gonogo::sim::elastic {
namespace {

using Corners = std::vector<int>;

/// Faces of an element by its corners, normals outward.
const std::vector<Corners>& face_corners(ElementKind kind) {
  static const std::array<std::vector<Corners>, 4> of_kind{
      {{{0, 1}, {1, 2}, {2, 0}},
       {{0, 1}, {1, 2}, {2, 3}, {3, 0}},
       {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}},
       {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}}};
  return of_kind[std::size_t(kind)];
}

std::array<Index, 4> key_of(const Face& f) {
  std::array<Index, 4> key = f.node;
  std::sort(key.begin(), key.end());
  return key;
}

Vec3d centre_of(const Mesh& mesh, const Face& f) {
  Vec3d sum;
  for (int k = 0; k < f.count; ++k) sum += mesh.node[std::size_t(f.node[k])];
  return sum * (1.0 / f.count);
}

std::string place(const std::string& name, std::size_t e) { return name + ": element " + std::to_string(e); }

void check_corners(const Mesh& mesh, const std::string& name, std::vector<bool>& used) {
  const int corners = corner_count(mesh.kind);
  for (std::size_t e = 0; e < mesh.element.size(); ++e)
    for (int k = 0; k < corners; ++k) {
      const Index n = mesh.element[e][std::size_t(k)];
      if (n < 0 || std::size_t(n) >= mesh.node.size())
        throw InputError(place(name, e) + " has corner " + std::to_string(n) + "; nodes are 0 to " +
                         std::to_string(mesh.node.size() - 1));
      for (int j = 0; j < k; ++j)
        if (mesh.element[e][std::size_t(j)] == n)
          throw InputError(place(name, e) + " has node " + std::to_string(n) + " twice; an element needs " +
                           std::to_string(corners) + " different corners");
      used[std::size_t(n)] = true;
    }
}

double size_of(const Mesh& mesh, std::size_t e) {
  double size = 0;
  for (int k = 1; k < corner_count(mesh.kind); ++k)
    size = std::max(size, length(mesh.node[std::size_t(mesh.element[e][std::size_t(k)])] -
                                 mesh.node[std::size_t(mesh.element[e][0])]));
  return size;
}

void check_volumes(const Mesh& mesh, const std::string& name) {
  for (std::size_t e = 0; e < mesh.element.size(); ++e) {
    const double least = 1e-12 * std::pow(size_of(mesh, e), dimension_of(mesh.kind));
    for (const QuadraturePoint& q : quadrature_of(mesh.kind)) {
      const double d = gradient_of(mesh, e, shape_values(mesh.kind, q.at)).determinant;
      if (d > least) continue;
      throw InputError(place(name, e) + (d < -least ? " is inverted" : " is degenerate") +
                       line(": the determinant of its Jacobian is %.3g, allowed is above %.3g; ", d, least) +
                       "order its corners counter-clockwise or as VTK does, and mesh again where it is flat");
    }
  }
}

}  // namespace

int dimension_of(ElementKind kind) { return kind == ElementKind::t3 || kind == ElementKind::q4 ? 2 : 3; }

int corner_count(ElementKind kind) { return kind == ElementKind::t3 ? 3 : kind == ElementKind::h8 ? 8 : 4; }

std::string name_of(ElementKind kind) {
  static const char* const names[] = {"t3", "q4", "t4", "h8"};
  return names[std::size_t(kind)];
}

std::vector<Face> boundary_faces(const Mesh& mesh) {
  std::vector<Face> all;
  for (std::size_t e = 0; e < mesh.element.size(); ++e)
    for (const Corners& corners : face_corners(mesh.kind)) {
      Face f;
      f.element = Index(e);
      for (const int c : corners) f.node[std::size_t(f.count++)] = mesh.element[e][std::size_t(c)];
      all.push_back(f);
    }
  std::map<std::array<Index, 4>, int> times;
  for (const Face& f : all) ++times[key_of(f)];
  std::vector<Face> once;
  for (const Face& f : all)
    if (times[key_of(f)] == 1) once.push_back(f);
  return once;
}

std::vector<Face> faces_where(const Mesh& mesh, const At& at) {
  std::vector<Face> found;
  for (const Face& f : boundary_faces(mesh))
    if (at(centre_of(mesh, f))) found.push_back(f);
  if (found.empty()) throw InputError("no face of the mesh's boundary is at the place asked for; check the condition");
  return found;
}

std::vector<Index> nodes_where(const Mesh& mesh, const At& at) {
  std::vector<Index> found;
  for (std::size_t i = 0; i < mesh.node.size(); ++i)
    if (at(mesh.node[i])) found.push_back(Index(i));
  if (found.empty()) throw InputError("no node of the mesh is at the place asked for; check the condition");
  return found;
}

std::vector<Index> nodes_of(const std::vector<Face>& faces) {
  std::vector<Index> nodes;
  for (const Face& f : faces) nodes.insert(nodes.end(), f.node.begin(), f.node.begin() + f.count);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

Box box_of(const Mesh& mesh) {
  Box box{mesh.node.at(0), mesh.node.at(0)};
  for (const Vec3d& x : mesh.node) {
    box.low = {std::min(box.low.x, x.x), std::min(box.low.y, x.y), std::min(box.low.z, x.z)};
    box.high = {std::max(box.high.x, x.x), std::max(box.high.y, x.y), std::max(box.high.z, x.z)};
  }
  return box;
}

void check_mesh(const Mesh& mesh, const std::string& name) {
  if (mesh.element.empty() || mesh.node.empty())
    throw InputError(name + ": the mesh has no element; give at least one");
  std::vector<bool> used(mesh.node.size(), false);
  check_corners(mesh, name, used);
  const auto lone = std::find(used.begin(), used.end(), false);
  if (lone != used.end())
    throw InputError(name + ": node " + std::to_string(lone - used.begin()) +
                     " belongs to no element and could move freely; remove it");
  check_volumes(mesh, name);
}

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

namespace {

constexpr double kGauss2 = 0.57735026918962576;  // 1/sqrt(3)

ShapeValues simplex(int dimension, const std::array<double, 3>& at) {
  ShapeValues s;
  s.n[0] = 1;
  for (int d = 0; d < dimension; ++d) {
    s.n[0] -= at[std::size_t(d)];
    s.n[std::size_t(d) + 1] = at[std::size_t(d)];
    s.slope[0][std::size_t(d)] = -1;
    s.slope[std::size_t(d) + 1][std::size_t(d)] = 1;
  }
  return s;
}

/// Products of (1 + sign x) / 2 along each direction.
ShapeValues cube(int dimension, const std::array<double, 3>& at) {
  static constexpr double sign[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                                        {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
  ShapeValues s;
  for (std::size_t k = 0; k < (dimension == 2 ? 4u : 8u); ++k) {
    double factor[3] = {1, 1, 1};
    for (int d = 0; d < dimension; ++d) factor[d] = (1 + sign[k][d] * at[std::size_t(d)]) / 2;
    s.n[k] = factor[0] * factor[1] * factor[2];
    for (int d = 0; d < dimension; ++d)
      s.slope[k][std::size_t(d)] = sign[k][d] / 2 * factor[(d + 1) % 3] * factor[(d + 2) % 3];
  }
  return s;
}

std::vector<QuadraturePoint> cube_points(int dimension) {
  std::vector<QuadraturePoint> points;
  for (int k = 0; k < (dimension == 2 ? 4 : 8); ++k) {
    QuadraturePoint q;
    q.weight = 1;
    for (int d = 0; d < dimension; ++d) q.at[std::size_t(d)] = (k >> d & 1) ? kGauss2 : -kGauss2;
    points.push_back(q);
  }
  return points;
}

/// Degree 2: points on the lines from the centre to the corners; Hughes, tables 3.I.1 and 3.I.2.
std::vector<QuadraturePoint> simplex_points(int dimension) {
  const double far = dimension == 2 ? 2.0 / 3 : 0.5854101966249685,
               near = dimension == 2 ? 1.0 / 6 : 0.1381966011250105;
  std::vector<QuadraturePoint> points;
  for (int k = 0; k <= dimension; ++k) {
    QuadraturePoint q;
    q.weight = dimension == 2 ? 1.0 / 6 : 1.0 / 24;
    for (int d = 0; d < dimension; ++d) q.at[std::size_t(d)] = d + 1 == k ? far : near;
    points.push_back(q);
  }
  return points;
}

struct LinePoint {
  double at, weight;
};

/// Gauss-Legendre on [-1, 1], weights adding up to 2.
std::vector<LinePoint> gauss(int points) {
  switch (points) {
    case 1:
      return {{0, 2}};
    case 2:
      return {{-kGauss2, 1}, {kGauss2, 1}};
    case 3:
      return {{-0.774596669241483377, 5.0 / 9}, {0, 8.0 / 9}, {0.774596669241483377, 5.0 / 9}};
    case 4:
      return {{-0.861136311594052575, 0.347854845137453857},
              {-0.339981043584856265, 0.652145154862546143},
              {0.339981043584856265, 0.652145154862546143},
              {0.861136311594052575, 0.347854845137453857}};
    default:
      return {{-0.906179845938663993, 0.236926885056189088},
              {-0.538469310105683091, 0.478628670499366468},
              {0, 128.0 / 225},
              {0.538469310105683091, 0.478628670499366468},
              {0.906179845938663993, 0.236926885056189088}};
  }
}

/// On the unit triangle, weights adding up to 1/2: degree 1, 2, or 4 (Dunavant 1985).
std::vector<QuadraturePoint> triangle_points(int points) {
  if (points == 1) return {{{1.0 / 3, 1.0 / 3, 0}, 0.5}};
  if (points <= 3) return simplex_points(2);
  std::vector<QuadraturePoint> six;
  const double a[2] = {0.445948490915965, 0.091576213509771}, w[2] = {0.223381589678011 / 2, 0.109951743655322 / 2};
  for (int k = 0; k < 2; ++k) {
    six.push_back({{a[k], a[k], 0}, w[k]});
    six.push_back({{1 - 2 * a[k], a[k], 0}, w[k]});
    six.push_back({{a[k], 1 - 2 * a[k], 0}, w[k]});
  }
  return six;
}

}  // namespace

ShapeValues shape_values(ElementKind kind, const std::array<double, 3>& at) {
  const bool is_simplex = kind == ElementKind::t3 || kind == ElementKind::t4;
  return is_simplex ? simplex(dimension_of(kind), at) : cube(dimension_of(kind), at);
}

const std::vector<QuadraturePoint>& quadrature_of(ElementKind kind) {
  static const std::vector<QuadraturePoint> t3 = simplex_points(2), q4 = cube_points(2), t4 = simplex_points(3),
                                            h8 = cube_points(3);
  return kind == ElementKind::t3 ? t3 : kind == ElementKind::q4 ? q4 : kind == ElementKind::t4 ? t4 : h8;
}

FacePoint face_values(int corners, double xi, double eta) {
  FacePoint p;
  if (corners == 2) {  // xi in [0, 1] from the first corner to the second
    p.n = {1 - xi, xi, 0, 0};
    p.slope[0][0] = -1;
    p.slope[1][0] = 1;
    return p;
  }
  const ShapeValues s = shape_values(corners == 3 ? ElementKind::t3 : ElementKind::q4, {xi, eta, 0});
  for (std::size_t k = 0; k < std::size_t(corners); ++k) {
    p.n[k] = s.n[k];
    p.slope[k] = {s.slope[k][0], s.slope[k][1]};
  }
  return p;
}

std::vector<FacePoint> face_quadrature(int corners, int points) {
  std::vector<FacePoint> all;
  const auto add = [&](double xi, double eta, double weight) {
    all.push_back(face_values(corners, xi, eta));
    all.back().weight = weight;
  };
  if (corners == 3) {
    for (const QuadraturePoint& q : triangle_points(points)) add(q.at[0], q.at[1], q.weight);
    return all;
  }
  for (const LinePoint& a : gauss(points)) {
    if (corners == 2) add((1 + a.at) / 2, 0, a.weight / 2);
    if (corners == 4)
      for (const LinePoint& b : gauss(points)) add(a.at, b.at, a.weight * b.weight);
  }
  return all;
}

double face_measure(int corners, const FacePoint& p, const std::array<Vec3d, 4>& x) {
  Vec3d along, across;
  for (std::size_t k = 0; k < std::size_t(corners); ++k) {
    along += x[k] * p.slope[k][0];
    across += x[k] * p.slope[k][1];
  }
  return corners == 2 ? length(along) : length(cross(along, across));
}

Gradient gradient_of(const Mesh& mesh, std::size_t element, const ShapeValues& s) {
  const int corners = corner_count(mesh.kind);
  Vec3d j[3];  // rows: derivative of the place by each local coordinate
  for (int k = 0; k < corners; ++k)
    for (int d = 0; d < 3; ++d)
      j[d] += mesh.node[std::size_t(mesh.element[element][std::size_t(k)])] * s.slope[std::size_t(k)][std::size_t(d)];
  if (dimension_of(mesh.kind) == 2) j[2] = {0, 0, 1};
  Gradient g;
  g.determinant = dot(j[0], cross(j[1], j[2]));
  const Vec3d inverse[3] = {cross(j[1], j[2]), cross(j[2], j[0]), cross(j[0], j[1])};  // columns, times the determinant
  for (int k = 0; k < corners; ++k) {
    Vec3d& slope = g.slope[std::size_t(k)];
    for (int d = 0; d < 3; ++d) slope += inverse[d] * (s.slope[std::size_t(k)][std::size_t(d)] / g.determinant);
  }
  return g;
}

}  // namespace gonogo::sim::elastic
