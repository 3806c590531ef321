// Records of a world as the engine holds it: numerical parameters, laws of contact, masses, large shapes, faults; and
// positions along periodic axes.
#pragma once
#include <cmath>

#include "base/math/vec.h"
#include "base/parallel/for_each.h"
#include "sim/law/penalty_law.h"
#include "sim/state/contact.h"
#include "sim/state/iteration.h"

namespace gonogo::sim {

/// Position folded into [origin, origin + period); a period of 0: not periodic.
GONOGO_HD inline double folded(double x, double origin, double period) {
  if (period <= 0) return x;
  return x - period * std::floor((x - origin) / period);
}

/// Shortest periodic image of the difference between two points that lie less than 1.5 periods apart.
GONOGO_HD inline double nearest_image(double d, double period) {
  const double half = period / 2;
  return period <= 0 || (d <= half && d >= -half) ? d : d > 0 ? d - period : d + period;
}
GONOGO_HD inline Vec3d nearest_image(const Vec3d& d, const Vec3d& period) {
  return {nearest_image(d.x, period.x), nearest_image(d.y, period.y), d.z};
}

/// How two materials touch.
struct PairLaw {
  Real friction = 0;           // sliding, [-]
  Real rolling_friction = 0;   // [-], times the sphere's effective radius
  Real cohesion_pressure = 0;  // tensile strength on the area pi r^2 of the smaller sphere or capsule [Pa]
  Real spinning_friction = 0;  // [-], times the sphere's effective radius
  Real stiffness = 0;          // of a compliant contact along its normal [N/m]; 0: rigid
  Real damping = 0;            // of a compliant contact along its normal [N s/m]
};

/// Numerical parameters of a step, the same for all worlds of a batch.
struct StepSettings {
  Real step = 1e-3f;              // [s]
  Index iterations = 100;         // max iterations of the solver in a substep
  Real tolerance = 0;             // root-mean-square residual at which a world stops iterating [m/s]; 0: never
  Real envelope = 2e-3f;          // contacts are found up to this gap [m]
  Real recovery_speed = 0.1f;     // overlaps are pushed out no faster than this [m/s]
  Real recovery_share = 0.2f;     // share of an overlap pushed out in one step
  Real cohesion_range = 0.5e-3f;  // cohesion acts up to this gap [m]
  Real give = 0;                  // of contacts whose law is rigid, see counted_gap [-]; 0: none
  Real give_share = 0.1f;         // share of an overlap that a contact with give is pushed out of in a substep
  ContactLaw contact = ContactLaw::complementarity;
  Iteration iteration = Iteration::apgd;  // the next two: of complementarity
  Target target = Target::ccp;
  Index substeps = 1;       // into which the solver divides a step; see step.h
  Index sort_every = 2000;  // steps of a world after which its bodies are sorted in memory, if they have mixed
  /// How often a world may slow a free body (one without joints) to one bin per step before flag_too_fast stops it. A
  /// grain pinched between two rigid bodies can leave at more than 30 m/s at any step size.
  Index max_slowed = 0;
  PenaltyLaw penalty;  // of pairs of materials for which the scene states no stiffness

  /// Length of a substep [s]; reported forces and impulses are those of the last substep.
  GONOGO_HD Real substep() const {
    GONOGO_ASSERT(step > 0 && substeps >= 1);
    return step / Real(substeps);
  }

  /// Bias per metre of gap of a contact with give [1/s].
  GONOGO_HD Real give_rate() const {
    GONOGO_ASSERT(give > 0 && give_share > 0 && give_share <= 1);
    return give_share / substep();
  }

  ContactMethod method() const { return {contact, iteration}; }

  GONOGO_HD IterationRules rules() const { return {iteration, target, iterations, tolerance, substeps}; }

