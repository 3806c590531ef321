// Laws of penalty contact from what is known of the materials, and the steps that they allow. Host only.
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

/// Overlap of a Hertzian contact, as a share of the radius, for which its stiffness bounds the step.
inline constexpr double kOverlapOfStep = 0.01;
/// Contacts of a body at once: as many equal spheres touch one. A mesh has as many points as the search gives it.
inline constexpr int kContactsOfStep = 12, kMeshContactsOfStep = 64;

/// The longest step of penalty contact, and the body that asks for it.
struct CriticalStep {
  double step = 0;  // [s]; infinite for a world where nothing moves
  BodyIndex body = -1;
};

/// Explicit steps of a damped oscillator are stable below (2 / w) (sqrt(1 + z^2) - z) when damping is half a step late
/// (Belytschko, Liu & Moran 2000, section 6.2). w^2 is bounded as the step sizes of the solvers are, by sharing each
/// body's mass among its contacts (split.h): w^2 <= n max(k_n / m_n, k_t / m_t + k_r / m_r) over contacts of two equal
/// bodies, with n contacts each.
CriticalStep critical_step(const SceneWorld& world, const StepSettings& settings);

/// pi r sqrt(density / G) / (0.1631 nu + 0.8766): a Rayleigh wave's time around a sphere, of which other programs take
/// a fifth as their step (Thornton & Randall 1988) [s]. `shear_modulus`: G [Pa].
double rayleigh_time(double radius, double density, double shear_modulus, double poisson_ratio);

/// Throws InputError, naming world `w` and the number, for laws out of range and a step above the critical one.
void check_penalty(const SceneWorld& world, std::size_t w, const StepSettings& settings);

}  // namespace gonogo::sim
