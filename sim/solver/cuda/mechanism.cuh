// A team moves a mechanism: its motors, the sums of its contacts and their projection onto its joints, without a
// barrier across the grid.
#pragma once
#include "sim/solver/cuda/residence.cuh"

namespace gonogo::sim {

/// What a team has at hand while it works on a mechanism, in shared memory.
struct MechanismWork {
  Mechanism mechanism;
  BodyIndex body[kMostMechanismBodies];
  HalfRange contacts[kMostMechanismBodies];
  Vec3 linear[kMostMechanismBodies], angular[kMostMechanismBodies];  // sums over contacts
  Velocity gathered[kMostMechanismBodies];
  Vec3 partial[2][kTileSize / 32];  // of the warps
};

/// `Sum(contacts, from, step, linear, angular)` adds every step-th contact of a body.
template <class Sum>
class MechanismMover {
 public:
  __device__ MechanismMover(const SolveViews& views, const Team& team, MechanismWork& work, const Sum& add)
      : s(views), team_(team), work_(work), add_(add) {}

  /// `held`: room for the map in shared memory, or null.
  __device__ void load(Index index, Real* held) {
    team_.sync();
    if (team_.rank == 0) work_.mechanism = s.projection.mechanism[index];
    team_.sync();
    const Mechanism& m = work_.mechanism;
    for (Index slot = team_.rank; slot < m.body_count; slot += kTileSize) {
      work_.body[slot] = s.projection.body[m.first_body + slot].body;
      work_.contacts[slot] = s.of_body[work_.body[slot]];
    }
    if (held != nullptr && m.projection_size() <= kHeldProjection)
      for (Index i = team_.rank; i < m.projection_size(); i += kTileSize)
        held[i] = s.projection.projection[m.projection + i];
    team_.sync();
  }

  /// After update number `k`; -1: of the warm start.
  __device__ void move(Index k, const Real* held) {
    const Mechanism& m = work_.mechanism;
    if (m.body_count == 0) return;
    const Momentum now = s.momentum[k < 0 ? 0 : k & 1][m.world];
    if (now.done) return;
    if (k >= 0) update_motors(m, k, now.beta);
    for (Index slot = 0; slot < m.body_count; ++slot) sum_contacts(slot);
    team_.sync();
    for (Index slot = team_.rank; slot < m.body_count; slot += kTileSize) gather(m, slot);
    team_.sync();
    const bool holds = held != nullptr && m.projection_size() <= kHeldProjection;
    const Real* map = holds ? held : s.projection.projection.data + m.projection;
    for (Index c = team_.rank; c < 6 * m.body_count; c += kTileSize) project(m, map, c, k < 0, now.next_beta);
  }

 private:
  /// From velocities of before.
  __device__ void update_motors(const Mechanism& m, Index k, Real beta) {
    const UpdateMotor motor{s.motor,           s.drive,         s.extrapolated_velocity, s.world_of_body,
                            s.momentum[k & 1], s.motor_impulse, s.motor_before,          s.step};
    const Index first = m.first_element + m.element_count - m.motor_count;
    for (Index n = team_.rank; n < m.motor_count; n += kTileSize) motor.update(s.element[first + n].index, beta);
  }

  /// By a warp, or by the whole team where there are many.
  __device__ void sum_contacts(Index slot) {
    const HalfRange c = work_.contacts[slot];
    const Index warp = team_.rank / 32, lane = team_.rank % 32;
    const bool many = c.end - c.begin > kTileSize / 4;
    if (!many && warp != slot % (kTileSize / 32)) return;
    Vec3 linear, angular;
    add_(c, many ? team_.rank : lane, many ? kTileSize : Index(32), linear, angular);
    linear = sum_of_lanes<32>(linear);
    angular = sum_of_lanes<32>(angular);
    if (many) {
      if (lane == 0) work_.partial[0][warp] = linear, work_.partial[1][warp] = angular;
      team_.sync();
      linear = angular = {};
      for (Index w = 0; w < kTileSize / 32; ++w) linear += work_.partial[0][w], angular += work_.partial[1][w];
      team_.sync();
    }
    if (many ? team_.rank == 0 : lane == 0) work_.linear[slot] = linear, work_.angular[slot] = angular;
  }

  __device__ void gather(const Mechanism& m, Index slot) {
    const BodyIndex b = work_.body[slot];
    const Velocity free = s.free_velocity[b];
    const BodyMass mass = s.mass[b];
    const Vec3 angular = work_.angular[slot] + s.motor_moment(m.first_body + slot);
    work_.gathered[slot] = driven(s, b, free, mass, work_.linear[slot], angular);
    s.gathered[m.first_body + slot] = work_.gathered[slot];  // for the joints' loads
  }

  /// One number of a body's velocity.
  __device__ void project(const Mechanism& m, const Real* map, Index c, bool first, Real beta) {
    const BodyIndex b = work_.body[c / 6];
    Real& now = component(s.velocity[b], c % 6);
    const Real before = now;
    Real next[1];
    Projection::add_columns(m, map + c, work_.gathered, next);
    component(s.extrapolated_velocity[b], c % 6) = first ? next[0] : multiply_add(beta, next[0] - before, next[0]);
    now = next[0];
  }

  __device__ static Real& component(Velocity& v, Index c) {
    Vec3& part = c < 3 ? v.linear : v.angular;
    return c % 3 == 0 ? part.x : c % 3 == 1 ? part.y : part.z;
  }

  const SolveViews& s;
  const Team& team_;
  MechanismWork& work_;
  const Sum& add_;
};

}  // namespace gonogo::sim
