// What every trial of a study shares: vehicle, soil calibration, beds, numerics and thresholds.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/campaign/study/study.h"
#include "pipeline/campaign/study/task_variables.h"
#include "pipeline/campaign/trial/task.h"
#include "terrain/bed/moving_patch.h"
#include "terrain/bed/numerics.h"
#include "terrain/soil/calibration.h"
#include "terrain/soil/table_numerics.h"
#include "vehicle/model/vehicle.h"
#include "vehicle/wheel_rig.h"

namespace gonogo::campaign {

/// Limits of the verdicts; see the verdict table of the contract.
struct Thresholds {
  double go_speed_share = 0.6;   // min of mean speed over commanded speed for go [-]
  double go_slip = 0.4;          // max slip for go [-]
  double immobile_speed = 0.05;  // below it for `immobile_time` the vehicle is stuck [m/s]
  double immobile_time = 1.0;    // [s]
  double slid_back_share = 0.5;  // of the vehicle's length [-]
  double tilt_deg = 60;          // roll or pitch against the bed: rolled over [deg]
  double creep_speed = 0.1;      // of the bed before the vehicle acts: the slope fails [m/s]
  // The tables' numerics take few solver iterations, which leave larger errors than a solver run to its tolerance.
  double residual = 0.2;      // max root-mean-square residual of a valid trial [m/s]
  double energy_error = 0.2;  // max unexplained energy gain over the energy exchanged, of a valid trial [-]
};

struct TrialSetup {
  std::string name;
  std::uint64_t seed = 0;
  double gravity = kGravity;  // where the vehicle drives; beds are settled under the Earth's [m/s^2]
  vehicle::WheelRig rig;      // drives when there is no whole vehicle
  std::optional<vehicle::Vehicle> whole;
  terrain::Calibration calibration;
  std::filesystem::path vehicle_file, calibration_file;
  double bed_length = 4, bed_width = 0.8;  // [m]
  double grain_density = 2650;             // of the solid [kg/m^3]
  int tiles_along = 1, tiles_across = 1;   // copies of the settled bed side by side
  bool moving_patch = false;               // ground left behind becomes undisturbed ground ahead
  bool folded = false;                     // a bed narrower than the vehicle, see pipeline/campaign/trial/lanes.h
  bool compliant_tyres = false;            // tyres have the contact stiffness of the vehicle's file
  double wheel_rolling = 0;       // rolling friction of grains on rims over that between grains [-]; see sim/contact
  double start = 0;               // x where the vehicle starts; 0: as course() says [m]
  int packing_seeds = 2;          // beds per packing level
  double deepest_bed = 0;         // shallower beds are cut from packings of this depth; 0: each is settled [m]
  double bed_settle_time = 0.25;  // of the tilted bed before the vehicle acts [s]
  double park_time = 0.2;         // the wheel is let down with its brake on [s]
  double ramp_time = 0.4;         // of the rim speed from zero to the commanded one [s]
  double run_in_distance = 0.4;   // not counted [m]
  double test_distance = 2.4;     // to be covered after the run-in [m]
  double min_drive_time = 1.6;    // driven at least this long, once the ramp is over [s]
  double time_limit = 5;          // of the driving, ramp included [s]
  terrain::Numerics numerics{2e-3, 1, 200, 0.01};  // studies and vehicles take the soil table's
  Thresholds thresholds;
  std::filesystem::path packing_folder;         // cache of settled beds
  sim::Backend settled_on = sim::Backend::cpu;  // where beds are settled: on the trials' own device
  /// Of a study whose points give numbers of it: with their largest values, which the bed must hold.
  std::shared_ptr<const TrialTask> task = default_task();
  Json task_given = Json::object();  // trial.task of such a study, without these numbers
  std::vector<TaskNumber> task_varied;

  /// Weight that drawbar pulls are divided by [N].
  double weight(double payload) const;
  /// Time at which the load of a drawbar sweep begins to grow, with the vehicle at its speed [s].
  double tow_start() const { return park_time + ramp_time + min_drive_time; }

  /// Course on a bed with this surface [m]. A quarter vehicle starts near the beginning of the bed, a whole one in its
  /// middle.
  Course course(double surface) const;
  double vehicle_length() const { return whole ? whole->length : rig.vehicle_length; }  // [m]
  double clearance() const { return whole ? whole->clearance : rig.ground_clearance; }  // [m]
  terrain::MovingPatch patch() const;

  /// Spec of a settled bed: its packing level and its seed.
  terrain::BedSpec bed_spec(double bed_depth, std::size_t packing, std::uint64_t seed) const;
};

/// Folder of settled beds, shared between runs: $GONOGO_CACHE/beds, or gonogo/beds in the user's cache folder.
std::filesystem::path default_packing_folder();

/// Setup without a study: a vehicle's file and a calibration's. A whole vehicle gets tiles of bed that are wide and
/// long enough, a moving patch, and two of its lengths or the task's obstacle to cover. Numerics are the table's
/// (terrain::numerics_by_table) where `asked` sets none.
TrialSetup vehicle_trial_setup(const std::filesystem::path& vehicle, const std::filesystem::path& calibration,
                               std::shared_ptr<const TrialTask> task = default_task(),
                               const terrain::AskedNumerics& asked = {},
                               const std::filesystem::path& packing_folder = default_packing_folder());

/// Throws InputError when compliant tyres are asked of a vehicle whose file has no tyre stiffness.
void check_tyres(const TrialSetup& s);

/// The setup of the trial at a point: its task has the numbers that the point gives. Throws InputError for a point that
/// sets a number that the task has not, or has already.
TrialSetup setup_at(const TrialSetup& setup, const DesignPoint& point);

/// Min tyre width in grain diameters for a label that may be published (the scale rule).
inline constexpr double kGrainsPerTyre = 8;
/// Tyre width over grain diameter.
double grains_per_tyre(const TrialSetup& setup);

/// Reads the study's vehicle and its sections "soil" and "trial". Packings are cached in `packing_folder`. Throws
/// InputError for anything out of range, also when the ranges of "design" exceed the calibration's reach.
TrialSetup read_trial_setup(const Study& study, const std::filesystem::path& packing_folder = default_packing_folder(),
                            sim::Backend device = sim::Backend::cpu);

}  // namespace gonogo::campaign
