// One time step of a batch: the half-implicit scheme of Stewart & Trinkle. The solver may divide a step into substeps,
// which converge faster than as many iterations on the whole step (Macklin et al. 2019). Gaps follow the velocities
// from substep to substep. Normals, arms, the maps of mechanisms and the forces are those of the step's start.
//
// Free rotation of a body over one step. Let L = I w be the momentum in body axes. The implicit midpoint rule for
// Euler's equation, with the Cayley rotation of `turned`, is
//     L+ - L = -h w x (I w),   w = I^-1 (L + L+) / 2,   R+ = R cay(h w).
// It keeps every quadratic invariant, so |L|, the momentum in world axes and the energy 1/2 L . I^-1 L are exact
// (Austin, Krishnaprasad, Wang 1993). The engine stores w, the mean of a step, which in body axes is the same before
// and after the turn. The momentum at the step's end is I w - h/2 w x I w, and the next mean w' solves
//     I w' + h/2 w' x I w' = I w - h/2 w x I w.
#pragma once
#include "base/math/vec.h"
#include "base/parallel/for_each.h"
#include "sim/constraint/find_contacts.h"
#include "sim/constraint/prepare_joints.h"
#include "sim/simulation/drive.h"
#include "sim/simulation/simulation.h"
#include "sim/simulation/watch.h"
#include "sim/solver/solve.h"
#include "sim/state/contact_lists.h"

namespace gonogo::sim {

/// Moment of inertia of an axis; 0 for an axis that cannot turn (inverse 0).
GONOGO_HD inline Real moment_of(Real inverse) { return inverse > 0 ? 1 / inverse : 0; }

/// x with A x = b, A given by its columns (Cramer's rule).
GONOGO_HD inline Vec3 solve3(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& right) {
  const Vec3 bc = cross(b, c);
  const Real inverse = 1 / dot(a, bc);
  return {dot(right, bc) * inverse, dot(a, cross(right, c)) * inverse, dot(a, cross(b, right)) * inverse};
}

/// Change of the mean angular velocity from the last step to the next, in body axes [rad/s].
GONOGO_HD inline Vec3 free_spin_change_B(const Vec3& inverse_inertia_B, const Vec3& w_B, Real step) {
  GONOGO_ASSERT(step > 0);
  const Vec3 inertia{moment_of(inverse_inertia_B.x), moment_of(inverse_inertia_B.y), moment_of(inverse_inertia_B.z)};
  const Real half = step / 2;
  // The unknown is the change d of w, so that only it is rounded: F(d) = 0, F' = I + h/2 (w'^ I - (I w')^).
  const Vec3 momentum = scale(inertia, w_B), rate = half * cross(w_B, momentum);
  const Vec3 free{inertia.x > 0 ? Real(1) : 0, inertia.y > 0 ? Real(1) : 0, inertia.z > 0 ? Real(1) : 0};
  const Vec3 held = Vec3{1, 1, 1} - free;
  Vec3 d;
  for (int newton = 0; newton < 3; ++newton) {
    const Vec3 w = w_B + d, l = scale(inertia, w);
    const Vec3 miss = scale(free, scale(inertia, d) + half * cross(w, l) + rate);
    const auto column = [&](const Vec3& e) {
      return scale(free, scale(inertia, e) + half * (cross(w, scale(inertia, e)) + cross(e, l))) + scale(held, e);
    };
    d -= solve3(column({1, 0, 0}), column({0, 1, 0}), column({0, 0, 1}), miss);
  }
  return d;
}

/// Change of a velocity by gravity and free rotation in a substep, and the body's inertia in the world frame.
struct FreeMotion {
  View<const WorldParameters> world;
  View<const WorldIndex> world_of_body;
  View<const BodyMass> mass;
  View<const Quat> orientation;
  View<const Velocity> velocity;
  View<SymMat3> inverse_inertia_W;
  View<Velocity> velocity_change;
  Real substep;

