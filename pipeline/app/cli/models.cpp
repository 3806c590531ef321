#include <cmath>

#include "base/line.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/campaign/study/task_variables.h"
#include "pipeline/learn/answer/model_gravity.h"
#include "pipeline/map/model/trained_model.h"

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

Json entry_of(const map::TrainedModel& model, const std::filesystem::path& folder) {
  const Json& provenance = model.predictor->model().provenance;
  Json entry = Json::object();
  entry["name"] = folder.filename().string();
  entry["vehicle"] = model.vehicle ? Json(model.vehicle->name) : Json();
  entry["fidelity"] = model.vehicle ? Json(model.vehicle->fidelity()) : Json();
  entry[campaign::kGravityKey] = learn::gravity_of(model.predictor->model());
  entry["trials"] = provenance.at("counts").at("trained_on");
  entry["brier"] = provenance.at("cross_validation").at("model").at("brier");
  entry["sampled"] = ranges_json(model.predictor->model());
  entry["card"] = (folder / "README.md").string();
  return entry;
}

void list_models(const Globals& globals) {
  Json result = Json::object();
  result["models"] = Json::array();
  std::string text;
  for (const auto& folder : map::shipped_models()) {
    const map::TrainedModel model = map::read_trained_model(folder / "model.h5");
    const Json entry = entry_of(model, folder);
    result["models"].push_back(entry);
    text += entry.at("name").string() +
            line(": vehicle %s, ", model.vehicle ? model.vehicle->name.c_str() : "not known") +
            (model.vehicle ? model.vehicle->fidelity() : "trials not at hand") +
            line("\n    %lld trials, Brier score of P(go) in cross-validation %.4f, gravity %g m/s2\n",
                 static_cast<long long>(entry.at("trials").integer()), entry.at("brier").number(),
                 learn::gravity_of(model.predictor->model())) +
            ranges_text(model.predictor->model()) + "    card: " + entry.at("card").string() + "\n";
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
