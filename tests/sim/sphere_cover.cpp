// Solids made of spheres, and their mass properties.
#include "sim/shape/sphere_cover.h"
#include "sim/scene/scene.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "sim/shape/meshes.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/message.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

/// How deep a point lies in a box about the origin; below zero outside, by the distance.
double depth_in_box(const Vec3d& p, const Vec3d& half) {
  const Vec3d q{std::abs(p.x) - half.x, std::abs(p.y) - half.y, std::abs(p.z) - half.z};
  const Vec3d out{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)};
  return -(length(out) + std::min(0.0, std::max({q.x, q.y, q.z})));
}

/// Share of a box that lies in some sphere, by drawn points.
double drawn_share(const SphereCover& cover, const Vec3d& half) {
  Draw draw(831);
  int held = 0;
  const int points = 20'000;
  for (int k = 0; k < points; ++k) {
    const Vec3d p = draw.in_box(-half, half);
    held += std::any_of(cover.sphere.begin(), cover.sphere.end(),
                        [&](const CoverSphere& s) { return length(p - s.centre) < s.radius; });
  }
  return double(held) / points;
}

/// A ring of 48 chords.
TriangleMesh ring() { return revolved_mesh({{0.3f, -0.1f}, {0.5f, -0.1f}, {0.5f, 0.1f}, {0.3f, 0.1f}}, 48); }

}  // namespace

TEST_CASE("depth inside of a mesh is that of its box, within and without") {
  Draw draw(832);
  const Vec3d half{0.1, 0.2, 0.3};
  const TriangleMesh mesh = box_mesh({0.1f, 0.2f, 0.3f}, 3);
  for (int k = 0; k < 500; ++k) {
    const Vec3d p = draw.in_box({-0.3, -0.4, -0.5}, {0.3, 0.4, 0.5});
    CHECK(depth_inside(mesh, p) == Approx(depth_in_box(p, half)).margin(1e-7));
  }
}

TEST_CASE("spheres of a box stay inside, hold what they say and hold more the more there are") {
  const Vec3d half{0.1, 0.2, 0.4};
  const TriangleMesh mesh = box_mesh({0.1f, 0.2f, 0.4f}, 1);
  double before = 0;
  for (const int count : {1, 4, 8, 40}) {
    const SphereCover cover = cover_by_spheres(mesh, {.count = count});
    REQUIRE(cover.sphere.size() == std::size_t(count));
    for (const CoverSphere& s : cover.sphere) CHECK(s.radius <= depth_in_box(s.centre, half) + 1e-6);
    CHECK(cover.volume_share == Approx(drawn_share(cover, half)).margin(0.02));
    CHECK(cover.volume_share > before);
    before = cover.volume_share;
  }
  // Eight spheres of 0.1 m side by side hold pi / 6; larger counts fill the gaps.
  CHECK(cover_by_spheres(mesh, {.count = 8}).volume_share > 0.45);
  CHECK(before > 0.75);
}

TEST_CASE("a cover stops at the share asked for; spheres that may stick out hold more") {
  const TriangleMesh mesh = box_mesh({0.1f, 0.1f, 0.1f}, 1);
  const SphereCover half = cover_by_spheres(mesh, {.count = 200, .share = 0.7});
  CHECK(half.volume_share == Approx(0.7).margin(0.06));
  CHECK(half.sphere.size() < 60);
  const SphereCover inside = cover_by_spheres(mesh, {.count = 8});
  const SphereCover out = cover_by_spheres(mesh, {.count = 8, .protrusion = 0.02});
  CHECK(out.volume_share > inside.volume_share + 0.05);
  for (const CoverSphere& s : out.sphere) CHECK(s.radius <= depth_in_box(s.centre, {0.1, 0.1, 0.1}) + 0.02 + 1e-6);
}

TEST_CASE("no sphere of a ring fills its hole") {
  const SphereCover cover = cover_by_spheres(ring(), {.count = 30});
  for (const CoverSphere& s : cover.sphere) {
    const double from_axis = std::hypot(s.centre.x, s.centre.y);
    CHECK(from_axis - s.radius > 0.3 * std::cos(kPi / 48) - 1e-6);
    CHECK(from_axis + s.radius < 0.5 + 1e-6);
  }
  CHECK(cover.volume_share > 0.6);
}

