// Controllers set a motor's target speed and torque limit at the beginning of every step, from the time and the state
// then. Their commands are piecewise-linear tables; all tables of a batch lie in one array.
#pragma once
#include <vector>

#include "base/parallel/buffer.h"
#include "sim/state/force.h"

namespace gonogo::sim {

struct TablePoint {
  double at = 0, value = 0;
};

/// Points first .. first + count - 1, ascending in `at`, at least one.
struct Table {
  Index first = 0, count = 0;
};

/// Linear between points; the outer values hold beyond the ends.
GONOGO_HD inline double interpolate(View<const TablePoint> points, const Table& table, double at) {
  GONOGO_ASSERT(table.count >= 1 && table.first >= 0);
  Index low = table.first, high = table.first + table.count - 1;
  if (at <= points[low].at) return points[low].value;
  if (at >= points[high].at) return points[high].value;
  while (high - low > 1) {
    const Index middle = low + (high - low) / 2;
    (points[middle].at <= at ? low : high) = middle;
  }
  const TablePoint &a = points[low], &b = points[high];
  GONOGO_ASSERT(a.at < b.at);
  return a.value + (b.value - a.value) * ((at - a.at) / (b.at - a.at));
}

enum class ControllerType : std::int32_t {
  schedule,            // speed and torque limit over time
  throttle,            // fraction of a torque curve over time
  velocity_by_torque,  // proportional-integral: velocity of a body -> torque
  velocity_by_speed,   // proportional-integral: velocity of a body -> motor speed
  steering,            // keeps a body on a straight line along x: offset of a point ahead -> angle of the motor
  angle,               // turns the motor to an angle
  held_speed           // speed over time, within a torque curve over the motor's speed
};

/// At most one per motor. Tables ascend in `at`; their outer values hold beyond their ends.
struct Controller {
  ControllerType type = ControllerType::schedule;
  Index motor = 0;  // in its world

  /// Over time [s]. schedule, held_speed: motor speed [rad/s]. throttle: [-1, 1], negative drives backwards. velocity:
  /// [m/s]. angle: [rad].
  std::vector<TablePoint> command;
  /// Torque limit [N m] over time [s]. throttle: torque at full throttle over the magnitude of the motor's speed
  /// [rad/s]; the last point is the speed that the motor does not exceed by itself. held_speed: the same curve for a
  /// motor that drives; one that brakes or turns the other way has its torque at rest.
  std::vector<TablePoint> limit;

  // velocity: u = p e + i (integral of e) + f c with command c and error e = c - velocity along the axis. u is a
  // torque [N m] within the limit, or a motor speed [rad/s] within +-top_speed.
  BodyIndex body = 0;                           // whose centre of mass is kept at the velocity
  ReferenceFrame frame = ReferenceFrame::body;  // of the axis
  Vec3 axis{1, 0, 0};                           // any length
  double proportional = 0;                      // p: [N m s/m] or [rad/m]
  double integral = 0;                          // i: [N m/m] or [rad/(m s)]
  double feed_forward = 0;                      // f: [N m s/m] or [rad/m]
  double top_speed = 0;                         // [rad/s]

