// Triangle meshes: what is refused, how they are cut into trees, and how spheres, capsules and planes meet them.
#include <algorithm>
#include <cstring>
#include <functional>
#include <memory>
#include <numeric>
#include <set>

#include "base/files/file.h"
#include "sim/shape/meshes.h"
#include "sim/shape/surface_library.h"
#include "sim/shape/touch/pairs.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

Shape mesh_shape() {
  Shape s;
  s.type = ShapeType::mesh;
  s.surface = 0;
  return s;
}

Shape round(ShapeType type, double radius, double half_length) {
  Shape s;
  s.type = type;
  s.size = {Real(radius), Real(half_length), 0};
  return s;
}

struct Found {
  int feature;
  Touch touch;
};

std::vector<Found> touches(const SurfaceLibrary& library, const Shape& a, const Quat& qa, const Shape& b,
                           const Quat& qb, const Vec3d& d, double envelope) {
  std::vector<Found> found;
  visit_touches(
      ShapePair{.a = a, .b = b, .qa = qa, .qb = qb, .d = d, .envelope = Real(envelope), .surfaces = library.view()},
      [&](int feature, const Touch& t) {
        found.push_back({feature, t});
      });
  return found;
}

SurfaceLibrary library_of(TriangleMesh mesh) {
  check_mesh(mesh);
  SurfaceLibrary library;
  library.add(std::make_shared<const TriangleMesh>(std::move(mesh)));
  return library;
}

double distance_to_segment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const double t = std::clamp(dot(p - a, b - a) / dot(b - a, b - a), 0.0, 1.0);
  return length(p - a - (b - a) * t);
}

/// To the plane where the foot of the perpendicular lies on the inner side of all edges, else to the nearest edge.
double distance_to_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d n = cross(b - a, c - a);
  const bool over =
      dot(cross(n, b - a), p - a) >= 0 && dot(cross(n, c - b), p - b) >= 0 && dot(cross(n, a - c), p - c) >= 0;
  if (over) return std::abs(dot(p - a, n)) / length(n);
  return std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

double distance_to_mesh(const TriangleMesh& mesh, const Vec3d& p) {
  double best = 1e300;
  for (const auto& [a, b, c] : mesh.triangle)
    best = std::min(best, distance_to_triangle(p, static_cast<Vec3d>(mesh.vertex[a]),
                                               static_cast<Vec3d>(mesh.vertex[b]), static_cast<Vec3d>(mesh.vertex[c])));
  return best;
}

/// Winding number by the solid angles of all triangles (van Oosterom & Strackee 1983).
bool is_inside(const TriangleMesh& mesh, const Vec3d& p) {
  double angle = 0;
  for (const auto& t : mesh.triangle) {
    const Vec3d a = static_cast<Vec3d>(mesh.vertex[t[0]]) - p, b = static_cast<Vec3d>(mesh.vertex[t[1]]) - p,
                c = static_cast<Vec3d>(mesh.vertex[t[2]]) - p;
    const double x = length(a), y = length(b), z = length(c);
    angle += 2 * std::atan2(dot(a, cross(b, c)), x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y);
  }
  return std::abs(angle) > 2 * kPi;
}

TriangleMesh lugged_tyre() {
  Shape wheel;
  wheel.type = ShapeType::wheel;
  wheel.size = {0.4f, 0.12f, 0.03f};
  wheel.lug_count = 12;
  wheel.lug_thickness = 0.04f;
  return tyre_mesh(wheel, 6);
}

}  // namespace

