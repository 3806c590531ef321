// Settles a bed of grains, sets a driven wheel on it, and drives it: settle_and_drive [<vehicle> [<frames folder>]]
// The vehicle is a quarter, as a file or by name. Every tenth of a second becomes a VTK file that ParaView opens.
#include <gonogo/terrain.h>
#include <gonogo/vehicle.h>

#include <cstdio>
#include <exception>
#include <optional>

using namespace gonogo::api;

int main(int argc, char** argv) try {
  const Vehicle quarter = Vehicle::read(argc > 1 ? argv[1] : "hmmwv_quarter");
  // Grains of 90 mm are coarse, so that the example takes seconds.
  const SoilGrains soil = SoilTable::read("calibration_90mm").grains({.friction_angle = 38});
  BedSettings spec = soil.bed;
  spec.length = 3;  // [m]
  spec.width = 0.7;
  const Bed bed = Bed::settle(spec, 2);
  std::printf("%d grains settled, %.0f %% solid\n", bed.grain_count(), 100 * bed.solid_fraction());

  World world = bed.world(soil.law, soil.law);
  const PlacedVehicle wheel = place(world, quarter, {0.8, spec.width / 2, bed.highest_point()}, kToolMaterial);
  StepSettings settings = bed.step_settings();
  settings.threads = 2;
  Simulation simulation({world}, settings);
  std::optional<VtkFrames> frames;
  if (argc > 2) frames.emplace(argv[2], world);

  const double start = simulation.body(wheel.chassis()).position.x;
  double travelled = 0, before = start;
  for (int tenth = 1; tenth <= 25; ++tenth) {
    if (tenth == 6) wheel.set_rim_speed(simulation, 1);  // [m/s]
    simulation.step(100);
    if (frames) frames->write(simulation);
    const double now = simulation.body(wheel.chassis()).position.x, moved = now - before;
    travelled += moved < -spec.length / 2 ? moved + spec.length : moved;  // the bed is periodic along x
    before = now;
    const StepReport report = simulation.report();
    std::printf("%.1f s  %+.2f m  torque %.0f N m  residual %.1e m/s\n", report.time, travelled,
                simulation.motor_torque(wheel.drive_motors().front()), report.rms_residual);
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
