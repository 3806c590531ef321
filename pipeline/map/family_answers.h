// A family's model asked about one vehicle. Its teacher answers through a machine of the vehicle's own variables, which
// it teaches (outcome/training/member_machine.h).
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "learning/model/model.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/map/evaluate/outcome_model.h"
#include "pipeline/map/family_member.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/prior/forecast.h"
#include "pipeline/outcome/prior/vehicle_odds.h"

namespace gonogo::map {

/// The machine of the member. Its box is that of the family's trials at the member's scale, with payloads to 0.6 of the
/// mass. file: of the family's model; sampled: its box. Throws InputError for a file without a teacher.
std::shared_ptr<const outcome::Predictor> machine_of_member(const std::filesystem::path& file,
                                                            const outcome::Predictor& family,
                                                            const FamilyMember& member,
                                                            const std::vector<Range>& sampled);

/// A model of the member, whose machine answers; machine: of machine_of_member(). How far a point is from trials is the
/// family's to say. Payloads go to a quarter of the mass, as in trials of a vehicle's own.
OutcomeModel model_of_member(const OutcomeModel& family, const OutcomeModel& machine, const FamilyMember& member);

/// Trials, and who answers for them.
struct AnsweredTrials {
  campaign::Dataset trials;                             // as the file has them
  campaign::Dataset in_model;                           // in the variables of the model that was asked
  std::shared_ptr<const outcome::Predictor> predictor;  // of `trials`
};

/// Trials of one vehicle are answered by its machine where the model is a family's, and by the model itself otherwise.
/// Throws InputError for a vehicle that is no member, and for trials that do not hold the file of their vehicle.
AnsweredTrials answer_trials(const TrainedModel& model, const std::filesystem::path& dataset);

/// Trials of vehicles, each driven by itself, as points of the family that the trials of `family` drove. `design`: as
/// make_training_data() takes it. Throws InputError where those drove one vehicle, these several, or none of the
/// family.
std::vector<outcome::VehicleTrials> vehicle_trials(const std::filesystem::path& family,
                                                   const std::optional<Config>& design,
                                                   const std::vector<std::filesystem::path>& files);

/// The machine of a vehicle of a family, of which rows can be drawn, too. No trial is made. family: as find_model()
/// takes it, or empty for the one that ships. Throws InputError where there is none, and for a vehicle outside it.
learning::Model model_for_vehicle(const std::string& family, const vehicle::Vehicle& vehicle, double gravity);

/// What the model of a family says of a vehicle before any trial of its own. `family`: as find_model() takes it, or
/// empty for the one that ships. Throws InputError where there is none, it is of no family, or the vehicle is no member
/// of it or lies outside.
std::shared_ptr<const outcome::Forecast> family_forecast(const std::string& family, const vehicle::Vehicle& vehicle,
                                                         bool compliant_tyres, double gravity);

/// The same of the vehicle that the trials of a dataset drove. Throws InputError where they drove several.
std::shared_ptr<const outcome::Forecast> family_forecast(const std::string& family,
                                                         const std::filesystem::path& dataset);

}  // namespace gonogo::map