TEST_CASE("meshes that are not the boundary of a solid are refused, with the place") {
  const TriangleMesh good = box_mesh({1, 2, 3}, 2);
  CHECK(input_error([&] { check_mesh(good); }).empty());
  const auto refusal = [&](const std::function<void(TriangleMesh&)>& spoil) {
    TriangleMesh m = good;
    spoil(m);
    return input_error([&] { check_mesh(m); });
  };
  CHECK(contains(refusal([](TriangleMesh& m) { m.triangle.clear(); }), "mesh \"box\": it is empty"));
  CHECK(contains(refusal([](TriangleMesh& m) { m.vertex[3].y = INFINITY; }), "vertex 3 is not finite"));
  CHECK(contains(refusal([](TriangleMesh& m) { m.triangle[5][1] = 999; }), "triangle 5 has the vertex 999"));
  CHECK(contains(refusal([](TriangleMesh& m) { m.triangle[5][1] = m.triangle[5][0]; }), "triangle 5 at"));
  CHECK(contains(refusal([](TriangleMesh& m) { m.triangle.pop_back(); }), "belongs to one triangle only"));
  CHECK(contains(refusal([](TriangleMesh& m) { m.triangle.push_back(m.triangle[0]); }), "belongs to 3 triangles"));
  CHECK(contains(refusal([](TriangleMesh& m) { std::swap(m.triangle[0][0], m.triangle[0][1]); }), "run the same way"));
  CHECK(contains(refusal([](TriangleMesh& m) {
                   for (auto& t : m.triangle) std::swap(t[0], t[1]);
                 }),
                 "inside out"));
  TriangleMesh ground = floor_mesh(1, 3);
  CHECK(input_error([&] { check_mesh(ground); }).empty());
  ground.open = false;
  CHECK(contains(input_error([&] { check_mesh(ground); }), "the mesh is not closed"));
}

TEST_CASE("meshes made from numbers are closed solids of the right volume") {
  const auto volume = [](const TriangleMesh& m) {
    check_mesh(m);
    double sum = 0;
    for (const auto& [a, b, c] : m.triangle)
      sum += dot(static_cast<Vec3d>(m.vertex[a]),
                 cross(static_cast<Vec3d>(m.vertex[b]), static_cast<Vec3d>(m.vertex[c]))) /
             6;
    return sum;
  };
  CHECK(volume(box_mesh({0.1f, 0.2f, 0.3f}, 3)) == Approx(0.048).epsilon(1e-6));
  // A regular polygon of n corners holds n / 2 sin(2 pi / n) r^2.
  CHECK(volume(cylinder_mesh(0.5f, 0.2f, 24)) == Approx(12 * std::sin(kPi / 12) * 0.25 * 0.4).epsilon(1e-5));
  // The tyre: sectors of chords between the lugs, and under each lug its box down to the axle's chord triangle.
  const double r = 0.4, half = 0.02, foot = std::asin(half / r), step = (2 * kPi / 12 - 2 * foot) / 6;
  const double face = 12 * (6 * 0.5 * r * r * std::sin(step) + 0.5 * r * r * std::sin(2 * foot) +
                            2 * half * (0.43 - r * std::cos(foot)));
  CHECK(volume(lugged_tyre()) == Approx(face * 0.24).epsilon(1e-5));
  // A ring: the outer prism less the inner one. A step inside of it takes another ring away.
  const double polygon = 12 * std::sin(kPi / 12);
  CHECK(volume(revolved_mesh({{0.3f, -0.1f}, {0.5f, -0.1f}, {0.5f, 0.3f}, {0.3f, 0.3f}}, 24)) ==
        Approx(polygon * (0.25 - 0.09) * 0.4).epsilon(1e-5));
  CHECK(volume(revolved_mesh({{0.3f, 0}, {0.5f, 0}, {0.5f, 0.3f}, {0.4f, 0.3f}, {0.4f, 0.1f}, {0.3f, 0.1f}}, 24)) ==
        Approx(polygon * ((0.25 - 0.16) * 0.3 + (0.16 - 0.09) * 0.1)).epsilon(1e-5));
  CHECK(contains(input_error([] { revolved_mesh({{0, 0}, {1, 0}, {1, 1}}, 24); }), "must keep off its axis"));
  // Clockwise: inside out.
  CHECK(contains(input_error([] {
                   check_mesh(revolved_mesh({{0.3f, 0}, {0.3f, 1}, {0.5f, 1}, {0.5f, 0}}, 24));
                 }),
                 "solid of revolution"));
}

TEST_CASE("the tree of a mesh holds every triangle once, inside the boxes above it") {
  const SurfaceLibrary library = library_of(lugged_tyre());
  const MeshSurface mesh = library.view().mesh_at(0);
  std::vector<int> held(library.triangle.size());
  std::vector<Index> open;  // ends of the nodes around the present one
  for (Index n = 0; n < mesh.range.node_count; ++n) {
    const MeshNode& node = mesh.node[n];
    CHECK(node.skip > n);
    for (Index t = node.first; t < node.first + node.count; ++t) {
      ++held[t];
      for (int k = 0; k < 3; ++k) {
        const Vec3 p = mesh.corner[mesh.vertex(t, k)];
        for (Index above = 0; above <= n; ++above) {
          const MeshNode& a = mesh.node[above];
          if (a.skip <= n) continue;  // not an ancestor
          REQUIRE((p.x >= a.low.x && p.y >= a.low.y && p.z >= a.low.z));
          REQUIRE((p.x <= a.high.x && p.y <= a.high.y && p.z <= a.high.z));
        }
      }
    }
  }
  CHECK(std::all_of(held.begin(), held.end(), [](int n) { return n == 1; }));
}

