// Records of the penalty family of contact, in which overlaps push bodies apart. penalty_force.h computes forces from
// them. A law of the family is a struct such as HertzLaw (hertz.h), listed in contact_law.h:
//   kDamping                               damping coefficient over damping ratio times sqrt(mass * stiffness) [-]
//   spring(law, overlap, radius, touched)  elastic part of a contact; `touched`: in the step before
//   stiffness(law, radius, share)          at an overlap of this share of the radius, for the critical step
//   is_stated(law)                         whether two materials state what this law needs
//   neck(law, radius)                      gap up to which surfaces that have touched hold each other [m]
//   numbers(law)                           the numbers that it needs, and their ranges
#pragma once
#include <vector>

#include "sim/shape/shape.h"

namespace gonogo::sim {

/// Pairs of materials of a world.
inline constexpr Index kPenaltyPairs = kMaxMaterials * kMaxMaterials;

/// How surfaces attract each other: Derjaguin, Muller & Toporov (1975) or Johnson, Kendall & Roberts (1971).
enum class Adhesion : std::int32_t { dmt, jkr };

/// How two materials touch. Friction, rolling friction and cohesion are those of their PairLaw.
/// sim/scene/penalty_setup.h computes the stiffness from elastic moduli or from a largest overlap.
struct PenaltyLaw {
  Real stiffness = 0;                   // spring_damper: along the normal [N/m]
  Real tangential_share = Real(2) / 7;  // spring_damper: tangential over normal stiffness [-]
  Real modulus = 0;                     // hertz: 1 / E* = (1 - nu_a^2) / E_a + (1 - nu_b^2) / E_b [Pa]
  Real shear_modulus = 0;               // hertz: 1 / G* = (2 - nu_a) / G_a + (2 - nu_b) / G_b [Pa]
  Real restitution = Real(0.5);         // of an impact along the normal, above 0, at most 1 [-]
  Real work_of_adhesion = 0;            // hertz: to part a unit of area [J/m^2]
  Adhesion adhesion = Adhesion::dmt;

  bool operator==(const PenaltyLaw&) const = default;
};

/// The same as kernels read it.
struct PenaltyNumbers {
  PenaltyLaw law;
  Real damping_ratio = 0;  // of the restitution [-]
};

/// What a contact remembers of the step before. Forces and moments are those on the owner's body, world frame.
struct alignas(16) ContactHistory {
  Vec3 force;          // of the tangential spring [N]
  Real stiffness = 0;  // of the tangential spring [N/m]; 0: it did not touch
  Vec3 moment;         // of the rolling and spinning spring [N m]
  Real pad0 = 0;
  Vec3 normal;  // towards the owner
  Real pad1 = 0;
};

/// The elastic part of a contact along the normal.
struct NormalSpring {
  Real push = 0, pull = 0;  // repulsion and attraction [N]
  Real stiffness = 0;       // dF/d(overlap) of the repulsion [N/m]
  Real tangential = 0;      // stiffness of the tangential spring [N/m]; 0: no contact
  Real holding = 0;         // pull-off force by which the load that friction feels exceeds push - pull [N]
};

/// Stiffness of a contact for the critical step [N/m].
struct ContactStiffness {
  double normal = 0, tangential = 0;
};

/// A number that a law needs, for messages: "the `what` of their penalty law is `value`; it must be `range`".
struct LawNumber {
  bool good;
  const char* what;
  double value;
  const char* range;
};

}  // namespace gonogo::sim
