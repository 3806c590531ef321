// Feasibility against closed forms of gradeability, tipping and torque, and against brute force.
#include "vehicle/feasible/feasible.h"

#include <cmath>
#include <random>

#include <Eigen/Dense>

#include "base/units.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/refused.h"
#include "tests/support/vehicles.h"
#include "tests/vehicle/on_slope.h"
#include "vehicle/family/driveline_share.h"
#include "vehicle/model/statics.h"

using namespace gonogo;
using namespace gonogo::test;
using namespace gonogo::vehicle;

namespace {

/// Largest slope along that is feasible, by bisection [deg].
double steepest(const Vehicle& v, double across, double friction, bool moving = true) {
  double low = 0, high = 80;
  for (int i = 0; i < 24; ++i) {
    const double middle = 0.5 * (low + high);
    (feasible(v, on_slope(middle, across, friction, moving)).feasible ? low : high) = middle;
  }
  return low;
}

Vehicle hmmwv(Differential axles, Differential centre, bool front = true, bool rear = true) {
  Vehicle v = shipped_vehicle("hmmwv");
  v.axle[0].driven = front;
  v.axle[1].driven = rear;
  for (Axle& a : v.axle) a.differential = axles;
  v.driveline.centre = centre;
  return v;
}

/// Lengths of the bicycle model [m]: centre of mass ahead of the rear axle, behind the front one, above the ground.
struct Bicycle {
  double to_rear, to_front, height, base;
  explicit Bicycle(const Vehicle& v) {
    const auto wheels = stations(v);
    const Weights w = weigh(v);
    to_rear = w.centre.x - wheels[2].centre.x;
    to_front = wheels[0].centre.x - w.centre.x;
    height = w.centre.z - w.ground;
    base = to_rear + to_front;
  }
};

double degrees(double tangent) { return std::atan(tangent) / kDegree; }

/// Whether the planar vehicle whose front (or rear) wheels are on the step's edge balances, by trying every ratio of
/// the other axle's forces.
bool balances(const Eigen::Vector2d& climber, const Eigen::Vector2d& other, const Eigen::Vector2d& centre,
              const Eigen::Vector2d& normal, double radius, double mu) {
  const Eigen::Vector2d tangent(normal.y(), -normal.x()), at = climber - radius * normal,
                                                          ground = other - Eigen::Vector2d(0, radius);
  const auto moment = [&](const Eigen::Vector2d& point, const Eigen::Vector2d& force) {
    const Eigen::Vector2d arm = point - centre;
    return arm.x() * force.y() - arm.y() * force.x();
  };
  for (int i = 0; i <= 4000; ++i) {
    const double ratio = mu * (2.0 * i / 4000 - 1);
    const Eigen::Vector2d rolling(ratio, 1);
    Eigen::MatrixXd m(3, 3);
    m.col(0) << normal, moment(at, normal);
    m.col(1) << tangent, moment(at, tangent);
    m.col(2) << rolling, moment(ground, rolling);
    Eigen::VectorXd weight(3);
    weight << 0, 1, 0;
    const Eigen::VectorXd f = m.fullPivLu().solve(weight);
    if (f(0) >= 0 && f(2) >= 0 && std::fabs(f(1)) <= mu * f(0)) return true;
  }
  return false;
}

/// Both axles of a vehicle with equal loads and drive on all wheels, from the foot of a step to its top.
bool climbs_by_brute_force(const Vehicle& v, double step, double mu) {
  const Bicycle b(v);
  const double radius = stations(v)[0].wheel->radius;
  for (const bool front : {true, false})
    for (int i = 0; i <= 24; ++i) {
      const double rise = step * i / 24, up_front = front ? rise : step, up_rear = front ? 0 : rise;
      const double pitch = std::asin((up_front - up_rear) / b.base);
      const Eigen::Vector2d forward(std::cos(pitch), std::sin(pitch)), upward(-std::sin(pitch), std::cos(pitch));
      const Eigen::Vector2d rear(0, radius + up_rear), ahead = rear + b.base * forward;
      const Eigen::Vector2d centre = rear + b.to_rear * forward + (b.height - radius) * upward;
      const double above = radius + rise - step;
      const Eigen::Vector2d normal =
          above <= 0 ? Eigen::Vector2d(-1, 0)
                     : Eigen::Vector2d(-std::sqrt(std::max(0.0, radius * radius - above * above)), above) / radius;
      if (!balances(front ? ahead : rear, front ? rear : ahead, centre, normal, radius, mu)) return false;
    }
  return true;
}

}  // namespace

