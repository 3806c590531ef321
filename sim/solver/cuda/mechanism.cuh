// A team moves a mechanism: it sums the bodies' contacts and projects the velocities onto the joints, without a barrier
// across the grid. Threads load what they will need while others still sum.
#pragma once
#include "sim/solver/cuda/records.cuh"
#include "sim/solver/cuda/views.cuh"

namespace gonogo::sim {

static_assert(kMaxMechanismBodies <= kTileSize);  // a thread for every body
/// Max bodies of a mechanism in a team's shared memory; a vehicle with suspension and steering has 19. Larger ones,
/// belts, use global memory. More room here would be taken from the cache, which holds all other contacts.
inline constexpr Index kHeldMechanismBodies = 20;
static_assert(6 * kHeldMechanismBodies <= kTileSize);  // and a thread for every number

/// Shared memory of a team that moves a mechanism.
struct MechanismWork {
  Mechanism mechanism;
  MechanismSlot* slot;  // [body of the mechanism]: held_slot, or in global memory
  Velocity* gathered;   // likewise
  MechanismSlot held_slot[kHeldMechanismBodies];
  Velocity held_gathered[kHeldMechanismBodies];
  Vec3 partial[2][kTileSize / 32];  // of the warps
};

/// `Sum(contacts, from, step, linear, angular)` adds every step-th contact of a body.
template <class Sum>
class MechanismMover {
 public:
  GONOGO_DEVICE MechanismMover(const SolveViews& views, const Team& team, MechanismWork& work, const Sum& add)
      : s(views), team_(team), work_(work), add_(add) {}

  /// `held`: room for the map in shared memory, or null.
  GONOGO_DEVICE void load(Index index, Real* held) {
    team_.sync();
    if (team_.rank == 0) {
      work_.mechanism = s.projection.mechanism[index];
      const bool fits = work_.mechanism.body_count <= kHeldMechanismBodies;
      work_.slot = fits ? work_.held_slot : &s.mechanism_slot[work_.mechanism.first_body];
      work_.gathered = fits ? work_.held_gathered : &s.mechanism_gathered[work_.mechanism.first_body];
    }
    team_.sync();
    const Mechanism& m = work_.mechanism;
    for (Index slot = team_.rank; slot < m.body_count; slot += kTileSize) {
      const BodyIndex b = s.projection.body[m.first_body + slot].body;
      work_.slot[slot].body = b;
      work_.slot[slot].contacts = s.of_body[b];
    }
    if (held != nullptr && m.projection_size() <= kHeldProjection)
      for (Index i = team_.rank; i < m.projection_size(); i += kTileSize)
        held[i] = s.projection.projection[m.projection + i];
    team_.sync();
  }

  /// After update number `k`; -1: of the warm start.
  template <bool in_substeps>
  GONOGO_DEVICE void move(Index k, const Real* held) {
    const Mechanism& m = work_.mechanism;
    if (m.body_count == 0) return;
    const Momentum now = s.momentum[k < 0 ? 0 : k & 1][m.world];
    if (now.done) return;
    const Index slot = team_.rank, number = team_.rank;
    Velocity free;
    BodyMass mass;
    Vec3 moment;
    Real before = 0;
    if (slot < m.body_count) {
      const BodyIndex b = work_.slot[slot].body;
      mass = s.mass[b];
      free = k < 0 ? begin_body(s, b) : s.free_velocity[b];
      moment = s.motor_moment(m.first_body + slot);
    }
    if (number < m.unknowns()) before = component(s.velocity[body_of(number)], number % 6);
    for (Index other = 0; other < m.body_count; ++other) sum_contacts(other);
    team_.sync();
    if (slot < m.body_count) gather(m, slot, free, mass, moment);
    team_.sync();
    const bool holds = held != nullptr && m.projection_size() <= kHeldProjection;
    const Real* map = holds ? held : s.projection.projection.data + m.projection;
    for (Index c = number; c < m.unknowns(); c += kTileSize) {
      if (c != number) before = component(s.velocity[body_of(c)], c % 6);
      const Real next = projected(m, map, c);
      Real ahead = 0;  // of the extrapolated velocity
      if (k >= 0) ahead = now.next_beta * (next - before);
      set_velocity(c, next, k < 0 ? next : multiply_add(now.next_beta, next - before, next));
      if (s.velocity_before.size > 0) component(s.velocity_before[body_of(c)], c % 6) = before;
      work_.slot[c / 6].ahead[c % 6] = ahead;
    }
    if (in_substeps && k >= 0 && now.ends) carry(m, map, free);
  }

