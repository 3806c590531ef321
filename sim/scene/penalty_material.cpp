#include "sim/scene/penalty_material.h"

#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"

namespace gonogo::sim {
namespace {

void require_positive(double value, const char* what) {
  if (!(value > 0 && std::isfinite(value)))
    throw InputError(std::string("penalty contact: the ") + what + " is " + number_text(value) +
                     "; it must be above zero");
}

/// 2 acos(z) / sqrt(1 - z^2), continued beyond critical damping.
double turn_over_sine(double z) {
  if (std::fabs(z - 1) < 1e-9) return 2;
  return z < 1 ? 2 * std::acos(z) / std::sqrt(1 - z * z) : 2 * std::acosh(z) / std::sqrt(z * z - 1);
}

}  // namespace

PenaltyLaw elastic_law(const ElasticMaterial& a, const ElasticMaterial& b, double restitution) {
  for (const ElasticMaterial* m : {&a, &b}) {
    require_positive(m->youngs_modulus, "modulus of elasticity [Pa]");
    if (!(m->poisson_ratio > -1 && m->poisson_ratio <= 0.5))
      throw InputError("penalty contact: Poisson's ratio is " + number_text(m->poisson_ratio) +
                       "; it must be above -1 and at most 0.5");
  }
  const auto plane = [](const ElasticMaterial& m) {
    return (1 - m.poisson_ratio * m.poisson_ratio) / m.youngs_modulus;
  };
  const auto slide = [](const ElasticMaterial& m) { return (2 - m.poisson_ratio) / m.shear_modulus(); };
  PenaltyLaw law;
  law.modulus = Real(1 / (plane(a) + plane(b)));
  law.shear_modulus = Real(1 / (slide(a) + slide(b)));
  law.restitution = Real(restitution);
  return law;
}

PenaltyLaw law_of_overlap(double share, double speed, double radius, double density, double restitution) {
  require_positive(share, "largest overlap over the radius");
  require_positive(speed, "speed [m/s]");
  require_positive(radius, "radius [m]");
  require_positive(density, "density [kg/m^3]");
  const double mass = density * kPi * 4 / 3 * radius * radius * radius / 2, overlap = share * radius;
  const double modulus = 15 * mass * speed * speed / (16 * std::sqrt(radius / 2) * std::pow(overlap, 2.5));
  const double ratio = 0.25;
  const ElasticMaterial material{2 * (1 - ratio * ratio) * modulus, ratio};
  PenaltyLaw law = elastic_law(material, material, restitution);
  law.stiffness = Real(mass * speed * speed / (overlap * overlap));
  return law;
}

double restitution_of(double damping_ratio) { return std::exp(-damping_ratio * turn_over_sine(damping_ratio)); }

double damping_ratio_of(double restitution) {
  double low = 0, high = 1;
  while (restitution_of(high) > restitution) high *= 2;
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    (restitution_of(middle) > restitution ? low : high) = middle;
  }
  return restitution >= 1 ? 0 : (low + high) / 2;
}

const PenaltyLaw& penalty_law(const SceneWorld& world, const StepSettings& settings, int a, int b) {
  const PenaltyLaw& own = world.penalty[a][b];
  return (settings.solver == Solver::hertz ? own.modulus : own.stiffness) != 0 ? own : settings.penalty;
}

std::vector<PenaltyNumbers> penalty_numbers(const SceneWorld& world, const StepSettings& settings) {
  std::vector<PenaltyNumbers> numbers;
  for (int a = 0; a < kMaxMaterials; ++a)
    for (int b = 0; b < kMaxMaterials; ++b) {
      const PenaltyLaw& law = penalty_law(world, settings, a, b);
      numbers.push_back({law, Real(damping_ratio_of(double(law.restitution)))});
    }
  return numbers;
}

}  // namespace gonogo::sim
