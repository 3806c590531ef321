// The worlds of a trial's two phases, and what is measured and judged at their ends.
#pragma once
#include "pipeline/campaign/trial/conditions.h"

namespace gonogo::campaign {

/// Verdict and measures of a drive. Measures stand in the contract's order and units.
struct DriveOutcome {
  Verdict verdict = Verdict::unknown;
  Reason reason = Reason::simulation_failed;
  // 0 before the driving began; NaN of a bed that failed by itself, except for distance, time and speed.
  double distance = 0, drive_time = 0, mean_speed = 0, slip = 0, sinkage = 0, drift = 0, mean_torque = 0,
         energy_per_metre = 0;
  double bed_creep = 0, worst_residual = 0, energy_error = 0;
  Index flags = 0;                  // sim::StepFlag
  std::vector<WheelRecord> wheels;  // of a whole vehicle
  std::vector<PullPoint> pull;      // of a drawbar sweep
};

/// Stiffness of the spring through which a carriage tows a wheel at a given slip. Its stretch measures the pull and
/// stays within millimetres.
inline constexpr double kCarriageStiffness = 2e6;  // [N/m]
/// Half of the critical damping of a wheel that moves this mass along [N s/m].
double carriage_damping(double mass);

/// First phase: the settled bed alone under the trial's gravity with its own laws.
sim::SceneWorld bed_alone(const TrialSetup& setup, const terrain::Packing& settled, const TrialConditions& conditions);

/// Steps of the first phase, at least one.
Index bed_steps(const TrialSetup& setup, const sim::StepSettings& settings);

/// The bed at the end of its phase.
struct TiltedBed {
  std::vector<terrain::GrainPlace> grain;  // in the packing's order
  double creep = 0;     // mean speed along the slope: one that fails by itself keeps accelerating [m/s]
  double residual = 0;  // root mean square [m/s]
  Index flags = 0;
};
TiltedBed tilted_bed(sim::Simulation& simulation, sim::WorldIndex world, const terrain::Packing& settled);

/// True when the bed creeps under its own weight or its simulation raised a flag.
bool fails(const TrialSetup& setup, const TiltedBed& bed);
DriveOutcome outcome_of_failed_bed(const TiltedBed& bed);

/// Second phase: quarter or whole vehicle parked just above the tilted bed, with its driver. The first monitor ends the
/// trial.
sim::SceneWorld vehicle_on_bed(const TrialSetup& setup, const terrain::Packing& settled, const TiltedBed& bed,
                               const TrialConditions& conditions);

/// Means over the driven wheels after the latest step; sinkage is the mean over all that touch the ground.
struct SeenWheels {
  double rolled = 0, sinkage = 0, torque = 0;  // [m], [m], [N m]
};
SeenWheels seen_wheels(const TrialSetup& setup, sim::Simulation& simulation, sim::WorldIndex world);
/// The same at a recorded sample.
SeenWheels seen_wheels(const TrialSetup& setup, sim::Simulation& simulation, sim::WorldIndex world, Index sample);

/// Measures and verdict of a drive whose monitor has stopped the world.
DriveOutcome judge_drive(const TrialSetup& setup, const TrialConditions& conditions, const TiltedBed& bed, double step,
                         sim::Simulation& simulation, sim::WorldIndex world);

}  // namespace gonogo::campaign
