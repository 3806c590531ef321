#include "vehicle/hard_ground/hard_ground.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/units.h"
#include "vehicle/model/statics.h"
#include "vehicle/multibody/vehicle_tree.h"

namespace gonogo::vehicle {
namespace {

constexpr int kTyre = 1;          // material
constexpr double kClosed = 0.02;  // tolerance, relative
constexpr double kPeriod = 40;    // of the plane along x [m]

void add_plane(sim::SceneWorld& world) {
  sim::Shape s;
  s.type = sim::ShapeType::plane;
  s.body = world.add_body({}, sim::fixed_body());
  world.add_shape(s);
}

std::string per_cent(double x) { return std::to_string(int(std::lround(100 * x))); }

/// Means while the wheels spin.
struct Climb {
  double tangent = 0;                     // of the slope that would just be held
  double base = 0, rear = 0, height = 0;  // wheelbase; centre of mass before the rear axle, over the ground [m]
};

/// Adds where the vehicle's masses are now: on a slope it squats, the springs of its front axle extend.
void add_pose(sim::Simulation& s, const HardGround& ground, double share, Climb& c) {
  const auto bodies = s.bodies(0);
  double mass = 0, x = 0, z = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const double inverse = ground.world.mass[i].inverse_mass.x;
    if (!(inverse > 0)) continue;
    mass += 1 / inverse;
    x += bodies[i].position.x / inverse;
    z += bodies[i].position.z / inverse;
  }
  const auto axle = [&](std::size_t left) {
    return 0.5 * (bodies[std::size_t(ground.e.wheel[left])].position.x +
                  bodies[std::size_t(ground.e.wheel[left + 1])].position.x);
  };
  const double rear = axle(ground.e.wheel.size() - 2);
  c.base += share * (axle(0) - rear);
  c.rear += share * (x / mass - rear);
  c.height += share * z / mass;
}

/// Full throttle on `slope`; what is left for acceleration tells which slope it would hold. In the lowest gear, because
/// a driver who shifts up ends where the engine, not the ground, is the limit. The wheels hop: hence the long mean.
Climb full_throttle(const Vehicle& v, double mu, double slope, const HardGroundRun& run, Trace& trace) {
  constexpr double settled = 2, time = 6, every = 0.02;  // [s]
  const int samples = int(std::lround(time / every));
  DriverOrders orders{.release = 0.5, .gear = 1};
  const HardGround ground(v, orders, mu, slope);
  const auto s = start(ground, run, 2e-3);
  run_for(*s, settled);
  const double before = forward_speed(*s, ground);
  Climb c;
  for (int k = 0; k < samples; ++k) {
    run_for(*s, every);
    add_pose(*s, ground, 1.0 / samples, c);
    trace.add(settled + (k + 1) * every, forward_speed(*s, ground));
  }
  c.tangent = std::tan(slope) + (forward_speed(*s, ground) - before) / time / (kGravity * std::cos(slope));
  return c;
}

/// With balanced torques T = mu N r of both axles, N that of the front one: N L = m g (b cos - h sin).
double open_centre_limit(double mu, double base, double rear, double height) {
  return 2 * mu * rear / base / (1 + 2 * mu * height / base);
}

/// The same vehicle with all differentials locked.
Vehicle all_locked(Vehicle v) {
  for (Axle& a : v.axle) a.differential = Differential::locked;
  v.driveline.centre = Differential::locked;
  return v;
}

// Heave and pitch.

constexpr double kGravityChange = 0.05;  // relative, of the experiments
constexpr double kStep = 5e-4;           // of the free oscillation [s]
constexpr Index kStride = 10;            // steps between samples
constexpr int kSamples = 250;

/// Mass of an axle that rests on the ground without its springs: wheels, uprights, half of the tie rods, and half of
/// the arms, which turn about their inner ends [kg].
double unsprung_of_axle(const std::vector<Station>& wheels, int axle) {
  double sum = 0;
  for (const Station& s : wheels) {
    if (s.axle != axle) continue;
    sum += s.wheel->part.mass + 0.5 * s.suspension->tie_rod_mass;
    for (const auto& [name, part] : s.suspension->part) sum += (name == "upright" ? 1 : 0.5) * part.mass;
  }
  return sum;
}

/// One station of each of two axles.
std::array<Station, 2> axles_of(const Vehicle& v) {
  const auto wheels = stations(v);
  if (wheels.size() != 4 || wheels.front().axle == wheels.back().axle)
    throw InputError("vehicle " + v.name + " has no two axles of two wheels; its heave and pitch have no closed form");
  return {wheels.front(), wheels.back()};
}

/// Inverse inertia seen by vertical forces on the chassis over its axles, from the vehicle in reduced coordinates
/// whose wheels may not leave the ground, nor turn: H N (N^T M N)^-1 N^T H^T with N spanning what loops and ground
/// leave free [1/kg].
Eigen::Matrix2d inertia_over_axles(const Vehicle& vehicle) {
  using namespace multibody;
  const Assembly a = assemble(vehicle);
  const VehicleTree t = vehicle_tree(a);
  const VectorX q = t.tree.zero_position(), rest = VectorX::Zero(t.tree.velocity_count());
  const Kinematics k = kinematics(t.tree, q, rest);
  const MatrixX loops = loop_equations(t.tree, t.loop, k, rest).jacobian;
  const auto wheels = stations(vehicle);
  const auto count = Eigen::Index(wheels.size());
  MatrixX held = MatrixX::Zero(loops.rows() + 2 * count, loops.cols());
  held.topRows(loops.rows()) = loops;
  for (Eigen::Index i = 0; i < count; ++i) {
    const int body = a.wheel[std::size_t(i)];
    held.row(loops.rows() + i) = point_jacobian(t.tree, k, body, t.local(body, wheels[std::size_t(i)].centre)).row(2);
    held(loops.rows() + count + i, t.axle[std::size_t(i)]) = 1;
  }
  const MatrixX free = held.fullPivLu().kernel();
  const MatrixX mass = mass_matrix_by_composites(t.tree, q);
  MatrixX over(2, loops.cols());
  const auto axles = axles_of(vehicle);
  for (int i = 0; i < 2; ++i) {
    const Vec3d at{axles[std::size_t(i)].centre.x, 0, 0};
    over.row(i) = point_jacobian(t.tree, k, 0, t.local(0, at)).row(2);
  }
  const MatrixX reach = over * free;
  return reach * (free.transpose() * mass * free).llt().solve(reach.transpose());
}

/// The vehicle on frictionless ground, where wheels are free to track out; its wheels as spheres, which touch where
/// their middle planes do, whatever their camber.
struct Shaker {
  HardGround ground;
  Vec3d centre;  // of the chassis's mass, in the vehicle's frame [m]
  std::array<Station, 2> axle;

