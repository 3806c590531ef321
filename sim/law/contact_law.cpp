#include "sim/law/contact_law.h"

#include <algorithm>

namespace gonogo::sim {

std::size_t place_of_name(const std::vector<std::string>& names, const std::string& name, const char* what) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return std::size_t(found - names.begin());
  std::string list;
  for (std::size_t k = 0; k < names.size(); ++k)
    list += (k == 0 ? "" : k + 1 == names.size() ? " or " : ", ") + names[k];
  throw InputError(std::string(what) + " \"" + name + "\" does not exist; use " + list);
}

const std::vector<std::string>& contact_names() {
#define GONOGO_LAW_NAME(name, Type) #name,
  static const std::vector<std::string> names{"complementarity", GONOGO_PENALTY_LAWS(GONOGO_LAW_NAME)};
#undef GONOGO_LAW_NAME
  return names;
}

const char* name_of(ContactLaw law) {
  GONOGO_ASSERT(std::size_t(law) < contact_names().size());
  return contact_names()[std::size_t(law)].c_str();
}

ContactLaw contact_named(const std::string& name) {
  return ContactLaw(place_of_name(contact_names(), name, "contact"));
}

const std::vector<std::string>& target_names() {
  static const std::vector<std::string> names{"ccp", "coulomb"};
  return names;
}

const char* name_of(Target target) { return target_names()[std::size_t(target)].c_str(); }

Target target_named(const std::string& name) { return Target(place_of_name(target_names(), name, "contact law")); }

}  // namespace gonogo::sim
