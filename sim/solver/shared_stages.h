// Stages around the update of the contacts, shared by all methods on either backend: velocities of bodies, energies.
#pragma once
#include "sim/constraint/project_joints.h"
#include "sim/solver/split.h"
#include "sim/state/contact_lists.h"
#include "sim/state/mechanism.h"

namespace gonogo::sim {

/// v_free + M^-1 (impulse and moment on the body) [m/s, rad/s].
GONOGO_HD_INLINED Velocity driven_velocity(const Velocity& free, const BodyMass& m, const SymMat3& inverse_inertia_W,
                                           const Vec3& linear, const Vec3& angular) {
  Velocity v;
  v.linear = free.linear + scale(m.inverse_mass, linear);
  v.angular = free.angular + (m.isotropic ? angular * m.inverse_inertia_B.x : inverse_inertia_W * angular);
  return v;
}

/// Applies changes of contact impulses at once to the bodies that a Gauss-Seidel sweep moves.
struct SweptBodies {
  Incidence incidence;
  View<const BodyMass> mass;
  View<const SymMat3> inverse_inertia_W;
  View<Velocity> velocity;

  GONOGO_HD void move(BodyIndex b, const Vec3& arm, const Impulse& change, Real sign) const {
    if (!is_swept(b, mass[b], incidence)) return;
    const SymMat3 inertia = mass[b].isotropic ? SymMat3{} : inverse_inertia_W[b];
    velocity[b] = driven_velocity(velocity[b], mass[b], inertia, change.linear * sign, moment(arm, change) * sign);
  }
};

/// Starts a body: returns and stores its velocity without impulses in the first substep. `change`: by gravity, spin and
/// forces in a substep.
GONOGO_HD_INLINED Velocity begin_body(const Velocity& v, const Velocity& change, Velocity& free, Velocity& earlier) {
  earlier.linear = earlier.angular = {};
  return free = sum(v, change);
}

/// Carries a body, which has moved with `v` through a substep, into the next one. `free` becomes the velocity without
/// impulses there; `substep_velocity` keeps `v` for the gaps, `earlier` adds it for the path. Returns the change of
/// `free`.
GONOGO_HD_INLINED Velocity carry_body(const Velocity& v, const Velocity& change, Velocity& free,
                                      Velocity& substep_velocity, Velocity& earlier) {
  const Velocity next = sum(v, change), more = difference(next, free);
  earlier.linear += v.linear;
  earlier.angular += v.angular;
  substep_velocity = v;
  free = next;
  return more;
}

/// Energy of a body and gravity's power on it, at the velocity of the step's end.
GONOGO_HD inline WorldSums energy_of_body(const BodyMass& m, const Quat& orientation, const Velocity& velocity,
                                          const Vec3& g) {
  const auto over = [](Real x, Real inverse) { return inverse > 0 ? double(x) / inverse : 0; };
  const Vec3& v = velocity.linear;
  const Vec3 w = rotate_back(orientation, velocity.angular);
  WorldSums s;
  s.kinetic = 0.5 * (over(v.x * v.x, m.inverse_mass.x) + over(v.y * v.y, m.inverse_mass.y) +
                     over(v.z * v.z, m.inverse_mass.z) + over(w.x * w.x, m.inverse_inertia_B.x) +
                     over(w.y * w.y, m.inverse_inertia_B.y) + over(w.z * w.z, m.inverse_inertia_B.z));
  s.gravity_power =
      over(g.x * v.x, m.inverse_mass.x) + over(g.y * v.y, m.inverse_mass.y) + over(g.z * v.z, m.inverse_mass.z);
  return s;
}

/// Starts a body.
struct BeginBody {
  View<const Velocity> velocity, change;
  View<Velocity> free_velocity, earlier_velocity;

  GONOGO_HD void operator()(BodyIndex b) const {
    begin_body(velocity[b], change[b], free_velocity[b], earlier_velocity[b]);
  }
};

/// Carries a body into the next substep, in worlds where one follows. The velocities of jointed bodies follow from
/// ProjectMechanism.
struct CarryBody {
  View<const BodyMass> mass;
  View<const Velocity> change;
  View<const WorldIndex> world_of_body;
  View<const Momentum> momentum;
  View<Velocity> free_velocity, velocity, extrapolated_velocity, substep_velocity, earlier_velocity, gathered;

  GONOGO_HD void operator()(BodyIndex b) const {
    if (!momentum[world_of_body[b]].ends) return;
    const Velocity more =
        carry_body(velocity[b], change[b], free_velocity[b], substep_velocity[b], earlier_velocity[b]);
    if (const Index slot = mass[b].slot; slot >= 0) {
      gathered[slot] = sum(gathered[slot], more);
      return;
    }
    velocity[b] = sum(velocity[b], more);
    extrapolated_velocity[b] = sum(extrapolated_velocity[b], more);
  }
};

/// Bodies of a mechanism whose velocities are summed together, so that the map is read in long runs.
inline constexpr int kProjectedTogether = 8;

/// Velocities of the jointed bodies from the gathered ones.
struct ProjectMechanism {
  Projection projection;
  View<const WorldIndex> world_of_body;
  View<const Momentum> momentum;
  View<Velocity> velocity, extrapolated_velocity;
  bool first, carried;  // after the warm start; after CarryBody

