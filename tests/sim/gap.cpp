#include "sim/shape/touch/gap.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "base/units.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"

using namespace gonogo;
using namespace gonogo::sim;
using gonogo::test::Draw;

namespace {

/// Piece of a surface over the unit square.
using Patch = std::function<Vec3d(double u, double v)>;

/// Smallest distance from `p` to a patch: a grid of samples, then finer grids around the best one.
double distance_to(const Patch& patch, const Vec3d& p) {
  double u = 0.5, v = 0.5, half = 0.5, best = 1e300;
  for (int level = 0; level < 14; ++level) {
    const int cells = level == 0 ? 40 : 8;
    double best_u = u, best_v = v;
    for (int i = 0; i <= cells; ++i)
      for (int k = 0; k <= cells; ++k) {
        const double at_u = std::clamp(u + half * (2.0 * i / cells - 1), 0.0, 1.0);
        const double at_v = std::clamp(v + half * (2.0 * k / cells - 1), 0.0, 1.0);
        const double d = length(p - patch(at_u, at_v));
        if (d < best) {
          best = d;
          best_u = at_u;
          best_v = at_v;
        }
      }
    u = best_u;
    v = best_v;
    half *= level == 0 ? 0.05 : 0.3;
  }
  return best;
}

double distance_to(const std::vector<Patch>& surface, const Vec3d& p) {
  double best = 1e300;
  for (const Patch& patch : surface) best = std::min(best, distance_to(patch, p));
  return best;
}

std::vector<Patch> box_surface(const Vec3d& half) {
  std::vector<Patch> faces;
  for (const double s : {-1.0, 1.0}) {
    faces.push_back([=](double u, double v) { return Vec3d{s * half.x, (2 * u - 1) * half.y, (2 * v - 1) * half.z}; });
    faces.push_back([=](double u, double v) { return Vec3d{(2 * u - 1) * half.x, s * half.y, (2 * v - 1) * half.z}; });
    faces.push_back([=](double u, double v) { return Vec3d{(2 * u - 1) * half.x, (2 * v - 1) * half.y, s * half.z}; });
  }
  return faces;
}

bool in_box(const Vec3d& p, const Vec3d& half) {
  return std::abs(p.x) < half.x && std::abs(p.y) < half.y && std::abs(p.z) < half.z;
}

/// Axle y; the seam of the unrolled side lies opposite to `p`, so that the search does not meet it.
std::vector<Patch> cylinder_surface(double radius, double half_width, const Vec3d& p) {
  const double towards = std::atan2(p.z, p.x);
  std::vector<Patch> patches;
  patches.push_back([=](double u, double v) {
    const double angle = towards + 2 * kPi * (u - 0.5);
    return Vec3d{radius * std::cos(angle), (2 * v - 1) * half_width, radius * std::sin(angle)};
  });
  for (const double s : {-1.0, 1.0})
    patches.push_back([=](double u, double v) {
      const double angle = towards + 2 * kPi * (u - 0.5);
      return Vec3d{v * radius * std::cos(angle), s * half_width, v * radius * std::sin(angle)};
    });
  return patches;
}

/// The frame of lug `k`, written anew: where its box sits.
Vec3d to_lug(const Vec3d& p, const Shape& wheel, int k) {
  const double angle = 2 * kPi * k / wheel.lug_count;
  return {std::cos(angle) * p.x + std::sin(angle) * p.z - wheel.size.x, p.y,
          -std::sin(angle) * p.x + std::cos(angle) * p.z};
}
Vec3d half_of_lug(const Shape& wheel) { return {wheel.size.z, wheel.size.y, 0.5 * wheel.lug_thickness}; }

/// Gap against sampled surface points; the normal leads from the nearest surface point to the sphere's centre.
void check_gap(const Gap& g, double radius, const Vec3d& p, const std::vector<Patch>& surface, bool inside) {
  const double distance = distance_to(surface, p);
  const double expected = (inside ? -distance : distance) - radius;
  INFO("gap " << g.gap << " expected " << expected << " at " << p.x << " " << p.y << " " << p.z);
  // Single precision on lengths up to 2 m (2e-7), and the search's own 1e-6.
  REQUIRE(std::abs(g.gap - expected) < 3e-6);
  REQUIRE(std::abs(length(static_cast<Vec3d>(g.normal)) - 1) < 1e-5);
  const Vec3d foot = p - static_cast<Vec3d>(g.normal) * (double(g.gap) + radius);
  INFO("distance of the foot from the surface " << distance_to(surface, foot));
  // A foot off the surface means a wrong normal; near edges (1e-3 m away) the normal is good to 1e-4.
  REQUIRE(distance_to(surface, foot) < 2e-5);
}

Shape lugged_wheel(Draw& draw, int lugs) {
  Shape s;
  s.type = ShapeType::wheel;
  s.lug_count = lugs;
  const double radius = draw.between(0.2, 0.6);
  s.size = {Real(radius), Real(draw.between(0.05, 0.2)), Real(draw.between(0.01, 0.06))};
  s.lug_thickness = Real(draw.between(0.01, 0.1));
  return s;
}

}  // namespace

