// The original Go/NoGo study: its input files, its bin of grains, its runs, to repeat them line by line.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "terrain/bed/bed.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::lab {

// Input of the original study: a text file with one run per line, five numbers separated by white space,
//   slope [deg]   grain radius [mm]   grain density [kg/m^3]   friction [-]   cohesion [kPa]

struct OriginalInput {
  double slope = 0;     // uphill [rad]
  double radius = 0;    // of the grains [m]
  double density = 0;   // of their solid [kg/m^3]
  double friction = 0;  // of grain on grain [-]
  double cohesion = 0;  // contact pressure p in the force pi r^2 p that holds a contact [Pa]
};

/// Line `line`, counted from 1. Throws InputError with file and line for a missing line, one without exactly five
/// numbers, and numbers out of range.
OriginalInput read_original_input(const std::filesystem::path& file, int line);

// The bin of the original study: 12 by 3.5 m between walls. Grains of one size are dropped in layers onto a rough
// floor. x along the vehicle's way, y left, z up from the floor; the origin is in the middle of the floor.
//
// Numbers of test_VEH_gonogo_hmmwv.cpp (R. Serban's fork of Project Chrono, src/projects/vehicle/go_nogo, revision
// 59e928cf).

struct OriginalBin {
  double half_length = 6, half_width = 1.75, half_height = 0.5;  // inside the walls [m]
  double half_wall = 0.05;                                       // half thickness of the walls [m]
  double depth = 0.1;                                            // of the bed, within the number of layers [m]
  int min_layers = 4, max_layers = 8;
  double spread = 1.01;   // of the dropped grains: their distance over that of touching ones [-]
  double base_pitch = 4;  // of the spheres of the rough floor, in grain radii [-]
};

/// Number of layers that fill the depth, within the bin's bounds.
int layer_count(const OriginalBin& bin, double radius);

/// Poisson disk sample of a rectangle about the origin: no two points are closer than `apart`, and about 30 tries
/// around each point find no free place (Bridson, "Fast Poisson disk sampling in arbitrary dimensions", SIGGRAPH 2007).
std::vector<Vec3d> poisson_disk(double half_x, double half_y, double apart, std::uint64_t seed);

/// Grains above the floor before they fall.
std::vector<Vec3d> dropped_grains(const OriginalBin& bin, double radius, std::uint64_t seed);

/// A world with the grains (bodies 0 .. n - 1) at these places and velocities, floor, and walls. Soil and floor are of
/// one material; floor, its spheres and the walls let tyres through, as in the original.
sim::SceneWorld bin_world(const OriginalBin& bin, const OriginalInput& input, double tyre_friction,
                          const std::vector<sim::BodyState>& grain);

/// Shapes of this group pass through the floor, its spheres and the walls.
inline constexpr int kPassesFloor = 1;

// One run of the original study. Grains settle, the vehicle is dropped onto them, gravity tilts and the throttle opens.
// The label is the reason why the run ends.

/// Times from the run's beginning unless said otherwise.
struct OriginalTimeline {
  double settle = 0.25;        // of the grains alone [s]
  double rest = 0.25;          // from the vehicle's creation to the engine's start and the tilt of gravity [s]
  double throttle_ramp = 0.5;  // from shut to full [s]
  double end = 7;              // [s]
  double start_x = -3.5;       // of the vehicle's origin [m]
  double drop = 0.6;           // from the vehicle's origin to the highest grain's top [m]
  double goal_x = 3.5, lost_x = -6;
  double output_step = 0.01;  // [s]
  double step = 1e-3;         // [s]
  int iterations = 50;
};

enum class OriginalStop { max_x, sliding_backward, max_time, failed };

/// As the original program writes it: "Reached maximum x position", "Vehicle sliding backward", "Reached maximum time".
const char* stop_sentence(OriginalStop stop);

struct OriginalSample {
  double time = 0, throttle = 0, steering = 0;  // [s], [0, 1], share of full lock [-1, 1]
  Vec3d position{}, velocity{};                 // of the vehicle's origin
};

struct OriginalRecord {
  OriginalStop stop = OriginalStop::failed;
  std::string fault;  // of a run that failed
  std::size_t grains = 0;
  double surface = 0;  // top of the highest grain when the vehicle is made [m]
  Index slowed = 0;    // times that a grain was slowed to one bin per step, with the vehicle there
  std::vector<OriginalSample> sample;
};

struct OriginalRequest {
  OriginalInput input;
  OriginalBin bin;
  OriginalTimeline time;
  double tyre_friction = 0.8;  // that of 2017; later revisions have 0.9
  std::uint64_t seed = 1;
  sim::Backend backend = sim::Backend::cpu;
  int threads = 1;
  std::function<void(const OriginalSample&)> watch;  // may be empty
};

/// Drives `v` as the original does: smooth rigid tyres, no brakes, a chassis without contacts. Throws InputError for a
/// vehicle that cannot be driven so.
OriginalRecord run_original(const vehicle::Vehicle& v, const OriginalRequest& request);

/// The original's output file: t throttle steering x y z vx vy vz every hundredth of a second, the reason at the end.
/// What the original adds to it, the time that the computation took, is left out.
std::string original_output(const OriginalRecord& record);

}  // namespace gonogo::lab
