// The contact laws by name: complementarity, and the laws of the penalty family.
#pragma once
#include <string>
#include <vector>

#include "base/error.h"
#include "sim/law/hertz.h"
#include "sim/law/spring_damper.h"

/// The registry of the penalty family: a line for each law, its name in files and options and its type. A new law is a
/// file beside hertz.h and a line here.
#define GONOGO_PENALTY_LAWS(LAW)      \
  LAW(spring_damper, SpringDamperLaw) \
  LAW(hertz, HertzLaw)

namespace gonogo::sim {

#define GONOGO_ENUMERATOR(name, Type) name,
/// `complementarity`: rigid contact, solved by iteration (Iteration, Target). The others are the penalty family, which
/// solves nothing: overlaps push bodies apart, in short steps.
enum class ContactLaw : std::int32_t { complementarity, GONOGO_PENALTY_LAWS(GONOGO_ENUMERATOR) };
#undef GONOGO_ENUMERATOR

inline bool is_penalty(ContactLaw law) { return law != ContactLaw::complementarity; }

/// What a solution by complementarity satisfies. `ccp`: the convex relaxation of Anitescu, in which a sliding contact
/// opens at mu |v_t|. `coulomb`: Coulomb's law, reached by iterating on that term (De Saxce & Feng 1998).
enum class Target : std::int32_t { ccp, coulomb };

/// Names in files, options and reports, in the order of the numbers: "complementarity", "spring_damper", ...
const std::vector<std::string>& contact_names();
const char* name_of(ContactLaw law);
/// Throws InputError that lists the names.
ContactLaw contact_named(const std::string& name);

/// "ccp", "coulomb"
const std::vector<std::string>& target_names();
const char* name_of(Target target);
/// Throws InputError that lists the names.
Target target_named(const std::string& name);

/// Place of `name` among `names`. Throws InputError: `what` "..." does not exist; use a, b or c.
std::size_t place_of_name(const std::vector<std::string>& names, const std::string& name, const char* what);

template <class... Law>
struct LawList {};

/// f(Law{}) of the law of this number in the list, which ends with void.
template <class F, class First, class... Rest>
auto with_law_in(LawList<First, Rest...>, std::int32_t number, const F& f) {
  if constexpr (sizeof...(Rest) > 1)
    if (number > 0) return with_law_in(LawList<Rest...>{}, number - 1, f);
  GONOGO_ASSERT(number == 0);
  return f(First{});
}

/// f(HertzLaw{}) for `hertz`, and so on. `law` must be of the penalty family.
template <class F>
auto with_penalty_law(ContactLaw law, const F& f) {
#define GONOGO_LAW_TYPE(name, Type) Type,
  return with_law_in(LawList<GONOGO_PENALTY_LAWS(GONOGO_LAW_TYPE) void>{}, std::int32_t(law) - 1, f);
#undef GONOGO_LAW_TYPE
}

}  // namespace gonogo::sim