TEST_CASE("gap and normal of two spheres are those of the line between their centres") {
  Draw draw(201);
  for (int i = 0; i < 2000; ++i) {
    const Vec3d d = draw.direction() * draw.magnitude(1e-6, 1);
    const double sum = draw.magnitude(1e-3, 1);
    const Gap g = sphere_sphere_gap(static_cast<Vec3>(d), Real(sum));
    REQUIRE(std::abs(g.gap - (length(d) - sum)) < 3e-7);
    REQUIRE(length(static_cast<Vec3d>(g.normal) - d * (1 / length(d))) < 1e-6);
  }
  const Gap same = sphere_sphere_gap({0, 0, 0}, 0.5f);
  CHECK(same.gap == -0.5f);
  CHECK(length(same.normal) == 1);
}

TEST_CASE("gap and normal of a sphere and a box agree with sampled surface points") {
  Draw draw(202);
  for (int i = 0; i < 150; ++i) {
    const Vec3d half{draw.between(0.05, 0.5), draw.between(0.05, 0.5), draw.between(0.05, 0.5)};
    const Vec3d p = draw.in_box(half * -1.5, half * 1.5);
    const double radius = draw.magnitude(1e-3, 0.1);
    const Gap g = sphere_box_gap(static_cast<Vec3>(p), static_cast<Vec3>(half), Real(radius));
    check_gap(g, radius, p, box_surface(half), in_box(p, half));
  }
}

TEST_CASE("gap and normal of a sphere and a cylinder agree with sampled surface points") {
  Draw draw(203);
  for (int i = 0; i < 150; ++i) {
    const double big = draw.between(0.1, 0.6), half_width = draw.between(0.05, 0.3);
    const Vec3d p = draw.in_box(Vec3d{big, half_width, big} * -1.5, Vec3d{big, half_width, big} * 1.5);
    const double radius = draw.magnitude(1e-3, 0.1);
    const Gap g = sphere_cylinder_gap(static_cast<Vec3>(p), Real(big), Real(half_width), Real(radius));
    const bool inside = std::hypot(p.x, p.z) < big && std::abs(p.y) < half_width;
    check_gap(g, radius, p, cylinder_surface(big, half_width, p), inside);
  }
  const Gap on_axle = sphere_cylinder_gap({0, 0, 0}, 0.3f, 0.5f, 0.1f);
  CHECK(on_axle.gap == Approx(-0.4));
  CHECK(length(on_axle.normal) == Approx(1));
}

