// Report of a training run: a struct, the JSON that the model's file keeps, and text for people.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "learning/model/model.h"
#include "pipeline/outcome/evaluation/scores.h"
#include "pipeline/outcome/joint_summary.h"
#include "pipeline/outcome/prior/other_trials.h"
#include "pipeline/outcome/settings.h"
#include "pipeline/outcome/training/training_sampler.h"

namespace gonogo::outcome {

struct TrialCounts {
  std::size_t trials = 0, trained_on = 0, unknown = 0, held_out = 0;
  std::vector<std::pair<std::string, std::size_t>> outcomes;  // rows trained on, in the contract's order
};

/// The rate of failed simulations among all trials, held-out ones included, modelled apart from the outcomes.
struct FailureRate {
  learning::Interval overall;
  /// By a logistic regression on the variables; none where no trial failed.
  struct Modelled {
    double highest = 0;                                   // over the trials
    std::vector<std::pair<std::string, double>> weights;  // of the variables, per standard deviation
  };
  std::optional<Modelled> modelled;
};

/// What trials of vehicles say of the model of their family (vehicle_odds.h).
struct VehicleOdds {
  struct Vehicle {
    std::string hash, name;  // of the dataset's file; of the vehicle
    std::size_t trials = 0;
  };
  double shift = 0;  // of the log odds of passing [nat]
  std::vector<Vehicle> vehicles;
};

struct TrainingReport {
  std::string data_hash, contract_hash, program_version;
  std::optional<double> gravity;  // of the trials [m/s^2]; none: the Earth's
  SamplerReport sampler;
  double calibration_power = 1;
  VehicleOdds odds;
  std::uint64_t seed = 0;
  LearningSettings settings;
  double teacher_weight = 0;
  std::vector<OtherDataset> others;
  std::size_t batch = 0, epochs = 0;
  TrialCounts counts;
  FailureRate failures;
  Scores cross_validation;
  std::size_t folds = 0;
  std::optional<JointSummary> joint;  // none: too few trials
};

/// The provenance that the model's file keeps.
Json to_json(const TrainingReport& report);
/// The fields that report_text() prints, from the provenance of a model's file.
TrainingReport read_report(const Json& provenance);

/// Trial counts, failure rate, and cross-validated scores of model and baselines, as text for people.
std::string report_text(const TrainingReport& report);

}  // namespace gonogo::outcome
