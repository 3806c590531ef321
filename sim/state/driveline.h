// An engine that drives wheels through a gearbox and differentials, and its driver. It sets the motors of the wheels at
// the beginning of every step, from the time and the state then.
//
//   driver:        throttle and brake over time, or a proportional-integral law that holds a speed
//   coupling:      direct (the engine turns with the gearbox), torque converter or clutch
//   gearbox:       shifts up and down at given engine speeds
//   differentials: an open centre gives every axle its share, and both wheels of an axle get equal torques. A
//                  limited-slip differential is a motor from wheel to wheel, which holds them at equal speeds with
//                  limited torque and is implicit like every motor. A locked one is a joint of the scene, equal_spin.
#pragma once
#include "sim/state/controller.h"

namespace gonogo::sim {

inline constexpr int kMaxDrivenAxles = 4, kMaxGears = 12, kMaxBrakes = 8;

enum class Coupling : std::int32_t { direct, converter, clutch };

struct DrivenAxle {
  Index wheel[2] = {-1, -1};  // motors between its wheels and their carriers; -1: no second wheel
  Index lock = -1;            // limited slip: motor from its left to its right wheel
  double share = 1;           // of the torque behind the gearbox
  double bias = 1;            // limited slip: largest ratio of the two torques
};

struct Brake {
  Index motor = -1;   // its own, between a wheel and its carrier
  double torque = 0;  // fully applied [N m]
};

/// Numbers of a driveline. Indices of motors and bodies count in the world of a scene, or through a batch.
struct DrivelineNumbers {
  Coupling coupling = Coupling::direct;
  Index axle_count = 0, gear_count = 0, brake_count = 0;
  DrivenAxle axle[kMaxDrivenAxles];
  double ratio[kMaxGears]{};  // engine speed over wheel speed, lowest gear first: ratios fall
  Brake brake[kMaxBrakes];
  Index first_gear = 0;
  double up_speed = 0;    // engine speed above which it shifts up; 0: never [rad/s]
  double down_speed = 0;  // below which it shifts down [rad/s]
  double shift_time = 0;  // between two shifts at least [s]
  double efficiency = 1;
  double wheel_inertia = 0;   // of all driven wheels about their axles: stabilises a falling torque curve [kg m^2]
  double engine_inertia = 0;  // converter and clutch [kg m^2]
  double idle_speed = 0;      // min engine speed with converter or clutch [rad/s]
  double clutch_torque = 0;   // max torque of the engaged clutch [N m]
  double engaged_speed = 0;   // engine speed at which the clutch is engaged; open at the idle speed [rad/s]

