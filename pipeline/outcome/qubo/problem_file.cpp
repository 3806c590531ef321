#include "pipeline/outcome/qubo/problem_file.h"

#include <utility>

#include "base/error.h"
#include "base/files/file.h"
#include "base/json/config.h"
#include "base/json/seal.h"
#include "learning/formats/dimod.h"

namespace gonogo::outcome {
namespace {

namespace fs = std::filesystem;

Json to_json(const Sidecar& sidecar) {
  Json json = learning::to_json(static_cast<const learning::ProblemSidecar&>(sidecar));
  if (!sidecar.of_model()) return json;
  Json clamped = Json::object();
  for (const auto& [name, value] : sidecar.clamped) clamped[name] = value;
  Json& model = json["model"];
  model["hash"] = sidecar.model_hash;
  model["clamped"] = std::move(clamped);
  if (sidecar.code_penalty > 0) model["code_penalty"] = sidecar.code_penalty;
  if (sidecar.words) model["words"] = learning::dimod_json(*sidecar.words);
  for (const auto& [key, answer] :
       {std::pair("machine_answer", &sidecar.machine_answer), std::pair("model_answer", &sidecar.model_answer)}) {
    if (answer->empty()) continue;
    Json outcomes = Json::object();
    for (const auto& [outcome, probability] : *answer) outcomes[outcome] = probability;
    model[key] = std::move(outcomes);
  }
  model["layout"] = sidecar.layout.to_json();
  return json;
}

void read_model_part(const Config& config, const fs::path& path, Sidecar& sidecar) {
  const Config model = config.object("model");
  sidecar.model_hash = model.text("hash");
  if (sidecar.model_hash.empty()) model.fail("hash", "is empty");
  const Config clamped = model.object("clamped");
  for (const auto& [name, value] : clamped.json().members()) sidecar.clamped[name] = clamped.number(name);
  if (model.has("words"))
    sidecar.words = learning::dimod_problem(model.object("words").json(), path.string() + ": model.words");
  if (model.has("code_penalty")) sidecar.code_penalty = model.number("code_penalty", {.minimum = 0});
  for (const auto& [key, answer] :
       {std::pair("machine_answer", &sidecar.machine_answer), std::pair("model_answer", &sidecar.model_answer)})
    if (model.has(key)) {
      const Config outcomes = model.object(key);
      for (const auto& [outcome, value] : outcomes.json().members())
        (*answer)[outcome] = outcomes.number(outcome, {.minimum = 0, .maximum = 1});
    }
  sidecar.layout = learning::VisibleLayout::from_json(model.object("layout").json(), path.string() + ": model.layout");
  model.finish();
}

const learning::Format& chosen_format(const fs::path& path, const FileChoice& choice) {
  if (!choice.format.empty()) return learning::format_named(choice.format);
  if (const auto* format = learning::format_of_file(path.filename().string())) return *format;
  throw InputError(path.string() + ": the extension names no format of problems; say which with " + choice.option);
}

/// Options with what they point to.
struct OpenOptions {
  std::optional<learning::SapiSolver> solver;
  learning::FormatOptions options;
};

void open(const FileChoice& choice, OpenOptions& result) {
  if (!choice.solver.empty()) {
    result.solver = learning::solver_from_json(Json::read(choice.solver), choice.solver.string());
    result.options.solver = &*result.solver;
  }
  if (!choice.vartype.empty())
    result.options.vartype = choice.vartype == "SPIN" ? learning::Vartype::spin : learning::Vartype::binary;
}

}  // namespace

Exported write_problem_file(const learning::Problem& problem, Sidecar sidecar, const fs::path& path,
                            const FileChoice& choice) {
  OpenOptions opened;
  open(choice, opened);
  const learning::Format& format = chosen_format(path, choice);
  const learning::WrittenProblem written = learning::write_problem(problem, format, opened.options);
  learning::ProblemSidecar base = learning::sidecar_of(written, format);
  base.scale = sidecar.scale;
  base.beta = sidecar.beta;
  base.gauge = sidecar.gauge;
  base.embedding = sidecar.embedding;
  static_cast<learning::ProblemSidecar&>(sidecar) = std::move(base);
  write_file_atomically(path, written.text);
  write_file_atomically(learning::sidecar_path(path), sealed(to_json(sidecar)).dump(1) + "\n");
  return {std::move(sidecar), written.notes};
}

Sidecar read_sidecar(const fs::path& path) {
  const Config config = Config::read(path);
  Sidecar sidecar;
  static_cast<learning::ProblemSidecar&>(sidecar) = learning::sidecar_from_json(config);
  if (config.has("model")) read_model_part(config, path, sidecar);
  config.has("hash");
  config.finish();
  require_seal(config.json(), path.string(), "export the problem again");
  return sidecar;
}

LoadedProblem load_problem(const fs::path& path, const FileChoice& choice) {
  OpenOptions opened;
  open(choice, opened);
  LoadedProblem loaded;
  const fs::path beside = learning::sidecar_path(path);
  if (fs::exists(beside)) loaded.sidecar = read_sidecar(beside);
  const std::string text = read_file(path);
  learning::refuse_foreign_file(text, path.string());
  const bool by_sidecar = loaded.sidecar && choice.format.empty();
  const learning::Format& format = by_sidecar ? *loaded.sidecar->format : chosen_format(path, choice);
  loaded.problem = learning::read_problem(text, format, opened.options, path.string());
  if (loaded.sidecar) loaded.problem = learning::restore(loaded.problem, *loaded.sidecar, path.string());
  return loaded;
}

Exported convert_problem(const LoadedProblem& loaded, const fs::path& path, const FileChoice& choice) {
  return write_problem_file(loaded.problem, loaded.sidecar.value_or(Sidecar{}), path, choice);
}

}  // namespace gonogo::outcome
