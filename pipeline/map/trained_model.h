// A trained model together with the trials that it learned from. The trials say which vehicle the model is of, on which
// grains, and what their wheels measured. Models that ship lie in data/<name>: model.h5, dataset.h5, and README.md as
// their card.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/units.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/map/evaluate/outcome_model.h"
#include "pipeline/outcome/answer/predictor.h"
#include "terrain/soil/calibration.h"
#include "vehicle/family/numbers.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::map {

/// What was driven in the trials of a dataset.
struct TrialVehicle {
  std::string name;
  vehicle::Vehicle vehicle;
  bool compliant_tyres = false;  // tyres gave way in the trials
  double wheel_rolling = 0;      // rolling friction of grains on wheels over that between grains [-]
  terrain::Calibration table{};  // of the grains
  double gravity = kGravity;     // [m/s^2]
  Json file;                     // text of the vehicle's file

  /// "whole vehicle on grains of 32 mm, 7.9 across a wheel", with the gravity where it is not the Earth's
  std::string fidelity() const;
};

/// Reads it from the provenance. Nothing where the dataset does not hold the file of one vehicle.
std::optional<TrialVehicle> trial_vehicle(const campaign::Provenance& provenance, const std::string& where);

struct TrainedModel {
  std::filesystem::path file{}, dataset_file{};  // dataset_file: empty without trials
  std::shared_ptr<const outcome::Predictor> predictor;
  std::optional<campaign::Dataset> dataset{};
  std::optional<TrialVehicle> vehicle{};    // none where the trials drove a family
  std::optional<vehicle::Family> family{};  // whose members the trials drove
  double gravity = kGravity;                // of the trials that it learned from [m/s^2]
  bool is_up_to_date = true;                // false: the dataset beside the model is not the one that it was trained on
};

/// The file of a model: `model` is a file, a folder that holds model.h5, the name of a shipped folder, or the vehicle
/// of exactly one shipped model, those of ditches left out. Throws InputError with the nearest names.
std::filesystem::path find_model(const std::string& model);

/// Reads the model and its trials. `dataset`: empty to take dataset.h5 beside the model, where there is one. Where the
/// model learned shipped trials together with others, those shipped ones are its trials. Throws
/// InputError for files that cannot be read.
TrainedModel read_trained_model(const std::filesystem::path& file, const std::filesystem::path& dataset = {});

/// Whether its trials drove members of a family: whole vehicles, or wheels by themselves.
bool is_of_family(const TrainedModel& model);

/// Throws InputError for a model of a family that cannot answer for a vehicle: one of wheels by themselves, or one
/// without its trials, which say how vehicles are scaled.
void require_family(const TrainedModel& model);

/// What the trials of the model sampled, by variable of the contract.
std::vector<Range> sampled_box(const TrainedModel& model);

/// Vehicles of the models that ship, those of ditches left out.
std::vector<std::string> vehicles_with_models();

/// The model of whole vehicles of a family that ships; nothing where none or several do.
std::optional<std::filesystem::path> shipped_family_model();

/// Folders of the models that ship, sorted by name.
std::vector<std::filesystem::path> shipped_models();

/// Whether the trials of a model crossed ditches of sampled sizes.
bool crosses_ditches(const learning::Model& model);

/// The model of ditches of a vehicle whose model on soil is `model`: `asked` as find_model() takes it, or else the only
/// shipped one of the same vehicle, grains, tyres and gravity; nothing where none or several ship. Throws InputError
/// for one that is asked for and is of another vehicle, other grains or tyres or another gravity, or of no ditches.
std::optional<TrainedModel> find_crossing_model(const TrainedModel& model, const std::string& asked);

/// Throws InputError unless the vehicle of this file is the model's: of the same name, and with the same numbers.
void require_vehicle(const TrainedModel& model, const std::filesystem::path& vehicle_file);

/// Throws InputError where a study names another vehicle, other grains or another gravity than the model's trials had.
void require_study(const TrainedModel& model, const std::filesystem::path& study_file);

/// A measure of the trials that passed, over the variables.
MeasureFit fit_of_passed(const campaign::Dataset& dataset, const char* name);

/// Fits resistance, slip and sinkage to the trials that passed. The driveline is that of `whole`, which a quarter
/// vehicle represents. Trials on level ground or uphill measure the resistance: downhill
/// the vehicle may roll against its brakes, whose torque is not measured. Nothing if there is none.
std::optional<SpeedModel> speed_of_trials(const campaign::Dataset& dataset, const TrialVehicle& driven,
                                          const vehicle::Vehicle& whole);

}  // namespace gonogo::map