TEST_CASE("a sphere's least gap to a mesh is its distance from all triangles, negative beyond its centre inside") {
  Draw draw(940);
  for (const TriangleMesh& source : {box_mesh({0.2f, 0.3f, 0.1f}, 3), lugged_tyre()}) {
    const SurfaceLibrary library = library_of(source);
    int outside = 0, inside = 0;
    for (int i = 0; i < 400; ++i) {
      const auto& t = source.triangle[std::size_t(draw.below(int(source.triangle.size())))];
      double u = draw.unit(), v = draw.unit();
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const Vec3d a = static_cast<Vec3d>(source.vertex[t[0]]), b = static_cast<Vec3d>(source.vertex[t[1]]),
                  c = static_cast<Vec3d>(source.vertex[t[2]]);
      const double radius = draw.between(0.01, 0.05);
      const Vec3d p = a + (b - a) * u + (c - a) * v + draw.direction() * (radius * draw.between(0, 1.2));
      const Quat q = draw.orientation();
      const Vec3d away = static_cast<Vec3d>(rotate(q, static_cast<Vec3>(p)));
      const double envelope = 0.002, distance = distance_to_mesh(source, p);
      const bool in = is_inside(source, p);
      const double expected = (in ? -distance : distance) - radius;
      // Deeper inside than its reach a sphere is lost, as documented.
      if (distance < 1e-5 || std::abs(expected - envelope) < 1e-5 || (in && distance > radius)) continue;
      const auto found = touches(library, round(ShapeType::sphere, radius, 0), {}, mesh_shape(), q, away, envelope);
      INFO("case " << i << " distance " << distance << (in ? " inside" : " outside") << " radius " << radius);
      REQUIRE(found.empty() == (expected >= envelope));
      if (found.empty()) continue;
      (in ? inside : outside)++;
      double least = 1e9;
      for (const Found& f : found) {
        least = std::min(least, double(f.touch.gap));
        REQUIRE(length(f.touch.normal) == Approx(1).epsilon(1e-5));
        // Out of the centre along the normal lies the surface.
        const Vec3d foot = p - static_cast<Vec3d>(rotate_back(q, f.touch.normal)) * (f.touch.gap + radius);
        REQUIRE(distance_to_mesh(source, foot) < 1e-5);
        const Vec3d middle =
            static_cast<Vec3d>(f.touch.point) + static_cast<Vec3d>(f.touch.normal) * (radius + f.touch.gap / 2.0);
        REQUIRE(length(middle) < 1e-6);
      }
      REQUIRE(least == Approx(expected).margin(2e-6));
      if (in) REQUIRE(found.size() == 1);
    }
    INFO(outside << " outside, " << inside << " inside");
    CHECK(outside > 150);
    CHECK(inside > 50);
  }
}

