// `hertz`: springs by Hertz along the normal and by Mindlin along the tangent, k_t = 8 G* a. The tangential spring
// grows by increments of the force and shrinks with k_t while the contact unloads (Thornton, Cummins & Cleary 2013).
#pragma once
#include <cmath>

#include "base/units.h"
#include "sim/law/penalty_law.h"

namespace gonogo::sim {

/// Radius of the contact circle by Johnson, Kendall & Roberts (1971):  a^2 / R - sqrt(2 pi w a / E*) = overlap. The
/// left side is convex, so Newton's method climbs down from above it without passing the root [m].
GONOGO_HD inline Real jkr_radius(Real overlap, Real radius, Real modulus, Real work) {
  GONOGO_ASSERT(radius > 0 && modulus > 0 && work > 0);
  const Real root = std::sqrt(2 * Real(kPi) * work / modulus);
  const Real at_zero = std::cbrt(root * root * radius * radius);
  Real a = at_zero + std::sqrt(radius * std::fmax(overlap, Real(0)));
  for (int k = 0; k < 8; ++k) {
    const Real s = std::sqrt(a);
    const Real slope = 2 * a / radius - root / (2 * s);
    if (!(slope > 0)) return a;
    a -= (a * a / radius - root * s - overlap) / slope;
  }
  return a;
}

/// Overlap, below zero, at which a JKR contact that is drawn apart breaks: 3 a^2 / R at a^(3/2) = R / 4 sqrt(2 pi w /
/// E*) [m].
GONOGO_HD inline Real jkr_break(Real radius, Real modulus, Real work) {
  GONOGO_ASSERT(radius > 0 && modulus > 0 && work > 0);
  const Real root = std::sqrt(2 * Real(kPi) * work / modulus);
  const Real a = std::cbrt(root * root * radius * radius / 16);
  return -3 * a * a / radius;
}

struct HertzLaw {
  /// Tsuji, Tanaka & Ishida (1992), with the factor sqrt(5 / 6) of the tangent stiffness, for which Antypov & Elliott
  /// (2011) map it onto the linear law.
  static constexpr Real kDamping = Real(1.8257418583505538);

  GONOGO_HD static NormalSpring spring(const PenaltyLaw& law, Real overlap, Real radius, bool touched) {
    GONOGO_ASSERT(radius > 0 && law.modulus > 0 && law.shear_modulus >= 0);
    const bool jkr = law.work_of_adhesion > 0 && law.adhesion == Adhesion::jkr;
    const Real least = jkr && touched ? jkr_break(radius, law.modulus, law.work_of_adhesion) : Real(0);
    if (!(overlap > least)) return {};
    const Real a = jkr ? jkr_radius(overlap, radius, law.modulus, law.work_of_adhesion) : std::sqrt(radius * overlap);
    NormalSpring s;
    s.push = Real(4) / 3 * law.modulus * a * a * a / radius;
    s.stiffness = 2 * law.modulus * a;
    s.tangential = 8 * law.shear_modulus * a;
    if (jkr) {
      s.pull = std::sqrt(8 * Real(kPi) * law.work_of_adhesion * law.modulus * a * a * a);
      s.holding = 3 * Real(kPi) * law.work_of_adhesion * radius;  // twice the pull-off force 3/2 pi w R (Thornton 1991)
    } else if (law.work_of_adhesion > 0) {
      s.pull = s.holding = 2 * Real(kPi) * law.work_of_adhesion * radius;
    }
    return s;
  }

  static ContactStiffness stiffness(const PenaltyLaw& law, double radius, double share) {
    GONOGO_ASSERT(radius >= 0 && share > 0);
    const double a = std::sqrt(radius / 2 * share * radius);
    return {2 * double(law.modulus) * a, 8 * double(law.shear_modulus) * a};
  }

  static bool is_stated(const PenaltyLaw& law) { return law.modulus != 0; }

  static Real neck(const PenaltyLaw& law, Real radius) {
    if (law.adhesion != Adhesion::jkr || !(law.work_of_adhesion > 0) || !(radius > 0)) return 0;
    return -jkr_break(radius, law.modulus, law.work_of_adhesion);
  }

  static std::vector<LawNumber> numbers(const PenaltyLaw& l) {
    return {
        {l.modulus > 0 && std::isfinite(l.modulus), "modulus [Pa]", l.modulus, "above zero"},
        {l.shear_modulus >= 0 && std::isfinite(l.shear_modulus), "shear modulus [Pa]", l.shear_modulus, "at least 0"},
        {l.work_of_adhesion >= 0 && std::isfinite(l.work_of_adhesion), "work of adhesion [J/m^2]", l.work_of_adhesion,
         "at least 0"}};
  }
};

}  // namespace gonogo::sim
