// Names of contact in studies and options: complementarity, or a law of the penalty family.
#pragma once
#include <string>
#include <vector>

#include "sim/state/momentum.h"

namespace gonogo::sim {

/// "complementarity" for every solver outside of the penalty family.
inline const char* contact_name(Solver solver) {
  if (solver == Solver::spring_damper) return "spring_damper";
  return solver == Solver::hertz ? "hertz" : "complementarity";
}

/// "complementarity", "spring_damper", "hertz".
const std::vector<std::string>& contact_names();
/// The default solver for "complementarity". Throws InputError that lists the names.
Solver contact_named(const std::string& name);

}  // namespace gonogo::sim
