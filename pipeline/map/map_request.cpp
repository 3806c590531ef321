#include "pipeline/map/map_request.h"

#include <memory>
#include <optional>

#include "base/error.h"
#include "base/hash.h"
#include "base/json/json.h"
#include "pipeline/learn/predictor.h"
#include "pipeline/study/study.h"

namespace gonogo::pipeline {
namespace {

OutcomeModel read_outcome_model(const std::filesystem::path& file) {
  const auto predictor = std::make_shared<const Predictor>(Predictor::read(file));
  OutcomeModel model;
  model.hash = file_hash(file);
  for (std::size_t v = 0; v < contract().variables.size(); ++v)
    model.sampled.push_back({predictor->model().sampled_lower[v], predictor->model().sampled_upper[v]});
  model.probabilities = [predictor](std::span<const double> points, std::span<double> result) {
    predictor->outcome_probabilities(points, result);
  };
  return model;
}

/// The vehicle's own name; the file's, if it gives none.
std::string vehicle_name(const std::filesystem::path& file) {
  const Json vehicle = Json::read(file);
  const Json* name = vehicle.is_object() ? vehicle.find("vehicle") : nullptr;
  return name && name->is_string() ? name->string() : file.stem().string();
}

}  // namespace

MapRequest read_map_request(const MapFiles& files) {
  std::optional<Study> study;
  if (!files.study.empty()) study = read_study(files.study);
  const std::filesystem::path region = !files.region.empty() ? files.region : study ? study->region : "";
  if (region.empty()) throw InputError("map: no region; give --region, or a --study that names one");
  MapRequest request;
  request.region = read_region(region);
  request.rules = read_map_rules(study ? study->config.object_if("map") : std::nullopt);
  request.model = read_outcome_model(files.model);
  if (study && !study->vehicle.empty()) request.model.vehicle = vehicle_name(study->vehicle);
  request.out = files.out;
  request.colour_blind_safe = files.colour_blind_safe;
  request.threads = files.threads;
  return request;
}

}  // namespace gonogo::pipeline