  GONOGO_HD void operator()(BodyIndex b) const {
    GONOGO_ASSERT(is_unit(orientation[b]));
    const BodyMass& m = mass[b];
    const Vec3 g = world[world_of_body[b]].gravity;
    Velocity change;
    change.linear =
        substep * Vec3{m.inverse_mass.x > 0 ? g.x : 0, m.inverse_mass.y > 0 ? g.y : 0, m.inverse_mass.z > 0 ? g.z : 0};
    if (!m.isotropic) {
      inverse_inertia_W[b] = rotated_diagonal(orientation[b], m.inverse_inertia_B);
      const Vec3 spin_B = rotate_back(orientation[b], velocity[b].angular);
      change.angular = rotate(orientation[b], free_spin_change_B(m.inverse_inertia_B, spin_B, substep));
    }
    velocity_change[b] = change;
  }
};

/// x + h v, summed over the substeps; periodic positions stay inside the period.
struct Integrate {
  View<const WorldParameters> world;
  View<const WorldIndex> world_of_body;
  View<const BodyMass> mass;
  View<Velocity> velocity;
  View<const Velocity> earlier_velocity;
  View<Vec3d> position;
  View<Quat> orientation;
  View<const Index> steps, slowed;
  View<Index> slowed_now, flags;
  View<PackedFault> fault;
  StepSettings settings;

  GONOGO_HD void operator()(BodyIndex b) const {
    const Real substep = settings.substep();
    const WorldIndex w = world_of_body[b];
    const WorldParameters& p = world[w];
    GONOGO_ASSERT(p.bin_size.x > 0 && b >= p.first_body);
    const Velocity &last = velocity[b], &earlier = earlier_velocity[b];
    Vec3 path = last.linear + earlier.linear, turn = last.angular + earlier.angular;
    const Real speed = square_of_speed(last), max_speed = p.bin_size.x / settings.step;
    Index raised = 0;
    if (!(speed < max_speed * max_speed)) {
      raised = flags_of_fast(b, w, speed);
      if (raised == 0 && mass[b].inverse_mass.x > 0) {
        const Real kept = kSlowedTo * max_speed / std::sqrt(speed);
        path = path * kept;
        turn = turn * kept;
        slow(b, w, kept);
      }
    }
    Vec3d x = position[b] + static_cast<Vec3d>(path) * double(substep);
    if (!(dot(x, x) < 1e24)) raised |= flag_not_finite;
    if (mass[b].inverse_mass.z > 0 && x.z < p.origin.z) raised |= flag_left_domain;
    if (raised != 0) flag(b, w, raised);
    x.x = folded(x.x, p.origin.x, p.period.x);
    x.y = folded(x.y, p.origin.y, p.period.y);
    position[b] = x;
    if (turn.x != 0 || turn.y != 0 || turn.z != 0) orientation[b] = turned(orientation[b], turn, substep);
    GONOGO_ASSERT(is_unit(orientation[b]));
  }

  /// Flags of a body that would cross more than a bin in a step; 0: it may be slowed.
  GONOGO_HD Index flags_of_fast(BodyIndex b, WorldIndex w, Real speed) const {
    if (mass[b].inverse_mass.x == 0) return speed < kAnySpeedSquare ? 0 : flag_not_finite;
    if (!(speed < kAnySpeedSquare)) return flag_not_finite | flag_too_fast;
    return mass[b].slot >= 0 || slowed[w] >= settings.max_slowed ? flag_too_fast : 0;
  }

  GONOGO_HD void slow(BodyIndex b, WorldIndex w, Real kept) const {
    velocity[b].linear = velocity[b].linear * kept;
    velocity[b].angular = velocity[b].angular * kept;
    atomic_increment(slowed_now[w]);
  }

  GONOGO_HD void flag(BodyIndex b, WorldIndex w, Index raised) const {
    atomic_raise(flags[w], raised);
    atomic_min(fault[w], packed(Fault{raised, steps[w] + 1, b - world[w].first_body}));
  }

  static constexpr Real kAnySpeedSquare = Real(1e12);  // above any physical speed [m^2/s^2]
  static constexpr Real kSlowedTo = Real(0.99);        // share of the max speed

