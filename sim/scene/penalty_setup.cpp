#include "sim/scene/penalty_setup.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"
#include "sim/law/contact_law.h"

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
  const bool stated = with_penalty_law(settings.contact, [&](auto law) { return decltype(law)::is_stated(own); });
  return stated ? own : settings.penalty;
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

namespace {

double largest(const Vec3& v) { return double(std::max({v.x, v.y, v.z})); }

/// Stiffness of a contact [N/m] and its damping ratio.
struct Spring : ContactStiffness {
  double rolling = 0, ratio = 0;  // rolling [N m/rad]
};

Spring spring_of(ContactLaw contact, const PenaltyLaw& numbers, const PairLaw& pair, double radius) {
  Spring s;
  s.ratio = damping_ratio_of(double(numbers.restitution));
  if (pair.stiffness > 0) {
    s.normal = pair.stiffness;
    s.tangential = double(numbers.tangential_share) * pair.stiffness;
  } else {
    static_cast<ContactStiffness&>(s) =
        with_penalty_law(contact, [&](auto law) { return decltype(law)::stiffness(numbers, radius, kOverlapOfStep); });
  }
  if (pair.rolling_friction > 0 || pair.spinning_friction > 0) s.rolling = s.tangential * radius * radius / 4;
  return s;
}

/// Of a shape that meets its like.
double step_of(const Shape& shape, const BodyMass& mass, const Spring& spring, const PairLaw& pair) {
  const double move = largest(mass.inverse_mass), turn = largest(mass.inverse_inertia_B);
  const double arm = double(bounding_radius(shape)) + double(length(shape.offset_B));
  const int contacts = shape.type == ShapeType::mesh ? kMeshContactsOfStep : kContactsOfStep;
  const double square =
      2 * contacts *
      std::max(spring.normal * move, spring.tangential * (move + turn * arm * arm) + spring.rolling * turn);
  if (!(square > 0)) return std::numeric_limits<double>::infinity();
  const double frequency = std::sqrt(square);
  const double damped = std::max(spring.ratio, double(pair.damping) * contacts * move / frequency);
  return 2 / frequency * (std::sqrt(1 + damped * damped) - damped);
}

std::string of_materials(std::size_t w, int a, int b) {
  return "world " + std::to_string(w) + ": materials " + std::to_string(a) + " and " + std::to_string(b) + ": the ";
}

void check_law(ContactLaw contact, const PenaltyLaw& numbers, const std::string& where) {
  auto needed = with_penalty_law(contact, [&](auto law) { return decltype(law)::numbers(numbers); });
  needed.push_back({numbers.restitution > 0 && numbers.restitution <= 1, "restitution", numbers.restitution,
                    "above 0 and at most 1"});
  for (const LawNumber& n : needed)
    if (!n.good)
      throw InputError(where + n.what + " of their penalty law is " + number_text(n.value) + "; it must be " + n.range);
}

/// The neck of a contact breaks within the gap up to which contacts are found.
void check_neck(const SceneWorld& world, const PenaltyLaw& numbers, const StepSettings& settings,
                const std::string& where) {
  Real radius = 0;
  for (const Shape& s : world.shape) radius = std::max(radius, mean_radius(s));
  const Real neck = with_penalty_law(settings.contact, [&](auto law) { return decltype(law)::neck(numbers, radius); });
  if (neck > settings.envelope)
    throw InputError(where + "necks of JKR reach " + number_text(double(neck)) + " m and contacts are found up to " +
                     number_text(double(settings.envelope)) + " m; make the envelope larger");
}

/// Materials that shapes have.
std::vector<int> materials(const SceneWorld& world) {
  std::vector<int> found;
  for (int m = 0; m < kMaxMaterials; ++m)
    if (std::any_of(world.shape.begin(), world.shape.end(), [&](const Shape& s) { return s.material == m; }))
      found.push_back(m);
  return found;
}

}  // namespace

CriticalStep critical_step(const SceneWorld& world, const StepSettings& settings) {
  const std::vector<int> present = materials(world);
  CriticalStep least{std::numeric_limits<double>::infinity(), -1};
  for (const Shape& s : world.shape) {
    const BodyMass& mass = world.mass[s.body];
    if (is_fixed(mass)) continue;
    const double radius = double(std::max(mean_radius(s), smallest_half(s)));
    for (const int other : present) {
      const PairLaw& pair = world.law[s.material][other];
      const Spring spring = spring_of(settings.contact, penalty_law(world, settings, s.material, other), pair, radius);
      const double step = step_of(s, mass, spring, pair);
      if (step < least.step) least = {step, s.body};
    }
  }
  return least;
}

double rayleigh_time(double radius, double density, double shear_modulus, double poisson_ratio) {
  return kPi * radius * std::sqrt(density / shear_modulus) / (0.1631 * poisson_ratio + 0.8766);
}

void check_penalty(const SceneWorld& world, std::size_t w, const StepSettings& settings) {
  const std::vector<int> present = materials(world);
  for (const int a : present)
    for (const int b : present) {
      const PenaltyLaw& law = penalty_law(world, settings, a, b);
      check_law(settings.contact, law, of_materials(w, a, b));
      check_neck(world, law, settings, of_materials(w, a, b));
    }
  if (settings.substeps != 1)
    throw InputError("the substeps are " + std::to_string(settings.substeps) +
                     "; penalty contact takes whole steps, so set 1 and divide the step by them");
  if (settings.give > 0)
    throw InputError("the give is " + number_text(double(settings.give)) +
                     "; penalty contact has springs of its own, so set 0");
  const CriticalStep critical = critical_step(world, settings);
  if (double(settings.step) > critical.step * (1 + 1e-6))
    throw InputError("world " + std::to_string(w) + ": the step is " + number_text(double(settings.step)) +
                     " s and the contacts of body " + std::to_string(critical.body) + " allow at most " +
                     number_text(critical.step) + " s; shorten the step, or make the contact softer");
}

}  // namespace gonogo::sim
