// Whole vehicles on hard ground in the contact engine against closed forms.
#include <Eigen/Dense>
#include <cmath>

#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/refused.h"
#include "tests/support/scenes.h"
#include "tests/support/vehicles.h"
#include "vehicle/model/engine_vehicle.h"
#include "vehicle/model/statics.h"
#include "vehicle/multibody/vehicle_tree.h"

using namespace gonogo;
using namespace gonogo::test;
using namespace gonogo::vehicle;

namespace {

constexpr int kTyre = 1;

/// A vehicle that stands on a plane whose slope rises along x.
struct Drive {
  sim::SceneWorld world;
  EngineVehicle e;
  double down = 0;  // from the design position to the ground [m]

  Drive(const Vehicle& v, const DriverOrders& orders, double mu, double slope = 0, double speed = 0) {
    world.origin = {-20, -10, -2};
    world.size = {40, 20, 8};
    world.periodic_x = true;
    world.gravity = tilted_gravity(slope);
    world.set_law(0, kTyre, {Real(mu), 0, 0});
    down = standing_height(v);
    e = add_vehicle(world, v, {0, 0, down}, kTyre);
    add_drive(world, v, e, orders);
    for (sim::BodyState& b : world.body) b.velocity = {Real(speed), 0, 0};
    for (std::size_t i = 0; i < e.wheel.size(); ++i)
      world.body[std::size_t(e.wheel[i])].angular_velocity = {0, Real(speed / e.station[i].wheel->radius), 0};
    add_plane(world);
  }
};

/// Tyres without lugs, which would roll like gear wheels on a plane.
Vehicle smooth(Vehicle v) {
  for (Wheel& w : v.wheel) w.lug_count = 0, w.lug_height = 0;
  return v;
}

Vehicle hmmwv() { return smooth(shipped_vehicle("hmmwv")); }

Vehicle all_locked(Vehicle v) {
  for (Axle& a : v.axle) a.differential = Differential::locked;
  v.driveline.centre = Differential::locked;
  return v;
}

std::unique_ptr<sim::Simulation> started(sim::Backend backend, const sim::SceneWorld& world, double step = 1e-3) {
  sim::StepSettings settings = settings_with(50);
  settings.step = Real(step);
  return simulate(backend, world, settings);
}

double speed_of(sim::Simulation& s, const Drive& d) { return s.body(0, d.e.chassis).velocity.x; }

/// Slope that full throttle on a `slope` would just hold, by what is left over for acceleration there.
double gradeability(const Vehicle& v, double mu, double slope) {
  DriverOrders orders;
  orders.release = 0.5;
  const Drive d(v, orders, mu, slope);
  const auto s = started(sim::Backend::cpu, d.world, 2e-3);
  advance_for(*s, 2);  // until the chassis has stopped to rock
  const double before = speed_of(*s, d);
  const double time = 2;
  advance_for(*s, time);
  return std::tan(slope) + (speed_of(*s, d) - before) / time / (test::kGravity * std::cos(slope));
}

}  // namespace

TEST_CASE("a HMMWV with all differentials locked climbs what friction allows: tan(slope) = mu") {
  const Vehicle v = all_locked(hmmwv());
  const double mu = 0.5, limit = std::atan(mu);
  CHECK(agrees("steepest slope, tangent", mu, gradeability(v, mu, limit), 0.02 * mu));
}

TEST_CASE("with an open centre the lighter front axle limits the climb: tan(slope) = 2 mu b / (L + 2 mu h)") {
  Vehicle v = hmmwv();
  for (Axle& a : v.axle) a.differential = Differential::locked;
  const Weights w = weigh(v);
  const auto wheels = stations(v);
  const double front = wheels[0].centre.x, rear = wheels[2].centre.x, base = front - rear;
  const double height = w.centre.z + standing_height(v), mu = 0.5;
  const double limit = std::atan(2 * mu * (w.centre.x - rear) / base / (1 + 2 * mu * height / base));
  CHECK(agrees("steepest slope, tangent", std::tan(limit), gradeability(v, mu, limit), 0.02 * mu));
}

