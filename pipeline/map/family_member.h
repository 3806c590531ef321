// The model of a family, asked about one vehicle. Flow of grains under a wheel scales (vehicle/family/numbers.h), so
// that trials at the family's size and gravity answer for members of any size, on any ground: each question is put in
// the family's numbers, and each measure comes back in the member's metres and newtons. The family's teacher answers,
// through a machine of the member's own variables that it teaches (outcome/training/member_machine.h).
#pragma once
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/map/evaluate/outcome_model.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/prior/forecast.h"
#include "pipeline/outcome/prior/vehicle_odds.h"
#include "vehicle/family/vehicle_numbers.h"

namespace gonogo::map {

/// A vehicle that a family answers for.
struct FamilyMember {
  vehicle::Vehicle vehicle;
  vehicle::Family family;
  double family_gravity = kGravity;  // of the family's trials [m/s^2]
  double gravity = kGravity;         // where the member drives [m/s^2]
  vehicle::VehicleNumbers numbers;   // without payload
  vehicle::MemberScale scale;
  double mass = 0;  // without payload [kg]
};

/// Throws InputError for vehicles on tracks, and for one axle or more than four.
FamilyMember family_member(const vehicle::Family& family, double family_gravity, const vehicle::Vehicle& vehicle,
                           double gravity);

/// A point of the member [variable count] as a point of the family's trials: cohesion, depth of the bed and speed at
/// the family's scale, the payload as part of the load, and uphill the slope that its driveline makes of it
/// (vehicle/family/driveline_share.h). An unknown payload counts as none.
std::vector<double> family_point(const FamilyMember& member, std::span<const double> point);

/// Values of the family's variables that the member has without payload, by their names in the contract. What only
/// helps counts as the most that was sampled where there is more of it: force, power and clearance, and a centre of
/// mass that is lower than sampled as the lowest. No soil returns more than about the weight to a wheel, so that wheels
/// spin long before the largest sampled force. `sampled`: box of the family's model.
Spreads family_values(const FamilyMember& member, const std::vector<Range>& sampled);

/// The machine of the member. Its box is that of the family's trials at the member's scale. Payloads go to a quarter of
/// the mass, as in trials of a vehicle's own, and no further than the family's range. file: of the family's model;
/// sampled: its box. Throws InputError for a file without a teacher.
std::shared_ptr<const outcome::Predictor> machine_of_member(const std::filesystem::path& file,
                                                            const outcome::Predictor& family,
                                                            const FamilyMember& member,
                                                            const std::vector<Range>& sampled);

/// A model of the member, whose machine answers. How far a point is from trials is the family's to say. machine: of
/// machine_of_member().
OutcomeModel model_of_member(const OutcomeModel& family, const OutcomeModel& machine, const FamilyMember& member);

/// The family's trials as the member would have driven them: points and measures at its scale. Energies and torques
/// keep their share of the weight. Payloads are none.
campaign::Dataset trials_of_member(const campaign::Dataset& family, const FamilyMember& member);

/// A member's own trials as points of the family's, its numbers among their variables. Measures stay the member's.
/// `sampled`: box of the family's model.
campaign::Dataset trials_in_family(const campaign::Dataset& own, const FamilyMember& member,
                                   const std::vector<Range>& sampled);

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

/// Numbers of the member that lie outside the trials after that, such as "load_number 7.2 (44 % above 0.3 to 5)".
std::vector<std::string> numbers_outside(const FamilyMember& member, const std::vector<Range>& sampled);

}  // namespace gonogo::map