TEST_CASE("gap and normal of a sphere and a lug agree with sampled surface points") {
  Draw draw(204);
  for (int i = 0; i < 150; ++i) {
    const Shape wheel = lugged_wheel(draw, 1 + draw.below(24));
    const int k = draw.below(wheel.lug_count);
    const Vec3d half = half_of_lug(wheel), local = draw.in_box(half * -2.0, half * 2.0);
    const double angle = 2 * kPi * k / wheel.lug_count, x = local.x + wheel.size.x;
    const Vec3d p{std::cos(angle) * x - std::sin(angle) * local.z, local.y,
                  std::sin(angle) * x + std::cos(angle) * local.z};
    const double radius = draw.magnitude(1e-3, 0.1);
    const Gap g = sphere_lug_gap(static_cast<Vec3>(p), wheel, k, Real(radius));
    Gap in_lug = g;  // the same gap, its normal turned into the frame of the lug
    const Vec3d n = to_lug(
        static_cast<Vec3d>(g.normal) + Vec3d{std::cos(angle), 0, std::sin(angle)} * double(wheel.size.x), wheel, k);
    in_lug.normal = static_cast<Vec3>(n);
    check_gap(in_lug, radius, to_lug(p, wheel, k), box_surface(half), in_box(to_lug(p, wheel, k), half));
  }
}

TEST_CASE("a small sphere meets every feature of a wheel that it touches, and each once") {
  Draw draw(205);
  int touching = 0;
  for (const int lugs : {0, 1, 2, 3, 8, 24})
    for (int i = 0; i < 4000; ++i) {
      const Shape wheel = lugged_wheel(draw, lugs);
      const double radius = draw.magnitude(1e-4, 5e-3), envelope = draw.magnitude(1e-5, 2e-3);
      const double reach = wheel.size.x + wheel.size.z + 0.005;
      const double angle = draw.between(-kPi, kPi), from_axle = draw.between(0.9 * wheel.size.x, reach);
      Vec3d p{from_axle * std::cos(angle), draw.between(-1.05, 1.05) * wheel.size.y, from_axle * std::sin(angle)};
      if (lugs > 0 && draw.below(2) == 0) {  // just off an outer edge of a lug, where it reaches furthest
        const double a = 2 * kPi * draw.below(lugs) / lugs, x = wheel.size.x + wheel.size.z;
        const double z = (draw.below(2) ? 0.5 : -0.5) * wheel.lug_thickness;
        p = Vec3d{std::cos(a) * x - std::sin(a) * z, p.y, std::sin(a) * x + std::cos(a) * z};
        const double out = (radius + 0.9 * envelope) / std::hypot(p.x, p.z);
        p.x *= 1 + out;
        p.z *= 1 + out;
      }
      std::vector<int> met;
      visit_wheel_gaps(static_cast<Vec3>(p), wheel, Real(radius), Real(envelope), [&](int feature, const Gap& g) {
        met.push_back(feature);
        REQUIRE(g.gap < envelope);
        REQUIRE(length(g.normal) == Approx(1).epsilon(1e-5));
      });
      std::vector<int> sorted = met;
      std::sort(sorted.begin(), sorted.end());
      INFO(lugs << " lugs, case " << i);
      REQUIRE(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end());
      for (int feature = 0; feature <= lugs; ++feature) {
        double gap = 0;
        if (feature == 0) {
          const double radial = std::hypot(p.x, p.z) - wheel.size.x, axial = std::abs(p.y) - wheel.size.y;
          gap = radial > 0 && axial > 0 ? std::hypot(radial, axial) : std::max(radial, axial);
        } else {
          const Vec3d q = to_lug(p, wheel, feature - 1), half = half_of_lug(wheel);
          const Vec3d out{std::abs(q.x) - half.x, std::abs(q.y) - half.y, std::abs(q.z) - half.z};
          const Vec3d past{std::max(out.x, 0.0), std::max(out.y, 0.0), std::max(out.z, 0.0)};
          gap = length(past) > 0 ? length(past) : std::max({out.x, out.y, out.z});
        }
        gap -= radius;
        // Lugs that overlap near their feet may all hold a sphere; those beyond the nearest two only repeat them.
        const bool deep = gap < -radius;
        const bool expected = gap < envelope;
        if (std::abs(gap - envelope) < 1e-6 || (feature > 0 && deep)) continue;
        const bool found = std::find(met.begin(), met.end(), feature) != met.end();
        INFO("feature " << feature << " gap " << gap << " envelope " << envelope << " found " << found);
        REQUIRE(found == expected);
        touching += expected;
      }
    }
  INFO(touching << " touching features");
  CHECK(touching > 3000);
}
