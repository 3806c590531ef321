#include "sim/state/contact.h"

#include <cmath>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/draw.h"

using namespace gonogo;
using namespace gonogo::sim;
using gonogo::test::Draw;

namespace {

struct Case {
  ConeImpulse from;
  Real mu, rho, sigma;
  ConeStep step;

  ConeShape cone() const { return {mu, rho, sigma}; }
};

/// Impulse in double.
struct Point {
  double n;
  Vec3d t, r;
  double s;
};

Point point(const ConeImpulse& p) {
  return {p.normal, static_cast<Vec3d>(p.tangential), static_cast<Vec3d>(p.rolling), p.spinning};
}

/// Impulses in N s with rolling parts of the size of an impulse times a grain's radius, so that every part matters.
Case random_case(Draw& draw) {
  const double mus[] = {0, 0.05, 0.5, 1.5}, rhos[] = {0, 1e-4, 5e-3};
  const double scale = draw.magnitude(1e-4, 1e3), radius = draw.magnitude(1e-2, 0.1);
  Case c;
  c.mu = Real(mus[draw.below(4)]);
  c.rho = Real(rhos[draw.below(3)]);
  c.sigma = Real(rhos[draw.below(3)]);
  c.from.normal = Real(scale * draw.between(-1, 1));
  c.from.tangential = static_cast<Vec3>(draw.direction() * (scale * draw.magnitude(1e-3, 1)));
  c.from.rolling = static_cast<Vec3>(draw.direction() * (scale * radius * draw.magnitude(1e-3, 1)));
  if (draw.below(20) == 0) c.from.tangential = {};
  c.from.spinning = Real(scale * radius * draw.between(-1, 1));
  if (draw.below(20) == 0) c.from.rolling = {};
  if (draw.below(20) == 0) c.from.spinning = 0;
  if (draw.below(50) == 0) c.from.normal = 0;
  const double mass = draw.magnitude(1e-3, 1e3);
  c.step = {Real(mass * draw.magnitude(0.1, 1)), Real(mass * draw.magnitude(0.1, 1)),
            Real(mass * radius * radius * draw.magnitude(0.1, 1))};
  return c;
}

double norm(const Vec3& v) { return length(static_cast<Vec3d>(v)); }

/// Squared distance in the metric of the step, in double.
double distance(const Case& c, const Point& p) {
  const Point from = point(c.from);
  const Vec3d dt = p.t - from.t, dr = p.r - from.r;
  const double dn = p.n - from.n, ds = p.s - from.s;
  return dn * dn / c.step.n + dot(dt, dt) / c.step.t + (dot(dr, dr) + ds * ds) / c.step.r;
}

/// Size of the terms that a check of this case sums up: single precision can do no better than a share of it.
double metric_scale(const Case& c) { return distance(c, {0, {}, {}, 0}); }

/// The three parts that clip: their lengths, openings and steps.
struct Part {
  double length, opening, step;
};
std::vector<Part> parts(const Case& c) {
  return {{norm(c.from.tangential), c.mu, c.step.t},
          {norm(c.from.rolling), c.rho, c.step.r},
          {std::abs(double(c.from.spinning)), c.sigma, c.step.r}};
}

/// Distance at the best friction impulses for a given normal impulse.
double distance_at(const Case& c, double n) {
  const double dn = n - c.from.normal;
  double sum = dn * dn / c.step.n;
  for (const Part& p : parts(c)) {
    const double over = std::max(0.0, p.length - p.opening * n);
    sum += over * over / p.step;
  }
  return sum;
}

/// The best normal impulse lies below this one.
double normal_bound(const Case& c) {
  double bound = std::abs(c.from.normal);
  for (const Part& p : parts(c)) bound += p.opening > 0 ? p.length / p.opening : 0;
  return bound;
}

/// The normal impulse of least distance: where the slope of distance_at, which only rises, changes sign.
double best_normal(const Case& c) {
  const auto slope = [&](double n) {
    double sum = (n - c.from.normal) / c.step.n;
    for (const Part& p : parts(c)) sum -= p.opening * std::max(0.0, p.length - p.opening * n) / p.step;
    return sum;
  };
  double low = 0, high = normal_bound(c);
  for (int i = 0; i < 200; ++i) (slope((low + high) / 2) > 0 ? high : low) = (low + high) / 2;
  return low;
}

// Some thirty single-precision operations (6e-8 each) with cancellation between terms of up to ten times the result.
constexpr double kRelative = 1e-5;

}  // namespace

