#include "pipeline/map/map_request.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "base/error.h"
#include "base/files/file.h"
#include "base/files/shipped.h"
#include "base/format.h"
#include "base/json/json.h"
#include "base/shell.h"
#include "base/units.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/campaign/setup/vehicle_study.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/map/evaluate/outcome_model.h"
#include "pipeline/map/family_answers.h"
#include "pipeline/map/soils/soil.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/answer/infer.h"
#include "terrain/raster/raster_source.h"
#include "terrain/soil/soil.h"
#include "vehicle/model/statics.h"
#include "vehicle/semi_empirical/mobility_index.h"

namespace gonogo::map {
namespace {

OutcomeModel outcome_model_of(const TrainedModel& trained) {
  const auto predictor = trained.predictor;
  OutcomeModel model;
  model.hash = file_hash(trained.file);
  model.gravity = trained.gravity;
  model.sampled = sampled_box(trained);
  model.probabilities = [predictor](std::span<const double> points, std::span<double> result) {
    predictor->outcome_probabilities(points, result);
  };
  model.on_slopes = [predictor, kept = std::make_shared<KeptAnswers>()](
                        std::span<const double> points, std::span<const double> along, std::span<const double> across,
                        std::span<double> result) {
    predictor->on_slopes(points, along, across, result, [&](auto point, auto answer, const auto& compute) {
      kept->fill(std::array{point, along, across}, answer, compute);
    });
  };
  model.novelty = [predictor](std::span<const double> point) { return predictor->novelty(point); };
  model.novelty_uphill = [predictor](auto... asked) { predictor->novelty_uphill(asked...); };
  if (!trained.is_up_to_date)
    model.remarks.push_back("the model was trained on other trials than those of " + trained.dataset_file.string() +
                            " beside it, which tell its vehicle and measures; train it again (gonogo train)");
  if (trained.vehicle) {
    model.vehicle = trained.vehicle->name;
    model.whole_vehicle = !vehicle::is_quarter(trained.vehicle->vehicle);
  }
  return model;
}

using SharedPredictor = std::shared_ptr<const outcome::Predictor>;
/// Who answers in place of the model in a file.
using AnswerFor = std::function<SharedPredictor(const std::filesystem::path& file, const SharedPredictor& predictor)>;

/// Reads the bootstrap members of a model whose trials sampled this box. answer_for: nothing where they answer.
void add_members(OutcomeModel& model, const std::vector<std::filesystem::path>& files, const std::vector<Range>& box,
                 const AnswerFor& answer_for) {
  for (const std::filesystem::path& file : files) {
    auto predictor = std::make_shared<const outcome::Predictor>(outcome::Predictor::read(file));
    for (std::size_t v = 0; v < box.size(); ++v)
      if (predictor->model().sampled_lower[v] != box[v].minimum ||
          predictor->model().sampled_upper[v] != box[v].maximum)
        throw InputError(file.string() + ": is no member of the model: its trials sampled another range of " +
                         campaign::contract().variables[v].name + "; make members with gonogo train --members");
    if (answer_for) predictor = answer_for(file, predictor);
    model.member_hashes.push_back(file_hash(file));
    model.members.push_back([predictor](std::span<const double> points, std::span<double> result) {
      predictor->outcome_probabilities(points, result);
    });
  }
}

/// Measures of the trials that passed, fitted over the variables.
void add_measures(OutcomeModel& model, const TrainedModel& trained) {
  if (!trained.dataset) return;
  model.dataset_hash = file_hash(trained.dataset_file);
  for (const char* name : {"slip", "sinkage", "energy_per_metre"})
    if (MeasureFit fit = fit_of_passed(*trained.dataset, name); fit.trials > 0)
      model.measures.push_back(std::move(fit));
}

ConeIndexNeed cone_index_need(const vehicle::Vehicle& v) {
  const vehicle::VehicleConeIndex index = vehicle::vehicle_index(v).cone_index;
  return {v.name, index.one_pass * kPsi, index.fifty_passes * kPsi};
}

/// The vehicle's need; nothing where it has none, such as a rover whose file gives no tyre size.
std::optional<ConeIndexNeed> cone_index_if_any(const vehicle::Vehicle& v) {
  try {
    return cone_index_need(v);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

CrossingLimits crossing_limits(const vehicle::Vehicle& v) {
  CrossingLimits limits{.vehicle = v.name,
                        .tracked = v.track.has_value(),
                        .radius = v.wheel.front().radius,
                        .friction = v.wheel.front().friction,
                        .width = v.width,
                        .length = v.length,
                        .clearance = v.clearance};
  if (!limits.tracked) return limits;
  limits.radius = std::min(v.track->sprocket_radius, v.track->idler_radius) + v.track->pad_below_pin;
  limits.contact_length = vehicle::track_contact_length(v);
  return limits;
}

/// Cone index and top speed, of the model's own vehicle or of the one that its quarter stands for.
/// Also what the vehicle crosses, for the region's obstacles.
void add_vehicle(OutcomeModel& model, Region& region, const TrainedModel& trained,
                 const std::filesystem::path& whole_file) {
  const bool on_earth = model.gravity == kGravity;  // cone indices are correlations of tests on the Earth
  if (!whole_file.empty() && on_earth) model.cone_index = read_cone_index_need(whole_file);
  std::optional<vehicle::Vehicle> whole;
  if (trained.vehicle && !vehicle::is_quarter(trained.vehicle->vehicle)) whole = trained.vehicle->vehicle;
  if (!whole && !whole_file.empty()) whole = vehicle::read_vehicle(whole_file);
  if (!whole) return;
  region.crossing = crossing_limits(*whole);
  if (!model.cone_index && on_earth) model.cone_index = cone_index_if_any(*whole);
  if (trained.vehicle && trained.dataset) model.speed = speed_of_trials(*trained.dataset, *trained.vehicle, *whole);
}

/// Lets trials of ditches answer for the region's ditches. Without such a model, or without a whole vehicle, geometry
/// alone decides.
void add_crossings(OutcomeModel& model, Region& region, const TrainedModel& trained, const std::string& asked) {
  const bool any = std::any_of(region.obstacles.begin(), region.obstacles.end(),
                               [](const Obstacle& o) { return o.kind == ObstacleKind::ditch; });
  if (asked.empty() && (!any || !region.crossing)) return;
  const std::optional<TrainedModel> ditches = find_crossing_model(trained, asked);
  if (!ditches || !region.crossing) return;
  const OutcomeModel crossing = outcome_model_of(*ditches);
  region.crossing->ditch_width = crossing.sampled[campaign::contract().variable_index("ditch_width")];
  region.crossing->ditch_depth = crossing.sampled[campaign::contract().variable_index("ditch_depth")];
  model.remarks.insert(model.remarks.end(), crossing.remarks.begin(), crossing.remarks.end());
  add_crossing_model(model, crossing);
}

/// Values of the mission that --set gives. Throws InputError for those that the model's trials did not sample: every
/// cell would be unknown.
void set_values(MapRules& rules, const std::vector<std::string>& texts, const OutcomeModel& model) {
  for (const auto& [name, value] : outcome::parse_named_values(texts)) {
    if (name == "slope_along" || name == "slope_across")
      throw InputError("map: --set " + name + ": slopes come from the elevation raster; leave it out");
    const std::size_t v = campaign::contract().variable_index(name);
    const campaign::Variable& variable = campaign::contract().variables[v];
    const Range sampled = model.sampled[v];
    if (variable.prior != "region" && (value < sampled.minimum || value > sampled.maximum))
      throw InputError(
          line("map: --set %s=%g: the model's trials had %g to %g %s; give a value of that range, or a model "
               "whose trials had it",
               name.c_str(), value, sampled.minimum, sampled.maximum, variable.unit.c_str()));
    rules.values[name] = {Spread::Kind::fixed, value, value, "--set"};
  }
}

/// Friction of a tyre or belt on soil as its vehicle's file has it, with what tread and wear make of it.
constexpr double kOrdinarySpread = 0.1;

/// The part of the sampled tyre friction that is ordinary for the vehicle; all of it where no file says what that is.
Spread ordinary_friction(const Range& sampled, const TrainedModel& trained) {
  const Spread all{Spread::Kind::range, sampled.minimum, sampled.maximum, "not given: the range that trials sampled"};
  if (!trained.vehicle || trained.vehicle->vehicle.wheel.empty()) return all;
  const double friction = trained.vehicle->vehicle.wheel.front().friction;
  const Range range = {std::max(sampled.minimum, friction - kOrdinarySpread),
                       std::min(sampled.maximum, friction + kOrdinarySpread)};
  if (!(range.minimum < range.maximum)) return all;
  return {Spread::Kind::range, range.minimum, range.maximum,
          line("not given: %g of the vehicle's file, +- %g", friction, kOrdinarySpread)};
}

/// Nobody gave the variables of the mission: they may be anywhere that trials sampled, and the grip of the tyres is
/// that of the vehicle's own.
void open_mission(Region& region, const OutcomeModel& model, const TrainedModel& trained) {
  for (std::size_t v = 0; v < model.sampled.size(); ++v) {
    const campaign::Variable& variable = campaign::contract().variables[v];
    const Range sampled = model.sampled[v];
    if (variable.prior == "region" || campaign::is_task_variable(variable) || !(sampled.minimum < sampled.maximum))
      continue;
    Spread& spread = region.values[variable.name] = {Spread::Kind::range, sampled.minimum, sampled.maximum,
                                                     "not given: the range that trials sampled"};
    if (variable.name == "tyre_friction") spread = ordinary_friction(sampled, trained);
  }
}

bool is_raster(const std::string& soil) {
  return std::filesystem::is_regular_file(soil) && std::filesystem::path(soil).extension() != ".json";
}

/// A cone index of all of the ground, or a raster of it.
void set_cone_index(Region& region, const std::string& text) {
  if (text.empty()) return;
  if (std::filesystem::is_regular_file(text)) {
    region.cone_index = RegionRaster{.files = std::filesystem::path(text),
                                     .source = std::filesystem::path(text).filename().string() + ", cone index in psi",
                                     .licence = "licence not stated",
                                     .unit = kPsi};
    return;
  }
  const bool kilopascal = text.ends_with("kPa");
  const double unit = kilopascal ? 1e3 : kPsi;
  const std::string number = text.substr(0, text.size() - (kilopascal || text.ends_with("psi") ? 3 : 0));
  const double index = unit * parsed<double>(number).value_or(-1);
  if (!(index >= 0 && index <= kMaxConeIndex))
    throw InputError(
        "map: --cone-index \"" + text +
        line("\" is neither a raster nor a number in range; give 0 to %.0f psi, or 0 to %.0fkPa with that unit",
             kMaxConeIndex / kPsi, kMaxConeIndex / 1e3));
  region.cone_index_everywhere = index;
}

/// An elevation raster, and a soil that comes by name, by a raster of textures, or not at all.
Region region_of_dem(const MapFiles& files) {
  Region region;
  region.file = files.dem;
  region.name = files.dem.stem().string();
  region.elevation.files = terrain::RasterFiles(files.dem);
  region.elevation.source = files.dem.filename().string();
  region.elevation.licence = "licence not stated";
  set_cone_index(region, files.cone_index);
  if (is_raster(files.soil)) {
    region.soil_class =
        RegionRaster{.files = std::filesystem::path(files.soil),
                     .source = std::filesystem::path(files.soil).filename().string() + ", USDA textures",
                     .licence = "licence not stated"};
    region.soils = texture_soils(terrain::class_names(region.soil_class->files), files.moisture, files.soil);
    region.soil_text = "USDA textures, " + soil_hash("");
    return region;
  }
  region.soils.push_back(files.soil.empty() ? soil_not_given(files.moisture) : named_soil(files.soil, files.moisture));
  region.about = region.name + ", " + region.soils.front().name;
  region.soil_text = region.soils.front().name + ", " + soil_hash(files.soil);
  return region;
}

Region region_of(const MapFiles& files, const std::optional<campaign::Study>& study) {
  if (!files.dem.empty()) {
    if (!files.region.empty()) throw InputError("map: --dem and --region are both given; keep one of them");
    return region_of_dem(files);
  }
  if (!files.cone_index.empty())
    throw InputError("map: --cone-index goes with --dem; a region file has its own key cone_index (docs/map.md)");
  if (!files.soil.empty())
    throw InputError("map: --soil goes with --dem; a region file says what its soils are (docs/map.md)");
  const std::filesystem::path region = !files.region.empty() ? files.region : study ? study->region : "";
  if (region.empty())
    throw InputError(
        "map: no region; give an elevation raster with --dem, a region file with --region, or a --study "
        "that names one");
  return read_region(region);
}

void check_moisture(const std::string& moisture) {
  if (!moisture.empty() && moisture != "dry" && moisture != "moist" && moisture != "wet")
    throw InputError("map: --moisture \"" + moisture + "\" is no scenario; use dry, moist or wet");
}

/// Names the trials that the model learned from but does not answer for, and the vehicles that shifted its odds.
void remark_helpers(OutcomeModel& model, const TrainedModel& trained) {
  const Json& provenance = trained.predictor->model().provenance;
  if (const Json* odds = provenance.find("vehicle_odds")) {
    std::vector<std::string> names;
    for (const Json& vehicle : odds->at("vehicles").items()) names.push_back(vehicle.at("vehicle").string());
    model.remarks.push_back("P(go) is shifted as trials of " + join_words(names) +
                            " ask of the family: " + line("%+.2f in log odds", odds->at("shift_nat").number()));
  }
  if (const Json* others = provenance.find("other_trials"))
    for (const Json& other : others->items())
      model.remarks.push_back(std::to_string(other.at("trials").integer()) +
                              " other trials helped the model: " + other.at("fidelity").string());
}

/// The vehicle's own name; the file's, if it gives none.
std::string vehicle_name(const std::filesystem::path& file) {
  const Json vehicle = Json::read(file);
  const Json* name = vehicle.is_object() ? vehicle.find("vehicle") : nullptr;
  return name && name->is_string() ? name->string() : file.stem().string();
}

constexpr std::size_t kOwnTrials = 600;  // that a vehicle's own model takes at least

/// How to make a vehicle's own model, and what that costs here.
std::string own_model_text(const std::filesystem::path& file, const std::string& name, double gravity) {
  const campaign::VehicleStudy study = campaign::study_of_vehicle(file, kOwnTrials, gravity);
  const std::string own = shell_word(name + "_study.json"), folder = shell_word("out/" + name),
                    model = shell_word("out/" + name + "/model.h5");
  const std::string there = is_same_gravity(gravity, kGravity) ? "" : line(" --gravity %.4g", gravity);
  return "To make its own: gonogo vehicle study " + shell_word(file.string()) + there + " --out " + own +
         "; gonogo campaign run " + own + " --out " + folder + "; gonogo train --dataset " +
         shell_word("out/" + name + "/dataset.h5") + " --study " + own + " --out " + model + "; then give --model " +
         model + ". Cost: " + campaign::cost_text(study, kOwnTrials);
}

/// The model that was asked for, or the one that ships for the vehicle or for its family.
std::filesystem::path model_file(const MapFiles& files) {
  if (!files.model.empty()) return find_model(files.model.string());
  const std::vector<std::string> names = vehicles_with_models();
  const std::string shipped = "models ship for: " + join_words(names);
  if (files.vehicle.empty())
    throw InputError("map: --model is missing; name a shipped model or its vehicle, a model.h5, or --vehicle. " +
                     shipped);
  const std::filesystem::path file = shipped_file("vehicles", "vehicle", files.vehicle.string());
  const std::string name = vehicle_name(file);
  if (std::count(names.begin(), names.end(), name) == 1) return find_model(name);
  const bool is_wheeled = vehicle::read_vehicle(file).kind == vehicle::VehicleKind::wheeled;
  if (const auto family = shipped_family_model(); family && is_wheeled) return *family;
  throw InputError(file.string() + ": the vehicle " + name + " has no model yet; " + shipped + ". " +
                   own_model_text(file, name, kGravity));
}

/// Gravity of the ground that is mapped.
double gravity_of(const Region& region) {
  const auto source = terrain::RasterSource::open_elevation(region.elevation.files);
  return ground_gravity(region, source.grid().body_radius);
}

/// Throws InputError for a model of a family that cannot answer for a vehicle.
void check_family(const TrainedModel& trained, const std::filesystem::path& vehicle) {
  if (!is_of_family(trained)) return;
  require_family(trained);
  if (vehicle.empty())
    throw InputError(trained.file.string() + ": is a model of a family, " + trained.family->name +
                     "; name one vehicle with --vehicle (gonogo vehicle new makes its file)");
}

/// Makes the model of a family one of the vehicle that is asked for: its trials, too.
FamilyMember take_member(TrainedModel& trained, const std::filesystem::path& file, const Region& region) {
  const campaign::TrialSettings settings =
      campaign::settings_of(trained.dataset->provenance, trained.dataset_file.string());
  FamilyMember member =
      family_member(*trained.family, trained.gravity, vehicle::read_vehicle(file), gravity_of(region));
  TrialVehicle driven{.name = member.vehicle.name,
                      .vehicle = member.vehicle,
                      .compliant_tyres = settings.compliant_tyres && member.numbers.wheel.deflection > 0,
                      .wheel_rolling = settings.wheel_rolling,
                      .table = terrain::read_calibration(
                          Config::parse(*campaign::input_text(trained.dataset->provenance, "calibration"),
                                        trained.dataset_file.string() + ": calibration")),
                      .gravity = member.gravity,
                      .file = Json::read(file)};
  driven.table.grain_diameter *= member.scale.length;
  trained.dataset = trials_of_member(*trained.dataset, member);
  trained.vehicle = driven;
  trained.gravity = member.gravity;
  return member;
}

/// Says who answers, and what lies outside.
void remark_member(OutcomeModel& model, const TrainedModel& trained, const FamilyMember& member,
                   const std::filesystem::path& file) {
  const std::string& name = member.vehicle.name;
  model.remarks.push_back("no trial drove the vehicle " + name + ": " +
                          std::to_string(trained.dataset->records.size()) + " trials of other vehicles of the family " +
                          member.family.name + " answer at its numbers without dimension (docs/vehicles.md)");
  const std::vector<std::string> outside = numbers_outside(member, model.sampled);
  if (outside.empty()) return;
  model.remarks.push_back(name + " lies outside the family, so that every cell is unknown: " + join_words(outside) +
                          ". " + own_model_text(file, name, member.gravity));
}

/// Lets the machines of a vehicle of the family answer for the model and its bootstrap members.
void ask_member(MapRequest& request, TrainedModel& trained, const std::vector<std::filesystem::path>& members,
                const std::filesystem::path& vehicle) {
  const FamilyMember member = take_member(trained, vehicle, request.region);
  const std::vector<Range> sampled = request.model.sampled;
  AnswerFor machine_of = [&](const std::filesystem::path& file, const SharedPredictor& family) {
    return machine_of_member(file, *family, member, sampled);
  };
  if (!numbers_outside(member, sampled).empty()) machine_of = nullptr;  // every cell is unknown, whoever answers
  TrainedModel own = trained;
  if (machine_of) own.predictor = machine_of(trained.file, trained.predictor);
  OutcomeModel machine = outcome_model_of(own);
  add_members(machine, members, sampled, machine_of);
  request.rules.values.merge(family_values(member, sampled));
  request.rules.values.try_emplace("payload",
                                   Spread{Spread::Kind::fixed, 0, 0, "not given: the vehicle as its file weighs"});
  request.model = model_of_member(request.model, machine, member);
  remark_member(request.model, trained, member, vehicle);
}

}  // namespace

ConeIndexNeed read_cone_index_need(const std::filesystem::path& file) {
  return cone_index_need(vehicle::read_vehicle(file));
}

MapRequest read_map_request(const MapFiles& files) {
  check_moisture(files.moisture);
  std::optional<campaign::Study> study;
  if (!files.study.empty()) study = campaign::read_study(files.study);
  TrainedModel trained = read_trained_model(model_file(files), files.dataset);
  if (crosses_ditches(trained.predictor->model()))
    throw InputError(trained.file.string() +
                     ": its trials cross ditches, so that it answers for ditches alone; give the vehicle's other model "
                     "with --model, and this one with --crossing-model");
  MapRequest request;
  request.rules = read_map_rules(study ? study->config.object_if("map") : std::nullopt);
  request.model = outcome_model_of(trained);
  request.region = region_of(files, study);
  const std::filesystem::path vehicle =
      files.vehicle.empty() ? "" : shipped_file("vehicles", "vehicle", files.vehicle.string());
  check_family(trained, vehicle);
  if (trained.family) {
    ask_member(request, trained, files.members, vehicle);
  } else {
    add_members(request.model, files.members, request.model.sampled, {});
  }
  if (!vehicle.empty()) require_vehicle(trained, vehicle);
  if (study) require_study(trained, files.study);
  if (!files.dem.empty()) open_mission(request.region, request.model, trained);
  if (trained.vehicle) request.region.table = trained.vehicle->table;
  if (!files.height_unit.empty()) request.region.elevation.heights.unit = files.height_unit;
  if (files.flat_is_ground) request.region.elevation.heights.flat_is_ground = true;
  add_measures(request.model, trained);
  if (!files.heading.empty()) set_heading(request.rules, files.heading, "map: --heading");
  if (files.dem.empty() && !files.moisture.empty()) request.rules.moisture = files.moisture;
  set_values(request.rules, files.set, request.model);
  if (files.max_speed_km_h > 0) request.rules.max_speed = files.max_speed_km_h / kKmPerHour;
  if (!files.whole_vehicle.empty()) request.rules.cone_index_of = files.whole_vehicle;
  add_vehicle(request.model, request.region, trained, request.rules.cone_index_of);
  add_crossings(request.model, request.region, trained, files.crossing_model.string());
  if (trained.vehicle && request.rules.fidelity == MapRules{}.fidelity)
    request.rules.fidelity = trained.vehicle->fidelity();
  remark_helpers(request.model, trained);
  if (!trained.vehicle && study && !study->vehicle.empty()) request.model.vehicle = vehicle_name(study->vehicle);
  request.out = files.out;
  request.colour_blind_safe = files.colour_blind_safe;
  request.threads = files.threads;
  return request;
}

}  // namespace gonogo::map
