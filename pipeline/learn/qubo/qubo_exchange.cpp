#include "pipeline/learn/qubo/qubo_exchange.h"

#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/json/config.h"
#include "learning/encoding/code_penalty.h"
#include "learning/qubo/dimod.h"
#include "pipeline/learn/qubo/decode_answer.h"
#include "pipeline/learn/qubo/qubo_embed.h"

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

Json to_json(const Sidecar& sidecar) {
  Json json = learning::to_json(static_cast<const learning::ProblemSidecar&>(sidecar));
  if (!sidecar.of_model()) return json;
  Json clamped = Json::object();
  for (const auto& [name, value] : sidecar.clamped) clamped[name] = value;
  Json& model = json["model"];
  model["hash"] = sidecar.model_hash;
  model["clamped"] = std::move(clamped);
  if (sidecar.code_penalty > 0) model["code_penalty"] = sidecar.code_penalty;
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
  sidecar.layout = learning::VisibleLayout::from_json(model.object("layout").json(), path.string() + ": model.layout");
  model.finish();
}

learning::ProblemFormat chosen_format(const fs::path& path, const FileChoice& choice) {
  if (!choice.format.empty()) return learning::format_named(choice.format).format;
  if (const auto format = learning::format_of_file(path.filename().string())) return *format;
  throw InputError(path.string() + ": the extension names no format of problems; say which with --format");
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
                        const FileChoice& choice, double code_penalty) {
  const learning::Model model = learning::read_model(model_file);
  const std::vector<double> fixed = unit_values(model, clamped);
  const learning::Problem machine = learning::to_qubo(model.weights, model.layout.unit_labels());
  const learning::Problem whole = learning::with_code_penalty(machine, model.layout, fixed, code_penalty);
  const learning::Problem problem = learning::to_vartype(learning::clamp(whole, fixed), vartype);
  Sidecar sidecar;
  sidecar.code_penalty = code_penalty;
  sidecar.model_hash = file_hash(model_file);
  sidecar.clamped = clamped;
  sidecar.layout = model.layout;
  return write(problem, std::move(sidecar), problem_file, choice);
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
  const bool by_sidecar = loaded.sidecar && choice.format.empty();
  const auto format = by_sidecar ? loaded.sidecar->format : chosen_format(path, choice);
  loaded.problem = learning::read_problem(read_file(path), format, opened.options, path.string());
  if (loaded.sidecar) loaded.problem = learning::restore(loaded.problem, *loaded.sidecar, path.string());
  return loaded;
}

Exported convert_problem(const LoadedProblem& loaded, const fs::path& path, const FileChoice& choice) {
  return write(loaded.problem, loaded.sidecar.value_or(Sidecar{}), path, choice);
}

Json sample_problem(const fs::path& problem_file, const fs::path& answer_file, const learning::Sampler& sampler,
                    const learning::SampleRequest& request, const FileChoice& choice) {
  const learning::Problem problem = load_problem(problem_file, choice).problem;
  const std::size_t reads = request.reads;
  learning::SampleSet answer = sampler.sample(problem, request);
  answer.info["problem_hash"] = learning::problem_hash(problem);
  answer.info["sampler"] = sampler.name();
  answer.info["seed"] = Json(request.seed);
  if (sampler.name() != "exact") answer.info["sweeps"] = Json(std::uint64_t(request.sweeps));
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
  Json json = Json::object(), chains;
  if (sidecar.embedding)
    answer = unembed_answer(answer, sidecar, learning::broken_chains_named(request.chains), request.seed, chains);
  if (sidecar.of_model()) {
    const DecodedAnswer decoded = decode_answer(sidecar, answer, request.rule);
    if (!request.rows.empty()) write_file_atomically(request.rows, rows_csv(sidecar, decoded));
    json = summary_json(sidecar, decoded);
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
