// Half a heap of spheres that slumped against a smooth wall: the angle at which it comes to rest rises with rolling
// friction.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/units.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

constexpr double kRadius = 0.02, kDepth = 8 * kRadius;  // of a grain [m]; of the heap, periodic along y [m]
constexpr int kGrain = 0, kFloor = 1, kWall = 2;        // materials

/// A floor of fixed grains that holds what rolls onto it, and a wall in the heap's middle plane.
void add_surroundings(SceneWorld& w, Draw& draw) {
  const BodyIndex wall = add_plane(w, {}, about_y(kPi / 2), kWall);
  w.body[wall].position = {0, 0, 0};
  for (double x = kRadius; x < 0.9; x += 1.9 * kRadius)
    for (int y = 0; y < 4; ++y) {
      const Vec3d at{x, (2 * y + 1) * kRadius, draw.between(-0.5, 0) * kRadius};
      w.mass[w.add_sphere(at, Real(kRadius), 2600, kFloor)] = fixed_body();
    }
}

/// A column of grains, 6 wide and 14 high, that falls apart.
SceneWorld column(double rolling, unsigned seed) {
  Draw draw(seed);
  SceneWorld w;
  w.origin = {-0.1, 0, -0.2};
  w.size = {1.2, kDepth, 1.2};
  w.periodic_y = true;
  w.set_law(kGrain, kGrain, {Real(0.5), Real(rolling), 0});
  w.set_law(kGrain, kFloor, {Real(0.9), Real(0.9), 0});
  add_surroundings(w, draw);
  for (int z = 0; z < 14; ++z)
    for (int x = 0; x < 6; ++x)
      for (int y = 0; y < 4; ++y) {
        const Vec3d at{(2.2 * x + 1.1) * kRadius, (2 * y + 1) * kRadius, (2.2 * z + 2.5) * kRadius};
        w.add_sphere(at + draw.direction() * (0.08 * kRadius), Real(kRadius * draw.between(0.9, 0.99)), 2600, kGrain);
      }
  return w;
}

/// Slope [degrees] of the heap's surface: least squares of the highest grain per slice of x over the slices between a
/// fifth and four fifths of the summit's height.
double angle_of(const std::vector<BodyState>& bodies, const std::vector<BodyMass>& mass) {
  std::vector<double> top(40, 0);
  const double width = 2 * kRadius;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto slice = std::size_t(bodies[b].position.x / width);
    if (!is_fixed(mass[b]) && slice < top.size()) top[slice] = std::max(top[slice], bodies[b].position.z);
  }
  const double summit = *std::max_element(top.begin(), top.end());
  double n = 0, x = 0, z = 0, xx = 0, xz = 0;
  for (std::size_t i = 0; i < top.size(); ++i) {
    if (top[i] < 0.2 * summit || top[i] > 0.8 * summit) continue;
    const double at = (double(i) + 0.5) * width;
    n += 1;
    x += at;
    z += top[i];
    xx += at * at;
    xz += at * top[i];
  }
  return to_degrees(-std::atan((n * xz - x * z) / (n * xx - x * x)));
}

/// Mean over heaps that differ in their grains; one heap's angle scatters by some 2 degrees.
double mean_angle(Backend backend, double rolling) {
  constexpr unsigned heaps = 6;
  Scene scene;
  for (unsigned seed = 0; seed < heaps; ++seed) scene.push_back(column(rolling, 41 + seed));
  StepSettings settings;
  settings.step = 2e-3f;
  settings.iterations = 40;
  const auto simulation = make_simulation(backend, scene, settings, 1);
  advance_for(*simulation, 3);
  double sum = 0;
  for (unsigned w = 0; w < heaps; ++w) {
    const StepReport report = simulation->report(WorldIndex(w));
    CHECK(report.flags == 0);
    CHECK(report.kinetic_energy < 1e-2);  // of 80 J that the column had
    sum += angle_of(simulation->bodies(WorldIndex(w)), scene[w].mass);
  }
  std::printf("heaps, rolling friction %.2f, %s: angle of repose %.1f degrees\n", rolling, name_of(backend),
              sum / heaps);
  return sum / heaps;
}

}  // namespace

TEST_CASE("the angle of repose rises with rolling friction") {
  for (const Backend backend : backends()) {
    const double smooth = mean_angle(backend, 0), rough = mean_angle(backend, 0.15), rougher = mean_angle(backend, 0.5);
    // Smooth spheres rest at 10 to 25 degrees, angular sand at 30 to 40.
    CHECK(smooth > 10);
    CHECK(smooth < 25);
    CHECK(rough > smooth + 2);
    CHECK(rougher > rough + 2);
    CHECK(rougher < 45);
  }
}
