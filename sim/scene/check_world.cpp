#include "sim/scene/check_world.h"

#include <cmath>
#include <cstdio>
#include <string>
#include <type_traits>

#include "base/error.h"

namespace gonogo::sim {
namespace {

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", x);
  return text;
}

template <class V>
bool is_finite(const V& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

template <class V>
std::string text_of(const V& v) {
  return "(" + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + ")";
}

void require(bool good, const std::string& sentence) {
  if (!good) throw InputError(sentence);
}

/// `sentence` is called when it is needed: worlds have many bodies, and making a sentence takes longer than checking
/// one.
template <class Sentence>
requires std::is_invocable_v<Sentence>
void require(bool good, const Sentence& sentence) {
  if (!good) throw InputError(sentence());
}

template <class V, class Name>
void require_finite(const V& v, const Name& name) {
  require(is_finite(v), [&] { return name() + " is " + text_of(v) + "; it must be finite"; });
}

bool at_least_zero(const Vec3& v) { return v.x >= 0 && v.y >= 0 && v.z >= 0 && is_finite(v); }

template <class Name>
void check_body(const BodyState& s, const BodyMass& m, const Name& name) {
  require(at_least_zero(m.inverse_mass), [&] {
    return name() + " has the inverse mass " + text_of(m.inverse_mass) +
           " 1/kg; masses must be above zero, and an inverse of 0 means fixed";
  });
  require(at_least_zero(m.inverse_inertia_B), [&] {
    return name() + " has the inverse moments of inertia " + text_of(m.inverse_inertia_B) +
           " 1/(kg m^2); moments must be above zero, and an inverse of 0 means that it does not turn";
  });
  require_finite(s.position, [&] { return name() + ": its position"; });
  require_finite(s.velocity, [&] { return name() + ": its velocity"; });
  require_finite(s.angular_velocity, [&] { return name() + ": its angular velocity"; });
  const Quat& q = s.orientation;
  const double norm = double(q.w) * q.w + double(q.x) * q.x + double(q.y) * q.y + double(q.z) * q.z;
  require(std::fabs(norm - 1) < 1e-3, [&] {
    return name() + ": the square of its orientation is " + number(norm) + ", it must be a unit quaternion";
  });
}

void check_law(const PairLaw& law, const std::string& what) {
  const std::pair<const char*, Real> parts[] = {
      {"friction", law.friction},          {"rolling friction", law.rolling_friction},
      {"cohesion", law.cohesion_pressure}, {"spinning friction", law.spinning_friction},
      {"stiffness", law.stiffness},        {"damping", law.damping}};
  for (const auto& [name, value] : parts)
    require(value >= 0 && std::isfinite(value),
            what + "the " + name + " is " + number(value) + "; it must be at least 0");
}

}  // namespace

void check_bodies(const SceneWorld& world, std::size_t w) {
  const std::string place = "world " + std::to_string(w) + ": ";
  require(world.mass.size() == world.body.size(), place + "has " + std::to_string(world.body.size()) + " bodies and " +
                                                      std::to_string(world.mass.size()) +
                                                      " masses; give every body one, by add_body");
  require_finite(world.gravity, [&] { return place + "gravity"; });
  require_finite(world.origin, [&] { return place + "the corner of the domain"; });
  for (std::size_t b = 0; b < world.body.size(); ++b)
    check_body(world.body[b], world.mass[b], [&] { return place + "body " + std::to_string(b); });
  for (int a = 0; a < kMaxMaterials; ++a)
    for (int b = 0; b < kMaxMaterials; ++b)
      check_law(world.law[a][b], place + "materials " + std::to_string(a) + " and " + std::to_string(b) + ": ");
}

void check_settings(const StepSettings& s) {
  require(s.step > 0 && std::isfinite(s.step), "the step is " + number(s.step) + " s; it must be above zero");
  require(s.iterations >= 1,
          "the solver's iterations are " + std::to_string(s.iterations) + "; at least one is needed");
  require(s.substeps >= 1, "the substeps are " + std::to_string(s.substeps) + "; at least one is needed");
  require(s.sort_every >= 1,
          "bodies are sorted every " + std::to_string(s.sort_every) + " steps; at least one is needed");
  require(s.max_slowed >= 0,
          "bodies may be slowed " + std::to_string(s.max_slowed) + " times; the number must be at least 0");
  const std::pair<const char*, Real> parts[] = {{"tolerance", s.tolerance},
                                                {"envelope", s.envelope},
                                                {"recovery speed", s.recovery_speed},
                                                {"recovery share", s.recovery_share},
                                                {"cohesion range", s.cohesion_range}};
  for (const auto& [name, value] : parts)
    require(value >= 0 && std::isfinite(value),
            std::string("the ") + name + " of the step settings is " + number(value) + "; it must be at least 0");
  require(s.recovery_share <= 1, "the recovery share is " + number(s.recovery_share) + "; at most 1 is possible");
}

}  // namespace gonogo::sim
