// Impulses of joints and springs in the latest step, when somebody asks for them.
#pragma once
#include "sim/joint/row.h"
#include "sim/simulation/joint_load.h"

namespace gonogo::sim {

/// p = -A^-1 (J v_gathered + b), from the system that prepare_mechanisms() solved at the step's start.
struct RecoverImpulse {
  View<const Mechanism> mechanism;
  View<const Row> row;
  View<const double> system;
  View<const Velocity> gathered;
  View<double> impulse;  // [row]

  GONOGO_HD void operator()(Index i) const {
    const Mechanism& m = mechanism[row[i].mechanism];
    const Index local = i - m.first_row;
    if (local < 0 || local >= m.row_count) return;  // an empty place in a batch
    const double* solved = system.data + m.system + std::size_t(local) * m.stride();
    const double pivot = solved[local];
    const double* of_velocity = solved + m.first_right();
    double sum = of_velocity[m.unknowns()];
    for (Index slot = 0; slot < m.body_count; ++slot) {
      const Velocity& v = gathered[m.first_body + slot];
      const double* share = of_velocity + 6 * slot;
      sum += share[0] * v.linear.x + share[1] * v.linear.y + share[2] * v.linear.z + share[3] * v.angular.x +
             share[4] * v.angular.y + share[5] * v.angular.z;
    }
    impulse[i] = -sum / pivot;
  }
};

/// Adds one row. A row is either a force at a's point, without moment about it, or a moment.
inline void add_row(JointLoad& load, const Row& row, double impulse, double step) {
  const double(&d)[6] = row.direction[0];
  const bool pushes = d[0] != 0 || d[1] != 0 || d[2] != 0;
  if (pushes) load.force += Vec3d{d[0], d[1], d[2]} * (impulse / step);
  if (!pushes) load.moment += Vec3d{d[3], d[4], d[5]} * (impulse / step);
}

template <class Exec>
void recover_impulses(Exec exec, MechanismStore<Exec>& s) {
  for_each_index(
      exec, s.row.size(),
      RecoverImpulse{s.mechanism.view(), s.row.view(), s.system.view(), s.gathered.view(), s.row_impulse.view()});
}

}  // namespace gonogo::sim
