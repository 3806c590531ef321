// Free rotation of a body with three different moments of inertia.
#include <cmath>
#include <string>

#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/joint_error.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

struct Rotation {
  double energy;
  Vec3d momentum;  // world axes
};

/// At the end of a step, where the engine's angular velocity is the mean of the step.
Rotation rotation(const BodyState& s, const Vec3d& inertia, double step) {
  const Pose at = pose_of(s);
  const auto spin = static_cast<Vec3d>(s.angular_velocity);
  const Vec3d w{dot(at.x, spin), dot(at.y, spin), dot(at.z, spin)};
  const Vec3d mean = scale(inertia, w), l = mean - cross(w, mean) * (step / 2);
  return {0.5 * (l.x * l.x / inertia.x + l.y * l.y / inertia.y + l.z * l.z / inertia.z),
          at.x * l.x + at.y * l.y + at.z * l.z};
}

}  // namespace

TEST_CASE("a tumbling body turns over and over and keeps its energy and angular momentum (Dzhanibekov)") {
  const Vec3d inertia{1, 2, 3};
  struct Case {
    double step, spin, seconds, tolerance;
  };
  for (const Backend backend : backends())
    for (const Case& c : {Case{1e-3, 10, 20, 1e-4}, Case{1e-2, 10, 20, 1e-4}, Case{1e-3, 100, 2, 1e-4}}) {
      SceneWorld w;
      w.gravity = {};
      w.origin = {-1, -1, -1};
      w.size = {2, 2, 2};
      const BodyIndex b = w.add_body({{}, {}, {}, {Real(0.001 * c.spin), Real(c.spin), 0}}, solid(1, {1, 2, 3}));
      StepSettings settings;
      settings.step = Real(c.step);
      const auto simulation = simulate(backend, w, settings);
      simulation->advance(1);
      const Rotation first = rotation(simulation->body(0, b), inertia, c.step);
      double energy_error = 0, momentum_error = 0, last = 1;
      int turns = 0;
      const int stride = 5;  // at most half a radian
      for (int i = 0; i < int(c.seconds / c.step) / stride; ++i) {
        simulation->advance(stride);
        const BodyState s = simulation->body(0, b);
        const Rotation now = rotation(s, inertia, c.step);
        energy_error = std::max(energy_error, std::fabs(now.energy / first.energy - 1));
        momentum_error = std::max(momentum_error, length(now.momentum - first.momentum) / length(first.momentum));
        const double upright = dot(pose_of(s).y, first.momentum) / length(first.momentum);
        if (std::fabs(upright) > 0.9 && upright * last < 0) {
          ++turns;
          last = upright;
        }
      }
      // Rounding of single precision over up to 20,000 steps; the scheme itself keeps both exactly.
      const std::string name = "tumbling, h " + short_text(c.step) + " s, " + short_text(c.spin) + " rad/s, ";
      CHECK(agrees(name + "energy error [-]", 0, energy_error, c.tolerance));
      CHECK(agrees(name + "momentum error [-]", 0, momentum_error, c.tolerance));
      // It turns over about every ln(2 / 0.001) 2 / (w / sqrt(3)): 2.6 s at 10 rad/s.
      CHECK(turns >= int(c.seconds * c.spin / 10 / 4));
      CHECK(turns <= int(c.seconds * c.spin / 10 / 1.5));
    }
}
