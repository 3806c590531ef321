#include "sim/scene/target_name.h"

#include "base/error.h"

namespace gonogo::sim {

const std::vector<std::string>& target_names() {
  static const std::vector<std::string> names{name_of(Target::ccp), name_of(Target::coulomb)};
  return names;
}

Target target_named(const std::string& name) {
  for (const Target target : {Target::ccp, Target::coulomb})
    if (name == name_of(target)) return target;
  throw InputError("contact law \"" + name + "\" does not exist; use ccp or coulomb");
}

}  // namespace gonogo::sim
