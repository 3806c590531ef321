// Scenes of penalty contact.
#pragma once
#include "sim/scene/penalty_setup.h"
#include "sim/scene/scene.h"
#include "tests/support/scenes.h"

namespace gonogo::test {

inline constexpr sim::ContactLaw kPenalties[] = {sim::ContactLaw::spring_damper, sim::ContactLaw::hertz};

/// Soft grains: an impact at 1 m/s of spheres of 10 mm overlaps by 5 % of the radius.
inline sim::PenaltyLaw soft_law(double restitution, double radius = 0.01) {
  return sim::law_of_overlap(0.05, 1, radius, 2600, restitution);
}

inline sim::StepSettings penalty_settings(sim::ContactLaw contact, const sim::PenaltyLaw& law, double step) {
  sim::StepSettings s;
  s.contact = contact;
  s.penalty = law;
  s.step = Real(step);
  s.envelope = Real(1e-4);
  s.cohesion_range = 0;
  return s;
}

/// The settings with a share of the world's critical step.
inline sim::StepSettings at_share(const sim::SceneWorld& world, sim::StepSettings settings, double share) {
  settings.step = Real(share * sim::critical_step(world, settings).step);
  return settings;
}

/// Two free spheres that meet along x at `speed`, each with half of it, a tenth of a radius apart; bodies 0 and 1.
inline sim::SceneWorld meeting_pair(double radius, double density, double speed, double friction = 0) {
  sim::SceneWorld w = open_world({Real(friction)});
  w.gravity = {};
  for (const double side : {-1.0, 1.0}) {
    const sim::BodyIndex b = w.add_sphere({side * 1.05 * radius, 0, 0}, Real(radius), Real(density), 0);
    w.body[b].velocity = {Real(-side * speed / 2), 0, 0};
  }
  return w;
}

/// A lugged wheel on a motor and a sprung mass on loose grains with friction, rolling resistance and cohesion.
inline sim::SceneWorld driven_penalty_wheel(std::uint64_t seed) {
  Draw draw(seed);
  sim::SceneWorld w;
  w.origin = {0, 0, -0.1};
  w.size = {0.42, 0.21, 1};
  w.periodic_x = w.periodic_y = true;
  w.set_law(0, 0, {Real(0.5), Real(0.1), 500});
  w.set_law(0, 1, {Real(0.7), 0, 0});
  add_plane(w);
  for (int x = 0; x < 10; ++x)
    for (int y = 0; y < 5; ++y)
      for (int z = 0; z < 4; ++z)
        w.add_sphere(Vec3d{x + 0.5, y + 0.5, z + 0.5} * 0.0412 + draw.direction() * 0.0005,
                     Real(draw.between(0.0195, 0.021)), 2600, 0);
  sim::Shape s;
  s.type = sim::ShapeType::wheel;
  s.material = 1;
  s.size = {0.15f, 0.06f, 0.03f};
  s.lug_count = 12;
  s.lug_thickness = 0.02f;
  sim::BodyMass hub = sim::solid(10, {1, 0.2f, 1});
  hub.inverse_mass.y = hub.inverse_inertia_B.x = hub.inverse_inertia_B.z = 0;
  s.body = w.add_body({{0.21, 0.1, 0.34}, {}, {}, {}}, hub);
  w.add_shape(s);
  sim::BodyMass sprung = sim::solid(50, {1, 1, 1});
  sprung.inverse_mass.x = sprung.inverse_mass.y = 0;
  const sim::BodyIndex mass = w.add_body({{0.21, 0.1, 0.8}, {}, {}, {}}, sprung);
  w.motor.push_back(sim::speed_motor(w, s.body, sim::kWorld, {0, 1, 0}, 3, 100));
  w.spring.push_back(
      sim::spring_along(w, s.body, mass, w.body[s.body].position, w.body[mass].position, {0, 0, -1}, 20000, 800));
  return w;
}

inline sim::StepSettings wheel_settings(sim::ContactLaw contact) {
  sim::StepSettings s = penalty_settings(contact, soft_law(0.5, 0.02), 0);
  s.cohesion_range = 1e-4f;
  return at_share(driven_penalty_wheel(1), s, 0.9);
}

}  // namespace gonogo::test
