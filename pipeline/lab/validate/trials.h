// Trials whose means over seeds are compared: the same drive on two undisturbed beds, such as a folded and a wide bed,
// or a moving patch and a fixed bed.
#pragma once
#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "base/math/statistics.h"
#include "pipeline/campaign/trial/trial.h"

namespace gonogo::lab {

/// The same variables with the seeds 0, 1, ...: replicates of one trial.
std::vector<campaign::DesignPoint> replicates(const std::vector<double>& variables, int count);

inline constexpr double kRelativeDensity = 0.5;  // of plain_variables() [-]
/// Dry soil of this triaxial friction angle, medium dense, 0.3 m deep, in the contract's order [deg], [m/s].
std::vector<double> plain_variables(const campaign::TrialSetup& setup, double slope_along, double friction_angle,
                                    double speed);

/// Side by side in one batch, records in the order of the points. `watch` may be shorter than the points: the rest are
/// not watched.
std::vector<campaign::TrialRecord> run_trials(const campaign::TrialSetup& setup,
                                              const std::vector<campaign::DesignPoint>& points,
                                              const campaign::BatchSettings& batch,
                                              const std::vector<campaign::TrialWatch>& watch = {});

/// `count` trials in one batch: start(i) starts the one whose record has the index i.
std::vector<campaign::TrialRecord> run_batch(campaign::TrialBatch& batch, std::size_t count,
                                             const std::function<void(std::size_t)>& start);

// The same drive on two undisturbed beds: means over seeds, and differences of the two trials of a seed.

struct BedsRequest {
  std::filesystem::path vehicle, calibration;
  double slope = 10, friction_angle = 0;  // 0: the middle of what the grains reach [deg]
  double speed = 1.5, distance = 8;       // [m/s], [m]
  int seeds = 4;
  /// Override the table's. A tolerance is ignored: it is a mean over a world's contacts, and a larger bed at rest
  /// reaches it sooner. Beds of two sizes would be solved to two accuracies near the wheel.
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

// A folded bed (pipeline/campaign/setup/setup.h) against three of it side by side. On the wide bed every wheel stands
// on the same grains, and left and right lanes lie a whole track apart. Also measured: how far from its lane a wheel
// moves grains.

struct FoldedReport {
  BedComparison beds;
  double lane_distance = 0;   // between the middles of neighbouring lanes on the folded bed [m]
  double tyre_width = 0;      // [m]
  double bin_width = 0;       // of the profile [m]
  std::vector<double> moved;  // by distance from the nearest lane's middle, on the wide bed: mean [m]
  /// Distance from a lane's middle beyond which grains move less than a tenth as far as those under the tyre [m].
  double rut_half_width = 0;
};

/// `width` of the folded bed [m]; 0: two thirds of the track. Throws InputError for one whose lanes lie too close.
FoldedReport compare_folded(const BedsRequest& request, double width = 0);

Json as_json(const FoldedReport& r);
std::string as_text(const FoldedReport& r);

// A moving patch against a fixed bed that is long enough for the whole drive.

/// Both beds are of the same tiles.
BedComparison compare_patch(const BedsRequest& request);

}  // namespace gonogo::lab
