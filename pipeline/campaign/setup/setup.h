// What every trial of a study shares: vehicle, soil calibration, beds, numerics and thresholds.
#pragma once
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/campaign/setup/task.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/campaign/study/study.h"
#include "terrain/bed/bed.h"
#include "terrain/soil/calibration.h"
#include "vehicle/family/vehicle_numbers.h"
#include "vehicle/model/vehicle.h"

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

/// The numbers of a design point that every trial has.
struct TrialInputs {
  double slope_along = 0, slope_across = 0;  // uphill, left side higher [deg]
  terrain::MacroscopicSoil soil;
  double tyre_friction = 0;  // between tyres and grains [-]
  double bed_depth = 0;      // [m]
  double payload = 0;        // of the whole vehicle [kg]
  double speed = 0;          // commanded [m/s]
  std::uint64_t bed_seed = 0;
};
TrialInputs inputs_of(const DesignPoint& point);

struct TrialSetup {
  std::string name;
  std::uint64_t seed = 0;
  double gravity = kGravity;  // where the vehicle drives; beds are settled under the Earth's [m/s^2]
  vehicle::Vehicle vehicle;   // a whole one or a quarter; of a family, the largest member of the design
  std::shared_ptr<const vehicle::Family> family;  // whose members the points describe; null for a single vehicle
  bool family_wheels = false;                     // they are wheels by themselves, not whole vehicles
  terrain::Calibration calibration;
  std::filesystem::path vehicle_file, calibration_file;
  double bed_length = 4, bed_width = 0.8;  // [m]
  double grain_density = 2650;             // of the solid [kg/m^3]
  int tiles_along = 1, tiles_across = 1;   // copies of the settled bed side by side
  bool moving_patch = false;               // ground left behind becomes undisturbed ground ahead
  bool folded = false;                     // a bed narrower than the vehicle, see pipeline/campaign/setup/setup.h
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
  /// In a study whose points give some of its numbers, the task with the largest of them, which the bed must hold.
  std::shared_ptr<const TrialTask> task = default_task();
  TaskValues task_given;  // of a study, without these numbers
  std::vector<TaskNumber> task_varied;
  TrialInputs inputs;  // of one trial's point, see setup_at()

  /// Weight that drawbar pulls are divided by, of the vehicle or quarter with its payload [N].
  double weight(double payload) const;
  /// Time at which the load of a drawbar sweep begins to grow, with the vehicle at its speed [s].
  double tow_start() const { return park_time + ramp_time + min_drive_time; }

  /// Course on a bed with this surface [m]. A quarter vehicle starts near the beginning of the bed, a whole one in its
  /// middle.
  Course course(double surface) const;
  terrain::MovingPatch patch() const;

  /// Spec of a settled bed: its packing level and its seed.
  terrain::BedSpec bed_spec(double bed_depth, std::size_t packing, std::uint64_t seed) const;
};

/// Folder of settled beds, shared between runs: $GONOGO_CACHE/beds, or gonogo/beds in the user's cache folder.
std::filesystem::path default_packing_folder();

/// Gravity in the frame of the bed (x along the heading, y left, z out of the bed) for slopes along and across it
/// [m/s^2]. The bed's normal leans by `s` from the vertical with tan^2 s = tan^2 along + tan^2 across. `gravity`: its
/// magnitude [m/s^2].
Vec3d bed_gravity(double slope_along_deg, double slope_across_deg, double gravity = kGravity);

/// Distance of the outer axles, and the largest wheel or shoe with its lugs [m].
struct Extent {
  double base = 0, wheel = 0, width = 0;
  double overhang = 0;  // of sprocket or idler beyond the outer axles
  /// From the middle to the foremost point of a tyre or belt.
  double ends() const { return base / 2 + std::max(wheel, overhang); }
};
Extent extent_of(const TrialSetup& s);

/// Whether points give this variable as a number of the task; if not, why trials cannot take it from the design.
bool is_varied(const TrialSetup& s, std::size_t variable);
std::string refusal_of_size(const TrialSetup& s, std::size_t variable);

/// A sweep gets the time that it takes. The vehicle and what it has to cross must lie side by side on the periodic bed;
/// the run ends behind the obstacle. Throws InputError for a bed too short and a carriage before a whole vehicle.
void fit_to_task(TrialSetup& s);

/// Throws InputError when compliant tyres are asked of a vehicle whose file has no tyre stiffness.
void check_tyres(const TrialSetup& s);

/// Numbers of the family's wheel and vehicle at a point.
vehicle::WheelNumbers wheel_at(const DesignPoint& point);
vehicle::VehicleNumbers vehicle_at(const DesignPoint& point);

/// The family's member of these numbers. A whole one gets as many tiles of bed as it needs: in a row, and side by side
/// the fewest on which no tyre runs in another's rut.
void take_member(TrialSetup& setup, const vehicle::VehicleNumbers& numbers);

/// The setup of the trial at a point: with its inputs, its member of a family, and its task with the numbers that the
/// point gives. Throws InputError for a point that sets a number that the task or vehicle has not, or has already.
TrialSetup setup_at(const TrialSetup& setup, const DesignPoint& point);

/// Min tyre width in grain diameters for a label that may be published (the scale rule).
inline constexpr double kGrainsPerTyre = 8;
/// Tyre width over grain diameter.
double grains_per_tyre(const TrialSetup& setup);

// A folded bed: periodic across and narrower than the vehicle. Left and right wheels roll on the same grains, each in a
// lane of its own. A whole vehicle then needs a third of the ground under it.
//
// The period is two thirds of the track. Left and right lanes then lie half a bed apart, on both sides.
//
// Tilt, load transfer, drift and steering are those of the whole vehicle. Two things differ: ruts repeat every third of
// the track, and a belly as wide as the bed meets each grain only once.

/// Min gap between the sides of tyres in neighbouring lanes of a folded bed, in tyre widths. A wheel moves grains far
/// beside it: a tyre width from its side they move a fifth as far as those under it (docs/validation.md).
inline constexpr double kMinLaneGap = 1;

/// Two thirds of the track: the width of a folded bed whose lanes lie half a bed apart [m].
double folded_width(const vehicle::Vehicle& v);

/// Min gap between a left and a right tyre, or a tyre and its image, on a bed of this period [m].
double lane_gap(const vehicle::Vehicle& v, double width);

/// Whether the vehicle's lanes lie far enough apart on a bed of folded_width().
bool is_foldable(const vehicle::Vehicle& v);

/// Width of a bed that is not folded, on which a vehicle's wheels stand a wheel's diameter from their images [m].
double wide_bed(const TrialSetup& setup);

/// Makes the bed of `setup` a folded one of one tile across. Throws InputError as check_foldable() does.
void fold_bed(TrialSetup& setup);

/// Throws InputError for a quarter vehicle, which has one lane, and for tracks, whose hull would meet the belts'
/// images.
void check_foldable(const TrialSetup& setup);

/// Throws InputError, with a bed that would do, when the lanes of a folded bed lie too close.
void check_lanes(const TrialSetup& setup);

}  // namespace gonogo::campaign
