// The worlds of a trial: the conditions that its inputs set, its bed, and what stands on it in its two phases, the bed
// alone and the vehicle on the bed.
#pragma once
#include "pipeline/campaign/setup/setup.h"
#include "terrain/bed/bed.h"

namespace gonogo::campaign {

struct TrialConditions {
  Vec3 gravity;  // in the frame of the bed [m/s^2]
  terrain::BedLaws laws;
  std::optional<sim::PairLaw> soft;  // between grains of a strip of softer soil
  double payload = 0;                // of the whole vehicle [kg]
  double speed = 1;                  // commanded rim speed [m/s]
};

/// Throws InputError for a soil that the calibration does not reach.
TrialConditions conditions_of(const TrialSetup& setup, const TrialInputs& in);

/// The packing on which the trial drives, before it is shifted.
terrain::BedSpec bed_spec_of(const TrialSetup& setup, const TrialInputs& in);

/// The settled bed of the trial, from the cache or else settled now.
terrain::Packing settled_bed(const TrialSetup& setup, const TrialInputs& in);

/// Step of an attempt [s]: the setup's for 1; for 2 half of it, so twice the iterations per simulated time.
double attempt_step(const TrialSetup& setup, std::uint64_t attempt);
sim::StepSettings attempt_settings(const TrialSetup& setup, std::uint64_t attempt);

/// Height of the axle of an unloaded wheel that is lowered onto the undisturbed grains until it touches one [m]: mean
/// over the places [from, from + way] along x in the lane at y. `reach`: from the axle to the tips of its lugs.
///
/// Sinkage of plates and wheels is zero at the first touch (bevameter tests; Wong, Theory of Ground Vehicles, 2.4). A
/// wheel rests on the highest grains under it. The mean top of the bed includes the gaps between grains and lies up to
/// half a grain lower. Counted from there, a wheel that has not sunk would have a negative sinkage. `yaw`: of the wheel
/// from x towards y [rad].
double untouched_axle_height(const terrain::Packing& packing, double reach, double width, double y, double from,
                             double way, double yaw = 0);

/// Index of the monitor of the vehicle's first running part: 0 for a quarter, whose wheel is watched for the vehicle.
Index first_wheel_monitor(const vehicle::Vehicle& v);

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

/// Second phase: quarter or whole vehicle parked just above the tilted bed, with its driver. The first monitor ends the
/// trial.
sim::SceneWorld vehicle_on_bed(const TrialSetup& setup, const terrain::Packing& settled, const TiltedBed& bed,
                               const TrialConditions& conditions);

}  // namespace gonogo::campaign