  explicit Shaker(const Vehicle& v)
      : ground(v, {100, 0, 0, 1e9, 0}, 0), centre(assemble(v).body[0].centre), axle(axles_of(v)) {
    for (sim::Shape& s : ground.world.shape)
      if (s.type == sim::ShapeType::cylinder) s.type = sim::ShapeType::sphere;
  }

  /// Heights of the chassis over the axles, from its pose [m].
  Eigen::Vector2d heights(sim::Simulation& s) const {
    const sim::BodyState b = s.body(0, ground.e.chassis);
    const Quat& start = ground.world.body[std::size_t(ground.e.chassis)].orientation;
    const auto z = [&](double x) {
      const Vec3 at{Real(x - centre.x), 0, Real(-centre.z)};
      return b.position.z + double(rotate(b.orientation, rotate_back(start, at)).z);
    };
    return {z(axle[0].centre.x), z(axle[1].centre.x)};
  }

  /// At rest under `factor` times gravity.
  std::unique_ptr<sim::Simulation> rested(double factor, const HardGroundRun& run) const {
    HardGround g = ground;
    g.world.gravity = g.world.gravity * Real(factor);
    auto s = start(g, run, 1e-3);
    run_for(*s, 3);
    return s;
  }
};

/// Rates of the two axles: a change of gravity changes their loads, and the heights follow [N/m].
Eigen::Vector2d axle_rates(const Vehicle& v, const Shaker& shaker, const HardGroundRun& run) {
  const Eigen::Vector2d low = shaker.heights(*shaker.rested(1 + kGravityChange, run)),
                        high = shaker.heights(*shaker.rested(1 - kGravityChange, run));
  const auto load = static_loads(v);
  const auto wheels = stations(v);
  Eigen::Vector2d rate;
  for (int a = 0; a < 2; ++a) {
    const std::size_t left = 2 * std::size_t(a);
    const double sprung = load[left] + load[left + 1] - unsprung_of_axle(wheels, wheels[left].axle) * kGravity;
    rate(a) = 2 * kGravityChange * sprung / (high(a) - low(a));
  }
  return rate;
}

/// Heights over the axles after gravity has grown from a little less than its own, without dampers.
std::vector<Eigen::Vector2d> free_oscillation(Vehicle v, const Shaker& damped, const HardGroundRun& run) {
  for (Suspension& s : v.suspension) {
    s.damper.force = {};
    s.damper.bump = {};
  }
  Shaker free(v);
  const auto rest = damped.rested(1 - kGravityChange, run)->bodies(0);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    free.ground.world.body[i].position = rest[i].position;
    free.ground.world.body[i].orientation = rest[i].orientation;
  }
  const auto s = start(free.ground, run, kStep);
  std::vector<Eigen::Vector2d> z;
  for (int k = 0; k < kSamples; ++k) {
    z.push_back(damped.heights(*s));
    run_for(*s, kStride * kStep);
  }
  return z;
}

