// One time step of a batch: the half-implicit scheme of Stewart & Trinkle, in parts where asked (small steps converge
// faster than many iterations: Macklin et al. 2019). Reads like the algorithm; formulas live in
// the kernels it calls.
#pragma once
#include "sim/contact/find.h"
#include "sim/element/drive.h"
#include "sim/element/watch.h"
#include "sim/joint/prepare.h"
#include "sim/solver/split.h"
#include "sim/world/spin.h"

namespace gonogo::sim {

/// v + h gravity, the angular velocity of free rotation (spin.h), and the inertia of this step in the world frame.
struct FreeMotion {
  View<const WorldParameters> world;
  View<const WorldIndex> world_of_body;
  View<const BodyMass> mass;
  View<const Quat> orientation;
  View<const Velocity> velocity;
  View<SymMat3> inverse_inertia_W;
  View<Velocity> free_velocity;
  Real step;

  GONOGO_HD void operator()(BodyIndex b) const {
    const BodyMass& m = mass[b];
    const Vec3 g = world[world_of_body[b]].gravity;
    Velocity v = velocity[b];
    v.linear +=
        step * Vec3{m.inverse_mass.x > 0 ? g.x : 0, m.inverse_mass.y > 0 ? g.y : 0, m.inverse_mass.z > 0 ? g.z : 0};
    if (!m.isotropic) {
      inverse_inertia_W[b] = rotated_diagonal(orientation[b], m.inverse_inertia_B);
      const Vec3 spin_B = rotate_back(orientation[b], v.angular);
      v.angular += rotate(orientation[b], free_spin_change_B(m.inverse_inertia_B, spin_B, step));
    }
    free_velocity[b] = v;
  }
};

/// x + h v; periodic positions stay inside the period.
struct Integrate {
  View<const WorldParameters> world;
  View<const WorldIndex> world_of_body;
  View<const BodyMass> mass;
  View<const Velocity> velocity;
  View<Vec3d> position;
  View<Quat> orientation;
  View<Index> flags;
  StepSettings settings;

  GONOGO_HD void operator()(BodyIndex b) const {
    const Velocity& v = velocity[b];
    const Real step = settings.substep();
    const WorldIndex w = world_of_body[b];
    const WorldParameters& p = world[w];
    Vec3d x = position[b] + static_cast<Vec3d>(v.linear) * double(step);
    check(b, w, x);
    x.x = folded(x.x, p.origin.x, p.period.x);
    x.y = folded(x.y, p.origin.y, p.period.y);
    position[b] = x;
    if (v.angular.x != 0 || v.angular.y != 0 || v.angular.z != 0)
      orientation[b] = turned(orientation[b], v.angular, step);
  }

  GONOGO_HD void check(BodyIndex b, WorldIndex w, const Vec3d& x) const {
    const Velocity& v = velocity[b];
    const Real speed_square = dot(v.linear, v.linear) + dot(v.angular, v.angular) * Real(1e-4);
    Index raised = 0;
    if (!(speed_square < Real(1e12)) || !(dot(x, x) < 1e24)) raised |= flag_not_finite;
    const Real reach = world[w].bin_size.x / settings.step;
    if (mass[b].inverse_mass.x > 0 && !(speed_square < reach * reach)) raised |= flag_too_fast;
    if (mass[b].inverse_mass.z > 0 && x.z < world[w].origin.z) raised |= flag_left_domain;
    if (raised != 0) atomic_raise(flags[w], raised);
  }
};

/// The step is complete: the worlds' clocks go on.
struct CountStep {
  View<Index> steps;  // [world]
  View<Progress> progress;
  GONOGO_HD void operator()(WorldIndex w) const {
    ++steps[w];
    if (w == 0) ++progress[0].steps;
  }
};

/// Velocities and impulses at the end of a substep, and positions from them.
template <class Exec>
void move(Exec exec, State<Exec>& s, const StepSettings& settings) {
  for_each_index(exec, s.body_count,
                 FreeMotion{s.world.view(), s.world_of_body.view(), s.mass.view(), s.orientation.view(),
                            s.velocity.view(), s.inverse_inertia_W.view(), s.free_velocity.view(), settings.substep()});
  apply_force_elements(exec, s, settings);
  prepare_mechanisms(exec, s, settings.substep());
  solve(exec, s, settings);
  for_each_index(exec, s.body_count,
                 Integrate{s.world.view(), s.world_of_body.view(), s.mass.view(), s.velocity.view(), s.position.view(),
                           s.orientation.view(), s.flags.view(), settings});
}

template <class Exec>
void step(Exec exec, State<Exec>& s, const StepSettings& settings) {
  sort_into_bins(exec, s);
  find_contacts(exec, s, settings);
  build_incidence(exec, s);
  cut_into_tiles(exec, s);
  split_masses(exec, s, settings);
  apply_controllers(exec, s, settings);
  move(exec, s, settings);
  for (Index k = 1; k < settings.substeps; ++k) {
    for_each_counted(exec, contact_count(s), AdvanceGaps{s.velocity.view(), s.contact.view(), settings});
    move(exec, s, settings);
  }
  update_monitors(exec, s, settings);
  for_each_index(exec, s.world_count, CountStep{s.steps.view(), s.progress.view()});
}

}  // namespace gonogo::sim
