#include "sim/state/iteration.h"

namespace gonogo::sim {

const std::vector<std::string>& iteration_names() {
#define GONOGO_ITERATION_NAME(name) #name,
  static const std::vector<std::string> names{GONOGO_ITERATIONS(GONOGO_ITERATION_NAME)};
#undef GONOGO_ITERATION_NAME
  return names;
}

const char* name_of(Iteration iteration) {
  GONOGO_ASSERT(std::size_t(iteration) < iteration_names().size());
  return iteration_names()[std::size_t(iteration)].c_str();
}

const std::vector<std::string>& method_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = iteration_names();
    all.insert(all.end(), contact_names().begin() + 1, contact_names().end());
    return all;
  }();
  return names;
}

const char* name_of(const ContactMethod& method) {
  return is_penalty(method.contact) ? name_of(method.contact) : name_of(method.iteration);
}

ContactMethod method_named(const std::string& name) {
  const std::size_t place = place_of_name(method_names(), name, "solver"), iterations = iteration_names().size();
  if (place < iterations) return {ContactLaw::complementarity, Iteration(place)};
  return {ContactLaw(place - iterations + 1), Iteration::apgd};
}

}  // namespace gonogo::sim
