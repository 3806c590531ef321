#include "terrain/soil/shear_test.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace gonogo::terrain {
namespace {

/// The plate: glued grains like the base's, one body on rails. It keeps its speed along x and is free along z only; its
/// weight is the normal load.
sim::BodyIndex add_plate(sim::SceneWorld& world, const Packing& cell, const ShearSettings& settings) {
  const BedSpec& s = cell.spec;
  double top = 0;
  for (const Grain& g : cell.grain) top = std::max(top, g.position.z + g.radius);
  const double area = s.length * s.width;
  sim::BodyMass mass;
  mass.inverse_mass = {0, 0, Real(9.81 / (settings.normal_stress * area))};
  sim::BodyState state;
  state.position = {0, 0, top + s.grain_diameter / 2};
  const sim::BodyIndex plate = world.add_body(state, mass);
  for (const Grain& g : cell.base) {
    sim::Shape shape;
    shape.body = plate;
    shape.material = base_material;
    shape.offset_B = {Real(g.position.x), Real(g.position.y), Real(-g.position.z - s.grain_diameter / 2)};
    shape.size = {Real(g.radius), 0, 0};
    world.add_shape(shape);
  }
  return plate;
}

}  // namespace

BedSpec shear_cell(double grain_diameter, double settle_friction, std::uint64_t seed) {
  BedSpec s;
  s.grain_diameter = grain_diameter;
  s.length = 10 * grain_diameter;
  s.width = 6 * grain_diameter;
  s.depth = 8 * grain_diameter;
  s.settle_friction = settle_friction;
  s.seed = seed;
  return s;
}

ShearResult shear_test(const Packing& cell, const BedLaws& laws, const ShearSettings& settings) {
  const BedSpec& s = cell.spec;
  sim::SceneWorld world = bed_world(cell, laws, 4 * s.grain_diameter);
  const sim::BodyIndex plate = add_plate(world, cell, settings);
  const auto simulation = sim::make_simulation(
      sim::Backend::cpu, {world},
      bed_step_settings(s.grain_diameter, settings.step, settings.iterations, settings.tolerance), 1);
  simulation->advance(Index(settings.settle_time / settings.step));
  sim::BodyState state = simulation->body(0, plate);
  state.velocity.x = Real(settings.speed);
  simulation->set_body(0, plate, state);
  const double start = state.position.z;

  constexpr Index sample_every = 5;
  const auto samples = std::size_t(settings.travel * s.grain_diameter / settings.speed / settings.step / sample_every);
  const auto first = std::size_t(samples * 0.5 / settings.travel);
  std::vector<double> shear;
  double normal = 0, worst = 0;
  for (std::size_t k = 0; k < samples; ++k) {
    simulation->advance(sample_every);
    const sim::StepReport report = simulation->report(0);
    if (report.flags != 0)
      throw DeviceError("shear test: the simulation failed: " + sim::description(report.fault, settings.step));
    worst = std::max(worst, report.rms_residual);
    if (k < first) continue;
    const Vec3d force = simulation->contact_force(0, plate);
    shear.push_back(-force.x / (s.length * s.width));
    normal += force.z / (s.length * s.width);
  }
  double mean = 0, square = 0;
  for (const double t : shear) mean += t / double(shear.size());
  for (const double t : shear) square += (t - mean) * (t - mean) / double(shear.size());
  // Samples closer than half a diameter of travel are not independent.
  const double independent = std::max(2.0, 2 * (settings.travel - 0.5));
  return {mean, normal / double(shear.size()), std::sqrt(square / independent),
          simulation->body(0, plate).position.z - start, worst};
}

}  // namespace gonogo::terrain
