#include <cmath>

#include "base/format.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/answer/predictor.h"

namespace gonogo::app {
namespace {

/// "slope along -25 to 35 deg, ..." of what trials sampled.
std::string ranges_text(const learning::Model& model) {
  std::string text;
  for (std::size_t v = 0; v < campaign::contract().variables.size(); ++v) {
    const campaign::Variable& variable = campaign::contract().variables[v];
    const double low = model.sampled_lower[v], high = model.sampled_upper[v];
    if (campaign::is_task_variable(variable) && high == 0) continue;
    text += (v == 0 ? "    " : v % 3 == 0 ? ",\n    " : ", ") + variable.name;
    text += low == high ? line(" %g", low) : line(" %g to %g", low, high);
    if (variable.unit != "-") text += " " + variable.unit;
  }
  return text + "\n";
}

Json ranges_json(const learning::Model& model) {
  Json json = Json::object();
  for (std::size_t v = 0; v < campaign::contract().variables.size(); ++v) {
    const campaign::Variable& variable = campaign::contract().variables[v];
    if (campaign::is_task_variable(variable) && model.sampled_upper[v] == 0) continue;
    json[variable.name] = Json::Array{model.sampled_lower[v], model.sampled_upper[v]};
  }
  return json;
}

struct ShippedModel {
  std::string name, card;  // card: file
  map::TrainedModel trained;
  double gravity = 0;  // of its trials [m/s^2]
  std::int64_t trials = 0;
  double brier = 0;  // of P(go) in cross-validation

  explicit ShippedModel(const std::filesystem::path& folder)
      : name(folder.filename().string()),
        card((folder / "README.md").string()),
        trained(map::read_trained_model(folder / "model.h5")),
        gravity(outcome::gravity_of(model())) {
    trials = model().provenance.at("counts").at("trained_on").integer();
    brier = model().provenance.at("cross_validation").at("model").at("brier").number();
  }
  const learning::Model& model() const { return trained.predictor->model(); }
};

/// What it answers for: a vehicle, or members of a family.
std::string subject(const map::TrainedModel& m) {
  if (m.vehicle) return "vehicle " + m.vehicle->name + ", " + m.vehicle->fidelity();
  if (m.family)
    return "any member of the family " + m.family->name + ": gonogo vehicle numbers VEHICLE tells whether yours is";
  return "vehicle not known, trials not at hand";
}

Json as_json(const ShippedModel& m) {
  Json entry = Json::object();
  entry["name"] = m.name;
  entry["family"] = m.trained.family ? Json(m.trained.family->name) : Json();
  entry["vehicle"] = m.trained.vehicle ? Json(m.trained.vehicle->name) : Json();
  entry["fidelity"] = m.trained.vehicle ? Json(m.trained.vehicle->fidelity()) : Json();
  entry[campaign::kGravityKey] = m.gravity;
  entry["trials"] = m.trials;
  entry["brier"] = m.brier;
  entry["sampled"] = ranges_json(m.model());
  entry["card"] = m.card;
  return entry;
}

std::string as_text(const ShippedModel& m) {
  return m.name + ": " + subject(m.trained) +
         line("\n    %lld trials, Brier score of P(go) in cross-validation %.4f, gravity %g m/s2\n",
              static_cast<long long>(m.trials), m.brier, m.gravity) +
         ranges_text(m.model()) + "    card: " + m.card + "\n";
}

void list_models(const Globals& globals) {
  Json result = Json::object();
  Json& models = result["models"] = Json::array();
  std::string text;
  for (const auto& folder : map::shipped_models()) {
    const ShippedModel model(folder);
    models.push_back(as_json(model));
    text += as_text(model);
  }
  if (text.empty()) text = "no model ships beside this program\n";
  print_result(globals, result, text);
}

}  // namespace

void add_models_command(CLI::App& app, const Globals& globals) {
  CLI::App* command =
      app.add_subcommand("models", "Trained models that ship, by name: vehicle, trials, sampled ranges");
  add_examples(*command, {"gonogo models", "gonogo map --model hmmwv --dem elevation.tif --soil sand --out out/map"},
               "gonogo map takes the name of a model, or that of its vehicle where only one model is of it.");
  command->callback([&globals] { list_models(globals); });
}

}  // namespace gonogo::app