TEST_CASE("the HMMWV's top speed in each gear is that at which the engine's torque vanishes") {
  const Vehicle v = hmmwv();
  const auto gears = gear_speeds(v);
  for (const sim::Backend backend : backends())
    for (const int gear : {1, 2, 3, 4}) {
      const double expected = gears[std::size_t(gear - 1)].balanced;
      DriverOrders orders;
      orders.gear = gear;
      const Drive d(v, orders, 0.9, 0, 0.96 * expected);
      const auto s = started(backend, d.world, 2e-3);
      advance_for(*s, 4);
      CHECK(agrees("top speed in gear " + std::to_string(gear) + " [m/s]", expected, speed_of(*s, d), 0.02 * expected));
    }
}

TEST_CASE("the HMMWV shifts up through its gears and is in the one that its speed asks for") {
  const Vehicle v = hmmwv();
  const Drive d(v, {}, 0.9);
  const auto s = started(sim::Backend::cpu, d.world, 2e-3);
  advance_for(*s, 4);
  const sim::DrivelineState now = s->snapshot(0).element.driveline.at(0);
  CHECK(now.gear >= 2);
  CHECK(now.engine_speed < 1.02 * v.driveline.up_speed);
  const double shaft = speed_of(*s, d) / 0.467;
  CHECK(agrees("engine speed from the road's [rad/s]", shaft * d.world.driveline[0].ratio[int(now.gear)],
               now.engine_speed, 0.03 * now.engine_speed));
}

TEST_CASE("the HMMWV stops with locked wheels within v^2 / (2 mu g)") {
  for (const sim::Backend backend : backends()) {
    const double speed = 20, mu = 0.4;
    DriverOrders orders;
    orders.brake_from = 0.2;
    orders.speed = speed;  // held until then
    orders.gear = 5;
    Drive d(hmmwv(), orders, mu, 0, speed);
    sim::Monitor m;
    m.body = d.e.chassis;
    m.time_limit = 10;
    d.world.monitor.push_back(m);
    const auto s = started(backend, d.world);
    advance_for(*s, 0.2);
    const double from = s->monitor(0, 0).now.x, before = speed_of(*s, d);
    advance_for(*s, 5.5);
    CHECK(std::fabs(speed_of(*s, d)) < 0.02);
    const double expected = before * before / (2 * mu * test::kGravity);
    CHECK(agrees("stopping distance [m]", expected, s->monitor(0, 0).now.x - from, 0.02 * expected));
  }
}

TEST_CASE("a driver who holds a speed brings the HMMWV to it and keeps it there") {
  DriverOrders orders;
  orders.release = 0.3;
  orders.throttle_ramp = 1;
  orders.speed = 3;
  const Drive d(hmmwv(), orders, 0.8, 10 * kPi / 180);
  const auto s = started(sim::Backend::cpu, d.world, 2e-3);
  advance_for(*s, 0.3);
  CHECK(std::fabs(speed_of(*s, d)) < 0.05);  // brakes on
  advance_for(*s, 8);
  CHECK(agrees("speed held up a slope of 10 deg [m/s]", 3, speed_of(*s, d), 0.1));
}

TEST_CASE("an open axle spins its wheel on ice, a limited-slip one pulls by its bias, a locked one turns both alike") {
  // Rear-wheel drive on level ground, left wheels on ice: T_right / T_left <= bias with T_left = mu_ice N r.
  const double mu_ice = 0.1, mu = 0.8;
  const auto pull = [&](Differential differential, double bias) {
    Vehicle v = hmmwv();
    v.axle[0].driven = false;
    v.axle[1].differential = differential;
    v.axle[1].torque_bias = bias;
    DriverOrders orders;
    orders.release = 0.5;
    orders.gear = 1;
    Drive d(v, orders, mu);
    for (sim::Shape& s : d.world.shape)
      if (s.body == d.e.wheel[2]) s.material = 2;
    d.world.set_law(0, 2, {Real(mu_ice), 0, 0});
    const auto s = started(sim::Backend::cpu, d.world);
    advance_for(*s, 3);
    double force = 0;
    for (int k = 0; k < 50; ++k) {
      s->advance(5);
      for (const int i : {2, 3}) force += s->contact_force(0, d.e.wheel[std::size_t(i)]).x / 50;
    }
    const auto spin = [&](std::size_t i) { return double(s->body(0, d.e.wheel[i]).angular_velocity.y); };
    if (differential == Differential::locked)
      CHECK(agrees("left wheel of a locked axle [rad/s]", spin(3), spin(2), 0.01 * spin(3)));
    return force;
  };
  const double open = pull(Differential::open, 1), slip = pull(Differential::limited_slip, 3);
  pull(Differential::locked, 1);
  CHECK(agrees("pull with bias 3 over pull when open", 2, slip / open, 0.2));
}

