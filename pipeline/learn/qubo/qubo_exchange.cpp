#include "pipeline/learn/qubo/qubo_exchange.h"

#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/file.h"
#include "base/format.h"
#include "base/hash.h"
#include "base/json/config.h"
#include "learning/encoding/code_penalty.h"
#include "learning/qubo/dimod.h"
#include "learning/qubo/foreign_file.h"
#include "pipeline/learn/answer/predictor.h"
#include "pipeline/learn/qubo/code_machine.h"
#include "pipeline/learn/qubo/decode_answer.h"
#include "pipeline/learn/qubo/prepared_machine.h"
#include "pipeline/learn/qubo/qubo_embed.h"
#include "pipeline/learn/training/contract_model.h"

namespace gonogo::learn {
namespace {

namespace fs = std::filesystem;

constexpr double kFree = std::numeric_limits<double>::quiet_NaN();

/// Values of the units of clamped variables, NaN for all others.
std::vector<double> unit_values(const learning::Model& model, const std::map<std::string, double>& clamped) {
  std::vector<double> values(model.weights.visible_count + model.weights.hidden_count, kFree);
  for (const auto& [name, value] : clamped) {
    const std::size_t v = model.layout.variable_index(name);
    if (!std::isfinite(value)) throw InputError("clamp " + name + ": the value must be a finite number");
    const learning::Encoder& encoder = model.layout.encoders()[v];
    encoder.encode_smooth(value, std::span(values).subspan(model.layout.offset(v), encoder.unit_count()));
  }
  return values;
}

/// The clamped values in the model's order of variables, NaN for the others.
std::vector<double> model_point(const learning::Model& model, const std::map<std::string, double>& clamped) {
  std::vector<double> point(model.layout.variable_count(), kFree);
  for (const auto& [name, value] : clamped) point[model.layout.variable_index(name)] = value;
  return point;
}

/// P(outcome) over the code words of the problem; empty if it cannot be summed.
std::map<std::string, double> machine_answer(const learning::Problem& problem, const Sidecar& sidecar) {
  const auto machine = CodeMachine::of(problem, sidecar);
  const auto exact = machine ? machine->exact() : std::nullopt;
  std::map<std::string, double> answer;
  if (!exact) return answer;
  for (std::size_t g = 0; g < machine->groups().size(); ++g)
    if (machine->groups()[g].variable < 0)
      for (std::size_t y = 0; y < sidecar.layout.outcome_count(); ++y)
        answer[sidecar.layout.outcomes()[y]] = exact->probability[g][y];
  return answer;
}

Json to_json(const Sidecar& sidecar) {
  Json json = learning::to_json(static_cast<const learning::ProblemSidecar&>(sidecar));
  if (!sidecar.of_model()) return json;
  Json clamped = Json::object();
  for (const auto& [name, value] : sidecar.clamped) clamped[name] = value;
  Json& model = json["model"];
  model["hash"] = sidecar.model_hash;
  model["clamped"] = std::move(clamped);
  if (sidecar.code_penalty > 0) model["code_penalty"] = sidecar.code_penalty;
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

learning::ProblemFormat chosen_format(const fs::path& path, const FileChoice& choice) {
  if (!choice.format.empty()) return learning::format_named(choice.format).format;
  if (const auto format = learning::format_of_file(path.filename().string())) return *format;
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

/// Writes `problem`; `sidecar` brings model and embedding, the rest of it is set anew.
Exported write(const learning::Problem& problem, Sidecar sidecar, const fs::path& path, const FileChoice& choice) {
  OpenOptions opened;
  open(choice, opened);
  const auto format = chosen_format(path, choice);
  const learning::WrittenProblem written = learning::write_problem(problem, format, opened.options);
  learning::ProblemSidecar base = learning::sidecar_of(written, format);
  base.scale = sidecar.scale;
  base.beta = sidecar.beta;
  base.gauge = sidecar.gauge;
  base.embedding = sidecar.embedding;
  static_cast<learning::ProblemSidecar&>(sidecar) = std::move(base);
  write_file_atomically(path, written.text);
  write_file_atomically(learning::sidecar_path(path), to_json(sidecar).dump(1) + "\n");
  return {std::move(sidecar), written.notes};
}

}  // namespace

Exported export_problem(const fs::path& model_file, const fs::path& problem_file,
                        const std::map<std::string, double>& clamped, learning::Vartype vartype,
                        const FileChoice& choice, std::optional<double> code_penalty) {
  const learning::Model model = read_contract_model(model_file);
  const std::vector<double> fixed = unit_values(model, clamped);
  const std::vector<double> point = model_point(model, clamped);
  const PreparedMachine prepared =
      code_penalty ? PreparedMachine{learning::to_qubo(model.weights, model.layout.unit_labels()), *code_penalty, ""}
                   : prepared_machine(model, fixed);
  Sidecar sidecar;
  sidecar.model_hash = file_hash(model_file);
  sidecar.clamped = clamped;
  sidecar.layout = model.layout;
  sidecar.code_penalty = prepared.penalty;
  const learning::Problem whole =
      learning::with_code_penalty(prepared.machine, model.layout, fixed, sidecar.code_penalty);
  const learning::Problem problem = learning::to_vartype(learning::clamp(whole, fixed), vartype);
  sidecar.machine_answer = machine_answer(problem, sidecar);
  const std::vector<double> model_answer = Predictor(model).outcome_probabilities(point);
  for (std::size_t y = 0; y < model_answer.size(); ++y)
    sidecar.model_answer[model.layout.outcomes()[y]] = model_answer[y];
  Exported exported = write(problem, std::move(sidecar), problem_file, choice);
  if (!prepared.note.empty()) exported.notes.push_back(prepared.note);
  return exported;
}

Sidecar read_sidecar(const fs::path& path) {
  const Config config = Config::read(path);
  Sidecar sidecar;
  static_cast<learning::ProblemSidecar&>(sidecar) = learning::sidecar_from_json(config);
  if (config.has("model")) read_model_part(config, path, sidecar);
  config.finish();
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
  const auto format = by_sidecar ? loaded.sidecar->format : chosen_format(path, choice);
  loaded.problem = learning::read_problem(text, format, opened.options, path.string());
  if (loaded.sidecar) loaded.problem = learning::restore(loaded.problem, *loaded.sidecar, path.string());
  return loaded;
}

Exported convert_problem(const LoadedProblem& loaded, const fs::path& path, const FileChoice& choice) {
  return write(loaded.problem, loaded.sidecar.value_or(Sidecar{}), path, choice);
}

Json sample_problem(const fs::path& problem_file, const fs::path& answer_file, const learning::Sampler& sampler,
                    const learning::SampleRequest& request, const FileChoice& choice) {
  const learning::Problem problem = load_problem(problem_file, choice).problem;
  return write_answer(problem, sampler.sample(problem, request), sampler.name(), request, answer_file);
}

Json write_answer(const learning::Problem& problem, learning::SampleSet answer, const std::string& sampler,
                  const learning::SampleRequest& request, const fs::path& answer_file) {
  const std::size_t reads = answer.row_count();
  answer.info["problem_hash"] = learning::problem_hash(problem);
  answer.info["sampler"] = sampler;
  answer.info["seed"] = Json(request.seed);
  if (sampler != "exact") answer.info["sweeps"] = Json(std::uint64_t(request.sweeps));
  write_file_atomically(answer_file, learning::to_dimod_json(answer) + "\n");
  double mean = 0, lowest = INFINITY;
  for (double e : answer.energies) {
    mean += e / double(reads);
    lowest = std::min(lowest, e);
  }
  Json json;
  json["answer"] = answer_file.string();
  json["reads"] = Json(std::uint64_t(reads));
  json["variables"] = Json(std::uint64_t(problem.variable_count()));
  json["energy_mean"] = mean;
  json["energy_lowest"] = lowest;
  return json;
}

namespace {

/// Decodes the rows of a model's problem, writes them where asked, and sums them up.
Json decoded_json(const ImportRequest& request, const Sidecar& sidecar, const learning::Problem& problem,
                  const learning::SampleSet& answer) {
  const auto machine = CodeMachine::of(problem, sidecar);
  const bool cannot_weigh = request.decoding == Decoding::weigh && !machine;
  const DecodedAnswer decoded = decode_answer(sidecar, answer, cannot_weigh ? Decoding::discard : request.decoding,
                                              machine ? &*machine : nullptr, request.seed);
  Json json = summary_json(sidecar, decoded, machine ? &*machine : nullptr);
  expect_enough(decoded, json, request.limits, request.answer.string());
  const auto inside = request.inside ? std::optional(request.seed) : std::nullopt;
  if (!request.rows.empty()) write_file_atomically(request.rows, rows_csv(sidecar, decoded, inside));
  for (const auto& [key, own] :
       {std::pair("machine_answer", &sidecar.machine_answer), std::pair("model_answer", &sidecar.model_answer)})
    for (const auto& [outcome, probability] : *own) json[key][outcome] = probability;
  return json;
}

}  // namespace

Json import_answer(const ImportRequest& request) {
  const LoadedProblem loaded = load_problem(request.problem, request.problem_file);
  if (!loaded.sidecar)
    throw InputError(learning::sidecar_path(request.problem).string() +
                     ": no such file; an answer is imported with the sidecar that was written beside its problem");
  const Sidecar& sidecar = *loaded.sidecar;
  if (!request.model.empty() && file_hash(request.model) != sidecar.model_hash)
    throw InputError(request.model.string() + ": the problem was exported from another model (hash " +
                     sidecar.model_hash + "); give that one");
  const std::string source = request.answer.string();
  const auto format = learning::answer_format_named(request.answer_format);
  learning::SampleSet answer = learning::check_answer(
      loaded.problem, learning::read_answer(read_file(request.answer), format, loaded.problem, source), source);
  if (answer.row_count() == 0) throw InputError(source + ": the answer has no rows; sample the problem with reads");
  Json json = Json::object(), chains;
  if (sidecar.embedding)
    answer = unembed_answer(answer, sidecar, learning::broken_chains_named(request.chains), request.seed, chains);
  if (answer.row_count() == 0)
    throw InputError(source + ": every row has a broken chain; take another policy than discard, or stronger chains");
  if (sidecar.of_model()) {
    json = decoded_json(request, sidecar, sidecar.embedding ? sidecar.embedding->source : loaded.problem, answer);
  } else {
    double reads = 0;
    for (std::int64_t count : answer.occurrences) reads += double(count);
    json["reads"] = reads;
    if (!request.rows.empty()) write_file_atomically(request.rows, learning::samples_csv(answer));
  }
  json["problem_hash"] = sidecar.problem_hash;
  json["energies"] = "verified";
  if (sidecar.embedding) json["chains"] = std::move(chains);
  return json;
}

}  // namespace gonogo::learn
