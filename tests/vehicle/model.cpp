// What follows from vehicle files, against sums and closed forms.
#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "base/units.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/vehicles.h"
#include "vehicle/model/statics.h"
#include "vehicle/model/track_loop.h"
#include "vehicle/world/engine_vehicle.h"

using namespace gonogo;
using namespace gonogo::test;
using namespace gonogo::vehicle;

namespace {

Eigen::Matrix3d matrix(const Part& p) {
  Eigen::Matrix3d m;
  m << p.moments.x, p.products.x, p.products.y, p.products.x, p.moments.y, p.products.z, p.products.y, p.products.z,
      p.moments.z;
  return m;
}

/// Points with masses that have a part's mass, centre and (rough) shape.
struct Cloud {
  std::vector<double> mass;
  std::vector<Eigen::Vector3d> at;
};

Cloud random_cloud(std::mt19937& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  Cloud c;
  for (int i = 0; i < 6; ++i) {
    c.mass.push_back(1.5 + u(random));
    c.at.emplace_back(u(random), u(random), u(random));
  }
  return c;
}

Part part_of(const Cloud& c) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Part p;
  for (std::size_t i = 0; i < c.mass.size(); ++i) {
    p.mass += c.mass[i];
    centre += c.mass[i] * c.at[i];
  }
  centre /= p.mass;
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < c.mass.size(); ++i) {
    const Eigen::Vector3d d = c.at[i] - centre;
    inertia += c.mass[i] * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
  }
  p.centre = {centre.x(), centre.y(), centre.z()};
  p.moments = {inertia(0, 0), inertia(1, 1), inertia(2, 2)};
  p.products = {inertia(0, 1), inertia(0, 2), inertia(1, 2)};
  return p;
}

/// Way around circles by a polygon of many points on them: gift wrapping by directions.
double sampled_belt(const std::vector<Circle>& circles) {
  const int count = 20000;
  std::vector<std::pair<double, double>> hull;
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * kPi * k / count, x = std::cos(angle), z = std::sin(angle);
    double best = -1e9;
    std::pair<double, double> point;
    for (const Circle& c : circles)
      if (c.x * x + c.z * z + c.radius > best) {
        best = c.x * x + c.z * z + c.radius;
        point = {c.x + c.radius * x, c.z + c.radius * z};
      }
    hull.push_back(point);
  }
  double length = 0;
  for (int k = 0; k < count; ++k) {
    const auto &a = hull[k], &b = hull[(k + 1) % count];
    length += std::hypot(b.first - a.first, b.second - a.second);
  }
  return length;
}

}  // namespace

TEST_CASE("two parts joined have the mass, centre and inertia of their points together") {
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    const Cloud a = random_cloud(random), b = random_cloud(random);
    Cloud both = a;
    both.mass.insert(both.mass.end(), b.mass.begin(), b.mass.end());
    both.at.insert(both.at.end(), b.at.begin(), b.at.end());
    const Part sum = joined(part_of(a), part_of(b)), expected = part_of(both);
    CHECK(std::fabs(sum.mass - expected.mass) < 1e-12);
    CHECK(length(sum.centre - expected.centre) < 1e-13);
    CHECK((matrix(sum) - matrix(expected)).norm() < 1e-12);
  }
}

TEST_CASE("a belt around circles is as long as tangents and arcs say") {
  CHECK(agrees("one circle [m]", 2 * kPi * 0.4, convex_belt_length({{1, 2, 0.4}}), 1e-12));
  CHECK(agrees("two equal circles [m]", 2 * 3 + 2 * kPi * 0.4, convex_belt_length({{0, 0, 0.4}, {3, 0, 0.4}}), 1e-12));
  // Open belt: 2 sqrt(d^2 - (R - r)^2) + R (pi + 2 b) + r (pi - 2 b), sin b = (R - r) / d.
  const double d = 2, big = 0.5, small = 0.2, b = std::asin((big - small) / d);
  CHECK(agrees("open belt [m]", 2 * std::sqrt(d * d - 0.09) + big * (kPi + 2 * b) + small * (kPi - 2 * b),
               convex_belt_length({{0, 0, big}, {0, d, small}}), 1e-12));
  CHECK(agrees("a circle inside another counts for nothing [m]", 2 * kPi,
               convex_belt_length({{0, 0, 1}, {0.2, 0.1, 0.3}}), 1e-12));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> u(0, 1);
  for (int trial = 0; trial < 10; ++trial) {
    std::vector<Circle> circles;
    for (int i = 0; i < 7; ++i) circles.push_back({4 * u(random), u(random), 0.1 + 0.3 * u(random)});
    const double expected = sampled_belt(circles);
    CHECK(agrees("seven circles [m]", expected, convex_belt_length(circles), 1e-6 * expected));
  }
}

