// What the sources of this folder share: errors as public types, numbers in and out, the inside of worlds.
#pragma once
#include <gonogo/sim.h>

#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "sim/simulation/simulation.h"

namespace gonogo::api {

/// Returns what `work` returns; errors of the library leave as the public types.
template <class Work>
auto guarded(Work&& work) {
  try {
    return work();
  } catch (const gonogo::InputError& error) {
    throw InputError(error.what());
  } catch (const gonogo::DeviceError& error) {
    throw DeviceError(error.what());
  } catch (const gonogo::Cancelled& error) {
    throw Cancelled(error.what());
  }
}

inline Vec3 vec3_of(const gonogo::Vec3& v) { return {double(v.x), double(v.y), double(v.z)}; }
inline Vec3 vec3_of(const Vec3d& v) { return {v.x, v.y, v.z}; }
inline gonogo::Vec3 real_of(const Vec3& v) { return {Real(v.x), Real(v.y), Real(v.z)}; }
inline Vec3d double_of(const Vec3& v) { return {v.x, v.y, v.z}; }

inline sim::PairLaw law_of(const ContactLaw& law) {
  sim::PairLaw result;
  result.friction = Real(law.friction);
  result.rolling_friction = Real(law.rolling_friction);
  result.cohesion_pressure = Real(law.cohesion_pressure);
  return result;
}

inline sim::Backend backend_of(Device device) {
  return device == Device::cuda ? sim::Backend::cuda : sim::Backend::cpu;
}

struct World::Impl {
  sim::SceneWorld scene;
};

struct Simulation::Impl {
  std::vector<sim::SceneWorld> world;
  std::unique_ptr<sim::Simulation> engine;

  /// The engine trusts its numbers. Throw gonogo::InputError for those that do not exist.
  sim::Simulation& at(int w) const { return check(w, world.size(), "world"), *engine; }
  sim::Simulation& with_body(int w, int body) const {
    return at(w), check(body, world[std::size_t(w)].body.size(), "body"), *engine;
  }
  sim::Simulation& with_motor(int w, int motor) const {
    return at(w), check(motor, world[std::size_t(w)].motor.size(), "motor"), *engine;
  }

 private:
  static void check(int number, std::size_t count, const char* what) {
    if (number < 0 || std::size_t(number) >= count)
      throw gonogo::InputError(std::string(what) + " " + std::to_string(number) + ": there are " +
                               std::to_string(count));
  }
};

}  // namespace gonogo::api
