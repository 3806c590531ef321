// `spring_damper`: linear springs and dampers (Cundall & Strack 1979), the tangential stiffness a share of the normal
// one. Contacts of pairs that state a stiffness of their own (PairLaw) follow it under every law of the family.
#pragma once
#include <cmath>

#include "sim/law/penalty_law.h"

namespace gonogo::sim {

GONOGO_HD inline NormalSpring linear_spring(Real overlap, Real stiffness, Real tangential_share) {
  GONOGO_ASSERT(stiffness > 0 && tangential_share >= 0);
  if (!(overlap > 0)) return {};
  return {stiffness * overlap, 0, stiffness, tangential_share * stiffness, 0};
}

struct SpringDamperLaw {
  static constexpr Real kDamping = 2;

  GONOGO_HD static NormalSpring spring(const PenaltyLaw& law, Real overlap, Real /*radius*/, bool /*touched*/) {
    return linear_spring(overlap, law.stiffness, law.tangential_share);
  }

  static ContactStiffness stiffness(const PenaltyLaw& law, double /*radius*/, double /*share*/) {
    return {double(law.stiffness), double(law.tangential_share) * double(law.stiffness)};
  }

  static bool is_stated(const PenaltyLaw& law) { return law.stiffness != 0; }

  static Real neck(const PenaltyLaw& /*law*/, Real /*radius*/) { return 0; }

  static std::vector<LawNumber> numbers(const PenaltyLaw& l) {
    return {{l.stiffness > 0 && std::isfinite(l.stiffness), "stiffness [N/m]", l.stiffness, "above zero"},
            {l.tangential_share >= 0 && std::isfinite(l.tangential_share), "tangential over normal stiffness",
             l.tangential_share, "at least 0"},
            {l.work_of_adhesion == 0, "work of adhesion [J/m^2]", l.work_of_adhesion,
             "0 for spring_damper; use hertz, or the cohesion of the pair's law"}};
  }
};

}  // namespace gonogo::sim
