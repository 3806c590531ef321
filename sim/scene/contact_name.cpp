#include "sim/scene/contact_name.h"

#include "base/error.h"

namespace gonogo::sim {

const std::vector<std::string>& contact_names() {
  static const std::vector<std::string> names{contact_name(Solver::apgd), contact_name(Solver::spring_damper),
                                              contact_name(Solver::hertz)};
  return names;
}

Solver contact_named(const std::string& name) {
  for (const Solver solver : {Solver::apgd, Solver::spring_damper, Solver::hertz})
    if (name == contact_name(solver)) return solver;
  throw InputError("contact \"" + name + "\" does not exist; use complementarity, spring_damper or hertz");
}

}  // namespace gonogo::sim