TEST_CASE("gradeability limited by friction is that of the bicycle model") {
  using enum Differential;
  for (const double mu : {0.3, 0.6, 0.9}) {
    const Bicycle b(shipped_vehicle("hmmwv"));
    const std::string at = "mu " + short_text(mu) + ", ";
    // The load's millimetre off the middle makes left and right differ a little.
    CHECK(agrees(at + "4 x 4 locked [deg]", degrees(mu), steepest(hmmwv(locked, locked), 0, mu), 0.02));
    CHECK(agrees(at + "rear drive [deg]", degrees(mu * b.to_front / (b.base - mu * b.height)),
                 steepest(hmmwv(locked, locked, false, true), 0, mu), 0.02));
    CHECK(agrees(at + "front drive [deg]", degrees(mu * b.to_rear / (b.base + mu * b.height)),
                 steepest(hmmwv(locked, locked, true, false), 0, mu), 0.02));
    // Equal torques everywhere: the front axle, which the slope unloads, spins first.
    const double half = mu * b.to_rear / b.base / (0.5 + mu * b.height / b.base);
    CHECK(agrees(at + "4 x 4 open [deg]", degrees(half), steepest(hmmwv(open, open), 0, mu), 0.02));
    CHECK(limiting_cause(hmmwv(open, open), on_slope(degrees(half) + 0.1, 0, mu)) == "traction");
    CHECK(agrees(at + "least friction for 10 degrees, locked", std::tan(10 * kDegree),
                 min_friction(hmmwv(locked, locked), on_slope(10, 0, mu)), 1e-4));
  }
}

TEST_CASE("a vehicle tips where its centre of mass leaves its wheels") {
  const Vehicle v = hmmwv(Differential::locked, Differential::locked);
  const Bicycle b(v);
  const double half_track = stations(v)[0].centre.y;
  for (const double past : {-0.1, 0.1}) {
    const bool holds = past < 0;
    const double back = degrees(b.to_rear / b.height), over = degrees((half_track - weigh(v).centre.y) / b.height);
    CHECK((feasible(v, on_slope(back + past, 0, 50, false), {true, false}).reserve > -1e-7) == holds);
    CHECK((feasible(v, on_slope(0, -over - past, 50, false), {true, false}).reserve > -1e-7) == holds);
    if (!holds) CHECK(limiting_cause(v, on_slope(0, -over - past, 50, false)) == "tip-over");
  }
  CHECK(limiting_cause(v, on_slope(0, 30, 0.5, false)) == "traction");
}

TEST_CASE("the centre of pressure is where gravity through the centre of mass meets the plane") {
  const Vehicle v = shipped_vehicle("hmmwv");
  const Weights w = weigh(v);
  const auto wheels = stations(v);
  const double height = w.centre.z - w.ground;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> slope(-25, 25);
  for (int trial = 0; trial < 20; ++trial) {
    Demand d = on_slope(slope(random), slope(random), 2, false);
    const Feasibility f = feasible(v, d);
    REQUIRE(f.pressure);
    const double x = w.centre.x - height * d.gravity.x / d.gravity.z,
                 y = w.centre.y - height * d.gravity.y / d.gravity.z;
    CHECK(f.pressure->x == Approx(x).margin(1e-6));
    CHECK(f.pressure->y == Approx(y).margin(1e-6));
    // Wheels in pairs, left first: front, rear.
    const double front = wheels[0].centre.x, rear = wheels[2].centre.x, half_front = std::fabs(wheels[0].centre.y),
                 half_rear = std::fabs(wheels[2].centre.y), rise = (half_front - half_rear) / (front - rear);
    const double side = (half_rear + rise * (x - rear) - std::fabs(y)) / std::hypot(1, rise);
    const double edge = std::min({front - x, x - rear, side});
    CHECK(f.pressure->edge == Approx(edge).margin(1e-6));
    d.edge_distance = 1.01 * edge;
    CHECK(limiting_cause(v, d) == "centre of pressure");
    d.edge_distance = 0.99 * edge;
    CHECK(feasible(v, d).feasible == f.feasible);
  }
  Demand bad = on_slope(0, 0, 1);
  bad.edge_distance = 0.1;
  bad.step = 0.1;
  refused([&] { feasible(v, bad); }, "for a plane");
}

