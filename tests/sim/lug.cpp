// Grains resist rolling on a wheel's rim and roll freely on its lugs.
#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

constexpr Real kGrain = 0.01f, kRolling = 0.3f;
constexpr double kRim = 0.2, kLug = 0.05;

/// A fixed wheel with four lugs at 0, 90, 180 and 270 degrees, and a grain or a short rod of it that touches at
/// `angle`, `from_axle` away from the axle.
SceneWorld grain_at(ShapeType type, double angle, double from_axle) {
  SceneWorld w;
  w.origin = {-1, -1, -1};
  w.size = {2, 2, 2};
  w.set_law(0, 0, {Real(0.5), kRolling, 0});
  const BodyIndex wheel = w.add_body({}, fixed_body());
  Shape tyre;
  tyre.type = ShapeType::wheel;
  tyre.body = wheel;
  tyre.size = {Real(kRim), Real(0.1), Real(kLug)};
  tyre.lug_count = 4;
  tyre.lug_thickness = Real(0.01);
  w.add_shape(tyre);
  const Vec3d at{from_axle * std::cos(angle), 0, from_axle * std::sin(angle)};
  if (type == ShapeType::sphere) {
    w.add_sphere(at, kGrain, 1000, 0);
    return w;
  }
  Shape rod;
  rod.type = type;
  rod.body = w.add_body({at, {}, {}, {}}, solid(1, {Real(1e-4), Real(1e-4), Real(1e-4)}));
  rod.size = {kGrain, kGrain, 0};
  w.add_shape(rod);
  return w;
}

/// Largest radius of rolling resistance among the contacts; NaN without any [m].
double rolling_length(ShapeType type, double angle, double from_axle) {
  const auto simulation = simulate(Backend::cpu, grain_at(type, angle, from_axle), settings_with(1e-4, 20));
  simulation->advance(1);
  double length = std::nan("");
  for (const Contact& c : simulation->contacts(0)) length = std::fmax(length, double(c.rho));
  return length;
}

}  // namespace

TEST_CASE("a grain resists rolling on the rim with its radius, and not at all on a lug's tip, edge or face") {
  const double rim = kRim + kGrain, tip = kRim + kLug + kGrain;
  for (const ShapeType type : {ShapeType::sphere, ShapeType::capsule}) {
    CHECK(rolling_length(type, kPi / 4, rim) == Approx(kRolling * kGrain));
    CHECK(rolling_length(type, kPi / 2, tip) == 0);
    CHECK(rolling_length(type, kPi / 2 + 0.04, tip - 0.003) == 0);
    CHECK(rolling_length(type, kPi / 2 + 0.0667, kRim + kLug / 2) == 0);
  }
}