namespace {

/// Heights of the chassis over the axles, from its pose.
Eigen::Vector2d heights(sim::Simulation& s, const Drive& d, const Vec3d& centre, const sim::BodyState& start) {
  const sim::BodyState b = s.body(0, d.e.chassis);
  const auto z = [&](double x) {
    const Vec3 at{Real(x - centre.x), 0, Real(-centre.z)};
    return b.position.z + double(rotate(b.orientation, rotate_back(start.orientation, at)).z);
  };
  return {z(d.e.station[0].centre.x), z(d.e.station[2].centre.x)};
}

}  // namespace

namespace {

/// What of a corner rests on the ground without the spring: wheel, upright, half of the tie rod, and of the arms, which
/// turn about their inner ends, the share of their weight that their ball joints carry [kg].
constexpr double kUnsprung = 71.105 + 19.45 + 3 + 0.5 * (5.813 + 23.965);

/// Inverse inertia that vertical forces on the chassis over its axles meet, from the vehicle in reduced coordinates
/// whose wheels may not leave the ground, nor turn: H N (N^T M N)^-1 N^T H^T with N spanning what loops and ground
/// leave free [1/kg].
Eigen::Matrix2d inertia_over_axles(const Vehicle& vehicle) {
  using namespace multibody;
  const Assembly a = assemble(vehicle);
  const VehicleTree t = vehicle_tree(a);
  const VectorX q = t.tree.zero_position(), rest = VectorX::Zero(t.tree.velocity_count());
  const Kinematics k = kinematics(t.tree, q, rest);
  const MatrixX loops = loop_equations(t.tree, t.loop, k, rest).jacobian;
  MatrixX held(loops.rows() + 8, loops.cols());
  held.topRows(loops.rows()) = loops;
  const auto wheels = stations(vehicle);
  for (int i = 0; i < 4; ++i) {
    const int body = a.wheel[std::size_t(i)];
    held.row(loops.rows() + i) = point_jacobian(t.tree, k, body, t.local(body, wheels[std::size_t(i)].centre)).row(2);
    held.row(loops.rows() + 4 + i).setZero();
    held(loops.rows() + 4 + i, t.axle[std::size_t(i)]) = 1;
  }
  const MatrixX free = held.fullPivLu().kernel();
  const MatrixX mass = mass_matrix_by_composites(t.tree, q);
  MatrixX over(2, loops.cols());
  for (int i = 0; i < 2; ++i) {
    const Vec3d at{wheels[std::size_t(2 * i)].centre.x, 0, 0};
    over.row(i) = point_jacobian(t.tree, k, 0, t.local(0, at)).row(2);
  }
  const MatrixX reach = over * free;
  return reach * (free.transpose() * mass * free).llt().solve(reach.transpose());
}

/// Wheels as spheres: they touch where their middle planes do, whatever their camber.
void round_wheels(Drive& d) {
  for (sim::Shape& s : d.world.shape)
    if (s.type == sim::ShapeType::cylinder) s.type = sim::ShapeType::sphere;
}

}  // namespace