  /// The first of kProjectedTogether bodies projects all of them.
  GONOGO_HD void operator()(Index k) const {
    if (projection.is_empty(k)) return;
    const Momentum& m = momentum[world_of_body[projection.body[k].body]];
    if (m.done || (carried && !m.ends)) return;
    const Mechanism& of = projection.mechanism[projection.body[k].mechanism];
    GONOGO_ASSERT(k >= of.first_body && k < of.first_body + of.body_count);
    const Index place = k - of.first_body, together = of.body_count / kProjectedTogether * kProjectedTogether;
    if (place >= together) return project<1>(k, m);
    if (place % kProjectedTogether == 0) project<kProjectedTogether>(k, m);
  }

  template <int bodies>
  GONOGO_HD void project(Index k, const Momentum& m) const {
    Velocity next[bodies];
    projection.velocities(k, next);
    for (int i = 0; i < bodies; ++i) set(projection.body[k + i].body, next[i], m);
  }

  GONOGO_HD void set(BodyIndex b, const Velocity& next, const Momentum& m) const {
    if (carried) {
      const Velocity more = difference(next, velocity[b]);
      velocity[b] = next;
      extrapolated_velocity[b] = sum(extrapolated_velocity[b], more);
      return;
    }
    extrapolated_velocity[b] = first ? next : extrapolated(next, velocity[b], m.next_beta);
    velocity[b] = next;
  }
};

/// Residuals of the contacts of a tile.
struct MeasureTile {
  Tiles tiles;
  View<const Contact> contact;
  View<const Velocity> velocity;
  View<const Impulse> impulse;
  View<WorldSums> sums;
  Target target;

  GONOGO_HD void operator()(Index tile) const {
    if (tile >= tiles.count()) return;
    const ContactRange range = tiles.contacts(tile);
    WorldSums s;
    for (ContactIndex i = range.begin; i < range.end; ++i) {
      const double r = residual(i);
      s.residual_square += r * r;
      s.residual_max = std::fmax(s.residual_max, r);
    }
    sums[tile] = s;
  }

  GONOGO_HD_INLINED double residual(ContactIndex i) const {
    const Contact& c = contact[i];
    GONOGO_ASSERT(is_in_cone(c, impulse[i]));
    return contact_residual(c, velocity[c.body_a], velocity[c.body_b], impulse[i], target);
  }
};

GONOGO_HD_INLINED WorldSums operator+(const WorldSums& a, const WorldSums& b) {
  WorldSums sum = a;
  return sum += b;
}

/// Energies of the bodies of a run of one world.
struct MeasureBodyTile {
  View<const WorldParameters> world;
  View<const Index> first_body_tile, world_of_body_tile;
  View<const BodyMass> mass;
  View<const Quat> orientation;
  View<const Velocity> velocity;
  View<WorldSums> sums;  // [body tile]

  GONOGO_HD void operator()(Index t) const {
    const WorldIndex w = world_of_body_tile[t];
    const WorldParameters& p = world[w];
    const Index begin = (t - first_body_tile[w]) * kTileSize, full = begin + kTileSize;
    const Index end = full < p.body_count ? full : p.body_count;
    GONOGO_ASSERT(begin >= 0 && t < first_body_tile[w + 1]);
    WorldSums s;
    for (BodyIndex b = p.first_body + begin; b < p.first_body + end; ++b)
      s += energy_of_body(mass[b], orientation[b], velocity[b], p.gravity);
    sums[t] = s;
  }
};

template <class Exec>
void begin_bodies(Exec exec, State<Exec>& s) {
  for_each_index(
      exec, s.body_count,
      BeginBody{s.velocity.view(), s.velocity_change.view(), s.free_velocity.view(), s.earlier_velocity.view()});
}

template <class Exec>
void measure_body_tiles(Exec exec, State<Exec>& s, View<WorldSums> sums) {
  for_each_index(exec, s.world_of_body_tile.size(),
                 MeasureBodyTile{.world = s.world.view(),
                                 .first_body_tile = s.first_body_tile.view(),
                                 .world_of_body_tile = s.world_of_body_tile.view(),
                                 .mass = s.mass.view(),
                                 .orientation = s.orientation.view(),
                                 .velocity = s.velocity.view(),
                                 .sums = sums});
}

/// `before`: impulses of the update before.
template <class Exec>
UpdateMotor motor_update(State<Exec>& s, View<Real> before, const StepSettings& settings) {
  return {.motor = s.mechanisms.motor.view(),
          .drive = s.mechanisms.drive.view(),
          .velocity = s.extrapolated_velocity.view(),
          .world_of_body = s.world_of_body.view(),
          .momentum = s.momentum.view(),
          .now = s.mechanisms.motor_impulse.view(),
          .before = before,
          .step = settings.substep()};
}

template <class Exec>
CarryBody body_carry(State<Exec>& s) {
  return {.mass = s.mass.view(),
          .change = s.velocity_change.view(),
          .world_of_body = s.world_of_body.view(),
          .momentum = s.momentum.view(),
          .free_velocity = s.free_velocity.view(),
          .velocity = s.velocity.view(),
          .extrapolated_velocity = s.extrapolated_velocity.view(),
          .substep_velocity = s.substep_velocity.view(),
          .earlier_velocity = s.earlier_velocity.view(),
          .gathered = s.mechanisms.gathered.view()};
}

template <class Exec>
ProjectMechanism mechanism_projection(State<Exec>& s, bool first, bool carried) {
  return {.projection = projection(s.mechanisms),
          .world_of_body = s.world_of_body.view(),
          .momentum = s.momentum.view(),
          .velocity = s.velocity.view(),
          .extrapolated_velocity = s.extrapolated_velocity.view(),
          .first = first,
          .carried = carried};
}

}  // namespace gonogo::sim
