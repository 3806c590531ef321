// Maps of regimes: how a sphere goes down an incline, and when three spheres that lean on each other stand.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "base/units.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/validation/sphere_on_slope.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

enum class Regime { rests, rolls, slides, slides_and_rolls };

/// Of a sphere released on an incline, with its speed and the speed of its rim after a time.
struct Descent {
  Regime regime;
  double speed, rim;  // [m/s]
  double margin;      // distance from the nearest border of the regime [-]
};

/// Sliding friction at most mu N, rolling couple at most mu_r N r.
Descent closed_form(double angle, double mu, double rolling, double time) {
  const double t = std::tan(angle), along = kGravity * std::cos(angle) * time;
  // Rolling without slip needs the friction 2/7 tan + 5/7 mu_r; see docs/validation.md.
  const double needed = 2.0 / 7 * t + 5.0 / 7 * rolling;
  const auto nearest = [](double a, double b) { return std::min(std::fabs(a), std::fabs(b)); };
  if (t <= mu && t <= rolling) return {Regime::rests, 0, 0, nearest(t - mu, t - rolling)};
  if (rolling >= mu) return {Regime::slides, along * (t - mu), 0, nearest(t - mu, rolling - mu)};
  if (needed <= mu) {
    const double speed = 5.0 / 7 * along * (t - rolling);
    return {Regime::rolls, speed, speed, nearest(t - rolling, needed - mu)};
  }
  return {Regime::slides_and_rolls, along * (t - mu), 2.5 * along * (mu - rolling), nearest(needed - mu, rolling - mu)};
}

Regime seen(double speed, double rim, double threshold) {
  if (speed < threshold) return Regime::rests;
  if (rim < threshold) return Regime::slides;
  return speed - rim < threshold ? Regime::rolls : Regime::slides_and_rolls;
}

/// Two spheres of mass w on the ground, `gap` radii apart, and one of mass m w between them on top. Contacts stay at
/// rest where forces within all cones balance. With f the friction angle, s and c sine and cosine of the angle of the
/// line of centres from upright (s = 1/2 + gap/4), the upper contacts, on the point of sliding, carry N = (m w g / 2) /
/// (c + mu s) and mu N; the lower ones G = w g (1 + m / 2) and F = N (s - mu c). Ground friction: F <= mu G. Moments
/// about a lower sphere: F - mu N <= mu_r G + mu_r N / 2, whose rolling couples act on r and, between spheres, on r
/// / 2. Less friction above makes both worse. Returns the largest m that stands; infinite where every one does.
double largest_top_mass(double gap, double mu, double rolling) {
  const double s = 0.5 + gap / 4, c = std::sqrt(1 - s * s), n = 0.5 / (c + mu * s);  // N over m w g
  const auto limit = [](double per_mass, double at_none) { return per_mass > 0 ? at_none / per_mass : INFINITY; };
  return std::min(limit(n * (s - mu * c) - mu / 2, mu),
                  limit(n * (s - mu * c) - mu * n - rolling * (0.5 + n / 2), rolling));
}

SceneWorld leaning(double gap, double mu, double rolling, double mass_ratio) {
  constexpr double r = 0.15;
  SceneWorld w = open_world({Real(mu), Real(rolling), 0});
  add_plane(w);
  const double half = r * (1 + gap / 2), height = std::sqrt(4 * r * r - half * half);
  for (const double x : {-half, half}) w.add_sphere({x, 0, r}, Real(r), density_for(1, r), 0);
  w.add_sphere({0, 0, r + height}, Real(r), density_for(mass_ratio, r), 0);
  return w;
}

}  // namespace

TEST_CASE("a sphere released on an incline rests, rolls, slides or does both where the closed forms say so") {
  constexpr double mu = 0.25, radius = 0.2, mass = 5, time = 0.5, step = 1e-3;
  struct Cell {
    double angle_deg, rolling;
  };
  std::vector<Cell> cells;
  Scene scene;
  for (double angle = 1; angle <= 60; angle += 3.1)
    for (double rolling = 0; rolling <= 0.305; rolling += 0.05) {
      cells.push_back({angle, rolling});
      scene.push_back(sphere_on_slope(to_radians(angle), mu, rolling, radius, mass));
    }
  const StepSettings settings = settings_with(step, 60);
  for (const Backend backend : backends()) {
    const auto simulation = make_simulation(backend, scene, settings, 1);
    advance_for(*simulation, time);
    int right = 0, counted = 0, of[4] = {};
    double worst = 0;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const double angle = to_radians(cells[k].angle_deg);
      const Descent expected = closed_form(angle, mu, cells[k].rolling, time);
      const BodyState s = simulation->body(WorldIndex(k), 1);
      const double speed = -s.velocity.x, rim = -s.angular_velocity.y * radius,
                   scale = kGravity * std::sin(angle) * time;
      worst = std::max({worst, std::fabs(speed - expected.speed) / scale, std::fabs(rim - expected.rim) / scale});
      if (expected.margin < 0.005) continue;
      ++counted;
      ++of[int(expected.regime)];
      right += seen(speed, rim, 0.006 * scale) == expected.regime;
    }
    const std::string label = std::string(", ") + name_of(backend);
    std::printf("incline: %d rest, %d roll, %d slide, %d slide and roll\n", of[0], of[1], of[2], of[3]);
    for (const int regime : of) CHECK(regime > 5);
    CHECK(agrees("incline, cells of the map in their regime" + label, counted, right, 0));
    // The first step finds the gap at zero and hops: 1/500 of what gravity alone would give.
    CHECK(agrees("incline, speeds off the closed form, over g sin t" + label, 0, worst, 2e-3));
  }
}

TEST_CASE("three spheres that lean on each other stand up to the mass that statics allows and no further") {
  constexpr double mu = 0.2, time = 2, step = 1e-3, unlimited = 20, beside = 0.05;
  struct Cell {
    double gap, rolling, mass;
    bool stands;
  };
  std::vector<Cell> cells;
  Scene scene;
  for (const double gap : {0.2, 0.3, 0.4})
    for (double rolling = 0.025; rolling <= 0.31; rolling += 0.025) {
      const double max = largest_top_mass(gap, mu, rolling);
      if (max < unlimited) {
        cells.push_back({gap, rolling, max * (1 - beside), true});
        cells.push_back({gap, rolling, max * (1 + beside), false});
      } else {
        cells.push_back({gap, rolling, unlimited, true});
      }
    }
  for (const Cell& c : cells) scene.push_back(leaning(c.gap, mu, c.rolling, c.mass));
  const StepSettings settings = settings_with(step, 300);
  for (const Backend backend : backends()) {
    const auto simulation = make_simulation(backend, scene, settings, 1);
    advance_for(*simulation, time);
    int right = 0;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const double fell = scene[k].body[3].position.z - simulation->body(WorldIndex(k), 3).position.z;
      const bool stood = fell<0.001 * 0.15, collapsed = fell> 0.1 * 0.15;
      right += cells[k].stands ? stood : collapsed;
      if (cells[k].stands ? !stood : !collapsed)
        std::printf("three spheres, gap %.1f r, rolling %.3f, top mass %.3f: top fell %.5f m, %s\n", cells[k].gap,
                    cells[k].rolling, cells[k].mass, fell, cells[k].stands ? "should stand" : "should collapse");
    }
    CHECK(agrees(std::string("three spheres, cells 5 % beside the border on its side, ") + name_of(backend),
                 double(cells.size()), right, 0));
  }
}
