// Laws of penalty contact from what is known of the materials. Host only.
#pragma once
#include <vector>

#include "sim/scene/scene.h"

namespace gonogo::sim {

/// An isotropic elastic material.
struct ElasticMaterial {
  double youngs_modulus = 0;  // [Pa]
  double poisson_ratio = 0;   // [-]

  double shear_modulus() const { return youngs_modulus / (2 * (1 + poisson_ratio)); }
};

/// The law of `hertz` for two materials; `restitution` of an impact along the normal [-]. Throws InputError for a
/// modulus not above zero and a ratio outside of -1 to 0.5.
PenaltyLaw elastic_law(const ElasticMaterial& a, const ElasticMaterial& b, double restitution);

/// The softest law by which two equal spheres that meet at `speed` [m/s] overlap by at most `share` of their radius
/// [m]. `density` [kg/m^3]. It has the stiffness of spring_damper, m* (v / overlap)^2, and the moduli of hertz for a
/// ratio of 0.25, from E* = 15 m* v^2 / (16 sqrt(R*) overlap^(5/2)), the energy of a Hertzian impact. Throws InputError
/// for numbers not above zero.
PenaltyLaw law_of_overlap(double share, double speed, double radius, double density, double restitution);

/// Restitution of a spring and damper of this ratio, exp(-2 z acos(z) / sqrt(1 - z^2)): the impact ends when the force
/// is zero, so that it never pulls (Schwager & Poeschel 2007). Hertz's law with the damping of damping_of() has the
/// same (Antypov & Elliott 2011).
double restitution_of(double damping_ratio);

/// The inverse, for 0 < restitution <= 1.
double damping_ratio_of(double restitution);

/// The scene's law of two materials, or the settings' where that states no stiffness for their solver.
const PenaltyLaw& penalty_law(const SceneWorld& world, const StepSettings& settings, int a, int b);

/// Laws of all pairs of materials as kernels read them.
std::vector<PenaltyNumbers> penalty_numbers(const SceneWorld& world, const StepSettings& settings);

}  // namespace gonogo::sim
