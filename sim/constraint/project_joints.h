// Velocities of a mechanism's bodies from the gathered ones, inside the iteration; see mechanism.h.
#pragma once
#include "sim/state/mechanism.h"

namespace gonogo::sim {

/// v = P v_gathered + c. Whole bodies and single numbers are summed in the same order.
struct Projection {
  View<const Mechanism> mechanism;
  View<const MechanismBody> body;
  View<const Real> projection;
  View<const Velocity> gathered;  // [mechanism body]

  /// Whether mechanism body k belongs to an empty place in a batch.
  GONOGO_HD bool is_empty(Index k) const {
    const Mechanism& m = mechanism[body[k].mechanism];
    return k - m.first_body >= m.body_count;
  }

  /// Velocities of `bodies` mechanism bodies from k on, all of one mechanism; for the host.
  template <int bodies>
  GONOGO_HD void velocities(Index k, Velocity (&v)[bodies]) const {
    Real sum[6 * bodies];
    const Mechanism& m = mechanism[body[k].mechanism];
    GONOGO_ASSERT(k >= m.first_body && k + bodies <= m.first_body + m.body_count);
    const Real* from = projection.data + m.projection + 6 * (k - m.first_body);
    add_columns(m, from, gathered.data + m.first_body, sum);
    for (int i = 0; i < bodies; ++i) {
      const Real* of = sum + 6 * i;
      v[i] = {{of[0], of[1], of[2]}, 0, {of[3], of[4], of[5]}, 0};
    }
  }

  /// `from`: the map's first column at the first number wanted; `gathered`: of the mechanism's first body.
  template <int kCount>
  GONOGO_HD static void add_columns(const Mechanism& m, const Real* from, const Velocity* gathered,
                                    Real (&sum)[kCount]) {
    const Index stride = m.column_stride();
    const Real* offset = from + std::size_t(m.unknowns()) * stride;
    for (int i = 0; i < kCount; ++i) sum[i] = offset[i];
    GONOGO_UNROLLED(3)
    for (Index slot = 0; slot < m.body_count; ++slot, from += 6 * stride) {
      const Velocity& g = gathered[slot];
      const Real x[6] = {g.linear.x, g.linear.y, g.linear.z, g.angular.x, g.angular.y, g.angular.z};
      for (int c = 0; c < 6; ++c)
        for (int i = 0; i < kCount; ++i) sum[i] = multiply_add(from[c * stride + i], x[c], sum[i]);
    }
  }
};

template <class Exec>
Projection projection(MechanismStore<Exec>& s) {
  return {s.mechanism.view(), s.body.view(), s.projection.view(), s.gathered.view()};
}

}  // namespace gonogo::sim
