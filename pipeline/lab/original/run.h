// One run of the original study. Grains settle, the vehicle is dropped onto them, gravity tilts and the throttle opens.
// The label is the reason why the run ends.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "pipeline/lab/original/bin.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::lab {

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
  Vec3d position, velocity;                     // of the vehicle's origin
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
