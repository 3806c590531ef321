// Contact laws by name, as files and options give them; the other way round is name_of() in numerics.h.
#pragma once
#include <string>
#include <vector>

#include "sim/state/momentum.h"

namespace gonogo::terrain {

/// "ccp", "coulomb".
const std::vector<std::string>& target_names();
/// Throws InputError naming those that exist.
sim::Target target_named(const std::string& name);

}  // namespace gonogo::terrain