TEST_CASE("the HMMWV weighs, stands and runs as its parts say") {
  const Vehicle v = shipped_vehicle("hmmwv");
  const double corner = 5.813 + 23.965 + 19.45 + 14.705 + 18.8 + 37.6 + 6.0;
  CHECK(agrees("mass [kg]", 2086.52 + 3.681 + 1.605 + 4 * corner, weigh(v).total, 1e-9));
  const auto load = static_loads(v);
  const auto wheel = stations(v);
  REQUIRE(load.size() == 4);
  const Weights w = weigh(v);
  // Lever rule about the rear axle; the few kilograms off the middle make left and right differ by their moment.
  const double base = wheel[0].centre.x - wheel[2].centre.x;
  const double front = w.total * kGravity * (w.centre.x - wheel[2].centre.x) / base;
  CHECK(agrees("front axle [N]", front, load[0] + load[1], 1e-6 * front));
  CHECK(agrees("all wheels [N]", w.total * kGravity, load[0] + load[1] + load[2] + load[3], 1e-6));
  CHECK(agrees("moment about x [N m]", w.total * kGravity * w.centre.y,
               load[0] * wheel[0].centre.y + load[1] * wheel[1].centre.y + load[2] * wheel[2].centre.y +
                   load[3] * wheel[3].centre.y,
               1e-6));
  CHECK(agrees("wheelbase, 130 in [m]", 3.302, base, 1e-4));
  CHECK(agrees("track [m]", 2 * 35.815 * kInch, wheel[0].centre.y - wheel[1].centre.y, 1e-4));
  const double published[6] = {4.5, 7.4, 11.1, 16.4, 26.9, 40.6};  // 2700 rpm, rounded
  const auto gears = gear_speeds(v);
  REQUIRE(gears.size() == 6);
  for (int i = 0; i < 6; ++i)
    CHECK(agrees("speed at 2700 rpm in gear " + std::to_string(i + 1) + " [m/s]", published[i], gears[i].cut, 0.05));
  CHECK(agrees("tractive force in gear 1 [N]", 1300.2 / (0.1708 * 0.2) / 0.467, gears[0].tractive_force, 1e-6));
}

TEST_CASE("every shipped vehicle is read, and its parts add up") {
  for (const auto& [name, mass, tolerance] : {std::tuple{"hmmwv", 2597.0, 1.0},
                                              {"m113", 11270.0, 60.0},
                                              {"viper", 440.0, 1e-9},
                                              {"mgru3", 17.5, 1e-9},
                                              {"mgru3_rover", 88.0, 1e-9},
                                              {"fed_alpha", 6351.0, 10.0}}) {
    INFO(name);
    const Vehicle v = shipped_vehicle(name);
    const Assembly a = assemble(v);
    CHECK(agrees(std::string(name) + ", mass [kg]", mass, weigh(v).total, tolerance));
    double sum = 0;
    for (const double load : static_loads(v)) {
      CHECK(load > 0);
      sum += load;
    }
    CHECK(agrees(std::string(name) + ", loads [N]", weigh(v).total * kGravity, sum, 1e-6 * sum));
    // A tree: every body but the chassis has exactly one link that is no loop, from a body listed before it.
    std::vector<int> held(a.body.size(), 0);
    for (const Link& link : a.link) {
      if (!link.loop) {
        ++held[link.child];
        CHECK(link.parent < link.child);
      }
      if (link.type != LinkType::spherical && link.type != LinkType::distance)
        CHECK(std::fabs(length(link.axis) - 1) < 1e-12);
    }
    CHECK(held[0] == 0);
    for (std::size_t i = 1; i < held.size(); ++i) CHECK(held[i] == 1);
    for (const Part& p : a.body) CHECK(p.mass > 0);
  }
}