TEST_CASE("a parked vehicle holds exactly where the slope is in the cone and the weight between the wheels") {
  const Vehicle v = hmmwv(Differential::open, Differential::open);
  const auto wheels = stations(v);
  const Weights w = weigh(v);
  std::mt19937 random(23);
  std::uniform_real_distribution<double> u(-1, 1);
  int held = 0, counted = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const double mu = 0.2 + 0.9 * std::fabs(u(random));
    const Demand d = on_slope(60 * u(random), 60 * u(random), mu, false);
    const double slope = std::hypot(d.gravity.x, d.gravity.y) / -d.gravity.z, height = w.centre.z - w.ground;
    const double x = w.centre.x + height * d.gravity.x / -d.gravity.z,
                 y = w.centre.y + height * d.gravity.y / -d.gravity.z;
    const double inside =
        std::min({wheels[0].centre.x - x, x - wheels[2].centre.x, wheels[0].centre.y - y, y - wheels[1].centre.y});
    if (std::fabs(slope - mu) < 1e-4 || std::fabs(inside) < 1e-4) continue;
    const bool expected = slope < mu && inside > 0;
    ++counted;
    held += expected;
    CHECK((feasible(v, d, {true, false}).reserve > -1e-7) == expected);
  }
  CHECK(held > 30);
  CHECK(counted - held > 30);
}

TEST_CASE("torque limits bind where the weight's part along the slope needs more") {
  // FED-Alpha: 23 kN in the lowest gear under 62 kN.
  const Vehicle alpha = shipped_vehicle("fed_alpha");
  const double weight = weigh(alpha).total * kGravity;
  const double max = std::asin(gear_speeds(alpha)[0].tractive_force / weight) / kDegree;
  CHECK(agrees("FED-Alpha on much friction [deg]", max, steepest(alpha, 0, 2), 1e-3));
  CHECK(limiting_cause(alpha, on_slope(max + 0.2, 0, 2)) == "torque");
  CHECK(agrees("share of the torque on 10 degrees", std::sin(10 * kDegree) / std::sin(max * kDegree),
               min_torque_share(alpha, on_slope(10, 0, 2)), 1e-5));
  Vehicle weak = shipped_vehicle("hmmwv");
  for (Axle& a : weak.axle) a.brake_torque = 500;
  const double held = std::asin(4 * 500 / 0.467 / (weigh(weak).total * kGravity)) / kDegree;
  CHECK(agrees("HMMWV held by brakes of 500 N m [deg]", held, steepest(weak, 0, 0.9, false), 1e-3));
  // Tracks: the sprockets' torque over their radius.
  const Vehicle m113 = shipped_vehicle("m113");
  const double force = largest_drive_torque(m113) / m113.track->sprocket_radius;
  CHECK(agrees("M113 on much friction [deg]", std::asin(force / (weigh(m113).total * kGravity)) / kDegree,
               steepest(m113, 0, 2), 0.01));
  CHECK(agrees("M113 on little friction [deg]", degrees(0.2), steepest(m113, 0, 0.2), 0.1));
  CHECK(agrees("single wheel [deg]", degrees(0.5), steepest(shipped_vehicle("mgru3"), 0, 0.5), 1e-3));
}

TEST_CASE("the forces of an answer balance weight, moments and torques, inside cones and limits") {
  const Vehicle v = shipped_vehicle("hmmwv");
  const auto wheels = stations(v);
  const Weights w = weigh(v);
  const Demand d = on_slope(14, -9, 0.8);
  const Feasibility f = feasible(v, d);
  REQUIRE(f.feasible);
  REQUIRE(f.contact.size() == 4);
  Vec3d force = d.gravity * w.total, moment;
  double torque = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const ContactForce& c = f.contact[i];
    const Vec3d on{c.along, c.across, c.normal};
    const Vec3d at = Vec3d{wheels[i].centre.x, wheels[i].centre.y, w.ground} - w.centre;
    force += on;
    moment += cross(at, on);
    CHECK(std::hypot(c.along, c.across) <= 0.8 * c.normal + 1e-4);
    CHECK(agrees("torque of " + f.unit[i] + " [N m]", c.along * 0.467, f.torque[i], 1e-3));
    torque += f.torque[i];
  }
  CHECK(length(force) < 1e-3);
  CHECK(length(moment) < 1e-3);
  CHECK(torque < largest_drive_torque(v));
  CHECK(agrees("an open centre shares equally [N m]", f.torque[0] + f.torque[1], f.torque[2] + f.torque[3], 1e-3));
  for (const std::size_t axle : {0, 2}) {
    const auto [min, max] = std::minmax(f.torque[axle], f.torque[axle + 1]);
    CHECK(max <= v.axle[axle / 2].torque_bias * min + 1e-3);
  }
}

TEST_CASE("limited slip lies between open and locked differentials") {
  using enum Differential;
  const Demand d = on_slope(12, 25, 0.6);
  const auto reserve = [&](Differential kind, double bias) {
    Vehicle v = hmmwv(kind, locked);
    for (Axle& a : v.axle) a.torque_bias = bias;
    return feasible(v, d).reserve;
  };
  const double none = reserve(open, 1), all = reserve(locked, 1), some = reserve(limited_slip, 2);
  CHECK(none < some - 1e-4);
  CHECK(some < all - 1e-4);
  CHECK(std::fabs(reserve(limited_slip, 1) - none) < 1e-6);
  CHECK(std::fabs(reserve(limited_slip, 100) - all) < 1e-4);
}