  // steering: the line runs along the world's x through the body's start. y is the offset from it of a point
  // `look_ahead` ahead of the body along `axis`. The wanted angle of the motor is `command` times -p y, limited to
  // +-max_angle. The motor turns at `rate` times the missing angle, at most at top_speed. p: [rad/m]. angle: the same
  // towards `command` itself.
  double look_ahead = 0;    // [m]
  double max_angle = 0;     // [rad]
  double rate = 0;          // [1/s]
  Vec3 pointer_a{1, 0, 0};  // in the frame of the motor's body a: along `axis` of its body b at angle zero
};

GONOGO_HD inline bool sets_angle(ControllerType type) {
  return type == ControllerType::steering || type == ControllerType::angle;
}

/// Whether its torque limit is a curve over the motor's speed.
GONOGO_HD inline bool has_torque_curve(ControllerType type) {
  return type == ControllerType::throttle || type == ControllerType::held_speed;
}

/// Whether it reads a body's motion.
inline bool follows_body(const Controller& c) {
  return c.type == ControllerType::velocity_by_torque || c.type == ControllerType::velocity_by_speed ||
         sets_angle(c.type);
}

/// Largest magnitude of a controller's command.
inline double command_limit(ControllerType type) { return type == ControllerType::throttle ? 1 : 1e9; }

/// A controller with the batch's indices.
struct ControllerPlan {
  ControllerType type = ControllerType::schedule;
  Index world = 0;
  Index motor = -1;  // -1: an empty place in a batch
  BodyIndex body = 0;
  ReferenceFrame frame = ReferenceFrame::body;
  Vec3 axis;  // unit
  Table command, limit;
  double proportional = 0, integral = 0, feed_forward = 0, top_speed = 0;
  double look_ahead = 0, max_angle = 0, rate = 0;
  Vec3 pointer_a;
};

struct ControllerState {
  double error_integral = 0;  // of the velocity error; steering: of the velocity along y [m]
};

struct MotorCommand {
  double speed = 0;       // [rad/s]
  double max_torque = 0;  // [N m]
};

/// Faster than any motor turns: with this target a motor gives its full torque limit [rad/s].
inline constexpr double kOutOfReach = 1e9;

GONOGO_HD inline MotorCommand torque_command(double torque) {
  return {torque < 0 ? -kOutOfReach : kOutOfReach, std::fabs(torque)};
}

GONOGO_HD inline MotorCommand schedule_command(View<const TablePoint> points, const ControllerPlan& c, double time) {
  return {interpolate(points, c.command, time), interpolate(points, c.limit, time)};
}

GONOGO_HD inline MotorCommand held_speed_command(View<const TablePoint> points, const ControllerPlan& c, double time,
                                                 double motor_speed) {
  const double wanted = interpolate(points, c.command, time);
  const bool drives = wanted * motor_speed > 0 && std::fabs(motor_speed) < std::fabs(wanted);
  return {wanted, interpolate(points, c.limit, drives ? std::fabs(motor_speed) : 0)};
}

/// Above the last speed of its curve a motor is held back by the curve's last torque.
GONOGO_HD inline MotorCommand throttle_command(View<const TablePoint> points, const ControllerPlan& c, double time,
                                               double motor_speed) {
  const double throttle = interpolate(points, c.command, time);
  const double top = points[c.limit.first + c.limit.count - 1].at;
  return {throttle < 0 ? -top : top, std::fabs(throttle) * interpolate(points, c.limit, std::fabs(motor_speed))};
}

GONOGO_HD inline double clamped(double x, double limit) {
  GONOGO_ASSERT(limit >= 0);
  return std::fmin(limit, std::fmax(-limit, x));
}

/// Proportional-integral law. The integral stops while the output is at its limit and the error would push it further
/// (conditional integration: Astrom & Hagglund, PID Controllers, section 3.5).
GONOGO_HD inline double proportional_integral(const ControllerPlan& c, double command, double velocity, double limit,
                                              double step, ControllerState& state) {
  GONOGO_ASSERT(step > 0);
  const double error = command - velocity;
  const double at_once = c.proportional * error + c.feed_forward * command;
  const double integral = state.error_integral + error * step;
  const double wish = at_once + c.integral * integral;
  if (std::fabs(wish) > limit && wish * c.integral * error > 0)
    return clamped(at_once + c.integral * state.error_integral, limit);
  state.error_integral = integral;
  return clamped(wish, limit);
}

/// Steering angle [rad] when a point ahead is `beside` [m] left of the line.
GONOGO_HD inline double steering_wish(double gain, double max_angle, double beside) {
  return clamped(-gain * beside, max_angle);
}

/// Unit vectors in the world. forward, up: of the motor's body b; pointer: of its body a.
struct ArmPose {
  Vec3 forward, up, pointer;
};

/// Turns an arm to an angle [rad].
GONOGO_HD inline MotorCommand turn_to(View<const TablePoint> points, const ControllerPlan& c, double time,
                                      const ArmPose& arm, double wish) {
  GONOGO_ASSERT(is_unit(arm.forward) && is_unit(arm.up) && is_unit(arm.pointer));
  const double angle =
      std::atan2(double(dot(arm.up, cross(arm.forward, arm.pointer))), double(dot(arm.forward, arm.pointer)));
  return {clamped(c.rate * (wish - angle), c.top_speed), interpolate(points, c.limit, time)};
}

/// `sideways`: velocity of the steered body along y.
GONOGO_HD inline MotorCommand steering_command(View<const TablePoint> points, const ControllerPlan& c, double time,
                                               const ArmPose& arm, double sideways, double step,
                                               ControllerState& state) {
  state.error_integral += sideways * step;
  const double beside = state.error_integral + c.look_ahead * arm.forward.y;
  return turn_to(points, c, time, arm,
                 interpolate(points, c.command, time) * steering_wish(c.proportional, c.max_angle, beside));
}

GONOGO_HD inline MotorCommand angle_command(View<const TablePoint> points, const ControllerPlan& c, double time,
                                            const ArmPose& arm) {
  return turn_to(points, c, time, arm, clamped(interpolate(points, c.command, time), c.max_angle));
}

GONOGO_HD inline MotorCommand velocity_command(View<const TablePoint> points, const ControllerPlan& c, double time,
                                               double velocity, double step, ControllerState& state) {
  const double command = interpolate(points, c.command, time), max_torque = interpolate(points, c.limit, time);
  const bool by_torque = c.type == ControllerType::velocity_by_torque;
  const double out = proportional_integral(c, command, velocity, by_torque ? max_torque : c.top_speed, step, state);
  return by_torque ? torque_command(out) : MotorCommand{out, max_torque};
}

}  // namespace gonogo::sim
