// Worlds that ranks divide among them, and all that they compute as one string of bytes.
#pragma once
#include <cmath>
#include <functional>
#include <string>

#include "sim/scene/scene.h"
#include "sim/simulation/simulation.h"
#include "tests/sim/driven_wheel.h"
#include "tests/support/scenes.h"

namespace gonogo::test {

struct DividedScene {
  sim::SceneWorld world;
  sim::StepSettings settings;
  std::function<void(sim::Simulation&, Index step)> drive;  // called before each step
  std::vector<sim::WorldBody> loaded;                       // whose contact forces are compared
};

/// Grains of several shapes in a box of planes; gravity turns, so that all of them slosh from side to side.
inline DividedScene shaken_tank() {
  using namespace sim;
  DividedScene scene;
  SceneWorld& w = scene.world;
  Draw draw(77);
  w.origin = {0, 0, 0};
  w.size = {0.6, 0.3, 0.5};
  w.set_law(0, 0, {Real(0.4), Real(0.05), 100});
  add_plane(w);
  add_plane(w, {0, 0, 0}, about_y(kPi / 2));
  add_plane(w, {0.6, 0, 0}, about_y(-kPi / 2));
  add_plane(w, {0, 0, 0}, about_x(-kPi / 2));
  add_plane(w, {0, 0.3, 0}, about_x(kPi / 2));
  for (int k = 0; k < 1200; ++k) {
    const Vec3d at = (grid_place(k, 20, 10) + Vec3d{0.5, 0.5, 0.5}) * 0.029 + draw.direction() * 0.001;
    const Real radius = Real(draw.between(0.009, 0.014));
    if (k % 7 == 0)
      w.add_ellipsoid({at, {}, {}, {}}, {radius, radius * Real(0.8), radius * Real(0.7)}, 2600, 0);
    else if (k % 11 == 0)
      add_box(w, {at, {}, {}, {}}, {radius * Real(0.7), radius * Real(0.6), radius * Real(0.5)}, 0.01);
    else
      w.add_sphere(at, radius, 2600, 0);
  }
  // Every part holds these: a box too large for the bins, and grains that a monitor watches or a force pulls.
  scene.loaded = {{0, add_box(w, {{0.3, 0.15, 0.3}, {}, {}, {}}, {0.1f, 0.08f, 0.06f}, 5)}, {0, 0}, {0, 40}};
  w.force.push_back(tow_load(100, ReferenceFrame::world, {-1, 0, 0}, 0.3, {}));
  Monitor monitor;
  monitor.body = 640;
  monitor.time_limit = 100;
  monitor.stride = 10;
  w.monitor.push_back(monitor);
  scene.settings.iterations = 20;
  scene.settings.step = Real(2e-3);
  scene.drive = [](Simulation& simulation, Index step) {
    const double angle = 0.9 * std::sin(0.05 * double(step));
    simulation.set_gravity(0, {Real(9.81 * std::sin(angle)), 0, Real(-9.81 * std::cos(angle))});
  };
  return scene;
}

/// A driven wheel whose bed the parts divide beneath it. `few`: substeps of few iterations, with give.
inline DividedScene wheel_on_bed(bool few) {
  DividedScene scene;
  scene.world = driven_wheel(601);
  scene.settings.iterations = few ? 2 : 30;
  if (few) {
    scene.settings.substeps = 6;
    scene.settings.give = Real(0.6);
    scene.settings.target = sim::Target::coulomb;
  } else {
    scene.settings.tolerance = Real(6e-3);
  }
  scene.loaded = {{0, 0}, {0, sim::BodyIndex(scene.world.body.size()) - 2}};
  return scene;
}

/// Two streams of grains through each other in a periodic box, so that all change sides; bodies are sorted often.
inline DividedScene mixing_streams() {
  using namespace sim;
  DividedScene scene;
  SceneWorld& w = scene.world;
  Draw draw(5);
  w.size = {0.5, 0.25, 0.4};
  w.periodic_x = w.periodic_y = true;
  w.set_law(0, 0, {Real(0.3), 0, 0});
  add_plane(w);
  for (int k = 0; k < 1000; ++k) {
    const int b = w.add_sphere((grid_place(k, 14, 7) + Vec3d{0.5, 0.5, 0.5}) * 0.034 + draw.direction() * 0.003,
                               Real(draw.between(0.010, 0.012)), 2600, 0);
    w.body[std::size_t(b)].velocity = static_cast<Vec3>(draw.direction() * 1.5);
  }
  scene.settings.iterations = 15;
  scene.settings.step = Real(1e-3);
  scene.settings.sort_every = 40;
  scene.settings.iteration = Iteration::jacobi;
  scene.loaded = {{0, 0}};
  return scene;
}

inline DividedScene divided_scene(const std::string& name) {
  if (name == "tank") return shaken_tank();
  if (name == "mixing") return mixing_streams();
  return wheel_on_bed(name == "wheel-substeps");
}

inline void take_steps(sim::Simulation& simulation, const DividedScene& scene, Index first, Index count) {
  for (Index k = first; k < first + count; ++k) {
    if (scene.drive) scene.drive(simulation, k);
    simulation.advance(1);
  }
}

class ByteList {
 public:
  template <class T>
  void add(const T& value) {
    text_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class T>
  void add(const std::vector<T>& list) {
    add(list.size());
    text_.append(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(T));
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// State, report, forces and monitors of a world. Calls the same functions on all ranks.
inline std::string all_bytes(sim::Simulation& simulation, const DividedScene& scene) {
  ByteList bytes;
  bytes.add(simulation.bodies(0));
  const sim::StepReport r = simulation.report(0);
  for (const double value : {r.time, r.kinetic_energy, r.gravity_power, r.motor_power, r.force_power, r.spring_energy,
                             r.rms_residual, r.max_residual})
    bytes.add(value);
  for (const Index value : {r.contact_count, r.iterations, r.flags, r.fault.body, r.fault.step, r.slowed})
    bytes.add(value);
  bytes.add(simulation.contact_forces(scene.loaded));
  for (const sim::Contact& c : simulation.contacts(0)) {
    bytes.add(c.normal);
    bytes.add(c.gap);
    bytes.add(c.bias);
    bytes.add(c.step);
    bytes.add(c.body_a);
    bytes.add(c.body_b);
  }
  bytes.add(simulation.impulses(0));
  const sim::Snapshot p = simulation.snapshot(0);
  bytes.add(p.place_of_body);
  bytes.add(p.contact_begin);
  bytes.add(p.contact_end);
  bytes.add(p.key);
  bytes.add(p.impulse);
  bytes.add(p.motor_impulse);
  for (const sim::MonitorState& m : p.element.monitor) {
    bytes.add(m.now.x);
    bytes.add(m.now.residual);
    bytes.add(m.energy);
    bytes.add(m.sample_count);
  }
  return bytes.text();
}

}  // namespace gonogo::test
