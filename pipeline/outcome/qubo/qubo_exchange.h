// A model's machine as an annealing problem: exports it, samples problems, and imports the answers.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/json/json.h"
#include "learning/annealer/annealer_sampler.h"
#include "learning/annealer/emulator.h"
#include "learning/model/model.h"
#include "learning/sampler/sampler.h"
#include "pipeline/outcome/qubo/decode_answer.h"
#include "pipeline/outcome/qubo/problem_file.h"
#include "pipeline/outcome/qubo/qubo_embed.h"

namespace gonogo::outcome {

struct MachineProblem {
  learning::Problem problem;
  Sidecar sidecar;   // without the model's hash
  std::string note;  // what was done to the machine and why; empty when there is nothing to say
};

/// `clamped` variables are fixed to their smooth code and leave the problem. Words of the others that are no code words
/// get `code_penalty`; without a value prepared_machine.h chooses the units. Throws InputError for variables that are
/// not in the model or not finite, and for a negative penalty.
MachineProblem machine_problem(const learning::Model& model, const std::map<std::string, double>& clamped,
                               learning::Vartype vartype, std::optional<double> code_penalty = std::nullopt);

/// The same of a model file as two files: problem and sidecar.
Exported export_problem(const std::filesystem::path& model, const std::filesystem::path& problem,
                        const std::map<std::string, double>& clamped, learning::Vartype vartype,
                        const FileChoice& choice = {}, std::optional<double> code_penalty = std::nullopt);

/// Summary of rows that a sampler drew.
struct SampleReport {
  std::filesystem::path answer;  // file of the rows; empty: none
  std::size_t reads = 0, variables = 0;
  double energy_mean = 0, energy_lowest = 0;
  Json anneal{};           // betas and schedule of the sampler anneal; null for others
  bool is_search = false;  // rows of low energy, which follow no distribution
  std::optional<learning::Correction>
      correction{};  // of the emulator (annealer_sampler.h); empty: nothing was corrected
};
SampleReport sample_report(const learning::SampleSet& rows);
Json to_json(const SampleReport& report);

/// The sampler for a problem file: make_machine_sampler() where its sidecar tells of a model, otherwise make_sampler().
std::unique_ptr<learning::Sampler> sampler_for(const std::filesystem::path& problem, const std::string& name,
                                               const learning::SamplerSettings& settings,
                                               const FileChoice& choice = {});

/// Samples a problem file and writes the answer in dimod's JSON form, with the problem's hash in its info.
SampleReport sample_problem(const std::filesystem::path& problem, const std::filesystem::path& answer,
                            const learning::Sampler& sampler, const learning::SampleRequest& request,
                            const FileChoice& choice = {});

struct DeviceChoice {
  GraphChoice graph;              // default: that of a D-Wave 2X
  double temperature = 0.2;       // in units of the fields h
  std::size_t post_sweeps = 100;  // of block Gibbs after the device, if the problem is bipartite
  bool as_programmed = false;     // nothing is corrected: the file's coefficients are programmed, on its qubits
  /// A machine on the qubits of the graph, such as a program that reaches one; empty: the emulator.
  std::shared_ptr<const learning::Sampler> machine{};
};

/// The device with the errors of a D-Wave 2X on the chosen graph.
learning::Device emulated_device(const DeviceChoice& choice);

/// The corrected sampler of `problem`, which is over variables and is embedded here.
learning::CorrectedAnnealer corrected_annealer(const learning::Problem& problem, const learning::Device& device,
                                               std::size_t post_sweeps);

/// Rows of the device, the emulator or another machine. Corrected ones (annealer_sampler.h) answer a problem over
/// variables, which is embedded here, or one that gonogo qubo embed wrote; its chains then come back unbroken.
/// `correction` is filled for corrected ones. Throws InputError if the problem does not fit.
learning::SampleSet emulated_rows(const LoadedProblem& problem, const DeviceChoice& choice,
                                  const learning::SampleRequest& request,
                                  std::optional<learning::Correction>& correction);

/// Writes them as sample_problem() does.
SampleReport sample_emulated(const std::filesystem::path& problem, const std::filesystem::path& answer,
                             const DeviceChoice& choice, const learning::SampleRequest& request,
                             const FileChoice& file = {});

struct DecodeSettings {
  Decoding decoding = Decoding::weigh;  // falls back to discard if the machine has no sum over code words
  ImportLimits limits;
  std::uint64_t seed = 1;  // of drawn code words, of values inside their bins, and of broken chains
};

struct ImportRequest : DecodeSettings {
  std::filesystem::path problem, answer;
  FileChoice problem_file;
  std::string answer_format = "dimod_json";
  std::filesystem::path model;             // if given: the problem must come from this model file (by hash)
  std::filesystem::path rows;              // if given: CSV file for the valid rows
  bool inside = false;                     // its values are uniform inside their bins; otherwise the middles
  std::string chains = "weighted_random";  // policy for broken chains of an embedded problem
};

struct ImportedAnswer {
  double reads = 0;
  std::optional<AnswerSummary> summary;                        // of a problem made from a model
  DecodedAnswer decoded;                                       // likewise
  std::map<std::string, double> machine_answer, model_answer;  // of the sidecar
  std::string problem_hash;
  std::optional<ChainReport> chains;  // of an embedded problem
};
Json to_json(const ImportedAnswer& answer);

/// Decodes an answer to a model's problem. `answer` must have passed check_answer(). Throws InputError for an answer
/// that is below the limits; messages begin with `source`.
ImportedAnswer decode_answer_to(const learning::Problem& problem, const Sidecar& sidecar,
                                const learning::SampleSet& answer, const DecodeSettings& settings,
                                const std::string& source);

/// Imports an answer: verifies labels, hash and energies, and undoes gauge and embedding of an embedded problem.
/// Decodes the rows of a problem made from a model. Throws InputError for an answer that does not belong to the
/// problem, has no rows, or is below the limits.
ImportedAnswer import_answer(const ImportRequest& request);

}  // namespace gonogo::outcome
