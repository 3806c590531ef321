#include "pipeline/outcome/qubo/qubo_exchange.h"

#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "learning/formats/dimod.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/joint_summary.h"
#include "pipeline/outcome/qubo/code_machine.h"
#include "pipeline/outcome/qubo/prepared_machine.h"

namespace gonogo::outcome {
namespace {

namespace fs = std::filesystem;

/// Throws InputError for variables that are not in the model or not finite.
void check_clamped(const learning::Model& model, const std::map<std::string, double>& clamped) {
  for (const auto& [name, value] : clamped) {
    model.layout.variable_index(name);
    if (!std::isfinite(value)) throw InputError("clamp " + name + ": the value must be a finite number");
  }
}

/// The clamped values in the model's order of variables, NaN for the others.
std::vector<double> model_point(const learning::Model& model, const std::map<std::string, double>& clamped) {
  std::vector<double> point(model.layout.variable_count(), NAN);
  for (const auto& [name, value] : clamped) point[model.layout.variable_index(name)] = value;
  return point;
}

/// What rows of a model's problem say of code words. None if units of different variables are coupled.
std::optional<CodeMachine> code_machine(const learning::Problem& problem, const Sidecar& sidecar) {
  return sidecar.words ? CodeMachine::with_free_units(*sidecar.words, problem, sidecar.layout)
                       : CodeMachine::of(problem, sidecar.layout);
}

}  // namespace

MachineProblem machine_problem(const learning::Model& model, const std::map<std::string, double>& clamped,
                               learning::Vartype vartype, std::optional<double> code_penalty) {
  check_clamped(model, clamped);
  const std::vector<double> point = model_point(model, clamped);
  PreparedMachine prepared;
  if (!code_penalty)
    prepared = prepared_machine(model, {point, {}});
  else
    prepared.problem = penalised_machine(model, {point, {}}, *code_penalty);
  MachineProblem result;
  Sidecar& sidecar = result.sidecar;
  sidecar.clamped = clamped;
  sidecar.layout = model.layout;
  sidecar.code_penalty = code_penalty.value_or(0);
  sidecar.words = prepared.words;
  result.note = code_penalty ? penalty_note(prepared.problem, model.layout, *code_penalty) : prepared.note;
  result.problem = learning::to_vartype(prepared.problem, vartype);
  sidecar.problem_hash = learning::problem_hash(result.problem);
  const auto machine = code_machine(result.problem, sidecar);
  const std::vector<double> own = machine ? machine->exact_outcomes() : std::vector<double>();
  const std::vector<double> answer = Predictor(model).outcome_probabilities(point);
  for (std::size_t y = 0; y < own.size(); ++y) sidecar.machine_answer[model.layout.outcomes()[y]] = own[y];
  for (std::size_t y = 0; y < answer.size(); ++y) sidecar.model_answer[model.layout.outcomes()[y]] = answer[y];
  return result;
}

Exported export_problem(const fs::path& model_file, const fs::path& problem_file,
                        const std::map<std::string, double>& clamped, learning::Vartype vartype,
                        const FileChoice& choice, std::optional<double> code_penalty) {
  const learning::Model model = read_contract_model(model_file);
  MachineProblem machine = machine_problem(model, clamped, vartype, code_penalty);
  machine.sidecar.model_hash = file_hash(model_file);
  Exported exported = write_problem_file(machine.problem, std::move(machine.sidecar), problem_file, choice);
  if (!machine.note.empty()) exported.notes.push_back(machine.note);
  if (std::string warning = joint_warning(model); !warning.empty()) exported.notes.push_back(std::move(warning));
  return exported;
}

SampleReport sample_report(const learning::SampleSet& rows) {
  SampleReport report{
      .answer = {}, .reads = rows.row_count(), .variables = rows.variable_count(), .energy_lowest = INFINITY};
  for (double e : rows.energies) {
    report.energy_mean += e / double(report.reads);
    report.energy_lowest = std::min(report.energy_lowest, e);
  }
  for (const char* key : {"beta_start", "beta_end", "schedule"})
    if (const Json* value = rows.info.is_object() ? rows.info.find(key) : nullptr) report.anneal[key] = *value;
  report.is_search = rows.info.is_object() && rows.info.find(learning::kSearchOf);
  return report;
}

Json to_json(const SampleReport& report) {
  Json json = Json::object();
  if (!report.answer.empty()) json["answer"] = report.answer.string();
  json["reads"] = report.reads;
  json["variables"] = report.variables;
  json["energy_mean"] = report.energy_mean;
  json["energy_lowest"] = report.energy_lowest;
  if (!report.anneal.is_null()) json["anneal"] = report.anneal;
  if (report.is_search) json["follows"] = "no distribution";
  if (report.correction) json["correction"] = to_json(*report.correction);
  return json;
}

namespace {

SampleReport write_answer(const learning::Problem& problem, learning::SampleSet answer, const std::string& sampler,
                          const learning::SampleRequest& request, const fs::path& file) {
  answer.info["problem_hash"] = learning::problem_hash(problem);
  answer.info["sampler"] = sampler;
  answer.info["seed"] = request.seed;
  if (sampler != "exact") answer.info["sweeps"] = request.sweeps;
  write_file_atomically(file, learning::to_dimod_json(answer) + "\n");
  SampleReport report = sample_report(answer);
  report.answer = file;
  return report;
}

}  // namespace

std::unique_ptr<learning::Sampler> sampler_for(const fs::path& problem, const std::string& name,
                                               const learning::SamplerSettings& settings, const FileChoice& choice) {
  const LoadedProblem loaded = load_problem(problem, choice);
  const bool of_model = loaded.sidecar && loaded.sidecar->of_model();
  return of_model ? learning::make_machine_sampler(name, settings) : learning::make_sampler(name, settings);
}

SampleReport sample_problem(const fs::path& problem_file, const fs::path& answer_file, const learning::Sampler& sampler,
                            const learning::SampleRequest& request, const FileChoice& choice) {
  const learning::Problem problem = load_problem(problem_file, choice).problem;
  return write_answer(problem, sampler.sample(problem, request), sampler.name(), request, answer_file);
}

namespace {

/// The chains of an embedded file on this graph. Throws InputError where they do not lie on it.
learning::Embedding recorded_embedding(const learning::EmbeddingRecord& record, const learning::HardwareGraph& graph,
                                       const GraphChoice& choice) {
  learning::Embedding embedding;
  for (const auto& chain : record.chains) embedding.chains.emplace_back(chain.begin(), chain.end());
  embedding.uncoupled = record.uncoupled;
  try {
    learning::check_chains(graph, embedding.chains);
  } catch (const InputError& error) {
    throw InputError("the problem was embedded on another graph than " +
                     (choice.solver.empty() ? choice.name : choice.solver.string()) + " with its dead qubits (" +
                     error.what() + "); name the graph of gonogo qubo embed, or embed the problem anew");
  }
  return embedding;
}

/// Rows over variables as rows over the qubits of an embedded problem, in its gauge: every chain is whole.
learning::SampleSet on_qubits(const learning::SampleSet& rows, const learning::Problem& problem,
                              const Sidecar& sidecar) {
  std::map<learning::Label, std::size_t> variable;
  for (std::size_t v = 0; v < sidecar.embedding->chains.size(); ++v)
    for (std::int64_t qubit : sidecar.embedding->chains[v]) variable[learning::Label(qubit)] = v;
  learning::SampleSet result;
  result.vartype = problem.vartype;
  result.labels = problem.labels;
  result.occurrences = rows.occurrences;
  result.info = rows.info;
  for (std::size_t r = 0; r < rows.row_count(); ++r) {
    for (std::size_t q = 0; q < problem.labels.size(); ++q) {
      const int sign = sidecar.gauge.empty() ? 1 : sidecar.gauge[q];
      const int spin = (rows.row(r)[variable.at(problem.labels[q])] > 0 ? 1 : -1) * sign;
      result.values.push_back(std::int8_t(problem.vartype == learning::Vartype::spin ? spin : spin > 0));
    }
    result.energies.push_back(learning::energy(problem, std::span(result.values).last(problem.labels.size())));
  }
  return result;
}

/// Of `machine`; of an emulator of the device without one.
learning::CorrectedAnnealer corrected(const learning::Device& device, learning::Embedding embedding,
                                      std::size_t post_sweeps, std::shared_ptr<const learning::Sampler> machine = {}) {
  learning::CorrectionSettings settings;
  settings.first_scale = device.temperature;
  settings.susceptibility = machine ? 0 : device.errors.susceptibility;
  settings.ranges = device.ranges;
  settings.post_sweeps = post_sweeps;
  if (!machine) machine = std::make_shared<learning::Emulator>(device);
  return learning::CorrectedAnnealer(std::move(machine), device.graph, std::move(embedding), settings);
}

}  // namespace

learning::Device emulated_device(const DeviceChoice& choice) {
  return {.graph = chosen_graph(choice.graph),
          .ranges = chosen_ranges(choice.graph),
          .errors = {},
          .temperature = choice.temperature,
          .auto_scale = false,
          .serial = choice.graph.dead_seed};
}

learning::CorrectedAnnealer corrected_annealer(const learning::Problem& problem, const learning::Device& device,
                                               std::size_t post_sweeps) {
  return corrected(device, learning::embed(device.graph, learning::to_ising(problem), "auto"), post_sweeps);
}

learning::SampleSet emulated_rows(const LoadedProblem& loaded, const DeviceChoice& choice,
                                  const learning::SampleRequest& request,
                                  std::optional<learning::Correction>& correction) {
  const learning::Device device = emulated_device(choice);
  if (choice.as_programmed)
    return choice.machine ? choice.machine->sample(loaded.problem, request)
                          : learning::Emulator(device).sample(loaded.problem, request);
  const bool embedded = loaded.sidecar && loaded.sidecar->embedding;
  const learning::Problem logical = embedded ? loaded.sidecar->embedding->source : learning::to_ising(loaded.problem);
  learning::Embedding embedding = embedded ? recorded_embedding(*loaded.sidecar->embedding, device.graph, choice.graph)
                                           : learning::embed(device.graph, logical, "auto");
  const learning::CorrectedAnnealer annealer =
      corrected(device, std::move(embedding), choice.post_sweeps, choice.machine);
  learning::SampleSet rows = annealer.sample(embedded ? logical : loaded.problem, request, correction.emplace());
  if (embedded) rows = on_qubits(rows, loaded.problem, *loaded.sidecar);
  rows.info = learning::to_json(*correction);
  return rows;
}

SampleReport sample_emulated(const fs::path& problem_file, const fs::path& answer_file, const DeviceChoice& choice,
                             const learning::SampleRequest& request, const FileChoice& file) {
  const LoadedProblem loaded = load_problem(problem_file, file);
  std::optional<learning::Correction> correction;
  learning::SampleSet rows = emulated_rows(loaded, choice, request, correction);
  SampleReport report =
      write_answer(loaded.problem, std::move(rows), choice.machine ? choice.machine->name() : learning::kEmulator,
                   request, answer_file);
  report.correction = correction;
  return report;
}

namespace {

/// Throws InputError for rows of a search for low energies.
void expect_distribution(const learning::SampleSet& answer, const std::string& source) {
  const Json* search = answer.info.is_object() ? answer.info.find(learning::kSearchOf) : nullptr;
  if (search && search->is_string())
    throw InputError(source + ": its rows are of a search for low energies (" + search->string() +
                     ") and follow no distribution; sample the problem with tempering or exact");
}

}  // namespace

ImportedAnswer decode_answer_to(const learning::Problem& problem, const Sidecar& sidecar,
                                const learning::SampleSet& answer, const DecodeSettings& settings,
                                const std::string& source) {
  if (sidecar.words && settings.decoding != Decoding::weigh)
    throw InputError(source + ": its problem has free units in place of code words, so " +
                     decoding_name(settings.decoding) +
                     " finds none; decode with weigh, or export the problem with a penalty");
  expect_distribution(answer, source);
  const auto machine = code_machine(problem, sidecar);
  const bool cannot_weigh = settings.decoding == Decoding::weigh && !machine;
  ImportedAnswer result;
  RowTemperature temperature = row_temperature(problem, answer);
  expect_temperature(temperature, settings.limits, source);
  const Decoding decoding = cannot_weigh ? Decoding::discard : settings.decoding;
  if (decoding == Decoding::weigh && temperature.verdict == "wrong" && std::isfinite(settings.limits.temperature))
    temperature.verdict = "corrected";
  result.decoded = decode_answer(sidecar, answer, decoding, machine ? &*machine : nullptr, settings.seed,
                                 temperature.verdict == "corrected" ? std::optional(temperature.beta) : std::nullopt);
  result.summary = summarise(sidecar, result.decoded, machine ? &*machine : nullptr);
  result.summary->temperature = temperature;
  expect_enough(*result.summary, settings.limits, source);
  result.reads = result.decoded.reads;
  result.machine_answer = sidecar.machine_answer;
  result.model_answer = sidecar.model_answer;
  result.problem_hash = sidecar.problem_hash;
  return result;
}

Json to_json(const ImportedAnswer& answer) {
  Json json = answer.summary ? to_json(*answer.summary) : Json(Json::Object{{"reads", answer.reads}});
  for (const auto& [key, own] :
       {std::pair("machine_answer", &answer.machine_answer), std::pair("model_answer", &answer.model_answer)})
    for (const auto& [outcome, probability] : *own) json[key][outcome] = probability;
  json["problem_hash"] = answer.problem_hash;
  json["energies"] = "verified";
  if (answer.chains) json["chains"] = to_json(*answer.chains);
  return json;
}

ImportedAnswer import_answer(const ImportRequest& request) {
  const LoadedProblem loaded = load_problem(request.problem, request.problem_file);
  if (!loaded.sidecar)
    throw InputError(learning::sidecar_path(request.problem).string() +
                     ": no such file; an answer is imported with the sidecar that was written beside its problem");
  const Sidecar& sidecar = *loaded.sidecar;
  if (!request.model.empty() && file_hash(request.model) != sidecar.model_hash)
    throw InputError(request.model.string() + ": the problem was exported from another model (hash " +
                     sidecar.model_hash + "); give that one");
  const std::string source = request.answer.string();
  const learning::Format& format = learning::answer_format_named(request.answer_format);
  learning::SampleSet answer = learning::check_answer(
      loaded.problem, learning::read_answer(read_file(request.answer), format, loaded.problem, source), source);
  if (answer.row_count() == 0) throw InputError(source + ": the answer has no rows; sample the problem with reads");
  std::optional<ChainReport> chains;
  if (sidecar.embedding)
    answer =
        unembed_answer(answer, sidecar, learning::broken_chains_named(request.chains), request.seed, chains.emplace());
  if (answer.row_count() == 0)
    throw InputError(source + ": every row has a broken chain; take another policy than discard, or stronger chains");
  ImportedAnswer result;
  if (sidecar.of_model()) {
    result = decode_answer_to(sidecar.embedding ? sidecar.embedding->source : loaded.problem, sidecar, answer, request,
                              source);
    const auto inside = request.inside ? std::optional(request.seed) : std::nullopt;
    if (!request.rows.empty()) write_file_atomically(request.rows, rows_csv(sidecar, result.decoded, inside));
  } else {
    for (std::int64_t count : answer.occurrences) result.reads += double(count);
    if (!request.rows.empty()) write_file_atomically(request.rows, learning::samples_csv(answer));
    result.problem_hash = sidecar.problem_hash;
  }
  result.chains = std::move(chains);
  return result;
}

}  // namespace gonogo::outcome
