// Ellipsoids that roll: closed forms of their motion on a plane and on ground of triangles.
#include <cmath>
#include <string>
#include <vector>

#include "sim/shape/meshes.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

void add_ground(SceneWorld& w, int cells) {
  if (cells == 0) {
    add_plane(w);
    return;
  }
  Shape s;
  s.body = w.add_body({}, fixed_body());
  s.type = ShapeType::mesh;
  s.surface = w.add_mesh(floor_mesh(4, cells));
  w.add_shape(s);
}

const char* name_of_ground(int cells) { return cells == 0 ? "plane" : cells == 1 ? "two triangles" : "many triangles"; }

/// Times at which a body's tilt about y goes through zero upward [s], and the largest tilt of the last swing [rad].
struct Rocking {
  std::vector<double> crossing;
  double swing = 0;
};

Rocking rock(Simulation& simulation, BodyIndex b, double step, int steps) {
  Rocking r;
  double before = 0;
  for (int i = 0; i < steps; ++i) {
    simulation.advance(1);
    const double tilt = 2 * double(simulation.body(0, b).orientation.y);
    if (before < 0 && tilt >= 0) {
      r.crossing.push_back(step * (i + 1 - tilt / (tilt - before)));
      r.swing = 0;
    }
    r.swing = std::max(r.swing, std::abs(tilt));
    before = tilt;
  }
  return r;
}

}  // namespace

TEST_CASE("an ellipsoid rocks on its flattest side with the period of its radius of curvature") {
  // Rolling without slip about a stable rest: w^2 = m g (R - h) / (I + m h^2), R = a^2 / c, h = c. Swings of 0.01 rad:
  // the radius of curvature falls fast beside the flattest point, by 0.1 % of the period here.
  const double a = 0.3, b = 0.2, c = 0.1, start = 0.01, step = 2.5e-4;
  const double inertia = (a * a + c * c) / 5, curvature = a * a / c;
  const double period = 2 * kPi / std::sqrt(kGravity * (curvature - c) / (inertia + c * c));
  for (const Backend backend : backends())
    for (const int cells : {0, 1, 60}) {
      SceneWorld w = open_world({Real(0.9), 0});
      add_ground(w, cells);
      const double height = std::hypot(c * std::cos(start), a * std::sin(start));
      const BodyIndex e =
          w.add_ellipsoid({{0.02, 0.03, height}, about_y(start), {}, {}}, {Real(a), Real(b), Real(c)}, 1000, 0);
      StepSettings settings = settings_with(60);
      settings.step = Real(step);
      const auto simulation = simulate(backend, w, settings);
      const Rocking r = rock(*simulation, e, step, int(6.3 * period / step));
      REQUIRE(r.crossing.size() >= 6);
      const std::string label = std::string("ellipsoid rocking on ") + name_of_ground(cells) + ", " + name_of(backend);
      CHECK(agrees(label + ": period [s]", period, (r.crossing[5] - r.crossing[0]) / 5, 2e-3 * period));
      CHECK(agrees(label + ": swing after six periods over the first", 1, r.swing / start, 0.01));
    }
}

TEST_CASE("an ellipsoid rolls down a slope about its long axis as a ball of its section does") {
  const double mu = 0.6, angle = 0.2, seconds = 0.5, radius = 0.1;
  for (const Backend backend : backends())
    for (const int cells : {0, 1, 60}) {
      SceneWorld w = open_world({Real(mu), 0});
      w.gravity = tilted_gravity(angle);
      add_ground(w, cells);
      const BodyIndex e = w.add_ellipsoid({{1, 0.01, radius}, {}, {}, {}}, {Real(radius), 0.3f, Real(radius)}, 2000, 0);
      const auto simulation = simulate(backend, w, settings_with(80));
      advance_for(*simulation, seconds);
      const double expected = -5.0 / 7 * kGravity * std::sin(angle) * seconds;
      const BodyState s = simulation->body(0, e);
      const std::string label =
          std::string("ellipsoid rolling down ") + name_of_ground(cells) + ", " + name_of(backend);
      CHECK(agrees(label + ": speed [m/s]", expected, s.velocity.x, 3e-3 * std::abs(expected)));
      CHECK(agrees(label + ": rim speed [m/s]", expected, double(s.angular_velocity.y) * radius,
                   3e-3 * std::abs(expected)));
    }
}
