// Numerics of trials, and of the soil tests behind their table: a measured friction angle holds for its numerics only
// (docs/soils.md).
#pragma once
#include "base/json/json.h"
#include "terrain/bed/bed.h"

namespace gonogo::terrain {

struct Numerics {
  double step = 2e-3;       // [s]
  int substeps = 1;         // of a step
  int iterations = 200;     // max in a substep
  double tolerance = 5e-3;  // residual at which the solver stops; 0: never [m/s]
  sim::Target target = sim::Target::ccp;
  sim::Solver contact = sim::Solver::apgd;  // or a law of the penalty family, which takes whole steps
  double overlap = 0.02;  // penalty: largest, as a share of the radius, in an impact at kOverlapSpeed [-]
};

/// Speed of the impact for which penalty contact is made stiff enough [m/s].
inline constexpr double kOverlapSpeed = 2;
/// Of penalty contact between grains [-].
inline constexpr double kPenaltyRestitution = 0.3;

inline bool operator==(const Numerics& a, const Numerics& b) {
  return a.step == b.step && a.substeps == b.substeps && a.iterations == b.iterations && a.tolerance == b.tolerance &&
         a.target == b.target && a.contact == b.contact && a.overlap == b.overlap;
}

sim::StepSettings step_settings(double grain_diameter, const Numerics& n);

/// "step 0.006 s, 14 x 2 updates to 0 m/s, coulomb"; without the target when it is ccp. Different numerics differ here.
std::string description(const Numerics& n);

/// Writes the keys of a study's `numerics`: step_s, substeps, iterations, tolerance_m_per_s, target unless ccp, and
/// contact and overlap unless complementarity.
void write_numerics(Json& object, const Numerics& n);
/// Reads the same keys.
Numerics read_numerics(const Json& object);

}  // namespace gonogo::terrain
