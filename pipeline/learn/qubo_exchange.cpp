#include "pipeline/learn/qubo_exchange.h"

#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/json/config.h"
#include "learning/qubo/dimod.h"
#include "learning/sampler/sampler.h"
#include "pipeline/learn/decode_answer.h"

namespace gonogo::pipeline {
namespace {

constexpr const char* kFormat = "gonogo/sidecar/1";
constexpr double kFree = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> label_texts(const learning::Problem& problem) {
  std::vector<std::string> texts;
  for (const learning::Label& label : problem.labels) texts.push_back(learning::label_text(label));
  return texts;
}

/// Values of the units of clamped variables, not-a-number for all others.
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
  Json json, clamped = Json::object();
  for (const auto& [name, value] : sidecar.clamped) clamped[name] = value;
  json["format"] = kFormat;
  json["problem_hash"] = sidecar.problem_hash;
  json["model_hash"] = sidecar.model_hash;
  json["vartype"] = learning::vartype_name(sidecar.vartype);
  json["offset"] = sidecar.offset;
  json["scale"] = sidecar.scale;
  json["beta"] = sidecar.beta;
  json["labels"] = Json(sidecar.labels);
  json["clamped"] = std::move(clamped);
  json["layout"] = sidecar.layout.to_json();
  return json;
}

learning::Problem read_problem(const std::filesystem::path& path) {
  return learning::problem_from_dimod_json(read_file(path), path.string());
}

}  // namespace

std::filesystem::path sidecar_path(const std::filesystem::path& problem) {
  std::filesystem::path path = problem;
  return path.replace_extension(".sidecar.json");
}

Sidecar export_problem(const std::filesystem::path& model_file, const std::filesystem::path& problem_file,
                       const std::map<std::string, double>& clamped, learning::Vartype vartype) {
  const learning::Model model = learning::read_model(model_file);
  const learning::Problem whole = learning::to_qubo(model.weights, model.layout.unit_labels());
  const learning::Problem problem = learning::to_vartype(learning::clamp(whole, unit_values(model, clamped)), vartype);
  Sidecar sidecar;
  sidecar.problem_hash = learning::problem_hash(problem);
  sidecar.model_hash = file_hash(model_file);
  sidecar.vartype = vartype;
  sidecar.offset = problem.offset;
  sidecar.labels = label_texts(problem);
  sidecar.clamped = clamped;
  sidecar.layout = model.layout;
  write_file_atomically(problem_file, learning::to_dimod_json(problem) + "\n");
  write_file_atomically(sidecar_path(problem_file), to_json(sidecar).dump(1) + "\n");
  return sidecar;
}

Sidecar read_sidecar(const std::filesystem::path& path, const learning::Problem& problem) {
  const Config config = Config::read(path);
  if (config.text("format") != kFormat) config.fail("format", std::string("expected \"") + kFormat + "\"");
  Sidecar sidecar;
  sidecar.problem_hash = config.text("problem_hash");
  sidecar.model_hash = config.text("model_hash");
  sidecar.vartype =
      config.choice("vartype", {"BINARY", "SPIN"}) == "SPIN" ? learning::Vartype::spin : learning::Vartype::binary;
  sidecar.offset = config.number("offset");
  sidecar.scale = config.number("scale", {.minimum = 1e-300});
  sidecar.beta = config.number("beta", {.minimum = 1e-300});
  sidecar.labels = config.texts("labels");
  const Config clamped = config.object("clamped");
  for (const auto& [name, value] : clamped.json().members()) sidecar.clamped[name] = clamped.number(name);
  const std::string source = path.string() + ": layout";
  sidecar.layout = learning::VisibleLayout::from_json(config.object("layout").json(), source);
  config.finish();
  if (sidecar.vartype != problem.vartype || sidecar.offset != problem.offset ||
      sidecar.labels != label_texts(problem) || sidecar.problem_hash != learning::problem_hash(problem))
    config.fail("problem_hash",
                "this sidecar belongs to another problem; keep problem and sidecar together, unchanged");
  return sidecar;
}

Json sample_problem(const std::filesystem::path& problem_file, const std::filesystem::path& answer_file,
                    const std::string& sampler_name, std::size_t reads, std::size_t sweeps, std::uint64_t seed) {
  const learning::Problem problem = read_problem(problem_file);
  const auto sampler = learning::make_sampler(sampler_name);
  learning::SampleRequest request;
  request.reads = reads;
  request.sweeps = sweeps;
  request.seed = seed;
  learning::SampleSet answer = sampler->sample(problem, request);
  answer.info["problem_hash"] = learning::problem_hash(problem);
  answer.info["sampler"] = sampler->name();
  answer.info["seed"] = Json(seed);
  if (sampler->name() != "exact") answer.info["sweeps"] = Json(std::uint64_t(sweeps));
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

Json import_answer(const std::filesystem::path& problem_file, const std::filesystem::path& answer_file,
                   const std::filesystem::path& model_file, const std::filesystem::path& rows_file,
                   learning::DecodeRule rule) {
  const learning::Problem problem = read_problem(problem_file);
  const Sidecar sidecar = read_sidecar(sidecar_path(problem_file), problem);
  if (!model_file.empty() && file_hash(model_file) != sidecar.model_hash)
    throw InputError(model_file.string() + ": the problem was exported from another model (hash " + sidecar.model_hash +
                     "); give that one");
  const learning::SampleSet answer = learning::check_answer(
      problem, learning::samples_from_dimod_json(read_file(answer_file), answer_file.string()), answer_file.string());
  const DecodedAnswer decoded = decode_answer(sidecar, answer, rule);
  if (!rows_file.empty()) write_file_atomically(rows_file, rows_csv(sidecar, decoded));
  Json json = summary_json(sidecar, decoded);
  json["problem_hash"] = sidecar.problem_hash;
  json["energies"] = "verified";
  return json;
}

}  // namespace gonogo::pipeline