TEST_CASE("a sphere on a mesh has as many contacts as the solid has nearest places, however finely it is cut") {
  for (const int cells : {1, 2, 5, 16}) {
    const SurfaceLibrary library = library_of(box_mesh({1, 1, 1}, cells));
    Draw draw(941);
    std::set<int> names;
    for (int i = 0; i < 300; ++i) {
      const Shape ball = round(ShapeType::sphere, 0.1, 0);
      const double x = i < 100 ? (i % 17 - 8) / 8.0 * 0.999 : draw.between(-0.999, 0.999);  // also on edges of cells
      const double y = i < 100 ? (i % 13 - 6) / 6.0 * 0.999 : draw.between(-0.999, 0.999);
      const auto on_face = touches(library, ball, {}, mesh_shape(), {}, {x, y, 1.1 - 1e-4}, 1e-3);
      REQUIRE(on_face.size() >= 1);
      REQUIRE(on_face.size() <= 2);  // two only within rounding of an edge of cells
      for (const Found& f : on_face) {
        CHECK(f.touch.gap == Approx(-1e-4).margin(1e-6));
        CHECK(f.touch.normal.z == Approx(1).margin(1e-5));
      }
      if (on_face.size() == 1) names.insert(on_face[0].feature);
      const auto beside_edge = touches(library, ball, {}, mesh_shape(), {}, {x, 1.06, 1.07}, 1e-3);
      REQUIRE(beside_edge.size() >= 1);
      CHECK(beside_edge[0].touch.gap == Approx(std::hypot(0.06, 0.07) - 0.1).margin(1e-6));
    }
    INFO(cells << " cells: " << names.size() << " names on one face");
    CHECK(std::size_t(std::count_if(names.begin(), names.end(), [](int n) { return n % 8 == 0; })) == 1);
    const auto corner =
        touches(library, round(ShapeType::sphere, 0.1, 0), {}, mesh_shape(), {}, {1.05, 1.05, 1.05}, 1e-3);
    REQUIRE(corner.size() == 1);
    CHECK(corner[0].touch.gap == Approx(0.05 * std::sqrt(3.0) - 0.1).margin(1e-6));
  }
}

TEST_CASE("a capsule lies on a mesh with its ends and on its ridges between them") {
  const SurfaceLibrary library = library_of(box_mesh({1, 1, 1}, 7));
  const Shape capsule = round(ShapeType::capsule, 0.1, 0.4);
  const auto lying = touches(library, capsule, {}, mesh_shape(), {}, {0.21, 0.13, 1.1 - 1e-4}, 1e-3);
  REQUIRE(lying.size() == 2);
  for (const Found& f : lying) {
    CHECK(f.touch.gap == Approx(-1e-4).margin(1e-6));
    CHECK(std::abs(f.touch.point.y) == Approx(0.4).margin(1e-6));
  }
  // Leaning over the edge of the top at 45 degrees: the axis passes the edge at half length.
  const double apart = (0.1 - 1e-4) / std::sqrt(2.0);
  const Quat lean{Real(std::cos(kPi / 8)), Real(-std::sin(kPi / 8)), 0, 0};  // y axis towards -z
  const auto leaning = touches(library, capsule, lean, mesh_shape(), {}, {0.03, 1 + apart, 1 + apart}, 1e-3);
  REQUIRE(leaning.size() == 1);
  CHECK(leaning[0].touch.gap == Approx(-1e-4).margin(2e-6));
  CHECK(leaning[0].touch.normal.y == Approx(std::sqrt(0.5)).margin(1e-4));
  CHECK(length(leaning[0].touch.point) == Approx(0.1).margin(1e-3));
}

TEST_CASE("a mesh on a plane has the gaps of its vertices, each once; the deepest and the outermost of too many") {
  Draw draw(942);
  const TriangleMesh source = lugged_tyre();
  const SurfaceLibrary library = library_of(source);
  Shape plane;
  plane.type = ShapeType::plane;
  int all = 0, chosen = 0;
  for (int i = 0; i < 80; ++i) {
    const Quat q = draw.orientation(), tilt = draw.orientation();
    const Vec3d up = static_cast<Vec3d>(rotate(tilt, {0, 0, 1})), d = up * draw.between(0.1, 0.5);
    std::vector<double> expected;
    for (const Vec3& v : source.vertex) {
      const double gap = dot(d + static_cast<Vec3d>(rotate(q, v)), up);
      if (gap < 0.01) expected.push_back(gap);
    }
    const auto found = touches(library, mesh_shape(), q, plane, tilt, d, 0.01);
    std::set<int> names;
    double sum = 0, least = 1;
    for (const Found& f : found) {
      names.insert(f.feature);
      sum += f.touch.gap;
      least = std::min(least, double(f.touch.gap));
    }
    CHECK(names.size() == found.size());
    if (expected.empty()) {
      CHECK(found.empty());
      continue;
    }
    CHECK(least == Approx(*std::min_element(expected.begin(), expected.end())).margin(1e-6));
    if (expected.size() > std::size_t(kMaxTouches)) {
      ++chosen;
      CHECK((found.size() >= 3 && found.size() <= 9));
      continue;
    }
    ++all;
    REQUIRE(found.size() == expected.size());
    CHECK(sum == Approx(std::accumulate(expected.begin(), expected.end(), 0.0)).margin(1e-4));
  }
  CHECK((all > 10 && chosen > 10));

  const SurfaceLibrary plate = library_of(box_mesh({0.3f, 0.2f, 0.1f}, 12));  // 169 vertices on the plane
  const auto found = touches(plate, mesh_shape(), {}, plane, {}, {0, 0, 0.1}, 0.01);
  int corners = 0;
  for (const Found& f : found)
    corners += std::abs(std::abs(f.touch.point.x) - 0.3) < 1e-6 && std::abs(std::abs(f.touch.point.y) - 0.2) < 1e-6;
  CHECK(found.size() <= 9);
  CHECK(corners == 4);
}