 private:
  /// The body to which a number of the mechanism's velocities belongs.
  GONOGO_DEVICE BodyIndex body_of(Index number) const { return work_.slot[number / 6].body; }

  /// By a warp, or by the whole team for many contacts.
  GONOGO_DEVICE void sum_contacts(Index slot) {
    const HalfRange c = work_.slot[slot].contacts;
    const Index warp = team_.rank / 32, lane = team_.rank % 32;
    const bool many = c.end - c.begin > kTileSize / 4;
    if (!many && warp != slot % (kTileSize / 32)) return;
    Vec3 linear, angular;
    add_(c, many ? team_.rank : lane, many ? kTileSize : Index(32), linear, angular);
    linear = sum_of_lanes<32>(linear);
    angular = sum_of_lanes<32>(angular);
    if (many) {
      if (lane == 0) {
        work_.partial[0][warp] = linear;
        work_.partial[1][warp] = angular;
      }
      team_.sync();
      linear = angular = {};
      for (Index w = 0; w < kTileSize / 32; ++w) {
        linear += work_.partial[0][w];
        angular += work_.partial[1][w];
      }
      team_.sync();
    }
    if (many ? team_.rank == 0 : lane == 0) {
      work_.slot[slot].linear = linear;
      work_.slot[slot].angular = angular;
    }
  }

  GONOGO_DEVICE void gather(const Mechanism& m, Index slot, const Velocity& free, const BodyMass& mass,
                            const Vec3& moment) {
    const MechanismSlot& own = work_.slot[slot];
    work_.gathered[slot] = driven(s, own.body, free, mass, own.linear, own.angular + moment);
    s.gathered[m.first_body + slot] = work_.gathered[slot];  // for the joints' loads
  }

  /// Carries the bodies into the next substep.
  GONOGO_DEVICE void carry(const Mechanism& m, const Real* map, Velocity& free) {
    const Index slot = team_.rank;
    team_.sync();
    if (slot < m.body_count) {
      const BodyIndex b = work_.slot[slot].body;
      work_.gathered[slot] = sum(work_.gathered[slot], carry_body(s, b, s.velocity[b], free));
    }
    team_.sync();
    for (Index c = team_.rank; c < m.unknowns(); c += kTileSize) {
      const Real next = projected(m, map, c);
      set_velocity(c, next, next + work_.slot[c / 6].ahead[c % 6]);
    }
  }

  /// One number of a body's velocity.
  GONOGO_DEVICE Real projected(const Mechanism& m, const Real* map, Index c) {
    Real next[1];
    Projection::add_columns(m, map + c, work_.gathered, next);
    return next[0];
  }

  GONOGO_DEVICE void set_velocity(Index c, Real velocity, Real extrapolated) {
    const BodyIndex b = body_of(c);
    component(s.velocity[b], c % 6) = velocity;
    component(s.extrapolated_velocity[b], c % 6) = extrapolated;
  }

  GONOGO_DEVICE static Real& component(Velocity& v, Index c) {
    Vec3& part = c < 3 ? v.linear : v.angular;
    return c % 3 == 0 ? part.x : c % 3 == 1 ? part.y : part.z;
  }

  const SolveViews& s;
  const Team& team_;
  MechanismWork& work_;
  const Sum& add_;
};

}  // namespace gonogo::sim
