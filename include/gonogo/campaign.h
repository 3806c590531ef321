// Single trials, and campaigns of many trials that end in a dataset. Link gonogo::campaign.
//
// A trial drives a vehicle on a settled bed of grains under tilted gravity and ends with a verdict. It is a pure
// function of study, values and seed.
#pragma once
#include <gonogo/common.h>

#include <functional>
#include <memory>
#include <optional>

namespace gonogo::api {

/// Codes are those of rasters. A failed simulation is unknown, never no_go.
enum class Verdict { go = 1, slow_go = 2, no_go = 3, unknown = 4 };
std::string name_of(Verdict verdict);   // "slow_go", as in files
std::string label_of(Verdict verdict);  // for people

/// A quantity that trials take or give. Values and measures are in these units everywhere.
struct Quantity {
  std::string name{}, unit{}, about{};
  Range range{};  // allowed values of a variable
};
/// Variables of trials, in the order of columns and points.
std::vector<Quantity> variables();
/// What trials measure.
std::vector<Quantity> measures();
/// Names of what a valid trial can end with: "go", "slow_go", "no_go/traction", ...
std::vector<std::string> outcomes();

/// A row of a dataset.
struct TrialResult {
  Verdict verdict = Verdict::unknown;
  std::string reason{};            // "none" after go, otherwise what stopped the vehicle
  Values variables{}, measures{};  // by name; a measure that the trial does not have is NaN
  std::uint64_t index = 0, seed = 0;
  int attempts = 1;             // 2: the first one failed a check and was repeated with half the step
  std::string failed_checks{};  // of an unknown trial, "residual+energy"; otherwise "none"
};

/// A trial after a step. NaN where the bed failed before there was a vehicle.
struct TrialMoment {
  double time = 0;      // from letting the vehicle down [s]
  double x = 0, y = 0;  // travelled [m]
  double sinkage = 0;   // [m]
  double speed = 0;     // [m/s]
  double slip = 0;      // ratio over the latest 0.25 s [-]
  double torque = 0;    // mean of the driven wheels [N m]
  double residual = 0;  // root mean square over contacts [m/s]
  int contacts = 0;
};

struct TrialOptions {
  Device device = Device::cpu;
  int threads = 1;                                    // of the CPU; results do not depend on it
  std::function<void(const TrialMoment&)> on_step{};  // empty: nobody watches
  std::filesystem::path frames{};                     // folder of VTK files (VtkFrames of sim.h); empty: none
  double frame_interval = 0.1;                        // simulated [s]
  std::filesystem::path checkpoint{};                 // the trial is saved there and goes on from there; empty: nowhere
};

/// One trial. Cheap to copy.
class Trial {
 public:
  struct Impl;
  /// A study's trial (a file or a shipped study): its fixed values and the middles of its ranges, with `values` in
  /// their place. Throws InputError for unknown names and values out of range.
  static Trial of_study(const std::string& study, const Values& values = {}, std::uint64_t seed = 1);
  /// A vehicle on a calibrated soil (files or shipped names) without a study: level ground and the middle friction
  /// angle, with `values` in their place. `task`: "drawbar", "step:height_m=0.2", ...; empty: a climb.
  static Trial of_vehicle(const std::string& vehicle, const std::string& soil_table = "calibration_90mm",
                          const Values& values = {}, std::uint64_t seed = 1, const std::string& task = "");

  Values variables() const;
  TrialResult run(const TrialOptions& options = {}) const;

 private:
  explicit Trial(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<const Impl> impl_;
};

struct CampaignRequest {
  std::string study{};             // a file, or the name of a shipped study
  std::filesystem::path folder{};  // of the campaign; dataset.h5 is written there
  int workers = 0;                 // processes; 0: as the study says, or one per core
  int places = 0;                  // trials side by side in each; 0: as the study says
  std::optional<Device> device{};  // none: as the study says
  std::string program = "gonogo";  // the installed program, which the workers run; found on PATH
};

using Counts = std::map<std::string, std::size_t>;  // trials by name of a verdict or reason

struct CampaignSummary {
  std::filesystem::path dataset{};
  std::size_t trials = 0, computed = 0, reused = 0;  // trials = computed + reused
  Counts verdicts{}, reasons{};
};

/// Computes the trials of a study's design that are missing. Progress goes to stderr. Finished trials are kept whatever
/// it throws, and the same call goes on. Throws InputError for the folder of another campaign or a program of another
/// version, DeviceError when workers cannot be started.
CampaignSummary run_campaign(const CampaignRequest& request);

struct CampaignStatus {
  std::size_t trials = 0, done = 0;
  bool running = false;                            // someone works there now
  double trials_per_second = 0, seconds_left = 0;  // 0: unknown
  Counts verdicts{}, reasons{};
};

/// Changes nothing; may be called while a campaign runs.
CampaignStatus campaign_status(const std::filesystem::path& folder);

/// Points of a study's design, replicates included.
std::vector<Values> design(const std::string& study);

/// Trials of a campaign. Cheap to copy.
class Dataset {
 public:
  struct Impl;
  static Dataset read(const std::filesystem::path& file);
  std::size_t size() const;
  TrialResult trial(std::size_t row) const;
  /// A variable or measure by name [row]; NaN: no value.
  std::vector<double> column(const std::string& name) const;
  Counts verdicts() const;
  /// Header and one line per trial.
  std::string csv() const;

 private:
  explicit Dataset(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<const Impl> impl_;
};

}  // namespace gonogo::api