TEST_CASE("meshes come back from STL and OBJ files, and bad files are refused with the line") {
  const TemporaryFolder folder;
  const TriangleMesh tyre = lugged_tyre();
  const auto same = [&](const TriangleMesh& m) {
    REQUIRE(m.triangle.size() == tyre.triangle.size());
    CHECK(m.vertex.size() == tyre.vertex.size());
    for (std::size_t t = 0; t < m.triangle.size(); ++t)
      for (int k = 0; k < 3; ++k)
        REQUIRE(length(m.vertex[m.triangle[t][k]] - tyre.vertex[tyre.triangle[t][k]]) < 1e-7f);
  };
  write_stl(folder / "tyre.stl", tyre);
  same(read_mesh(folder / "tyre.stl"));

  std::string text = "solid tyre in mm\n", obj = "# tyre\no tyre\n";
  char line[160];
  for (const auto& t : tyre.triangle) {
    text += "  facet normal 0 0 0\n    outer loop\n";
    for (const Index v : t) {
      const Vec3 p = tyre.vertex[v];
      std::snprintf(line, sizeof line, "      vertex %.9g %.9g %.9g\n", 1e3 * p.x, 1e3 * p.y, 1e3 * p.z);
      text += line;
    }
    text += "    endloop\n  endfacet\n";
  }
  write_file_atomically(folder / "tyre_text.stl", text + "endsolid tyre\n");
  same(read_mesh(folder / "tyre_text.stl", 1e-3));
  for (const Vec3& p : tyre.vertex) {
    std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", p.x, p.y, p.z);
    obj += line;
  }
  obj += "vn 0 0 1\n";
  for (const auto& [a, b, c] : tyre.triangle) {
    std::snprintf(line, sizeof line, "f %d//1 %d//1 %d//1\n", a + 1, b + 1, c + 1);
    obj += line;
  }
  write_file_atomically(folder / "tyre.OBJ", obj);
  same(read_mesh(folder / "tyre.OBJ"));
  write_file_atomically(folder / "cube.obj",
                        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 4 3 2 1\nf 5 6 7 8\n"
                        "f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf -8 -4 -1 -5\n");
  CHECK(read_mesh(folder / "cube.obj").triangle.size() == 12);

  const auto refusal = [&](const char* name, const std::string& content) {
    write_file_atomically(folder / name, content);
    return input_error([&] { read_mesh(folder / name); });
  };
  CHECK(contains(refusal("a.stl", "hello"), "it is no STL file"));
  CHECK(contains(refusal("a.stl", "solid a\n facet normal 0 0 x\n"), "a.stl, line 2: expected a number, found \"x\""));
  CHECK(contains(refusal("a.stl", text), "expected \"facet\" or \"endsolid\", found \"\""));  // cut off
  CHECK(contains(refusal("a.obj", "v 1 2 3\nv 1 2\nf 1 2 3\n"), "a.obj, line 3"));
  CHECK(contains(refusal("a.obj", "v 1 2 3\nv 1 2 4\nf 1 2 3\n"), "line 3: a face has the corner \"3\""));
  CHECK(contains(refusal("a.obj", "v 1 2 3\n"), "it is empty"));
  CHECK(contains(refusal("a.ply", "ply"), "must end in .stl or .obj"));
  std::string open_stl = read_file(folder / "tyre.stl");
  const auto fewer = std::uint32_t(tyre.triangle.size() - 1);
  open_stl.resize(84 + 50 * fewer);
  std::memcpy(open_stl.data() + 80, &fewer, sizeof fewer);
  CHECK(contains(refusal("b.stl", open_stl), "the mesh is not closed"));
}