  /// [m^2/s^2]; 1 rad/s counts as 0.01 m/s.
  GONOGO_HD static Real square_of_speed(const Velocity& v) {
    return dot(v.linear, v.linear) + dot(v.angular, v.angular) * Real(1e-4);
  }
};

/// The motion without contacts.
template <class Exec>
void prepare_motion(Exec exec, State<Exec>& s, const StepSettings& settings) {
  for_each_index(exec, s.body_count,
                 FreeMotion{.world = s.world.view(),
                            .world_of_body = s.world_of_body.view(),
                            .mass = s.mass.view(),
                            .orientation = s.orientation.view(),
                            .velocity = s.velocity.view(),
                            .inverse_inertia_W = s.inverse_inertia_W.view(),
                            .velocity_change = s.velocity_change.view(),
                            .substep = settings.substep()});
  prepare_mechanisms(exec, s, settings);
}

/// The contacts of each body, and tiles of contacts.
template <class Exec>
void list_contacts(Exec exec, State<Exec>& s) {
  beside(
      exec, [&](Exec main) { build_incidence(main, s); }, [&](Exec side) { cut_into_tiles(side, s); });
}

template <class Exec>
void prepare_contacts(Exec exec, State<Exec>& s, const StepSettings& settings) {
  sort_into_bins(exec, s);
  find_contacts(exec, s, settings);
  list_contacts(exec, s);
}

template <class Exec>
void apply_forces(Exec exec, State<Exec>& s, const StepSettings& settings) {
  apply_controllers(exec, s, settings);
  apply_force_elements(exec, s, settings);
}

template <class Exec>
Integrate integration(State<Exec>& s, const StepSettings& settings) {
  return {.world = s.world.view(),
          .world_of_body = s.world_of_body.view(),
          .mass = s.mass.view(),
          .velocity = s.velocity.view(),
          .earlier_velocity = s.earlier_velocity.view(),
          .position = s.position.view(),
          .orientation = s.orientation.view(),
          .steps = s.steps.view(),
          .slowed = s.slowed.view(),
          .slowed_now = s.slowed_now.view(),
          .flags = s.flags.view(),
          .fault = s.fault.view(),
          .settings = settings};
}

template <class Exec>
void integrate(Exec exec, State<Exec>& s, const StepSettings& settings) {
  for_each_index(exec, s.body_count, integration(s, settings));
  finish_step(exec, s, settings);
}

/// One step of all worlds, from the state of the bodies to that a step later.
/// In: positions, orientations and velocities of the bodies; motors, histories of elements and the contacts' impulses
/// of the step before, in store[1 - parity]. Out: the same a step later, the impulses in store[parity], and what the
/// stages say that they compute (State lists it). The caller swaps the parity. `own` is scratch memory of solve(). No
/// array of the State or of `own` may alias another. Worlds that have stopped or raised a flag are stepped as all
/// others. On the GPU a step that finds more contacts than fit does nothing; see Progress.
template <class Exec>
void step(Exec exec, State<Exec>& s, SolverStorage<Exec>& own, const StepSettings& settings) {
  GONOGO_ASSERT(settings.step > 0 && settings.substeps >= 1);
  GONOGO_ASSERT(s.position.size() == s.body_count && s.orientation.size() == s.body_count);
  GONOGO_ASSERT(s.shape.size() == s.shape_count && s.world.size() == s.world_count);
  beside(
      exec, [&](Exec main) { prepare_contacts(main, s, settings); },
      [&](Exec side) { prepare_motion(side, s, settings); });
  apply_forces(exec, s, settings);
  solve(exec, s, own, settings);
  integrate(exec, s, settings);
}

/// The same step, one stage after the other. Calls timed(stage, work) for each.
template <class Exec, class Timed>
void step_by_stage(Exec exec, State<Exec>& s, SolverStorage<Exec>& own, const StepSettings& settings,
                   const Timed& timed) {
  timed(Stage::bins, [&] { sort_into_bins(exec, s); });
  timed(Stage::contacts, [&] { find_contacts(exec, s, settings); });
  timed(Stage::lists, [&] { list_contacts(exec, s); });
  timed(Stage::motion, [&] { prepare_motion(exec, s, settings); });
  timed(Stage::forces, [&] { apply_forces(exec, s, settings); });
  timed(Stage::solve, [&] { solve(exec, s, own, settings); });
  timed(Stage::integrate, [&] { integrate(exec, s, settings); });
}

/// The search for contacts alone.
template <class Exec, class Timed>
void search_by_stage(Exec exec, State<Exec>& s, const StepSettings& settings, const Timed& timed) {
  timed(Stage::bins, [&] { sort_into_bins(exec, s); });
  timed(Stage::contacts, [&] { find_contacts(exec, s, settings); });
}

}  // namespace gonogo::sim
