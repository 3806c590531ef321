// Monitors measure a world where it is simulated: travel of a body, turning and torque of a motor, energy, residual and
// flags. Their rules stop the world. Sums are recorded at a fixed stride, so that the mean over any part of a run
// follows from the difference of two samples.
#pragma once
#include <limits>

#include "sim/shape/shape.h"

namespace gonogo::sim {

/// Why a world stopped. Where several rules hold in the same step, the first of this list is the cause.
enum class StopCause : std::int32_t { none, flags, overturned, slid_back, distance, immobile, time_limit };

/// Times are rounded to whole steps. Travel along x and y counts from the first step, across periodic sides.
struct Monitor {
  BodyIndex body = 0;  // watched
  Index motor = -1;    // whose turning, torque and work are summed, or -1
  double height = 0;   // z from which the body's drop is counted [m]
  double start = 0;    // of the stop rules other than `flags` [s]
  Index stride = 1;    // steps between recorded samples

  // Stop rules; times are counted from `start`. A flag raised in the world always stops it.
  double time_limit = 0;  // above zero, because it bounds the memory of the record [s]
  double earliest = 0;    // earliest stop by distance or immobile [s]
  double distance = std::numeric_limits<double>::infinity();   // travelled along x [m]
  double slid_back = std::numeric_limits<double>::infinity();  // travelled along -x [m]
  double immobile_window = 0;  // time over which the mean speed along x is taken; 0: no such rule [s]
  double immobile_from = 0;    // start of the first window [s]
  double immobile_speed = 0;   // the rule holds below this mean speed [m/s]
  Vec3 up{0, 0, 1};            // unit vector, in the world at the start, that turns with the body
  double min_up = -2;          // min z of this vector: cosine of the max roll or pitch
};

/// A monitor with the batch's indices; times in steps of the world.
struct MonitorPlan {
  BodyIndex body = 0;
  Index motor = -1, stride = 1;
  Index first_sample = 0, capacity = 0;
  Index start = 0, earliest = 0, time_limit = 0, immobile_from = 0;  // immobile_from: end of the first window
  Index immobile_samples = 0;                                        // window in samples, 0: no such rule
  double height = 0, distance = 0, slid_back = 0;
  double immobile_travel = 0;  // [m]
  Vec3 up_B{0, 0, 1};
  double min_up = -2;
};

/// A world after one step; sums count from its first step.
struct MonitorSample {
  double x = 0, y = 0;    // travelled [m]
  double turned = 0;      // by the motor [rad]
  double drop_sum = 0;    // of `drop` over steps [m]
  double torque_sum = 0;  // of `torque` over steps [N m]
  double work = 0;        // of the motor, negative where it brakes [J]
  Real drop = 0;          // of the body below `height` [m]
  Real speed = 0;         // of the body along x [m/s]
  Real torque = 0;        // of the motor [N m]
  Real residual = 0;      // root mean square over contacts [m/s]
  Index step = 0;         // of the world, the first is 1
  Index contact_count = 0, iterations = 0, flags = 0;
};

/// State of a monitor. It no longer changes once its world has stopped.
struct MonitorState {
  MonitorSample now;          // after the latest step
  Vec3d position;             // of the body, inside the period [m]
  double energy = 0;          // kinetic and of springs [J]
  double energy_gained = 0;   // beyond the supply by gravity, motors and forces, summed over steps that gained [J]
  double exchanged = 0;       // sum of the magnitudes of the energies by gravity, motors and forces [J]
  double worst_residual = 0;  // largest root-mean-square residual of a step [m/s]
  Index sample_count = 0;     // recorded
  Index started = 0;          // a step was watched
};

/// When and why a world stopped. `monitor`: the one, in its world, whose rule held first.
struct WorldStop {
  StopCause cause = StopCause::none;
  Index monitor = 0;
  Index step = 0;  // of the world
};

/// Energy and its supply in one step beside those of WorldSums, at the velocities and positions of the step's end.
struct WorldEnergy {
  double spring = 0;       // [J]
  double motor_power = 0;  // [W]
  double force_power = 0;  // of force elements [W]
};

/// What a monitor reads of one step.
struct WatchedStep {
  Vec3d moved;             // of the body, nearest image [m]
  double drop = 0;         // [m]
  double motor_speed = 0;  // [rad/s]
  double torque = 0;       // [N m]
  double energy = 0;       // kinetic and of springs [J]
  double supplied = 0;     // by gravity, motors and forces [J]
  double exchanged = 0;    // sum of the magnitudes of the three [J]
  Real speed = 0;          // along x [m/s]
  double up = 1;           // z of the body's upward vector
  double residual = 0;     // [m/s]
  Index step = 0, contact_count = 0, iterations = 0, flags = 0;
};

/// Energy gained beyond the supply is an error of the time stepping, because contacts can only remove energy. Compare
/// it with the energy exchanged: uphill that of the motors, downhill that of gravity, which the brakes remove.
GONOGO_HD inline void add_energy(MonitorState& m, const WatchedStep& s) {
  if (m.started != 0) m.energy_gained += std::fmax(0.0, s.energy - m.energy - s.supplied);
  m.exchanged += s.exchanged;
  m.energy = s.energy;
  m.started = 1;
}

GONOGO_HD inline void add_step(MonitorState& m, const WatchedStep& s, double step) {
  GONOGO_ASSERT(step > 0 && s.step > m.now.step);
  MonitorSample& now = m.now;
  now.x += s.moved.x;
  now.y += s.moved.y;
  now.turned += s.motor_speed * step;
  now.drop_sum += s.drop;
  now.torque_sum += s.torque;
  now.work += s.torque * s.motor_speed * step;
  now.drop = Real(s.drop);
  now.speed = s.speed;
  now.torque = Real(s.torque);
  now.residual = Real(s.residual);
  now.step = s.step;
  now.contact_count = s.contact_count;
  now.iterations = s.iterations;
  now.flags = s.flags;
  m.worst_residual = std::fmax(m.worst_residual, s.residual);
  add_energy(m, s);
}

/// Progress over the last window, which ends with the latest sample, is too small. Asked only in steps that record.
GONOGO_HD inline bool is_immobile(const MonitorPlan& p, const MonitorState& m, View<const MonitorSample> sample) {
  if (p.immobile_samples == 0 || m.now.step < p.immobile_from || m.now.step % p.stride != 0 ||
      m.sample_count <= p.immobile_samples)
    return false;
  const MonitorSample& then = sample[p.first_sample + m.sample_count - 1 - p.immobile_samples];
  return m.now.x - then.x < p.immobile_travel;
}

GONOGO_HD inline StopCause stop_cause(const MonitorPlan& p, const MonitorState& m, double up,
                                      View<const MonitorSample> sample) {
  if (m.now.flags != 0) return StopCause::flags;
  if (m.now.step < p.start) return StopCause::none;
  if (up < p.min_up) return StopCause::overturned;
  if (m.now.x < -p.slid_back) return StopCause::slid_back;
  if (m.now.step >= p.earliest && m.now.x >= p.distance) return StopCause::distance;
  if (m.now.step >= p.earliest && is_immobile(p, m, sample)) return StopCause::immobile;
  return m.now.step >= p.time_limit ? StopCause::time_limit : StopCause::none;
}

/// Means over the steps after sample `from` up to sample `to`.
struct MonitorMeans {
  double time = 0;              // [s]
  double x = 0, y = 0;          // travelled [m]
  double turned = 0;            // [rad]
  double drop = 0, torque = 0;  // mean [m], [N m]
  double work = 0;              // [J]
};

/// `to` must be later than `from`.
GONOGO_HD inline MonitorMeans means_between(const MonitorSample& from, const MonitorSample& to, double step) {
  GONOGO_ASSERT(to.step > from.step);
  const double count = to.step - from.step;
  return {.time = count * step,
          .x = to.x - from.x,
          .y = to.y - from.y,
          .turned = to.turned - from.turned,
          .drop = (to.drop_sum - from.drop_sum) / count,
          .torque = (to.torque_sum - from.torque_sum) / count,
          .work = to.work - from.work};
}

}  // namespace gonogo::sim
