#include "sim/scene/critical_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"
#include "sim/scene/penalty_material.h"
#include "sim/state/penalty.h"

namespace gonogo::sim {
namespace {

double largest(const Vec3& v) { return double(std::max({v.x, v.y, v.z})); }

/// Stiffness of a contact [N/m] and its damping ratio.
struct Spring {
  double normal = 0, tangential = 0, rolling = 0, ratio = 0;  // rolling [N m/rad]
};

Spring spring_of(const PenaltyLaw& law, const PairLaw& pair, double radius, bool hertz) {
  Spring s;
  s.ratio = damping_ratio_of(double(law.restitution));
  if (pair.stiffness > 0) {
    s.normal = pair.stiffness;
    s.tangential = double(law.tangential_share) * pair.stiffness;
  } else if (hertz) {
    const double a = std::sqrt(radius / 2 * kOverlapOfStep * radius);
    s.normal = 2 * double(law.modulus) * a;
    s.tangential = 8 * double(law.shear_modulus) * a;
  } else {
    s.normal = law.stiffness;
    s.tangential = double(law.tangential_share) * law.stiffness;
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

void check_law(const PenaltyLaw& law, bool hertz, const std::string& where) {
  const auto require = [&](bool good, const char* what, double value, const char* range) {
    if (!good)
      throw InputError(where + what + " of their penalty law is " + number_text(value) + "; it must be " + range);
  };
  const auto finite = [](Real x) { return std::isfinite(x); };
  if (hertz) {
    require(law.modulus > 0 && finite(law.modulus), "modulus [Pa]", law.modulus, "above zero");
    require(law.shear_modulus >= 0 && finite(law.shear_modulus), "shear modulus [Pa]", law.shear_modulus, "at least 0");
    require(law.work_of_adhesion >= 0 && finite(law.work_of_adhesion), "work of adhesion [J/m^2]", law.work_of_adhesion,
            "at least 0");
  } else {
    require(law.stiffness > 0 && finite(law.stiffness), "stiffness [N/m]", law.stiffness, "above zero");
    require(law.tangential_share >= 0 && finite(law.tangential_share), "tangential over normal stiffness",
            law.tangential_share, "at least 0");
    require(law.work_of_adhesion == 0, "work of adhesion [J/m^2]", law.work_of_adhesion,
            "0 for spring_damper; use hertz, or the cohesion of the pair's law");
  }
  require(law.restitution > 0 && law.restitution <= 1, "restitution", law.restitution, "above 0 and at most 1");
}

/// A neck of JKR breaks within the gap up to which contacts are found.
void check_neck(const SceneWorld& world, const PenaltyLaw& law, const StepSettings& settings,
                const std::string& where) {
  if (law.adhesion != Adhesion::jkr || !(law.work_of_adhesion > 0)) return;
  Real radius = 0;
  for (const Shape& s : world.shape) radius = std::max(radius, mean_radius(s));
  const Real neck = radius > 0 ? -jkr_break(radius, law.modulus, law.work_of_adhesion) : Real(0);
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
  const bool hertz = settings.solver == Solver::hertz;
  const std::vector<int> present = materials(world);
  CriticalStep least{std::numeric_limits<double>::infinity(), -1};
  for (const Shape& s : world.shape) {
    const BodyMass& mass = world.mass[s.body];
    if (is_fixed(mass)) continue;
    const double radius = double(std::max(mean_radius(s), smallest_half(s)));
    for (const int other : present) {
      const PairLaw& pair = world.law[s.material][other];
      const Spring spring = spring_of(penalty_law(world, settings, s.material, other), pair, radius, hertz);
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
  const bool hertz = settings.solver == Solver::hertz;
  const std::vector<int> present = materials(world);
  for (const int a : present)
    for (const int b : present) {
      const PenaltyLaw& law = penalty_law(world, settings, a, b);
      check_law(law, hertz, of_materials(w, a, b));
      if (hertz) check_neck(world, law, settings, of_materials(w, a, b));
    }
  if (settings.substeps != 1)
    throw InputError("the substeps are " + std::to_string(settings.substeps) +
                     "; penalty contact takes whole steps, so set 1 and divide the step by them");
  const CriticalStep critical = critical_step(world, settings);
  if (double(settings.step) > critical.step * (1 + 1e-6))
    throw InputError("world " + std::to_string(w) + ": the step is " + number_text(double(settings.step)) +
                     " s and the contacts of body " + std::to_string(critical.body) + " allow at most " +
                     number_text(critical.step) + " s; shorten the step, or make the contact softer");
}

}  // namespace gonogo::sim
