// Stages around the update of the contacts, shared by the host's iteration and by jacobi_scan on either backend.
#pragma once
#include "sim/joint/project.h"
#include "sim/solver/body_update.h"
#include "sim/solver/split.h"
#include "sim/state/motor.h"
#include "sim/state/tiles.h"

namespace gonogo::sim {

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
      const Contact& c = contact[i];
      const double r = contact_residual(c, velocity[c.body_a], velocity[c.body_b], impulse[i], target);
      s.residual_square += r * r;
      s.residual_max = std::fmax(s.residual_max, r);
    }
    sums[tile] = s;
  }
};

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
