// Settles a bed of grains, sets a driven wheel on it, and drives it: settle_and_drive <wheel.json> [<frames folder>]
// With a folder, every tenth of a second becomes a VTK file that ParaView opens.
#include <gonogo/sim.h>
#include <gonogo/terrain.h>
#include <gonogo/vehicle.h>

#include <cstdio>
#include <exception>
#include <optional>

using namespace gonogo;

int main(int argc, char** argv) try {
  if (argc < 2) throw InputError("usage: settle_and_drive <wheel.json> [<frames folder>]");
  const vehicle::Vehicle quarter = vehicle::read_quarter_vehicle(argv[1]);
  const vehicle::Wheel& wheel = quarter.wheel.front();
  constexpr int kThreads = 2;

  terrain::BedSpec spec;  // [m]; coarse grains, so that the example takes seconds
  spec.length = 3;
  spec.width = 0.7;
  spec.depth = 0.3;
  const terrain::Packing packing = terrain::settle_packing(spec, kThreads);
  std::printf("%zu grains settled, %.0f %% solid\n", packing.grain.size(), 100 * packing.solid_fraction);

  sim::PairLaw law;
  law.friction = 0.6f;
  law.rolling_friction = 0.2f;
  sim::SceneWorld world = terrain::bed_world(packing, {law, law}, 2);
  const double axle_height = terrain::highest_point(packing) + wheel.radius + wheel.lug_height;
  const vehicle::EngineVehicle bodies =
      vehicle::add_vehicle(world, quarter, {0.8, spec.width / 2, axle_height}, terrain::tool_material);
  const double torque = vehicle::largest_drive_torque(quarter);  // [N m]
  const auto settings = terrain::bed_step_settings(spec.grain_diameter, 1e-3, 50);
  const auto simulation = sim::make_simulation(sim::Backend::cpu, {world}, settings, kThreads);

  std::optional<sim::VtkSeries> frames;
  if (argc > 2) frames.emplace(argv[2], world);
  const Real rim_speed = 1;  // [m/s]
  const double start = simulation->body(0, bodies.wheel.front()).position.x;
  double travelled = 0, before = start;
  for (int tenth = 1; tenth <= 25; ++tenth) {
    if (tenth == 6) simulation->set_motor(0, bodies.drive_motor.front(), rim_speed / Real(wheel.radius), Real(torque));
    simulation->advance(100);
    if (frames) frames->write(sim::capture_world(*simulation, 0));
    const double now = simulation->body(0, bodies.wheel.front()).position.x, moved = now - before;
    travelled += moved < -spec.length / 2 ? moved + spec.length : moved;  // the bed is periodic along x
    before = now;
    const sim::StepReport report = simulation->report(0);
    std::printf("%.1f s  %+.2f m  torque %.0f N m  residual %.1e m/s\n", report.time, travelled,
                simulation->motor_torque(0, bodies.drive_motor.front()), report.rms_residual);
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