  // A driver who holds a speed: u = p e + i (integral of e) with e = command - speed, u in [-1, 1]; above zero
  // throttle, below zero brake. The speed is the speedometer's, from the shaft behind the gearbox: a driver who watched
  // the body would race spinning wheels through all gears.
  double way_per_radian = 0;  // of that shaft [m]; 0: the driver reads the speed of the body instead
  BodyIndex body = 0;
  Vec3 axis_B{1, 0, 0};     // unit: forward in the body's frame
  double proportional = 0;  // [s/m]
  double integral = 0;      // [1/m]
};

/// One engine. Tables ascend in `at`; their outer values hold beyond their ends.
struct Driveline : DrivelineNumbers {
  std::vector<TablePoint> torque;        // at full throttle over engine speed [N m, rad/s]; negative: at any throttle
  std::vector<TablePoint> torque_ratio;  // of a converter over its speed ratio [-]
  std::vector<TablePoint> capacity;      // of a converter: its input torque over the square of the engine's speed
                                         // [N m s^2], over its speed ratio
  std::vector<TablePoint> throttle;      // [0, 1] over time [s]; with a speed to hold, its max
  std::vector<TablePoint> braking;       // [0, 1] over time [s]; with a speed to hold, its min
  std::vector<TablePoint> speed;         // to hold, over time [m/s]; empty: throttle and braking as they are
};

/// A driveline with the batch's indices.
struct DrivelinePlan : DrivelineNumbers {
  Index world = -1;  // -1: an empty place in a batch
  Table torque, torque_ratio, capacity, throttle, braking, speed;
};

struct DrivelineState {
  double error_integral = 0;  // of the driver's speed error [m]
  double engine_speed = 0;    // [rad/s]
  double next_shift = 0;      // earliest time of the next shift [s]
  double gear = 0;            // whole, 0 the lowest
};

struct Pedals {
  double throttle = 0, brake = 0;  // [0, 1]
};

/// Proportional-integral law with conditional integration, as in controller.h.
GONOGO_HD inline Pedals pedals(View<const TablePoint> points, const DrivelinePlan& d, double time, double speed,
                               double step, DrivelineState& state) {
  Pedals p{interpolate(points, d.throttle, time), interpolate(points, d.braking, time)};
  if (d.speed.count == 0) return p;
  const double error = interpolate(points, d.speed, time) - speed;
  const double integral = state.error_integral + error * step;
  const double wish = d.proportional * error + d.integral * integral;
  const bool wound = (wish > p.throttle && error > 0) || (wish < -1 && error < 0);
  if (!wound) state.error_integral = integral;
  p.brake = std::fmax(p.brake, std::fmin(1.0, -wish));
  p.throttle = std::fmax(0.0, std::fmin(p.throttle, wish));
  return p;
}

/// Torque of the engine [N m]. Where the curve is negative it brakes at any throttle.
GONOGO_HD inline double engine_torque(View<const TablePoint> points, const DrivelinePlan& d, double throttle,
                                      double speed) {
  const double full = interpolate(points, d.torque, speed);
  return full > 0 ? throttle * full : full;
}

/// Torque t(w) on an inertia that turns at w, at the end of a step in which nothing else acts. A falling curve is
/// implicit by its tangent, so the torque never reverses the motion.
GONOGO_HD inline double tangent_implicit(double torque, double slope, double inertia, double step) {
  return slope < 0 && inertia > 0 ? torque / (1 - slope * step / inertia) : torque;
}

/// Behind the gearbox, of an engine that turns with it [N m].
GONOGO_HD inline double direct_torque(View<const TablePoint> points, const DrivelinePlan& d, double ratio,
                                      double throttle, double shaft_speed, double step, DrivelineState& state) {
  constexpr double apart = 0.5;  // step of the slope's difference quotient [rad/s]
  const double speed = shaft_speed * ratio;
  state.engine_speed = speed;
  const double now = engine_torque(points, d, throttle, speed);
  const double slope = (engine_torque(points, d, throttle, speed + apart) - now) / apart;
  return d.efficiency * ratio * tangent_implicit(now, slope * ratio * ratio, d.wheel_inertia, step);
}

/// Behind the gearbox with a hydrodynamic torque converter: input torque = capacity(n) w_e^2 of the speed ratio
/// n = w_turbine / w_e, output torque = torque_ratio(n) times that. The engine's speed is implicit in its load.
GONOGO_HD inline double converter_torque(View<const TablePoint> points, const DrivelinePlan& d, double ratio,
                                         double throttle, double shaft_speed, double step, DrivelineState& state) {
  const double engine = std::fmax(state.engine_speed, d.idle_speed);
  GONOGO_ASSERT(d.engine_inertia > 0);
  const double n = std::fmin(1.0, std::fmax(0.0, shaft_speed * ratio / std::fmax(engine, 1e-6)));
  const double capacity = interpolate(points, d.capacity, n), rate = step / d.engine_inertia;
  const double next = (engine + rate * engine_torque(points, d, throttle, engine)) / (1 + rate * capacity * engine);
  state.engine_speed = std::fmax(next, d.idle_speed);
  return d.efficiency * ratio * interpolate(points, d.torque_ratio, n) * capacity * state.engine_speed * engine;
}

/// Behind the gearbox with a dry clutch that closes between idle and engaged speed. Coulomb friction: the clutch sticks
/// when its max torque suffices to make both sides equally fast at the step's end.
GONOGO_HD inline double clutch_torque(View<const TablePoint> points, const DrivelinePlan& d, double ratio,
                                      double throttle, double shaft_speed, double step, DrivelineState& state) {
  const double engine = std::fmax(state.engine_speed, d.idle_speed);
  GONOGO_ASSERT(d.engine_inertia > 0 && d.clutch_torque >= 0);
  const double closed = (engine - d.idle_speed) / std::fmax(1e-6, d.engaged_speed - d.idle_speed);
  const double max = d.clutch_torque * std::fmin(1.0, std::fmax(0.0, closed));
  const double free = engine + step / d.engine_inertia * engine_torque(points, d, throttle, engine);
  const double yielding = 1 / d.engine_inertia + ratio * ratio / std::fmax(d.wheel_inertia, 1e-9);
  const double passed = clamped((free - shaft_speed * ratio) / (step * yielding), max);
  state.engine_speed = std::fmax(free - step / d.engine_inertia * passed, d.idle_speed);
  return d.efficiency * ratio * passed;
}

/// Gear of the step that begins.
GONOGO_HD inline void shift(const DrivelinePlan& d, double time, DrivelineState& state) {
  if (!(d.up_speed > 0) || time < state.next_shift) return;
  const Index gear = Index(state.gear);
  if (state.engine_speed > d.up_speed && gear + 1 < d.gear_count) {
    state.gear = gear + 1;
  } else if (state.engine_speed < d.down_speed && gear > 0) {
    state.gear = gear - 1;
  } else {
    return;
  }
  state.next_shift = time + d.shift_time;
}

/// Torque behind the gearbox [N m] at the speed of the shaft there.
GONOGO_HD inline double gearbox_torque(View<const TablePoint> points, const DrivelinePlan& d, double throttle,
                                       double shaft_speed, double step, DrivelineState& state) {
  GONOGO_ASSERT(Index(state.gear) >= 0 && Index(state.gear) < d.gear_count && step > 0);
  const double ratio = d.ratio[Index(state.gear)];
  if (d.coupling == Coupling::converter) return converter_torque(points, d, ratio, throttle, shaft_speed, step, state);
  if (d.coupling == Coupling::clutch) return clutch_torque(points, d, ratio, throttle, shaft_speed, step, state);
  return direct_torque(points, d, ratio, throttle, shaft_speed, step, state);
}

/// Max torque [N m] from the faster to the slower wheel when their axle gets `torque` T. With T/2 + c and T/2 - c in
/// the ratio of the bias, c = T/2 (bias - 1) / (bias + 1).
GONOGO_HD inline double lock_limit(const DrivenAxle& a, double torque) {
  GONOGO_ASSERT(a.bias >= 1);
  return 0.5 * std::fabs(torque) * (a.bias - 1) / (a.bias + 1);
}

}  // namespace gonogo::sim