  bool operator==(const StepSettings&) const = default;
};

/// Bias of a contact [m/s]; the solver keeps the normal speed above its negative. A gap may close in this substep, an
/// overlap opens at a limited speed; a compliant contact gets the resting speed of its spring and damper. `rate`,
/// `softness`: see Contact.
template <class T>
GONOGO_HD_INLINED T bias_of_gap(const T& gap, const T& rate, const T& softness, const StepSettings& settings) {
  const T zero = constant<T>(0), fastest = constant<T>(-settings.recovery_speed);
  const T bias = rate * gap, push_out = settings.recovery_share * bias;
  return select(either(softness > zero, gap >= zero), bias, select(push_out < fastest, fastest, push_out));
}

/// Rigid contacts with few updates in a substep are unstable. An overlap pushes with a delay, so slow modes of many
/// grains grow until friction limits them, and the bed creeps. A contact with give is a damped spring that the updates
/// can follow. It is stable if the part of its softness that one update takes in, give * step.n * mobility, is above
/// 0.02 for two updates in a substep and above 0.05 for one. With `give` = 0.6 that part is 0.12 for a grain with six
/// loaded neighbours and 0.06 for one with twelve. The stiffness is give_share / (give * mobility * substep^2)
/// (docs/log/creep.md).
///
/// Returns how much of a gap counts. What an overlap exceeds its impulse by is pushed out no faster than
/// recovery_speed, as with rigid contacts; a deeper part does not count yet. `rate`: of the contact; `held`: its
/// softness times its normal impulse [m/s].
template <class T>
GONOGO_HD_INLINED T counted_gap(const T& gap, const T& rate, const T& held, const StepSettings& settings) {
  if (settings.give <= 0) return gap;
  const T zero = constant<T>(0);
  const T deepest = -(select(held > zero, held, zero) + settings.recovery_speed) / rate;
  return select(both(rate == constant<T>(settings.give_rate()), gap < deepest), deepest, gap);
}

struct WorldParameters {
  Vec3 gravity;   // [m/s^2]
  Vec3d origin;   // lower corner of the domain [m]
  Vec3d period;   // length of the domain along x and y where periodic, 0 where open [m]
  Vec3 bin_size;  // [m]
  Index bins[3] = {3, 3, 3};
  Index first_bin = 0;
  BodyIndex first_body = 0;
  Index body_count = 0;
  ShapeIndex first_shape = 0;
  Index shape_count = 0;
  Index first_large = 0, large_count = 0;  // into the list of large shapes, which are not binned
  Index first_motor = 0, motor_count = 0;
  PairLaw law[kMaxMaterials][kMaxMaterials];
};

/// Mass properties; zero means that the motion is prescribed. Separate inverse masses per world axis describe a body on
/// rails: a test-rig wheel carries its whole vehicle along x and only its hub along z.
struct BodyMass {
  Vec3 inverse_mass;           // along world x, y, z [1/kg]
  Vec3 inverse_inertia_B;      // about body axes [1/(kg m^2)]
  std::int32_t isotropic = 1;  // inverse_inertia_B has three equal entries; set by flatten
  std::int32_t slot = -1;      // of its mechanism body, or -1 where nothing is jointed to it; set by flatten
};

GONOGO_HD inline bool is_fixed(const BodyMass& mass) {
  const Vec3 &m = mass.inverse_mass, &i = mass.inverse_inertia_B;
  return m.x == 0 && m.y == 0 && m.z == 0 && i.x == 0 && i.y == 0 && i.z == 0;
}

/// Change of the normal speed of a contact point on the body by a unit normal impulse, approximately [1/kg].
GONOGO_HD inline Real mobility(const BodyMass& mass, const Vec3& arm, const Vec3& normal) {
  const Vec3 &l = mass.inverse_mass, &i = mass.inverse_inertia_B, off_centre = cross(arm, normal);
  const Real aside = dot(off_centre, off_centre);
  const bool central = aside < Real(1e-6) * dot(arm, arm);
  const Real by_turning = central ? Real(0) : aside * std::fmax(i.x, std::fmax(i.y, i.z));
  const Real result = dot(scale(l, normal), normal) + by_turning;
  GONOGO_ASSERT(!(result < 0));
  return result;
}

/// A shape that is not binned, and its bounding box of this step.
struct LargeShape {
  ShapeIndex shape = 0;
  Vec3d middle;  // of the box around it [m]
  Vec3 half;     // half edges of that box along the world's axes [m]
  Vec3 up;       // of a plane: unit normal; what is further above it than its radius is out of reach. Others: zero

  /// Whether a sphere about `d` [m, from the middle] may touch it.
  GONOGO_HD bool reaches(const Vec3& d, Real radius) const {
    return std::fabs(d.z) < half.z + radius && std::fabs(d.x) < half.x + radius && std::fabs(d.y) < half.y + radius &&
           dot(d, up) < radius;
  }
};

/// Bits of the flag word of a world.
enum StepFlag : Index {
  flag_not_finite = 1,   // a velocity or position is NaN or infinite: smaller step or more iterations
  flag_too_fast = 2,     // a body moves more than a bin in a step, see StepSettings::max_slowed: smaller step
  flag_left_domain = 4,  // a body fell out of the domain: deeper domain or rougher base
};

/// The first fault of a world: of the step that raised the first flag, the body with the lowest index, for any order of
/// the threads.
struct Fault {
  Index flags = 0;      // of this body in this step; 0: nothing has gone wrong
  Index step = 0;       // counted from 1
  BodyIndex body = -1;  // in its world
};

/// Smaller is earlier, then lower in index.
using PackedFault = std::uint64_t;
inline constexpr PackedFault kNoFault = ~PackedFault(0);

GONOGO_HD inline PackedFault packed(const Fault& f) {
  if (f.flags == 0) return kNoFault;
  GONOGO_ASSERT(f.flags > 0 && f.flags < 8 && f.step >= 0 && f.body >= 0);
  return PackedFault(std::uint32_t(f.step)) << 34 | PackedFault(std::uint32_t(f.body)) << 3 | PackedFault(f.flags);
}

GONOGO_HD inline Fault unpacked(PackedFault p) {
  if (p == kNoFault) return {};
  return {Index(p & 7), Index(p >> 34), BodyIndex(p >> 3 & 0x7FFFFFFF)};
}

}  // namespace gonogo::sim