/// z'' = -A z - C z' + b by least squares; 2 (1 - cos(w dt)) / dt^2 are the eigenvalues of A. Ascending [rad/s].
Eigen::Vector2d frequencies(const std::vector<Eigen::Vector2d>& z, double dt) {
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
  return found;
}

}  // namespace

std::unique_ptr<sim::Simulation> start(const HardGround& ground, const HardGroundRun& run, double step) {
  sim::StepSettings settings;
  settings.iterations = 50;
  settings.step = Real(step);
  return sim::make_simulation(run.backend, sim::Scene{ground.world}, settings, run.threads);
}

void run_for(sim::Simulation& s, double time) {
  s.advance(Index(std::lround(time / s.settings().step)));
  const sim::StepReport report = s.report(0);
  if (report.flags != 0)
    throw DeviceError("a vehicle on hard ground failed: " + sim::description(report.fault, s.settings().step));
}

double forward_speed(sim::Simulation& s, const HardGround& ground) { return s.body(0, ground.e.chassis).velocity.x; }

HardGround::HardGround(const Vehicle& v, const DriverOrders& orders, double mu, double slope, double speed) {
  world.origin = {-kPeriod / 2, -10, -2};
  world.size = {Real(kPeriod), 20, 8};
  world.periodic_x = true;
  world.gravity = {Real(-kGravity * std::sin(slope)), 0, Real(-kGravity * std::cos(slope))};
  world.set_law(0, kTyre, {Real(mu), 0, 0});
  down = standing_height(v);
  e = add_vehicle(world, v, {0, 0, down}, kTyre);
  add_driveline(world, v, e, orders);
  for (sim::BodyState& b : world.body) b.velocity = {Real(speed), 0, 0};
  for (std::size_t i = 0; i < e.wheel.size(); ++i)
    world.body[std::size_t(e.wheel[i])].angular_velocity = {0, Real(speed / e.station[i].wheel->radius), 0};
  add_plane(world);
}

Vehicle smooth(Vehicle v) {
  for (Wheel& w : v.wheel) {
    w.lug_count = 0;
    w.lug_height = 0;
  }
  return v;
}

HardGroundReport check_wheel_loads(const Vehicle& vehicle, const HardGroundRun& run) {
  const Vehicle v = smooth(vehicle);
  DriverOrders parked;
  parked.release = 100;
  const HardGround ground(v, parked, 0.8);
  const auto s = start(ground, run, 1e-3);
  run_for(*s, 3);
  HardGroundReport r{.name = "wheel_loads",
                     .title = v.name + ": wheel loads on level ground",
                     .x_label = "wheel",
                     .y_label = "load [N]"};
  const auto expected = static_loads(v);
  Trace balance{"balance of forces and moments", {}, {}, true}, engine{"engine", {}, {}, true};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    double load = 0;
    const int samples = 50;
    for (int k = 0; k < samples; ++k) {
      s->advance(2);
      load += s->contact_force(0, ground.e.wheel[i]).z / samples;
    }
    std::string key = ground.e.station[i].name;
    std::replace(key.begin(), key.end(), ' ', '_');
    r.expect("wheel_load_" + key + "_N", "load of the wheel " + ground.e.station[i].name + " [N]", expected[i], load,
             kClosed * expected[i]);
    balance.add(double(i + 1), expected[i]);
    engine.add(double(i + 1), load);
  }
  r.trace = {balance, engine};
  return r;
}

HardGroundReport check_gradeability(const Vehicle& vehicle, double mu, const HardGroundRun& run) {
  Vehicle v = all_locked(smooth(vehicle));
  HardGroundReport r{.name = "gradeability",
                     .title = v.name + ": speed at full throttle on the slope that friction just allows",
                     .x_label = "time [s]",
                     .y_label = "speed [m/s]"};
  r.trace = {{"all differentials locked", {}, {}}, {"open centre", {}, {}}};
  r.expect("gradeability_locked", "steepest slope with all differentials locked: tan = mu", mu,
           full_throttle(v, mu, std::atan(mu), run, r.trace[0]).tangent, kClosed * mu);
  v.driveline.centre = Differential::open;
  const Weights w = weigh(v);
  const auto wheels = stations(v);
  const double design = open_centre_limit(mu, wheels.front().centre.x - wheels.back().centre.x,
                                          w.centre.x - wheels.back().centre.x, w.centre.z + standing_height(v));
  const Climb c = full_throttle(v, mu, std::atan(design), run, r.trace[1]);
  const double limit = open_centre_limit(mu, c.base, c.rear, c.height);
  r.expect("gradeability_open_centre", "steepest slope with an open centre, as it squats: tan = 2 mu b / (L + 2 mu h)",
           limit, c.tangent, kClosed * limit);
  return r;
}