TEST_CASE("mass properties of meshes are those of their solids, wherever the axes are") {
  TriangleMesh box = box_mesh({0.1f, 0.2f, 0.3f}, 2);
  for (Vec3& v : box.vertex) v += Vec3{1, -2, 0.5f};
  const SolidMoments m = moments_of(box);
  CHECK(m.volume == Approx(0.048).epsilon(1e-5));
  CHECK(length(m.centre - Vec3d{1, -2, 0.5}) < 1e-6);
  CHECK(m.inertia[0][0] == Approx(0.048 / 3 * (0.04 + 0.09)).epsilon(1e-4));
  CHECK(m.inertia[1][1] == Approx(0.048 / 3 * (0.01 + 0.09)).epsilon(1e-4));
  CHECK(m.inertia[2][2] == Approx(0.048 / 3 * (0.01 + 0.04)).epsilon(1e-4));
  CHECK(std::abs(m.inertia[0][1]) + std::abs(m.inertia[1][2]) + std::abs(m.inertia[2][0]) < 1e-7);
  // A ring of n chords is that of two discs whose mean square radius is r^2 (2 + cos(2 pi / n)) / 3.
  const SolidMoments r = moments_of(ring());
  const double polygon = 24 * std::sin(2 * kPi / 48), round = (2 + std::cos(2 * kPi / 48)) / 3;
  CHECK(r.inertia[2][2] == Approx(polygon * 0.2 * round * (std::pow(0.5, 4) - std::pow(0.3, 4)) / 2).epsilon(1e-4));
}

TEST_CASE("a compound has the mass and inertia of its mesh about its centre, and its spheres where the mesh is") {
  TriangleMesh mesh = box_mesh({0.1f, 0.2f, 0.3f}, 1);
  const Quat lean = normalised(Quat{0.8f, 0.3f, -0.2f, 0.4f});
  for (Vec3& v : mesh.vertex) v = rotate(lean, v) + Vec3{0.5f, 0, 0};
  const SphereCover cover = cover_by_spheres(mesh, {.count = 12});
  SceneWorld w = open_world({});
  const BodyState at{{1, 2, 3}, about_x(0.7), {}, {}};
  const BodyIndex b = add_compound(w, at, mesh, cover, 1000, 0);
  CHECK(1 / w.mass[b].inverse_mass.x == Approx(48).epsilon(1e-5));
  const Vec3& i = w.mass[b].inverse_inertia_B;  // ascending inertia: about the long axis first
  CHECK(1 / i.x == Approx(16 * (0.01 + 0.04)).epsilon(1e-4));
  CHECK(1 / i.y == Approx(16 * (0.01 + 0.09)).epsilon(1e-4));
  CHECK(1 / i.z == Approx(16 * (0.04 + 0.09)).epsilon(1e-4));
  // The body's x axis is the mesh's long one, up to its sign.
  const Vec3 long_axis = rotate(at.orientation, rotate(lean, {0, 0, 1}));
  CHECK(std::abs(dot(rotate(w.body[b].orientation, {1, 0, 0}), long_axis)) == Approx(1).epsilon(1e-5));
  CHECK(w.shape.size() == 12);
  for (std::size_t k = 0; k < 12; ++k) {
    const Vec3d expected =
        at.position + static_cast<Vec3d>(rotate(at.orientation, static_cast<Vec3>(cover.sphere[k].centre)));
    const Vec3d centre = w.body[b].position + static_cast<Vec3d>(rotate(w.body[b].orientation, w.shape[k].offset_B));
    CHECK(length(centre - expected) < 1e-5);
  }
}

TEST_CASE("a box of spheres falls flat onto a plane and rests on its lowest spheres") {
  const TriangleMesh mesh = box_mesh({0.2f, 0.2f, 0.1f}, 1);
  const SphereCover cover = cover_by_spheres(mesh, {.count = 25});
  double lowest = 0;
  for (const CoverSphere& s : cover.sphere) lowest = std::min(lowest, s.centre.z - s.radius);
  SceneWorld w = open_world({Real(0.5), 0, 0});
  add_plane(w);
  const BodyIndex b = add_compound(w, {{0, 0, 0.15}, about_x(0.1), {}, {}}, mesh, cover, 1000, 0);
  const auto simulation = simulate(sim::Backend::cpu, w, settings_with(50));
  advance_for(*simulation, 1.5);
  const BodyState end = simulation->body(0, b);
  CHECK(end.position.z == Approx(-lowest).margin(2e-3));
  CHECK(length(end.velocity) < 1e-3f);
  CHECK(simulation->contact_force(0, b).z == Approx(kGravity * 32).epsilon(1e-3));
}

TEST_CASE("solids that cannot be made of spheres are refused") {
  CHECK(contains(input_error([] { cover_by_spheres(floor_mesh(1, 2), {}); }), "only solids can be made of spheres"));
  const auto said = [](const CoverSettings& s) {
    return input_error([&] { cover_by_spheres(box_mesh({1, 1, 1}, 1), s); });
  };
  CHECK(contains(said({.count = 0}), "at least one sphere"));
  CHECK(contains(said({.share = 0}), "above 0 and at most 1"));
  CHECK(contains(said({.cells = 1}), "2 to 200"));
  CHECK(contains(said({.protrusion = -1}), "at least 0"));
}
