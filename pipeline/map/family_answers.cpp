#include "pipeline/map/family_answers.h"

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/outcome/training/member_machine.h"
#include "pipeline/outcome/training_data.h"

namespace gonogo::map {
namespace {

constexpr double kPayloadShare = 0.25;  // of the mass, on maps: as in campaign::study_of_vehicle()
constexpr double kMostPayload = 0.6;    // of the mass, that a machine learns: trials of the HMMWV have as much

outcome::FamilyQuestion question_of(const FamilyMember& member, const std::vector<Range>& sampled) {
  outcome::FamilyQuestion question{
      .vehicle = member.vehicle.name, .gravity = member.gravity, .lower = {}, .upper = {}, .in_family = {}};
  const Spreads values = family_values(member, sampled);
  std::vector<Range> box = member_box(member, sampled, kMostPayload);
  for (const auto& [name, spread] : values) box[campaign::contract().variable_index(name)] = {spread.low, spread.low};
  for (const Range& range : box) {
    question.lower.push_back(range.minimum);
    question.upper.push_back(range.maximum);
  }
  question.in_family = [member, values](const std::vector<double>& points) {
    return family_points(member, values, points);
  };
  return question;
}

}  // namespace

std::shared_ptr<const outcome::Predictor> machine_of_member(const std::filesystem::path& file,
                                                            const outcome::Predictor& family,
                                                            const FamilyMember& member,
                                                            const std::vector<Range>& sampled) {
  return std::make_shared<const outcome::Predictor>(outcome::member_machine(
      family, outcome::Teacher::read(file), question_of(member, sampled), outcome::MachineUse::answers));
}

OutcomeModel model_of_member(const OutcomeModel& family, const OutcomeModel& machine, const FamilyMember& member) {
  OutcomeModel model = family;
  model.probabilities = machine.probabilities;
  model.on_slopes = machine.on_slopes;
  model.members = machine.members;
  model.member_hashes = machine.member_hashes;
  if (family.novelty)
    model.novelty = [member, novelty = family.novelty](std::span<const double> point) {
      return novelty(family_point(member, point));
    };
  if (family.novelty_uphill)
    model.novelty_uphill = [member, novelty = family.novelty_uphill](std::span<const double> point,
                                                                     std::span<const double> slopes, auto result) {
      novelty(family_point(member, point), felt_slopes(member, slopes), result);
    };
  model.sampled = member_box(member, family.sampled, kPayloadShare);
  model.gravity = member.gravity;
  model.vehicle = member.vehicle.name;
  model.whole_vehicle = true;
  return model;
}

namespace {

bool drove_family(const campaign::Dataset& trials, const std::filesystem::path& file) {
  const std::string* text = campaign::input_text(trials.provenance, "vehicle");
  return text && vehicle::is_family(Config::parse(*text, file.string() + ": vehicle"));
}

/// The vehicle as trials drive it: on rigid wheels unless tyres give way.
FamilyMember driven_member(const vehicle::Family& family, double family_gravity, const vehicle::Vehicle& vehicle,
                           bool compliant_tyres, double gravity) {
  FamilyMember member = family_member(family, family_gravity, vehicle, gravity);
  if (!compliant_tyres) member.numbers.wheel.deflection = 0;
  return member;
}

}  // namespace

AnsweredTrials answer_trials(const TrainedModel& model, const std::filesystem::path& file) {
  campaign::Dataset own = campaign::read_dataset(file);
  if (drove_family(own, file) || !is_of_family(model)) return {own, own, model.predictor};
  require_family(model);
  const std::optional<TrialVehicle> driven = trial_vehicle(own.provenance, file.string());
  if (!driven)
    throw InputError(file.string() + ": does not hold the files of its vehicle and soil, so that the model " +
                     model.file.string() + " of a family cannot be asked; give trials that hold them");
  const FamilyMember member =
      driven_member(*model.family, model.gravity, driven->vehicle, driven->compliant_tyres, driven->gravity);
  const std::vector<Range> box = sampled_box(model);
  return {own, trials_in_family(own, member, box), machine_of_member(model.file, *model.predictor, member, box)};
}

std::vector<outcome::VehicleTrials> vehicle_trials(const std::filesystem::path& family_file,
                                                   const std::optional<Config>& design,
                                                   const std::vector<std::filesystem::path>& files) {
  std::vector<outcome::VehicleTrials> result;
  if (files.empty()) return result;
  const campaign::Dataset trials = campaign::read_dataset(family_file);
  if (!drove_family(trials, family_file))
    throw InputError(family_file.string() +
                     ": its trials drove one vehicle, so --vehicles has no family to calibrate; leave it out");
  const vehicle::Family driven_family = vehicle::read_family(
      Config::parse(*campaign::input_text(trials.provenance, "vehicle"), family_file.string() + ": vehicle"));
  const double gravity = campaign::settings_of(trials.provenance, family_file.string()).gravity;
  outcome::TrainingData data = outcome::make_training_data(trials.records, design);
  outcome::widen_to_own_ranges(data, trials.provenance, family_file.string());
  std::vector<Range> box;
  for (std::size_t v = 0; v < data.lower.size(); ++v) box.push_back({data.lower[v], data.upper[v]});
  for (const std::filesystem::path& file : files) {
    const campaign::Dataset own = campaign::read_dataset(file);
    const std::optional<TrialVehicle> driven = trial_vehicle(own.provenance, file.string());
    if (!driven || drove_family(own, file))
      throw InputError(file.string() + ": --vehicles wants trials of one vehicle, with the files of vehicle and soil");
    const campaign::Dataset seen = trials_in_family(
        own, driven_member(driven_family, gravity, driven->vehicle, driven->compliant_tyres, driven->gravity), box);
    result.push_back({file_hash(file), driven->name, outcome::make_training_data(seen.records, std::nullopt).table});
  }
  return result;
}

namespace {

/// `family`: empty for the one that ships. Throws InputError where there is none, or it is of no family.
TrainedModel family_model(const std::string& family) {
  const std::optional<std::filesystem::path> file =
      family.empty() ? shipped_family_model() : std::optional(find_model(family));
  if (!file) throw InputError("no model of a family ships; name one with --family-model");
  TrainedModel model = read_trained_model(*file);
  if (!is_of_family(model))
    throw InputError(file->string() + ": is no model of a family of vehicles; give one that is");
  require_family(model);
  return model;
}

/// Throws InputError for a vehicle outside the box of its family, with this advice.
void require_inside(const FamilyMember& member, const std::vector<Range>& box, const std::string& advice) {
  const std::vector<std::string> outside = numbers_outside(member, box);
  if (outside.empty()) return;
  throw InputError(member.vehicle.name + ": lies outside the family " + member.family.name + ": " +
                   join_words(outside) + "; " + advice);
}

}  // namespace

learning::Model model_for_vehicle(const std::string& family, const vehicle::Vehicle& vehicle, double gravity) {
  const TrainedModel model = family_model(family);
  const std::vector<Range> box = sampled_box(model);
  const FamilyMember member = family_member(*model.family, model.gravity, vehicle, gravity);
  require_inside(member, box, "gonogo vehicle study says what trials of its own cost");
  return outcome::member_machine(*model.predictor, outcome::Teacher::read(model.file), question_of(member, box),
                                 outcome::MachineUse::samples);
}

std::shared_ptr<const outcome::Forecast> family_forecast(const std::string& family, const vehicle::Vehicle& vehicle,
                                                         bool compliant_tyres, double gravity) {
  const TrainedModel model = family_model(family);
  const std::vector<Range> box = sampled_box(model);
  const FamilyMember member = driven_member(*model.family, model.gravity, vehicle, compliant_tyres, gravity);
  require_inside(member, box, "leave --from-family out");
  const outcome::FamilyQuestion question = question_of(member, box);
  const auto answer = [question, predictor = model.predictor,
                       teacher = outcome::Teacher::read(model.file)](const std::vector<double>& points) {
    return outcome::member_forecast(predictor->model(), teacher, question, points);
  };
  return std::make_shared<const outcome::Forecast>(
      outcome::Forecast{.hash = file_hash(model.file),
                        .about = "forecast of the family " + member.family.name + " for " + member.vehicle.name,
                        .trials = model.dataset->records.size(),
                        .p_go = answer,
                        .table = outcome::make_training_data(model.dataset->records, std::nullopt).table,
                        .in_family = question.in_family});
}

std::shared_ptr<const outcome::Forecast> family_forecast(const std::string& family,
                                                         const std::filesystem::path& dataset) {
  const std::optional<TrialVehicle> driven =
      trial_vehicle(campaign::read_dataset(dataset).provenance, dataset.string());
  if (!driven)
    throw InputError(dataset.string() +
                     ": does not hold the file of one vehicle, for which --from-family asks its family; leave it out");
  return family_forecast(family, driven->vehicle, driven->compliant_tyres, driven->gravity);
}

}  // namespace gonogo::map
