// Names of contact laws in files, options and reports.
#pragma once
#include <string>
#include <vector>

#include "sim/state/target.h"

namespace gonogo::sim {

inline const char* name_of(Target target) { return target == Target::coulomb ? "coulomb" : "ccp"; }

/// "ccp", "coulomb".
const std::vector<std::string>& target_names();
/// Throws InputError that lists the names.
Target target_named(const std::string& name);

}  // namespace gonogo::sim
