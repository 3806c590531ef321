// What drives a motor: the target of its speed and its torque limit, set at the beginning of every step from the time
// and the state there.
#pragma once
#include <vector>

#include "sim/element/force.h"
#include "sim/element/table.h"

namespace gonogo::sim {

enum class ControllerType : std::int32_t {
  schedule,            // speed and torque limit over time
  throttle,            // share of a torque curve over time
  velocity_by_torque,  // proportional-integral: velocity of a body -> torque
  velocity_by_speed    // proportional-integral: velocity of a body -> motor speed
};

/// One per motor at most. Tables are ascending in `at` and hold their outer values beyond their ends.
struct Controller {
  ControllerType type = ControllerType::schedule;
  Index motor = 0;  // in its world

  /// Over time [s]. schedule: motor speed [rad/s]. throttle: [-1, 1], negative drives backwards. velocity: [m/s].
  std::vector<TablePoint> command;
  /// Torque limit [N m] over time [s]; throttle: the torque curve at full throttle over the size of the motor's speed
  /// [rad/s], whose last point is the speed that the motor does not exceed by itself.
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
};

/// Whether it needs a body.
inline bool follows_velocity(const Controller& c) {
  return c.type == ControllerType::velocity_by_torque || c.type == ControllerType::velocity_by_speed;
}

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
};

struct ControllerState {
  double error_integral = 0;  // of the velocity error [m]
};

struct MotorCommand {
  double speed = 0;       // [rad/s]
  double max_torque = 0;  // [N m]
};

/// Faster than any motor turns: asked for this speed, a motor gives its whole torque limit [rad/s].
inline constexpr double kOutOfReach = 1e9;

GONOGO_HD inline MotorCommand torque_command(double torque) {
  return {torque < 0 ? -kOutOfReach : kOutOfReach, std::fabs(torque)};
}

GONOGO_HD inline MotorCommand schedule_command(View<const TablePoint> points, const ControllerPlan& c, double time) {
  return {interpolate(points, c.command, time), interpolate(points, c.limit, time)};
}

/// Above the last speed of its curve a motor is held back by the curve's last torque.
GONOGO_HD inline MotorCommand throttle_command(View<const TablePoint> points, const ControllerPlan& c, double time,
                                               double motor_speed) {
  const double throttle = interpolate(points, c.command, time);
  const double top = points[c.limit.first + c.limit.count - 1].at;
  return {throttle < 0 ? -top : top, std::fabs(throttle) * interpolate(points, c.limit, std::fabs(motor_speed))};
}

GONOGO_HD inline double clamped(double x, double limit) { return std::fmin(limit, std::fmax(-limit, x)); }

/// Proportional-integral law. The integral rests while the output is at its limit and the error would push it further
/// (conditional integration: Astrom & Hagglund, PID Controllers, section 3.5), so that it does not wind up.
GONOGO_HD inline double proportional_integral(const ControllerPlan& c, double command, double velocity, double limit,
                                              double step, ControllerState& state) {
  const double error = command - velocity;
  const double at_once = c.proportional * error + c.feed_forward * command;
  const double integral = state.error_integral + error * step;
  const double wish = at_once + c.integral * integral;
  if (std::fabs(wish) > limit && wish * c.integral * error > 0)
    return clamped(at_once + c.integral * state.error_integral, limit);
  state.error_integral = integral;
  return clamped(wish, limit);
}

GONOGO_HD inline MotorCommand velocity_command(View<const TablePoint> points, const ControllerPlan& c, double time,
                                               double velocity, double step, ControllerState& state) {
  const double command = interpolate(points, c.command, time), max_torque = interpolate(points, c.limit, time);
  const bool by_torque = c.type == ControllerType::velocity_by_torque;
  const double out = proportional_integral(c, command, velocity, by_torque ? max_torque : c.top_speed, step, state);
  return by_torque ? torque_command(out) : MotorCommand{out, max_torque};
}

}  // namespace gonogo::sim