TEST_CASE("the two sides of an assembly are mirror images") {
  for (const char* name : {"hmmwv", "viper"}) {
    const Vehicle v = shipped_vehicle(name);
    const Assembly a = assemble(v);
    const auto half = (a.body.size() - 1) / 2 / 2;  // bodies of a corner
    for (std::size_t axle = 0; axle < 2; ++axle)
      for (std::size_t i = 0; i < half; ++i) {
        const Part &left = a.body[1 + 2 * axle * half + i], &right = a.body[1 + (2 * axle + 1) * half + i];
        CHECK(left.mass == right.mass);
        CHECK(length(left.centre - Vec3d{right.centre.x, -right.centre.y, right.centre.z}) < 1e-12);
        CHECK(length(left.products - Vec3d{-right.products.x, right.products.y, -right.products.z}) < 1e-12);
      }
  }
}

TEST_CASE("the HMMWV's spring follows its table between the stops and the stops beyond them") {
  const Vehicle v = shipped_vehicle("hmmwv");
  const Spring& s = find_suspension(v, "front").spring;
  CHECK(agrees("at its free length, without stops [N]", 0, s.force(0.339), 1e-9));
  CHECK(agrees("60 mm compressed [N]", 17818.165, s.push(0.279), 1e-6));
  CHECK(agrees("70 mm compressed: half way in the table [N]", (17818.165 + 31840.681) / 2, s.push(0.269), 1e-6));
  CHECK(agrees("10 mm beyond the long stop [N]", s.force(0.31) - 1000, s.push(0.31), 1e-6));
  CHECK(s.push(0.14) > s.push(0.15) + 1000);
}

TEST_CASE("nominal pressures are load over width times radius, or over the track's share of ground") {
  const Vehicle hmmwv = shipped_vehicle("hmmwv"), m113 = shipped_vehicle("m113");
  CHECK(agrees("HMMWV [Pa]", static_loads(hmmwv)[0] / (0.254 * 0.467), contact_pressures(hmmwv)[0], 1e-6));
  double sum = 0;
  for (const double p : contact_pressures(m113)) sum += p / 10;
  CHECK(agrees("M113, mean [Pa]", weigh(m113).total * kGravity / (2 * 0.381 * (3.322 - 0.655)), sum, 1e-6 * sum));
}

TEST_CASE("a quarter vehicle has one driven station, and its share of the payload") {
  const Vehicle v = read_quarter_vehicle(vehicle_path("hmmwv_quarter"));
  const auto wheels = stations(v);
  REQUIRE(wheels.size() == 1);
  CHECK((wheels[0].driven && wheels[0].side == 0));
  CHECK(weigh(v).total == Approx(105.5 + 537.7));
  CHECK(loaded_mass(v, 400) == Approx(105.5 + 537.7 + 100));
  CHECK(weigh(loaded(v, 400)).total == Approx(loaded_mass(v, 400)));
  CHECK(standing_height(v) == Approx(0.467 + 0.02));
  CHECK(largest_drive_torque(v) == 9515);
  CHECK(read_any_vehicle(vehicle_path("hmmwv_quarter")).kind == VehicleKind::quarter);
  CHECK(read_any_vehicle(vehicle_path("hmmwv")).kind == VehicleKind::wheeled);
}

TEST_CASE("a quarter moves along the ground with all of its mass, and its hub moves by itself along the normal") {
  const Vehicle v = loaded(read_quarter_vehicle(vehicle_path("hmmwv_quarter")), 400);
  sim::SceneWorld world;
  const EngineVehicle e = add_vehicle(world, v, {0, 0, 1}, 1);
  const sim::BodyMass &hub = world.mass[std::size_t(e.wheel.front())],
                      &sprung = world.mass[std::size_t(e.bodies.body.front())];
  CHECK(hub.inverse_mass.x == Real(1 / loaded_mass(v, 0)));
  CHECK(hub.inverse_mass.y == hub.inverse_mass.x);
  CHECK(hub.inverse_mass.z == Real(1 / 105.5));
  CHECK((sprung.inverse_mass.x == 0 && sprung.inverse_mass.y == 0));
  CHECK(sprung.inverse_mass.z == Real(1 / (537.7 + 100)));
  CHECK(world.joint.empty());
}
