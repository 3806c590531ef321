#include "pipeline/map/write/map_request.h"

#include <memory>
#include <optional>

#include "base/error.h"
#include "base/hash.h"
#include "base/json/json.h"
#include "base/units.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/learn/answer/predictor.h"
#include "terrain/soil/strength.h"
#include "vehicle/semi_empirical/mobility_index.h"

namespace gonogo::map {
namespace {

OutcomeModel read_outcome_model(const std::filesystem::path& file) {
  const auto predictor = std::make_shared<const learn::Predictor>(learn::Predictor::read(file));
  OutcomeModel model;
  model.hash = file_hash(file);
  for (std::size_t v = 0; v < campaign::contract().variables.size(); ++v)
    model.sampled.push_back({predictor->model().sampled_lower[v], predictor->model().sampled_upper[v]});
  model.probabilities = [predictor](std::span<const double> points, std::span<double> result) {
    predictor->outcome_probabilities(points, result);
  };
  model.novelty = [predictor](std::span<const double> point) { return predictor->novelty(point); };
  return model;
}

/// Reads the bootstrap members of the model.
void add_members(OutcomeModel& model, const std::vector<std::filesystem::path>& files) {
  for (const std::filesystem::path& file : files) {
    const auto predictor = std::make_shared<const learn::Predictor>(learn::Predictor::read(file));
    for (std::size_t v = 0; v < model.sampled.size(); ++v)
      if (predictor->model().sampled_lower[v] != model.sampled[v].minimum ||
          predictor->model().sampled_upper[v] != model.sampled[v].maximum)
        throw InputError(file.string() + ": is no member of the model: its trials sampled another range of " +
                         campaign::contract().variables[v].name + "; make members with gonogo train --members");
    model.member_hashes.push_back(file_hash(file));
    model.members.push_back([predictor](std::span<const double> points, std::span<double> result) {
      predictor->outcome_probabilities(points, result);
    });
  }
}

/// Measures of the trials that passed, fitted over the variables.
void add_measures(OutcomeModel& model, const std::filesystem::path& file) {
  const campaign::Dataset dataset = campaign::read_dataset(file);
  model.dataset_hash = file_hash(file);
  for (const char* name : {"mean_speed", "slip", "sinkage", "energy_per_metre"}) {
    std::vector<double> points, value;
    const std::size_t index = campaign::contract().measure_index(name);
    for (const campaign::TrialRecord& record : dataset.records) {
      if (!campaign::passes(record.verdict)) continue;
      points.insert(points.end(), record.point.variables.begin(), record.point.variables.end());
      value.push_back(record.measures[index]);
    }
    model.measures.push_back(fit_measure(name, campaign::contract().measures[index].unit, points, value));
    if (model.measures.back().trials == 0) model.measures.pop_back();
  }
}

/// The vehicle's own name; the file's, if it gives none.
std::string vehicle_name(const std::filesystem::path& file) {
  const Json vehicle = Json::read(file);
  const Json* name = vehicle.is_object() ? vehicle.find("vehicle") : nullptr;
  return name && name->is_string() ? name->string() : file.stem().string();
}

}  // namespace

ConeIndexNeed read_cone_index_need(const std::filesystem::path& file) {
  const vehicle::Vehicle vehicle = vehicle::read_vehicle(file);
  const vehicle::VehicleConeIndex index = vehicle::vehicle_index(vehicle).cone_index;
  return {vehicle.name, index.one_pass * kPsi, index.fifty_passes * kPsi};
}

MapRequest read_map_request(const MapFiles& files) {
  std::optional<campaign::Study> study;
  if (!files.study.empty()) study = campaign::read_study(files.study);
  const std::filesystem::path region = !files.region.empty() ? files.region : study ? study->region : "";
  if (region.empty()) throw InputError("map: no region; give --region, or a --study that names one");
  MapRequest request;
  request.region = read_region(region);
  request.rules = read_map_rules(study ? study->config.object_if("map") : std::nullopt);
  request.model = read_outcome_model(files.model);
  add_members(request.model, files.members);
  if (!files.dataset.empty()) add_measures(request.model, files.dataset);
  if (!files.heading.empty()) set_heading(request.rules, files.heading, "map: --heading");
  if (!files.moisture.empty()) {
    if (files.moisture != "dry" && files.moisture != "moist" && files.moisture != "wet")
      throw InputError("map: --moisture \"" + files.moisture + "\" is no scenario; use dry, moist or wet");
    request.rules.moisture = files.moisture;
  }
  if (!files.vehicle.empty()) request.rules.cone_index_of = files.vehicle;
  if (!request.rules.cone_index_of.empty())
    request.model.cone_index = read_cone_index_need(request.rules.cone_index_of);
  if (study && !study->vehicle.empty()) request.model.vehicle = vehicle_name(study->vehicle);
  request.out = files.out;
  request.colour_blind_safe = files.colour_blind_safe;
  request.threads = files.threads;
  return request;
}

}  // namespace gonogo::map
