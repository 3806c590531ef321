#include "sim/elastic/law.h"

#include <cmath>

#include "base/error.h"
#include "base/line.h"

namespace gonogo::sim::elastic {
namespace {

void check_exponent(double m, const char* name, int dimension, const std::string& contact) {
  const double most = dimension == 3 ? 3 : 1e3;
  if (m >= 1 && m <= most) return;
  throw InputError(contact + line(": exponent %s is %g; allowed is ", name, m) +
                   (dimension == 3 ? "1 to 3 in 3-D" : "1 and above in 2-D") +
                   "; 1 is a penalty, 2.5 a rough surface of evenly spread tips");
}

}  // namespace

void check_law(const ContactLaw& law, int dimension, const std::string& contact) {
  if (!(law.c_n > 0) || !std::isfinite(law.c_n))
    throw InputError(contact + line(": stiffness c_n is %g Pa/m^m_n; it must be above 0", law.c_n));
  if (!(law.c_t >= 0) || !std::isfinite(law.c_t))
    throw InputError(contact + line(": friction c_t is %g Pa/m^m_t; it must be 0 or above", law.c_t));
  check_exponent(law.m_n, "m_n", dimension, contact);
  check_exponent(law.m_t, "m_t", dimension, contact);
  if (law.c_t > 0 && !(law.epsilon > 0))
    throw InputError(contact + line(": epsilon is %g m/s; with friction it must be above 0, as 1e-4", law.epsilon));
}

ContactLaw penalty_law(double c_n, double friction, double epsilon) {
  return {.c_n = c_n, .m_n = 1, .c_t = friction * c_n, .m_t = 1, .epsilon = epsilon};
}

ContactLaw rough_law(const RoughSurface& s, double epsilon) {
  if (!(s.density > 0 && s.radius > 0 && s.height > 0 && s.modulus > 0 && s.friction >= 0))
    throw InputError(
        line("rough surface: density %g 1/m^2, radius %g m, height %g m and modulus %g Pa must be above 0, ", s.density,
             s.radius, s.height, s.modulus) +
        line("friction %g must be 0 or above", s.friction));
  const double c_n = 8.0 / 15 * s.modulus * std::sqrt(s.radius) * s.density / s.height;
  return {.c_n = c_n, .m_n = 2.5, .c_t = s.friction * c_n, .m_t = 2.5, .epsilon = epsilon};
}

double psi(double s, double epsilon) {
  return s < epsilon ? s * s / epsilon * (1 - s / (3 * epsilon)) : s - epsilon / 3;
}

double psi_slope(double s, double epsilon) { return s < epsilon ? (2 - s / epsilon) * s / epsilon : 1; }

double psi_curvature(double s, double epsilon) { return s < epsilon ? 2 * (1 - s / epsilon) / epsilon : 0; }

}  // namespace gonogo::sim::elastic