HardGroundReport check_top_speeds(const Vehicle& vehicle, const std::vector<int>& gears, const HardGroundRun& run) {
  const Vehicle v = smooth(vehicle);
  HardGroundReport r{.name = "top_speed",
                     .title = v.name + ": full throttle in each gear",
                     .x_label = "time [s]",
                     .y_label = "speed [m/s]"};
  const auto speeds = gear_speeds(v);
  for (const int gear : gears) {
    const double expected = speeds[std::size_t(gear - 1)].balanced;
    DriverOrders orders;
    orders.gear = gear;
    const HardGround ground(v, orders, 0.9, 0, 0.96 * expected);
    const auto s = start(ground, run, 2e-3);
    Trace trace{"gear " + std::to_string(gear), {0}, {0.96 * expected}};
    for (int k = 0; k < 16; ++k) {
      run_for(*s, 0.25);
      trace.add(0.25 * (k + 1), forward_speed(*s, ground));
    }
    r.expect("top_speed_gear_" + std::to_string(gear) + "_m_per_s",
             "top speed in gear " + std::to_string(gear) + ": the engine's torque vanishes [m/s]", expected,
             trace.y.back(), kClosed * expected);
    r.trace.push_back(trace);
  }
  return r;
}

HardGroundReport check_stopping(const Vehicle& vehicle, double speed, double mu, const HardGroundRun& run) {
  const Vehicle v = smooth(vehicle);
  DriverOrders orders;
  orders.brake_from = 0.2;
  orders.speed = speed;  // held until then
  orders.gear = int(v.driveline.gears.size()) > 4 ? 5 : 0;
  HardGround ground(v, orders, mu, 0, speed);
  sim::Monitor m{.body = ground.e.chassis, .time_limit = 20};
  ground.world.monitor.push_back(m);
  const auto s = start(ground, run, 1e-3);
  run_for(*s, orders.brake_from);
  const double from = s->monitor(0, 0).now.x, before = forward_speed(*s, ground);
  const double expected = before * before / (2 * mu * kGravity), time = before / (mu * kGravity) + 0.5;
  Trace trace{"engine", {0}, {before}}, closed{"v - mu g t", {0, before / (mu * kGravity)}, {before, 0}};
  for (int k = 0; k < 50; ++k) {
    run_for(*s, time / 50);
    trace.add((k + 1) * time / 50, forward_speed(*s, ground));
  }
  HardGroundReport r{.name = "stopping",
                     .title = v.name + ": locked wheels, mu " + per_cent(mu) + " %",
                     .x_label = "time from braking [s]",
                     .y_label = "speed [m/s]",
                     .trace = {closed, trace}};
  r.expect("stopping_distance_m", "stopping distance: v^2 / (2 mu g) [m]", expected, s->monitor(0, 0).now.x - from,
           kClosed * expected);
  r.expect("stopped_speed_m_per_s", "speed half a second after it should have stopped [m/s]", 0,
           std::fabs(trace.y.back()), 0.02);
  return r;
}

HardGroundReport check_suspension(const Vehicle& vehicle, const HardGroundRun& run) {
  const Vehicle v = smooth(vehicle);
  const Shaker shaker(v);
  const Eigen::Vector2d rate = axle_rates(v, shaker, run);
  const Eigen::Matrix2d inertia = inertia_over_axles(v).inverse(), stiffness = rate.asDiagonal();
  const Eigen::Vector2d expected =
      Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d>(stiffness, inertia).eigenvalues().cwiseSqrt();
  const auto z = free_oscillation(v, shaker, run);
  const Eigen::Vector2d found = frequencies(z, kStride * kStep);

  HardGroundReport r{.name = "suspension",
                     .title = v.name + ": free oscillation without dampers",
                     .x_label = "time [s]",
                     .y_label = "height over the axle [m]",
                     .trace = {{"front axle", {}, {}}, {"rear axle", {}, {}}}};
  const char* const name[2] = {"slower", "faster"};
  for (int m = 0; m < 2; ++m) {
    const double hertz = expected(m) / (2 * kPi);
    r.expect(std::string("suspension_") + name[m] + "_Hz",
             std::string(name[m]) + " of heave and pitch on the static rates of the axles [Hz]", hertz,
             found(m) / (2 * kPi), 0.05 * hertz);
  }
  for (std::size_t k = 0; k < z.size(); ++k)
    for (int a = 0; a < 2; ++a) {
      r.trace[std::size_t(a)].add(double(k) * kStride * kStep, z[k](a));
    }
  return r;
}

}  // namespace gonogo::vehicle