TEST_CASE("the HMMWV's heave and pitch frequencies are those of its mass on its static wheel rates") {
  Vehicle v = hmmwv();
  Drive damped(v, {100, 0, 0, 1e9, 0}, 0);  // frictionless ground: wheels are free to track out
  round_wheels(damped);
  const Vec3d centre = assemble(v).body[0].centre;
  const auto height_at = [&](double factor) {
    sim::SceneWorld w = damped.world;
    w.gravity = w.gravity * Real(factor);
    const auto s = started(sim::Backend::cpu, w);
    advance_for(*s, 3);
    return heights(*s, damped, centre, damped.world.body[std::size_t(damped.e.chassis)]);
  };
  // Static: a change of gravity changes the axle loads, the heights answer.
  const double change = 0.05;
  const Eigen::Vector2d low = height_at(1 + change), high = height_at(1 - change), middle = height_at(1);
  const auto load = static_loads(v);
  Eigen::Vector2d rate;  // of an axle: its load beyond that of what does not move with the chassis, over the height
  for (int a = 0; a < 2; ++a)
    rate(a) = 2 * change * (load[std::size_t(2 * a)] + load[std::size_t(2 * a + 1)] - 2 * kUnsprung * test::kGravity) /
              (high(a) - low(a));
  const Eigen::Matrix2d inertia = inertia_over_axles(v).inverse(), stiffness = rate.asDiagonal();
  const Eigen::Vector2d expected =
      Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d>(stiffness, inertia).eigenvalues().cwiseSqrt();

  // Dynamic: without dampers, from the rest under a little less gravity.
  for (Suspension& s : v.suspension) s.damper.force = {};
  Drive free(v, {100, 0, 0, 1e9, 0}, 0);
  round_wheels(free);
  {
    sim::SceneWorld w = damped.world;
    w.gravity = w.gravity * Real(1 - change);
    const auto s = started(sim::Backend::cpu, w);
    advance_for(*s, 3);
    auto rest = s->bodies(0);
    for (std::size_t i = 0; i < rest.size(); ++i) {
      free.world.body[i].position = rest[i].position;
      free.world.body[i].orientation = rest[i].orientation;
    }
  }
  const auto s = started(sim::Backend::cpu, free.world, 5e-4);
  const Index stride = 10;
  const double dt = stride * 5e-4;
  std::vector<Eigen::Vector2d> z;
  for (int k = 0; k < 250; ++k) {
    z.push_back(heights(*s, free, centre, damped.world.body[std::size_t(free.e.chassis)]) - middle);
    s->advance(stride);
  }
  // z'' = -A z - C z' + b by least squares; 2 (cos(w dt) - 1) / dt^2 are the eigenvalues of -A.
  Eigen::MatrixXd state(Eigen::Index(z.size()) - 2, 5), second(state.rows(), 2);
  for (Eigen::Index k = 0; k < state.rows(); ++k) {
    const auto i = std::size_t(k) + 1;
    state.row(k) << z[i].transpose(), (z[i + 1] - z[i - 1]).transpose() / (2 * dt), 1;
    second.row(k) = ((z[i + 1] - 2 * z[i] + z[i - 1]) / (dt * dt)).transpose();
  }
  const Eigen::MatrixXd fit = state.colPivHouseholderQr().solve(second);
  Eigen::Vector2d found = Eigen::EigenSolver<Eigen::Matrix2d>(Eigen::Matrix2d(-fit.topRows(2))).eigenvalues().real();
  for (int m = 0; m < 2; ++m) found(m) = std::acos(1 - found(m) * dt * dt / 2) / dt;
  if (found(0) > found(1)) std::swap(found(0), found(1));
  for (int m = 0; m < 2; ++m)
    CHECK(agrees("suspension frequency " + std::to_string(m) + " [Hz]", expected(m) / (2 * kPi), found(m) / (2 * kPi),
                 0.05 * expected(m) / (2 * kPi)));
}

TEST_CASE("vehicles that the engine cannot drive are refused with the reason") {
  sim::SceneWorld w;
  refused([&] { add_vehicle(w, shipped_vehicle("m113"), {}, 1); }, "tracks");
  Vehicle v = hmmwv();
  v.driveline.centre = Differential::locked;
  refused([&] { Drive(v, {}, 0.9); }, "centre differential");
  v = hmmwv();
  v.driveline.converter = {{0, 1}, {2, 1}};
  refused([&] { Drive(v, {}, 0.9); }, "capacity");
}
