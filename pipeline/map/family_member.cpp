#include "pipeline/map/family_member.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "pipeline/campaign/setup/setup.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/outcome/training/member_machine.h"
#include "pipeline/outcome/training_data.h"
#include "vehicle/family/driveline_share.h"
#include "vehicle/model/statics.h"
#include "vehicle/world/engine_vehicle.h"

namespace gonogo::map {
namespace {

constexpr double kPayloadShare = 0.25;  // of the mass, on maps: as in campaign::study_of_vehicle()
constexpr double kMostPayload = 0.6;    // of the mass, that a machine learns: trials of the HMMWV have as much

std::size_t index(const char* name) { return campaign::contract().variable_index(name); }

/// A variable of the contract that a member has at another scale than the family.
struct ScaledVariable {
  std::size_t variable;
  double factor;  // member over family
};

std::array<ScaledVariable, 3> scaled_variables(const FamilyMember& m) {
  return {{{index("cohesion"), m.scale.stress},
           {index("bed_depth"), m.scale.length},
           {index("commanded_speed"), m.scale.speed}}};
}

using SlopeOf = double(const vehicle::Vehicle&, const vehicle::VehicleNumbers&, double);

/// Changes a slope along the member [deg]. What is equal or not known stays so to the last digit.
double changed(const FamilyMember& m, double slope, SlopeOf change) {
  const double before = to_radians(slope), after = change(m.vehicle, m.numbers, before);
  return after == before || std::isnan(after) ? slope : to_degrees(after);
}
double felt(const FamilyMember& m, double slope) { return changed(m, slope, vehicle::felt_slope); }
double unfelt(const FamilyMember& m, double slope) { return changed(m, slope, vehicle::own_slope); }
std::vector<double> felt(const FamilyMember& m, std::span<const double> slopes) {
  std::vector<double> result;
  for (const double slope : slopes) result.push_back(felt(m, slope));
  return result;
}

/// Numbers that the mass changes, by loaded().
void add_load(std::vector<double>& point, double mass_ratio) {
  for (const char* name : {"load_number", "deflection_ratio"}) point[index(name)] *= mass_ratio;
  for (const char* name : {"force_number", "power_number"}) point[index(name)] /= mass_ratio;
}

/// Largest payload over the mass, no more than `share`, that keeps the numbers within the box.
double largest_payload(const std::vector<Range>& sampled, const FamilyMember& m, double share) {
  const auto keep = [&](double mass_ratio) {
    if (mass_ratio >= 1) share = std::min(share, mass_ratio - 1);
  };
  keep(sampled[index("load_number")].maximum / m.numbers.wheel.load);
  if (m.numbers.wheel.deflection > 0) keep(sampled[index("deflection_ratio")].maximum / m.numbers.wheel.deflection);
  if (sampled[index("force_number")].minimum > 0) keep(m.numbers.force / sampled[index("force_number")].minimum);
  if (sampled[index("power_number")].minimum > 0) keep(m.numbers.power / sampled[index("power_number")].minimum);
  return share;
}

/// The numbers that are variables of the contract, with what was sampled; trials command the speed.
std::vector<vehicle::PlacedNumber> numbers_of(const FamilyMember& m, const std::vector<Range>& sampled) {
  std::vector<vehicle::PlacedNumber> list = vehicle::placed(m.family, m.numbers);
  std::erase_if(list, [](const vehicle::PlacedNumber& n) { return n.name == "top_speed_number"; });
  for (vehicle::PlacedNumber& n : list) {
    n.range = sampled[index(n.name.c_str())];
    n.value = vehicle::counted(n);
  }
  return list;
}

/// What a measure of the family's vehicle becomes.
struct MeasureScale {
  double weight = 1;  // the member's over that of the trial's vehicle
  double torque = 1;  // of a wheel, at equal push over weight
};

MeasureScale measure_scale(const FamilyMember& m, const campaign::DesignPoint& point) {
  const vehicle::VehicleNumbers driven = campaign::vehicle_at(point);
  const double wheels = 2 * driven.axles;
  double own_wheels = 0;
  for (const vehicle::RunningPart& part : vehicle::running_parts(m.vehicle)) own_wheels += part.driven;
  const double weight = m.mass * m.gravity / (wheels * vehicle::load_of(m.family, driven.wheel, m.family_gravity));
  const double radius = vehicle::drive_radius(m.vehicle) / (m.family.diameter / 2);
  return {.weight = weight, .torque = weight * radius * wheels / own_wheels};
}

campaign::TrialRecord record_of_member(const FamilyMember& m, campaign::TrialRecord record) {
  const MeasureScale s = measure_scale(m, record.point);
  for (const ScaledVariable& v : scaled_variables(m)) record.point.variables[v.variable] *= v.factor;
  double& slope = record.point.variables[index("slope_along")];
  slope = unfelt(m, slope);
  const auto scale = [&](const char* name, double factor) {
    record.measures[campaign::contract().measure_index(name)] *= factor;
  };
  for (const char* name : {"distance", "sinkage", "drift"}) scale(name, m.scale.length);
  for (const char* name : {"mean_speed", "bed_creep", "worst_residual"}) scale(name, m.scale.speed);
  scale("drive_time", m.scale.time());
  scale("mean_torque", s.torque);
  scale("energy_per_metre", s.weight);
  return record;
}

}  // namespace

FamilyMember family_member(const vehicle::Family& family, double family_gravity, const vehicle::Vehicle& v,
                           double gravity) {
  return {.vehicle = v,
          .family = family,
          .family_gravity = family_gravity,
          .gravity = gravity,
          .numbers = vehicle::vehicle_numbers(v, gravity),
          .scale = vehicle::member_scale(family, family_gravity, 2 * v.wheel.front().radius, gravity),
          .mass = vehicle::weigh(v).total};
}

std::vector<double> family_point(const FamilyMember& m, std::span<const double> point) {
  std::vector<double> asked(point.begin(), point.end());
  for (const ScaledVariable& v : scaled_variables(m)) asked[v.variable] /= v.factor;
  double& slope = asked[index("slope_along")];
  slope = felt(m, slope);
  double& payload = asked[index("payload")];
  if (payload > 0) add_load(asked, 1 + payload / m.mass);
  payload = 0;
  return asked;
}

Spreads family_values(const FamilyMember& m, const std::vector<Range>& sampled) {
  Spreads values;
  for (const vehicle::PlacedNumber& n : numbers_of(m, sampled))
    values[n.name] = {Spread::Kind::fixed, n.value, n.value, vehicle_source(m.vehicle.name)};
  return values;
}

namespace {

/// Its box: the family's numbers are its own, and the rest is the family's at its scale.
std::vector<Range> box_of(const FamilyMember& member, std::vector<Range> sampled) {
  const double payload = largest_payload(sampled, member, kMostPayload) * member.mass;
  for (const auto& [name, spread] : family_values(member, sampled))
    sampled[index(name.c_str())] = {spread.low, spread.low};
  for (const ScaledVariable& v : scaled_variables(member)) {
    sampled[v.variable].minimum *= v.factor;
    sampled[v.variable].maximum *= v.factor;
  }
  sampled[index("payload")] = {0, payload};
  return sampled;
}

/// Points of the member as the family's. values: of family_values().
std::vector<double> family_points(const FamilyMember& member, const Spreads& values, std::span<const double> points) {
  const std::size_t width = campaign::contract().variables.size();
  std::vector<double> result;
  result.reserve(points.size());
  for (std::size_t first = 0; first < points.size(); first += width) {
    std::vector<double> point(points.begin() + std::ptrdiff_t(first), points.begin() + std::ptrdiff_t(first + width));
    for (const auto& [name, spread] : values) point[index(name.c_str())] = spread.low;
    point = family_point(member, point);
    result.insert(result.end(), point.begin(), point.end());
  }
  return result;
}

outcome::FamilyQuestion question_of(const FamilyMember& member, const std::vector<Range>& sampled) {
  outcome::FamilyQuestion question{
      .vehicle = member.vehicle.name, .gravity = member.gravity, .lower = {}, .upper = {}, .in_family = {}};
  for (const Range& range : box_of(member, sampled)) {
    question.lower.push_back(range.minimum);
    question.upper.push_back(range.maximum);
  }
  question.in_family = [member, values = family_values(member, sampled)](const std::vector<double>& points) {
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
      novelty(family_point(member, point), felt(member, slopes), result);
    };
  for (const ScaledVariable& v : scaled_variables(member)) {
    model.sampled[v.variable].minimum *= v.factor;
    model.sampled[v.variable].maximum *= v.factor;
  }
  model.sampled[index("payload")] = {0, largest_payload(family.sampled, member, kPayloadShare) * member.mass};
  model.gravity = member.gravity;
  model.vehicle = member.vehicle.name;
  model.whole_vehicle = true;
  return model;
}

campaign::Dataset trials_of_member(const campaign::Dataset& family, const FamilyMember& member) {
  campaign::Dataset own{.records = {}, .provenance = family.provenance};
  own.records.reserve(family.records.size());
  for (const campaign::TrialRecord& record : family.records) own.records.push_back(record_of_member(member, record));
  return own;
}

campaign::Dataset trials_in_family(const campaign::Dataset& own, const FamilyMember& member,
                                   const std::vector<Range>& sampled) {
  const Spreads values = family_values(member, sampled);
  campaign::Dataset result = own;
  for (campaign::TrialRecord& record : result.records) {
    std::vector<double>& point = record.point.variables;
    for (const auto& [name, spread] : values) point[index(name.c_str())] = spread.low;
    point = family_point(member, point);
  }
  return result;
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

std::vector<std::string> numbers_outside(const FamilyMember& m, const std::vector<Range>& sampled) {
  std::vector<std::string> outside;
  for (const vehicle::PlacedNumber& n : numbers_of(m, sampled))
    if (vehicle::excess(n) > 0)
      outside.push_back(n.name + line(" %.3g (", n.value) + vehicle::place_text(n) +
                        line(" %.3g to %.3g)", n.range.minimum, n.range.maximum));
  return outside;
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

}  // namespace

learning::Model model_for_vehicle(const std::string& family, const vehicle::Vehicle& vehicle, double gravity) {
  const TrainedModel model = family_model(family);
  const std::vector<Range> box = sampled_box(model);
  const FamilyMember member = family_member(*model.family, model.gravity, vehicle, gravity);
  if (const std::vector<std::string> outside = numbers_outside(member, box); !outside.empty())
    throw InputError(vehicle.name + ": lies outside the family " + member.family.name + ": " + join_words(outside) +
                     "; gonogo vehicle study says what trials of its own cost");
  return outcome::member_machine(*model.predictor, outcome::Teacher::read(model.file), question_of(member, box),
                                 outcome::MachineUse::samples);
}

std::shared_ptr<const outcome::Forecast> family_forecast(const std::string& family, const vehicle::Vehicle& vehicle,
                                                         bool compliant_tyres, double gravity) {
  const TrainedModel model = family_model(family);
  const std::vector<Range> box = sampled_box(model);
  const FamilyMember member = driven_member(*model.family, model.gravity, vehicle, compliant_tyres, gravity);
  if (const std::vector<std::string> outside = numbers_outside(member, box); !outside.empty())
    throw InputError(vehicle.name + ": lies outside the family " + member.family.name + ": " + join_words(outside) +
                     "; leave --from-family out");
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
