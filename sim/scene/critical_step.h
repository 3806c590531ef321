// Steps that penalty contact can take. Host only.
#pragma once
#include "sim/scene/scene.h"

namespace gonogo::sim {

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
