#include "pipeline/outcome/training/report.h"

#include "base/format.h"
#include "pipeline/campaign/study/study.h"

namespace gonogo::outcome {
namespace {

Json annealer_json(const AnnealerReport& annealer) {
  Json json = to_json(annealer.choice), readings = Json::array();
  json["working_qubits"] = annealer.working_qubits;
  json["longest_chain"] = annealer.longest_chain;
  json["pairs"] = annealer.pairs;
  json["masked_pairs"] = annealer.masked_pairs;
  json["last_scale"] = annealer.last_scale;
  for (const learning::ThermometerReading& reading : annealer.readings)
    readings.push_back(Json::Object{{"epoch", reading.epoch},
                                    {"scale", reading.scale},
                                    {"beta", reading.beta},
                                    {"beta_low", reading.low},
                                    {"beta_high", reading.high}});
  json["readings"] = std::move(readings);
  return json;
}

void add_sampler(const SamplerReport& sampler, Json& json) {
  json["sampler"] = sampler.name;
  json["sampled_on"] = sampler.on_gpu ? "gpu" : "cpu";
  json["stand_in"] = sampler.stood_in;
  if (sampler.annealer) json["annealer"] = annealer_json(*sampler.annealer);
  if (!sampler.stood_in) return;
  json["sampler_wanted"] = sampler.wanted;
  json["stand_in_reason"] = sampler.reason;
}

SamplerReport read_sampler(const Json& json) {
  SamplerReport sampler{.name = json.at("sampler").string(), .stood_in = json.at("stand_in").boolean()};
  if (const Json* found = json.find("annealer")) {
    AnnealerReport& annealer = sampler.annealer.emplace();
    annealer.choice.graph = found->at("graph").string();
    annealer.choice.thermometer = found->at("thermometer").string();
    annealer.working_qubits = found->at("working_qubits").unsigned_integer();
    annealer.pairs = found->at("pairs").unsigned_integer();
    annealer.masked_pairs = found->at("masked_pairs").unsigned_integer();
    annealer.last_scale = found->at("last_scale").number();
  }
  if (!sampler.stood_in) return sampler;
  sampler.wanted = json.at("sampler_wanted").string();
  sampler.reason = json.at("stand_in_reason").string();
  return sampler;
}

Json counts_json(const TrialCounts& counts) {
  Json outcomes = Json::object();
  for (const auto& [name, count] : counts.outcomes) outcomes[name] = count;
  return Json::Object{{"trials", counts.trials},
                      {"trained_on", counts.trained_on},
                      {"left_out_unknown", counts.unknown},
                      {"outcomes", std::move(outcomes)},
                      {"held_out", counts.held_out}};
}

Json failures_json(const FailureRate& failures) {
  Json json = Json::Object{
      {"rate", failures.overall.value}, {"rate_low", failures.overall.low}, {"rate_high", failures.overall.high}};
  if (!failures.modelled) return json;
  Json weights = Json::object();
  for (const auto& [variable, weight] : failures.modelled->weights) weights[variable] = weight;
  json["modelled_rate_highest"] = failures.modelled->highest;
  json["weights_per_standard_deviation"] = std::move(weights);
  return json;
}

Json odds_json(const VehicleOdds& odds) {
  Json vehicles = Json::array();
  for (const VehicleOdds::Vehicle& vehicle : odds.vehicles)
    vehicles.push_back(
        Json::Object{{"data_hash", vehicle.hash}, {"vehicle", vehicle.name}, {"trials", vehicle.trials}});
  return Json::Object{{"shift_nat", odds.shift}, {"vehicles", std::move(vehicles)}};
}

}  // namespace

Json to_json(const TrainingReport& report) {
  Json json, others = Json::array();
  json["data_hash"] = report.data_hash;
  json["contract_hash"] = report.contract_hash;
  json["program_version"] = report.program_version;
  if (report.gravity) json[campaign::kGravityKey] = *report.gravity;
  add_sampler(report.sampler, json);
  json["calibration_power"] = report.calibration_power;
  if (!report.odds.vehicles.empty()) json["vehicle_odds"] = odds_json(report.odds);
  json["seed"] = report.seed;
  json["settings"] = to_json(report.settings);
  json["teacher_weight"] = report.teacher_weight;
  for (const OtherDataset& other : report.others)
    others.push_back(Json::Object{{"data_hash", other.hash}, {"trials", other.trials}, {"fidelity", other.fidelity}});
  if (!report.others.empty()) json["other_trials"] = std::move(others);
  json["batch"] = report.batch;
  json["epochs"] = report.epochs;
  json["counts"] = counts_json(report.counts);
  json["failures"] = failures_json(report.failures);
  json["cross_validation"] = to_json(report.cross_validation);
  json["cross_validation"]["folds"] = report.folds;
  if (report.joint) json["joint"] = to_json(*report.joint);
  return json;
}

TrainingReport read_report(const Json& provenance) {
  const Json &counts = provenance.at("counts"), &failures = provenance.at("failures");
  TrainingReport report;
  report.sampler = read_sampler(provenance);
  report.calibration_power = provenance.at("calibration_power").number();
  if (const Json* others = provenance.find("other_trials"))
    for (const Json& other : others->items())
      report.others.push_back(
          {other.at("data_hash").string(), other.at("trials").unsigned_integer(), other.at("fidelity").string()});
  if (const Json* odds = provenance.find("vehicle_odds")) {
    report.odds.shift = odds->at("shift_nat").number();
    for (const Json& vehicle : odds->at("vehicles").items())
      report.odds.vehicles.push_back(
          {vehicle.at("data_hash").string(), vehicle.at("vehicle").string(), vehicle.at("trials").unsigned_integer()});
  }
  report.epochs = provenance.at("epochs").unsigned_integer();
  report.counts.trials = counts.at("trials").unsigned_integer();
  report.counts.trained_on = counts.at("trained_on").unsigned_integer();
  report.counts.unknown = counts.at("left_out_unknown").unsigned_integer();
  for (const auto& [name, count] : counts.at("outcomes").members())
    report.counts.outcomes.emplace_back(name, count.unsigned_integer());
  report.failures.overall = {failures.at("rate").number(), failures.at("rate_low").number(),
                             failures.at("rate_high").number()};
  report.cross_validation = read_scores(provenance.at("cross_validation"));
  report.folds = provenance.at("cross_validation").at("folds").unsigned_integer();
  report.joint = joint_summary(provenance);
  return report;
}

std::string report_text(const TrainingReport& report) {
  const learning::Interval& rate = report.failures.overall;
  std::string text =
      line("%zu trials: trained on %zu, left out %zu that failed (rate %.3f, 95 %% interval %.3f to %.3f)\n",
           report.counts.trials, report.counts.trained_on, report.counts.unknown, rate.value, rate.low, rate.high);
  for (const OtherDataset& other : report.others)
    text += line("%zu other trials help: %s\n", other.trials, other.fidelity.c_str());
  text += "outcomes:";
  for (const auto& [name, count] : report.counts.outcomes)
    if (count > 0) text += line(" %s %zu", name.c_str(), count);
  const SamplerReport& sampler = report.sampler;
  text += line("\nsampler %s, %zu epochs; scores by %zu-fold cross-validation:\n", sampler.name.c_str(), report.epochs,
               report.folds);
  if (sampler.stood_in)
    text +=
        "the sampler " + sampler.wanted + " could not be used, " + sampler.name + " stood in: " + sampler.reason + "\n";
  if (const auto& annealer = sampler.annealer)
    text += line(
        "emulated annealer: %zu working qubits of %s, %zu of %zu pairs of units masked; thermometer %s, last scale "
        "%.3f\n",
        annealer->working_qubits, annealer->choice.graph.c_str(), annealer->masked_pairs, annealer->pairs,
        annealer->choice.thermometer.c_str(), annealer->last_scale);
  if (report.calibration_power != 1)
    text += line("probabilities are calibrated: raised to %.3f\n", report.calibration_power);
  if (!report.odds.vehicles.empty()) {
    text += line("log odds of passing shifted by %+.2f, though not in these scores, by trials of", report.odds.shift);
    for (const VehicleOdds::Vehicle& vehicle : report.odds.vehicles)
      text += line(" %s (%zu)", vehicle.name.c_str(), vehicle.trials);
    text += "\n";
  }
  text += scores_text(report.cross_validation);
  if (const auto& joint = report.joint)
    text += line(
        "joint distribution, %zu of the machine's rows against as many trials: AUC in bins %.3f (trials against trials "
        "%.3f), of values %.3f (%.3f);\n  Brier score trained on the rows %.4f (%.4f); P(go or slow-go) %.3f (%.3f)\n",
        joint->rows, joint->auc_bins, joint->floor_bins, joint->auc_values, joint->floor_values, joint->trained_brier,
        joint->floor_brier, joint->passable, joint->trials_passable);
  return text;
}

}  // namespace gonogo::outcome
