// Law of a compliant surface with friction. Normal compliance and friction by powers of the penetration:
//   pressure  p = c_n w^m_n,  w = max(-gap, 0)
//   friction |q| <= c_t w^m_t, against the sliding velocity v; Coulomb with mu = c_t / c_n where m_t = m_n
// Oden & Martins, Models and computational methods for dynamic friction phenomena, CMAME 52, 1985. Friction is
// regularised by the convex function psi with threshold epsilon [m/s] of the same paper:
//   psi(v) = v^2 / epsilon (1 - |v| / (3 epsilon)) for |v| < epsilon, |v| - epsilon / 3 from there on
//   q = -c_t w^m_t psi'(|v|) v / |v|,  psi'(s) = (2 - s / epsilon) s / epsilon, then 1
// psi' is piecewise quadratic and has a continuous slope: 2 / epsilon at rest, 0 at the threshold. Full sliding is
// exact above the threshold; below it the surface creeps in place of sticking.
#pragma once
#include <string>

namespace gonogo::sim::elastic {

struct ContactLaw {
  double c_n = 0;         // [Pa/m^m_n]
  double m_n = 1;         // [-]
  double c_t = 0;         // [Pa/m^m_t]; 0: no friction
  double m_t = 1;         // [-]
  double epsilon = 1e-4;  // [m/s]
};

/// Throws InputError, naming `contact`, for c_n not above 0, c_t below 0, exponents outside 1 to 3 (2-D: below 1;
/// Martins & Oden 1987 need that bound for a solution to exist) and an epsilon not above 0 where there is friction.
void check_law(const ContactLaw& law, int dimension, const std::string& contact);

/// Penalty: linear, with Coulomb's coefficient. c_n [Pa/m].
ContactLaw penalty_law(double c_n, double friction, double epsilon);

/// A rough surface: hemispherical tips of one radius, with heights spread evenly.
struct RoughSurface {
  double density = 0;   // tips per area [1/m^2]
  double radius = 0;    // of the tips [m]
  double height = 0;    // of the highest tip above the lowest [m]
  double modulus = 0;   // E* of the pair, 1 / E* = (1 - nu_1^2) / E_1 + (1 - nu_2^2) / E_2 [Pa]
  double friction = 0;  // [-]
};
/// Greenwood & Williamson, Contact of nominally flat surfaces, 1966, with an even distribution in place of the Gaussian
/// one, where the integral has a closed form: p = (4/3) E* sqrt(R) (density / height) integral_0^w s^(3/2) ds, so that
/// m_n = 5/2 and c_n = (8/15) E* sqrt(R) density / height. Holds for penetrations up to `height`. Throws InputError for
/// numbers not above 0, friction below 0.
ContactLaw rough_law(const RoughSurface& surface, double epsilon);

/// psi and its first two derivatives at the speed s >= 0 [m/s].
double psi(double s, double epsilon);
double psi_slope(double s, double epsilon);
double psi_curvature(double s, double epsilon);

}  // namespace gonogo::sim::elastic
