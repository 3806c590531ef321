#include "pipeline/map/trained_model.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "base/files/shipped.h"
#include "base/format.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/map/region/region.h"
#include "pipeline/outcome/settings.h"
#include "vehicle/model/assembly.h"
#include "vehicle/model/statics.h"
#include "vehicle/world/engine_vehicle.h"

namespace gonogo::map {

namespace fs = std::filesystem;
namespace {

/// A vehicle file without its prose: what decides how it drives.
Json numbers_of(const Json& file) {
  Json numbers = Json::object();
  for (const auto& [key, value] : file.members())
    if (key != "about" && key != "sources" && key != "unsourced") numbers[key] = value;
  return numbers;
}

/// The first part in which two vehicle files differ; empty where they agree.
std::string difference(const Json& a, const Json& b) {
  const Json one = numbers_of(a), two = numbers_of(b);
  for (const auto* side : {&one, &two})
    for (const auto& [key, value] : side->members()) {
      const Json *left = one.find(key), *right = two.find(key);
      if (!left || !right || left->dump() != right->dump()) return key;
    }
  return "";
}

/// Vehicle of a shipped model; empty where its dataset does not tell it.
std::string vehicle_of(const fs::path& folder) {
  if (!fs::is_regular_file(folder / "dataset.h5")) return "";
  const fs::path file = folder / "dataset.h5";
  const auto vehicle = trial_vehicle(campaign::read_dataset(file).provenance, file.string());
  return vehicle ? vehicle->name : "";
}

bool has_sampled(const learning::Model& model, const char* number) {
  return model.sampled_upper[campaign::contract().variable_index(number)] > 0;
}

/// Whether the trials of a model drove whole vehicles of a family.
bool is_of_vehicles(const learning::Model& model) { return has_sampled(model, "axles"); }

std::optional<vehicle::Family> trial_family(const campaign::Provenance& provenance, const std::string& where) {
  const std::string* text = campaign::input_text(provenance, "vehicle");
  if (!text) return std::nullopt;
  const Config file = Config::parse(*text, where + ": vehicle");
  return vehicle::is_family(file) ? std::optional(vehicle::read_family(file)) : std::nullopt;
}

bool is_of_ditches(const fs::path& folder) {
  return crosses_ditches(outcome::read_contract_model(folder / "model.h5"));
}

[[noreturn]] void refuse_model(const std::string& model) {
  std::vector<std::string> names;
  for (const fs::path& folder : shipped_models()) {
    names.push_back(folder.filename().string());
    if (const std::string vehicle = vehicle_of(folder); !vehicle.empty() && !is_of_ditches(folder))
      names.push_back(vehicle);
  }
  if (names.empty()) throw InputError(model + ": no such model file, and no model ships beside this program");
  const std::string have = "names of models and of their vehicles: " + join_words(names);
  std::vector<std::string> vehicles;
  for (const fs::path& folder : shipped_folders("vehicles"))
    for (const std::string& name : shipped_names(folder)) vehicles.push_back(name);
  if (std::find(vehicles.begin(), vehicles.end(), model) != vehicles.end())
    throw InputError(model + ": is a vehicle, and no model of its trials ships; gonogo vehicle study " + model +
                     " writes the study of its trials and says what they cost here. " + have);
  const std::string nearest = nearest_word(model, names);
  const bool is_near = 2 * edit_distance(model, nearest) <= std::max(model.size(), nearest.size());
  const std::string hint = is_near ? " (did you mean \"" + nearest + "\"?)" : "";
  throw InputError(model + ": no such model file, and no shipped model has that name" + hint + "; " + have);
}

/// The study's own vehicle and grains may be others where it learns the model's trials beside its own.
bool learns_trials_of(const campaign::Study& study, const TrainedModel& model) {
  const Json* hash = model.predictor->model().provenance.find("data_hash");
  const auto files = outcome::named_trials(study.config.object_if("learning"));
  return hash && std::any_of(files.begin(), files.end(),
                             [&](const fs::path& file) { return file_hash(file) == hash->string(); });
}

std::string model_vehicle(const TrainedModel& model) {
  if (model.vehicle) return model.vehicle->name;
  throw InputError(model.file.string() +
                   ": does not say which vehicle it was trained on, because its trials are not beside it; give them "
                   "with --dataset");
}

/// Trials that only helped are of another fidelity, so they say neither what was driven nor what its wheels measured.
void refuse_helpers(const TrainedModel& model) {
  const Json* others = model.predictor->model().provenance.find("other_trials");
  if (!others) return;
  const std::string hash = file_hash(model.dataset_file);
  for (const Json& other : others->items())
    if (other.at("data_hash").string() == hash)
      throw InputError(model.dataset_file.string() + ": the model " + model.file.string() +
                       " does not answer for these trials (" + other.at("fidelity").string() +
                       "), they only helped; give the finest trials that it learned from (--dataset)");
}

std::string tyres_text(const TrialVehicle& v) {
  return (v.compliant_tyres ? ", compliant tyres" : ", rigid tyres") + line(", wheel_rolling %.3g", v.wheel_rolling);
}

/// Why trials of ditches do not go with the trials of a model; empty where they do.
std::string why_not_crossing(const TrainedModel& model, const TrainedModel& ditches) {
  if (!crosses_ditches(ditches.predictor->model()))
    return "no trial of it crosses a ditch of varied width and depth; give a model of a study of type ditch";
  if (ditches.gravity != model.gravity)
    return "its trials had a gravity of " + gravity_text(ditches.gravity) + ", and those of the model " +
           model.file.string() + " had " + gravity_text(model.gravity) + "; give one of that gravity";
  const std::string vehicle = model_vehicle(model), other = model_vehicle(ditches);
  const std::string part = difference(model.vehicle->file, ditches.vehicle->file);
  if (vehicle != other || !part.empty())
    return "is of the vehicle " + other + (vehicle == other ? " with another \"" + part + "\"" : "") +
           ", and the model " + model.file.string() + " is of the vehicle " + vehicle + "; give one of that vehicle";
  if (ditches.vehicle->fidelity() != model.vehicle->fidelity() ||
      ditches.vehicle->compliant_tyres != model.vehicle->compliant_tyres ||
      ditches.vehicle->wheel_rolling != model.vehicle->wheel_rolling)
    return "has the fidelity \"" + ditches.vehicle->fidelity() + tyres_text(*ditches.vehicle) + "\", and the model " +
           model.file.string() + " has \"" + model.vehicle->fidelity() + tyres_text(*model.vehicle) +
           "\"; give one of the same trials";
  return "";
}

}  // namespace

bool is_of_family(const TrainedModel& model) { return has_sampled(model.predictor->model(), "load_number"); }

void require_family(const TrainedModel& model) {
  const std::string of = model.file.string() + ": is a model of a family";
  if (!is_of_vehicles(model.predictor->model()))
    throw InputError(of + "'s wheels by themselves, which stand on no ground of a map; give one of whole vehicles");
  if (!model.family)
    throw InputError(of + ", and its trials, which say how vehicles are scaled, are not beside it; put their " +
                     "dataset.h5 into its folder");
}

std::string TrialVehicle::fidelity() const {
  return (vehicle::is_quarter(vehicle) ? "one wheel with a quarter of the vehicle" : std::string("whole vehicle")) +
         line(" on grains of %.3g mm, %.1f across a %s", 1e3 * table.grain_diameter,
              vehicle::tread_width(vehicle) / table.grain_diameter, vehicle.track ? "shoe" : "wheel") +
         (gravity == kGravity ? "" : ", gravity " + gravity_text(gravity));
}

std::optional<TrialVehicle> trial_vehicle(const campaign::Provenance& provenance, const std::string& where) {
  const std::string *text = campaign::input_text(provenance, "vehicle"),
                    *soil = campaign::input_text(provenance, "calibration");
  if (!text || !soil) return std::nullopt;
  const Config file = Config::parse(*text, where + ": vehicle");
  if (vehicle::is_family(file)) return std::nullopt;  // of many vehicles
  TrialVehicle v;
  v.file = file.json();
  v.name = file.text("vehicle");
  v.vehicle = vehicle::read_any_vehicle(file);
  v.table = terrain::read_calibration(Config::parse(*soil, where + ": calibration"));
  const campaign::TrialSettings settings = campaign::settings_of(provenance, where);
  v.gravity = settings.gravity;
  v.compliant_tyres = settings.compliant_tyres;
  v.wheel_rolling = settings.wheel_rolling;
  return v;
}

std::vector<fs::path> shipped_models() { return shipped_data_folders("model.h5"); }

fs::path find_model(const std::string& model) {
  if (fs::is_regular_file(model)) return model;
  if (fs::is_regular_file(fs::path(model) / "model.h5")) return fs::path(model) / "model.h5";
  std::vector<fs::path> of_vehicle;
  for (const fs::path& folder : shipped_models()) {
    if (folder.filename() == model) return folder / "model.h5";
    if (vehicle_of(folder) == model && !is_of_ditches(folder)) of_vehicle.push_back(folder);
  }
  if (of_vehicle.size() == 1) return of_vehicle.front() / "model.h5";
  if (of_vehicle.empty()) refuse_model(model);
  std::vector<std::string> names;
  for (const fs::path& folder : of_vehicle) names.push_back(folder.filename().string());
  throw InputError(model + ": several shipped models are of this vehicle; name one of them: " + join_words(names));
}

std::optional<fs::path> shipped_family_model() {
  std::vector<fs::path> found;
  for (const fs::path& folder : shipped_models())
    if (fs::is_regular_file(folder / "dataset.h5") && is_of_vehicles(outcome::read_contract_model(folder / "model.h5")))
      found.push_back(folder / "model.h5");
  return found.size() == 1 ? std::optional(found.front()) : std::nullopt;
}

std::vector<std::string> vehicles_with_models() {
  std::vector<std::string> names;
  for (const fs::path& folder : shipped_models())
    if (const std::string vehicle = vehicle_of(folder); !vehicle.empty() && !is_of_ditches(folder))
      names.push_back(vehicle);
  return names;
}

TrainedModel read_trained_model(const fs::path& file, const fs::path& dataset) {
  TrainedModel model{.file = file,
                     .predictor = std::make_shared<const outcome::Predictor>(outcome::Predictor::read(file))};
  model.gravity = outcome::gravity_of(model.predictor->model());
  model.dataset_file = dataset;
  if (dataset.empty()) {
    const fs::path beside = file.parent_path() / "dataset.h5";
    const Json& provenance = model.predictor->model().provenance;
    const Json* hash = provenance.find("data_hash");
    const fs::path shipped = hash && provenance.find("other_trials") ? outcome::shipped_trials(hash->string()) : "";
    if (!hash || (shipped.empty() && !fs::is_regular_file(beside))) return model;
    model.dataset_file = shipped.empty() ? beside : shipped;
    model.is_up_to_date = file_hash(model.dataset_file) == hash->string();
  }
  refuse_helpers(model);
  model.dataset = campaign::read_dataset(model.dataset_file);
  model.vehicle = trial_vehicle(model.dataset->provenance, model.dataset_file.string());
  model.family = trial_family(model.dataset->provenance, model.dataset_file.string());
  const double of_trials = campaign::settings_of(model.dataset->provenance, model.dataset_file.string()).gravity;
  if (of_trials != model.gravity)
    throw InputError(model.dataset_file.string() + ": its trials had a gravity of " + gravity_text(of_trials) +
                     ", and those of the model " + file.string() + " had " + gravity_text(model.gravity) +
                     "; give the trials that the model learned from (--dataset)");
  return model;
}

std::vector<Range> sampled_box(const TrainedModel& model) {
  const learning::Model& of = model.predictor->model();
  std::vector<Range> box;
  for (std::size_t v = 0; v < of.sampled_lower.size(); ++v) box.push_back({of.sampled_lower[v], of.sampled_upper[v]});
  return box;
}

bool crosses_ditches(const learning::Model& model) {
  const auto sampled = [&](const char* name) {
    return model.sampled_upper[campaign::contract().variable_index(name)] > 0;
  };
  return sampled("ditch_width") && sampled("ditch_depth");
}

std::optional<TrainedModel> find_crossing_model(const TrainedModel& model, const std::string& asked) {
  if (!asked.empty()) {
    TrainedModel found = read_trained_model(find_model(asked));
    if (const std::string why = why_not_crossing(model, found); !why.empty())
      throw InputError(found.file.string() + ": " + why);
    return found;
  }
  std::optional<TrainedModel> found;
  if (!model.vehicle) return found;
  for (const fs::path& folder : shipped_models()) {
    if (!is_of_ditches(folder) || vehicle_of(folder) != model.vehicle->name) continue;
    TrainedModel candidate = read_trained_model(folder / "model.h5");
    if (!why_not_crossing(model, candidate).empty()) continue;
    if (found) return std::nullopt;
    found = std::move(candidate);
  }
  return found;
}

void require_vehicle(const TrainedModel& model, const fs::path& vehicle_file) {
  const std::string known = model_vehicle(model);
  const Config asked = Config::read(vehicle_file);
  const std::string name = asked.text("vehicle"), about = vehicle_file.string() + ": ";
  if (name != known)
    throw InputError(about + "the vehicle " + name + " is asked for, and the model " + model.file.string() +
                     " was trained on trials of the vehicle " + known +
                     "; another vehicle needs a model of its own (gonogo models lists those that ship)");
  if (const std::string part = difference(asked.json(), model.vehicle->file); !part.empty())
    throw InputError(about + "\"" + part + "\" differs from that of the vehicle " + known +
                     " whose trials the model learned; simulate and train with this file, or leave --vehicle out");
}

void require_study(const TrainedModel& model, const fs::path& study_file) {
  const campaign::Study study = campaign::read_study(study_file);
  if (study.gravity != model.gravity)
    throw InputError(study_file.string() + ": gravity: is " + gravity_text(study.gravity) +
                     ", and the trials of the model " + model.file.string() + " had " + gravity_text(model.gravity) +
                     "; give a study of that gravity");
  if (!model.vehicle || learns_trials_of(study, model)) return;
  if (!study.vehicle.empty()) {
    const std::string name = Config::read(study.vehicle).text("vehicle");
    if (name != model.vehicle->name)
      throw InputError(study_file.string() + ": vehicle: is " + name + ", and the model " + model.file.string() +
                       " was trained on trials of " + model.vehicle->name +
                       "; give a study of that vehicle, or one without a vehicle");
  }
  const auto soil = study.config.object_if("soil");
  if (!soil || !soil->has("calibration")) return;
  const double grain = Config::read(soil->path("calibration")).number("grain_diameter_m");
  if (grain != model.vehicle->table.grain_diameter)
    throw InputError(
        study_file.string() + ": soil.calibration: " +
        line("has grains of %g m, and the trials of the model had %g m", grain, model.vehicle->table.grain_diameter) +
        "; give the study of those trials, or one without a soil");
}

namespace {

/// What a trial's numbers refer to.
struct Driven {
  double mass = 0;            // without payload [kg]
  double wheels = 1;          // driven ones, over which the torque is averaged
  double payload_share = 1;   // of the vehicle's payload that it carries
  double radius = 0;          // [m]
  double tyre_stiffness = 0;  // of all tyres together [N/m]
};

Driven driven_of(const TrialVehicle& v) {
  Driven driven{.mass = vehicle::weigh(v.vehicle).total,
                .wheels = 0,
                .payload_share = 1.0 / v.vehicle.payload_shares,
                .radius = vehicle::drive_radius(v.vehicle)};
  for (const vehicle::RunningPart& part : vehicle::running_parts(v.vehicle)) driven.wheels += part.driven;
  for (const vehicle::Station& s : vehicle::stations(v.vehicle))
    if (v.compliant_tyres) driven.tyre_stiffness += s.wheel->compliant.stiffness;
  return driven;
}

double measure(const campaign::TrialRecord& record, const char* name) {
  return record.measures[campaign::contract().measure_index(name)];
}

/// What a trial measured; nothing for trials downhill. Shares are of the load across the ground.
std::optional<ResistanceTrial> resistance_of(const campaign::TrialRecord& record, const Driven& driven,
                                             const SpeedModel& model) {
  const double along = std::tan(to_radians(campaign::variable_of(record, "slope_along"))),
               across = std::tan(to_radians(campaign::variable_of(record, "slope_across")));
  const double mass = driven.mass + driven.payload_share * campaign::variable_of(record, "payload");
  const double load = mass * model.gravity / std::sqrt(1 + along * along + across * across);
  const double push = driven.wheels * measure(record, "mean_torque") / driven.radius / load;
  const double slip = measure(record, "slip"), speed = measure(record, "mean_speed");
  if (!(along >= 0) || !(slip < 1) || !(speed > 0) || !std::isfinite(push)) return std::nullopt;
  return ResistanceTrial{.resistance = push - along,
                         .rut = model.rut(measure(record, "sinkage"), load),
                         .slip = slip,
                         .speed = speed / (1 - slip)};
}

/// Width of all ruts side by side: the wheels of one axle, or two tracks [m].
double rut_width(const vehicle::Vehicle& v) {
  if (v.kind == vehicle::VehicleKind::tracked) return 2 * v.track->shoe_width;
  double front = -std::numeric_limits<double>::infinity(), width = 0;
  for (const vehicle::Station& s : vehicle::stations(v)) front = std::max(front, s.centre.x);
  for (const vehicle::Station& s : vehicle::stations(v))
    if (s.centre.x > front - 1e-3) width += s.wheel->width;
  return width;
}

}  // namespace

MeasureFit fit_of_passed(const campaign::Dataset& dataset, const char* name) {
  std::vector<double> points, value;
  for (const campaign::TrialRecord& record : dataset.records) {
    if (!campaign::passes(record.verdict)) continue;
    points.insert(points.end(), record.point.variables.begin(), record.point.variables.end());
    value.push_back(measure(record, name));
  }
  return fit_measure(name, campaign::contract().measures[campaign::contract().measure_index(name)].unit, points, value);
}

std::optional<SpeedModel> speed_of_trials(const campaign::Dataset& dataset, const TrialVehicle& driven,
                                          const vehicle::Vehicle& whole) {
  const Driven of_trials = driven_of(driven);
  SpeedModel model;
  model.drive = vehicle::TractiveForce(whole);
  model.gravity = driven.gravity;
  model.mass = vehicle::weigh(whole).total;
  model.tyre_stiffness = of_trials.tyre_stiffness;
  model.rut_width = rut_width(whole);
  std::vector<ResistanceTrial> trials;
  for (const campaign::TrialRecord& record : dataset.records)
    if (campaign::passes(record.verdict))
      if (const auto trial = resistance_of(record, of_trials, model)) trials.push_back(*trial);
  if (trials.empty()) return std::nullopt;
  model.resistance = fit_resistance(trials);
  model.slip = fit_of_passed(dataset, "slip");
  model.sinkage = fit_of_passed(dataset, "sinkage");
  return model;
}

}  // namespace gonogo::map
