// The same drive on two undisturbed beds: means over seeds, and differences of the two trials of a seed.
#pragma once
#include <array>
#include <filesystem>
#include <functional>
#include <string>

#include "base/json/json.h"
#include "base/mean_error.h"
#include "pipeline/lab/validate/trials.h"

namespace gonogo::lab {

struct BedsRequest {
  std::filesystem::path vehicle, calibration;
  double slope = 10, friction_angle = 0;  // 0: the middle of what the grains reach [deg]
  double speed = 1.5, distance = 8;       // [m/s], [m]
  int seeds = 4;
  /// Override the table's. A tolerance is ignored: it is a mean over a world's contacts, and a larger bed at rest meets
  /// it sooner. Beds of two sizes would be solved to two accuracies near the wheel.
  terrain::AskedNumerics numerics;
  campaign::BatchSettings batch;
};

/// One of the two; the second one is the reference.
struct BedSide {
  std::string key, name;  // in JSON, in text
  campaign::TrialSetup setup;
  /// Sees a trial's start and end; may be empty.
  std::function<void(std::size_t seed, const campaign::TrialFrame&)> frame;
};

struct BedComparison {
  std::array<std::string, 2> key, name;
  MeanError slip[2], sinkage[2];                  // over the last half of the driving [-], [m]
  MeanError slip_difference, sinkage_difference;  // of a seed's two trials
  std::size_t grains[2] = {};
  double cost[2][2] = {};             // contact-iterations per metre over the first and the second half of the way
  double length[2] = {}, width[2]{};  // of the bed [m]
  int passed = 0;                     // of trials, neither unknown nor no_go

  /// Difference over the reference's value.
  double slip_deviation() const { return slip_difference.mean / slip[1].mean; }
  double sinkage_deviation() const { return sinkage_difference.mean / sinkage[1].mean; }
  double worst_deviation() const;
};

/// Vehicle, table and numerics of `r`.
campaign::TrialSetup setup_of(const BedsRequest& r);

/// A bed as `r` asks for: its way and its time limit.
void fit_to_request(const BedsRequest& r, campaign::TrialSetup& setup);

/// Throws DeviceError when a trial fails its checks.
BedComparison compare_beds(const BedsRequest& r, const BedSide& first, const BedSide& reference);

Json as_json(const BedComparison& c);
std::string as_text(const BedComparison& c);

}  // namespace gonogo::lab
