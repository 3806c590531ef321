// How trials are stepped, and the soil tests whose table they use: a friction angle belongs to its numerics
// (docs/soils.md).
#pragma once
#include "base/json/json.h"
#include "terrain/bed/bed.h"

namespace gonogo::terrain {

struct Numerics {
  double step = 2e-3;       // [s]
  int substeps = 1;         // parts of a step that the solver goes through
  int iterations = 200;     // most in a part
  double tolerance = 5e-3;  // residual at which the solver stops; 0: never [m/s]
  sim::Target target = sim::Target::ccp;
};

inline bool operator==(const Numerics& a, const Numerics& b) {
  return a.step == b.step && a.substeps == b.substeps && a.iterations == b.iterations && a.tolerance == b.tolerance &&
         a.target == b.target;
}

inline sim::StepSettings step_settings(double grain_diameter, const Numerics& n) {
  sim::StepSettings s = bed_step_settings(grain_diameter, n.step, n.iterations, n.tolerance);
  s.substeps = n.substeps;
  s.target = n.target;
  return s;
}

/// "6e-3 s, 14 x 2 updates to 0 m/s, ccp": for names that tell numerics apart.
std::string description(const Numerics& n);

/// Keys as in a study's `numerics`: step_s, substeps, iterations, tolerance_m_per_s, target (where not ccp).
void write_numerics(Json& object, const Numerics& n);
/// From an object that has them.
Numerics read_numerics(const Json& object);

}  // namespace gonogo::terrain