TEST_CASE("steps are climbed where brute force finds forces for every height of the axle") {
  Vehicle v = shipped_vehicle("viper");
  int climbed = 0, refused_count = 0;
  for (const double mu : {0.35, 0.5, 0.7, 0.9, 1.2})
    for (const double step : {0.02, 0.05, 0.08, 0.12, 0.16, 0.2, 0.24}) {
      Demand d;
      d.friction = mu;
      d.step = step;
      const Feasibility f = feasible(v, d, {true, false});
      if (std::fabs(f.reserve) < 2e-3) continue;  // brute force has a grid
      const bool expected = climbs_by_brute_force(v, step, mu);
      INFO("mu " << mu << " step " << step << " reserve " << f.reserve);
      CHECK((f.reserve > 0) == expected);
      ++(expected ? climbed : refused_count);
    }
  CHECK(climbed > 5);
  CHECK(refused_count > 5);
  Demand high;
  high.friction = 5;
  high.step = 0.4;
  CHECK(needed_clearance(v, 0.4) > v.clearance - 0.3);
  v.clearance = 0.01;
  high.step = 0.2;
  CHECK(limiting_cause(v, high) == "belly");
}

TEST_CASE("accelerating needs the force of the mass and of the wheels' spin") {
  const Vehicle v = hmmwv(Differential::locked, Differential::locked);
  Demand d = on_slope(0, 0, 0.9);
  d.acceleration = 2;
  const Feasibility f = feasible(v, d);
  double along = 0, torque = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    along += f.contact[i].along;
    torque += f.torque[i];
  }
  CHECK(agrees("sum of forces [N]", weigh(v).total * 2, along, 1e-3));
  const double spin = 4 * (0.07352 + 0.6243 + 6.69) * 2 / 0.467;
  CHECK(agrees("sum of torques [N m]", along * 0.467 + spin, torque, 1e-2));
}

TEST_CASE("questions that cannot be are refused") {
  Demand d;
  d.step = 0.1;
  refused([&] { feasible(shipped_vehicle("m113"), d); }, "two axles");
  d.step = -0.1;
  refused([&] { feasible(shipped_vehicle("hmmwv"), d); }, "at least 0");
  d.step = 5;
  refused([&] { feasible(shipped_vehicle("hmmwv"), d); }, "wheelbase");
  d.step = 0;
  d.friction = 0;
  refused([&] { feasible(shipped_vehicle("hmmwv"), d); }, "friction");
}

TEST_CASE("a driveline needs the friction of the slope that it feels, by the convex program of its forces") {
  struct Case {
    const char* vehicle;
    Differential centre;
    double front_share;
  };
  for (const Case& c : {Case{"hmmwv", Differential::open, 0.5}, Case{"hmmwv", Differential::open, 0.4},
                        Case{"hmmwv", Differential::locked, 0.5}, Case{"fed_alpha", Differential::open, 0.5},
                        Case{"viper", Differential::open, 0.5}})
    for (const double slope : {4.0, 10.0, 17.0}) {
      INFO(c.vehicle << ", front " << c.front_share << ", " << slope << " deg");
      Vehicle v = shipped_vehicle(c.vehicle);
      v.driveline.centre = c.centre;
      v.driveline.front_share = c.front_share;
      const VehicleNumbers n = vehicle_numbers(v, kGravity);
      const double own = to_radians(slope), felt = felt_slope(v, n, own);
      CHECK(std::tan(felt) == Approx(min_friction(v, on_slope(slope, 0, 0.8))).epsilon(0.01));
      CHECK(own_slope(v, n, felt) == Approx(own).epsilon(1e-9));
    }
}

TEST_CASE("an axle without drive only rides along, and downhill a slope is what it is") {
  const VehicleNumbers n = vehicle_numbers(shipped_vehicle("hmmwv"), kGravity);
  const Vehicle rear_driven = hmmwv(Differential::open, Differential::open, false);
  CHECK(driveline_share(rear_driven, n, 0) == Approx(axle_shares(n, 0)[1]));
  CHECK(driveline_share(rear_driven, n, 0.3) > driveline_share(rear_driven, n, 0));  // it bears more uphill
  CHECK(felt_slope(rear_driven, n, -0.2) == -0.2);
  CHECK(felt_slope(shipped_vehicle("viper"), n, 0.2) == 0.2);  // a motor in every wheel
}