TEST_CASE("the projection lies in the cone and its residual in the polar cone, orthogonal to it") {
  Draw draw(101);
  for (int i = 0; i < 20000; ++i) {
    const Case c = random_case(draw);
    const ConeImpulse p = project_onto_cone(c.from, c.cone(), c.step);
    INFO("case " << i << " mu " << c.mu << " rho " << c.rho << " n0 " << c.from.normal << " n " << p.normal);
    REQUIRE(p.normal >= 0);
    REQUIRE(norm(p.tangential) <= c.mu * double(p.normal) * (1 + kRelative));
    REQUIRE(norm(p.rolling) <= c.rho * double(p.normal) * (1 + kRelative));
    REQUIRE(std::abs(p.spinning) <= c.sigma * double(p.normal) * (1 + kRelative));

    // Residual in the metric: (from - p) / step. Polar cone of K: d_n + mu |d_t| + rho |d_r| + sigma |d_s| <= 0.
    const double d_n = (double(c.from.normal) - p.normal) / c.step.n;
    const Vec3d d_t = static_cast<Vec3d>(c.from.tangential - p.tangential) * (1.0 / c.step.t);
    const Vec3d d_r = static_cast<Vec3d>(c.from.rolling - p.rolling) * (1.0 / c.step.r);
    const double d_s = (double(c.from.spinning) - p.spinning) / c.step.r;
    double size = (std::abs(double(c.from.normal)) + p.normal) / c.step.n;
    for (const Part& part : parts(c)) size += part.opening * part.length / part.step;
    const double support = d_n + c.mu * length(d_t) + c.rho * length(d_r) + c.sigma * std::abs(d_s);
    INFO("polar " << support << " of " << size);
    REQUIRE(support <= kRelative * size);

    const double product = d_n * p.normal + dot(d_t, static_cast<Vec3d>(p.tangential)) +
                           dot(d_r, static_cast<Vec3d>(p.rolling)) + d_s * p.spinning;
    INFO("product " << product << " of " << size * p.normal);
    REQUIRE(std::abs(product) <= kRelative * size * p.normal);
  }
}

TEST_CASE("projecting twice changes nothing") {
  Draw draw(102);
  for (int i = 0; i < 5000; ++i) {
    const Case c = random_case(draw);
    const ConeImpulse p = project_onto_cone(c.from, c.cone(), c.step);
    const ConeImpulse q = project_onto_cone(p, c.cone(), c.step);
    INFO("case " << i << " n " << p.normal << " then " << q.normal);
    REQUIRE(std::abs(double(p.normal) - q.normal) <= kRelative * p.normal);
    REQUIRE(norm(p.tangential - q.tangential) <= kRelative * (c.mu * p.normal));
    REQUIRE(norm(p.rolling - q.rolling) <= kRelative * (c.rho * p.normal));
    REQUIRE(std::abs(p.spinning - q.spinning) <= kRelative * (c.sigma * p.normal));
  }
}

TEST_CASE("the projection agrees with a numerical minimiser") {
  Draw draw(103);
  double worst = 0;
  for (int i = 0; i < 5000; ++i) {
    const Case c = random_case(draw);
    const ConeImpulse p = project_onto_cone(c.from, c.cone(), c.step);
    const double best = distance_at(c, best_normal(c));
    const double got = distance(c, point(p));
    worst = std::max(worst, (got - best) / metric_scale(c));
    INFO("case " << i << " mu " << c.mu << " rho " << c.rho << " distance " << got << " best " << best);
    REQUIRE(std::abs(got - best) <= kRelative * metric_scale(c));
    REQUIRE(std::abs(p.normal - best_normal(c)) <= kRelative * normal_bound(c));
  }
  INFO("worst excess of the distance, relative: " << worst);
  CHECK(worst < kRelative);
}

TEST_CASE("no admissible impulse drawn at random is nearer than the projection") {
  Draw draw(104);
  for (int i = 0; i < 300; ++i) {
    const Case c = random_case(draw);
    const ConeImpulse p = project_onto_cone(c.from, c.cone(), c.step);
    const double got = distance(c, point(p));
    const double reach = 2 * (p.normal + std::abs(c.from.normal));
    for (int k = 0; k < 300; ++k) {
      const double n = draw.between(0, reach);
      const Vec3d t = draw.direction() * (c.mu * n * draw.unit()), r = draw.direction() * (c.rho * n * draw.unit());
      REQUIRE(distance(c, {n, t, r, c.sigma * n * draw.between(-1, 1)}) >= got - kRelative * metric_scale(c));
    }
  }
}

TEST_CASE("the projection is exact where the cone degenerates") {
  const ConeStep step{2, 1, 0.01f};
  const ConeImpulse push{3, {4, 0, 0}, {0, 0.1f, 0}, 0.2f};
  const ConeImpulse without = project_onto_cone(push, {0, 0, 0}, step);
  CHECK(without.normal == 3);
  CHECK(norm(without.tangential) == 0);
  CHECK(norm(without.rolling) == 0);
  CHECK(without.spinning == 0);
  const ConeImpulse pull = project_onto_cone({-3, {0, 0, 0}, {0, 0, 0}, 0}, {0.5f, 0.01f, 0.01f}, step);
  CHECK(pull.normal == 0);
  const ConeImpulse nothing = project_onto_cone({}, {0.5f, 0.01f, 0.01f}, step);
  CHECK(nothing.normal == 0);
  // Inside the cone nothing moves, to the bit.
  const ConeImpulse inside = project_onto_cone({3, {1, 0, 0}, {0, 0.01f, 0}, 0.01f}, {0.5f, 0.01f, 0.01f}, step);
  CHECK(inside.normal == 3);
  CHECK(inside.tangential.x == 1);
  CHECK(inside.rolling.y == 0.01f);
  CHECK(inside.spinning == 0.01f);
  // A pull with a sideways part that the friction cone's slope lifts back: n = (n0 / s_n + mu t / s_t) / (1 / s_n +
  // mu^2 / s_t) = (-0.5 + 2) / (0.5 + 0.25) = 2.
  const ConeImpulse lifted = project_onto_cone({-1, {4, 0, 0}, {}, 0}, {0.5f, 0, 0}, step);
  CHECK(lifted.normal == Approx(2.0));
  CHECK(lifted.tangential.x == Approx(1.0));
}
