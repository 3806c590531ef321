// Annealing problems: files, samplers, embeddings, and models of learn.h as problems. Link gonogo::qubo.
//
//   E(x) = offset + sum_i linear_i x_i + sum_(a<b) coupling_ab x_a x_b,   P(x) proportional to exp(-E(x))
#pragma once
#include <gonogo/common.h>

#include <optional>
#include <variant>

namespace gonogo::api {

/// x in {0, 1} (QUBO) or {-1, +1} (Ising).
enum class Vartype { binary, spin };

struct Coupling {
  std::uint32_t a = 0, b = 0;  // variables, a < b
  double value = 0;
};

struct Problem {
  Vartype vartype = Vartype::binary;
  std::vector<std::string> labels{};  // [variable], unique; a text of digits is a number in files. Empty: 0, 1, ...
  std::vector<double> linear{};       // [variable]
  std::vector<Coupling> couplings{};  // each pair once, in any order
  double offset = 0;
};

/// row: [variable] of the values of the vartype. Throws InputError, as all functions here, for a problem whose sizes
/// differ, or with repeated labels or pairs.
double energy(const Problem& problem, const std::vector<std::int8_t>& row);
/// The same energies in the other vartype, s = 2 x - 1.
Problem to_vartype(const Problem& problem, Vartype vartype);

/// Names of file formats: "dimod_json", "coo", "qubo", ...
std::vector<std::string> problem_formats();
/// `format`: empty for that of the file's extension. A sidecar beside the file restores labels, order and offset.
Problem read_problem(const std::filesystem::path& file, const std::string& format = "");
/// Writes problem and sidecar. Returns one sentence for each conversion, and for what the format cannot hold.
std::vector<std::string> write_problem(const Problem& problem, const std::filesystem::path& file,
                                       const std::string& format = "");

/// A flag, a whole number, a number, a text, or a program with its arguments.
using Setting = std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>>;

struct SamplerParameter {
  std::string name{}, help{};
  Setting usual{};
};
struct SamplerInfo {
  std::string name{}, about{};
  std::vector<SamplerParameter> parameters{};
  bool any_problem = true;       // false: bipartite problems only
  bool follows_energies = true;  // rows follow exp(-beta E); false: rows of low energy, of no distribution
};
std::vector<SamplerInfo> samplers();

/// A sampler by its name, with settings in place of the usual ones.
struct Sampler {
  std::string name = "tempering";
  std::map<std::string, Setting> settings{};
};
struct Reads {
  std::size_t count = 1000;
  std::uint64_t seed = 1;
  std::size_t sweeps = 1000;  // of Markov chains, before a chain is read
};

struct SampleSet {
  Vartype vartype = Vartype::binary;
  std::vector<std::string> labels{};        // [variable]
  std::vector<std::int8_t> values{};        // [row][variable]
  std::vector<double> energies{};           // [row]
  std::vector<std::int64_t> occurrences{};  // [row]
};

/// Draws rows; a pure function of its arguments. Throws InputError for unknown names and for problems that the sampler
/// does not support.
SampleSet sample(const Problem& problem, const Sampler& sampler, const Reads& reads);

/// A model as a problem for any annealer.
struct ExportRequest {
  std::string model{};              // file
  std::filesystem::path problem{};  // to write, with its sidecar
  Values clamped{};                 // variables with a known value leave the problem
  Vartype vartype = Vartype::binary;
  std::optional<double> code_penalty{};  // energy of bit patterns that are no code words; none: free units if rare
  std::string format{};
};
/// Returns notes as write_problem().
std::vector<std::string> export_problem(const ExportRequest& request);

struct SampleReport {
  std::size_t reads = 0, variables = 0;
  double energy_mean = 0, energy_lowest = 0;
};
/// Samples a problem file and writes the answer in dimod's JSON form.
SampleReport sample_file(const std::filesystem::path& problem, const std::filesystem::path& answer,
                         const Sampler& sampler, const Reads& reads);

/// A D-Wave 2X with its published errors on a graph: "chimera:12", "pegasus:6", "zephyr:4".
struct EmulatedAnnealer {
  std::string graph = "chimera:12";
  double dead_share = 0;     // of the qubits [0, 1)
  double temperature = 0.2;  // in units of the fields h
};
/// As sample_file(); the problem is embedded, and known distortions are corrected.
SampleReport sample_emulated(const std::filesystem::path& problem, const std::filesystem::path& answer,
                             const EmulatedAnnealer& annealer, const Reads& reads);

struct ImportRequest {
  std::filesystem::path problem{}, answer{};
  std::string answer_format = "dimod_json";
  std::filesystem::path model{};             // the problem must come from this file; empty: not checked
  std::filesystem::path rows{};              // CSV of the valid rows; empty: none
  std::string decoding = "weigh";            // of words that are no code words; or "discard", "repair"
  double min_reads = 100, min_share = 0.05;  // of usable reads; an answer below is refused
};
struct ReadOutcome {
  std::string name{};
  double frequency = 0, standard_error = 0;
  double machine = 0;  // the model's own probability; NaN where it is not known exactly
};
struct ImportedAnswer {
  double reads = 0, valid = 0;            // counted with their occurrences
  double independent_reads = 0;           // that the rows are worth
  std::vector<ReadOutcome> outcomes{};    // none for a problem that was not made from a model
  std::string bias{};                     // "not checked", "none found" or "biased"
  std::optional<double> broken_chains{};  // share; of an embedded problem
};
/// Reads an answer back: verifies labels, hash and energies, undoes the embedding, decodes rows. Throws InputError for
/// an answer to another problem or below the limits.
ImportedAnswer import_answer(const ImportRequest& request);

struct EmbedRequest {
  std::filesystem::path problem{}, out{};  // over variables, over qubits; with sidecars
  std::string graph = "chimera:12";
  double dead_share = 0;                   // of the qubits [0, 1)
  std::string method = "auto";             // or "biclique", "clique", "heuristic"
  std::optional<double> chain_strength{};  // none: by torque compensation
  std::optional<std::uint64_t> gauge{};    // seed of random sign flips; none: no flips
  bool auto_scale = false;                 // to the coefficient range of a D-Wave 2X
  double time_limit = 60;                  // of the heuristic [s]
};
struct EmbedResult {
  std::size_t variables = 0, qubits = 0, longest_chain = 0;
  double chain_strength = 0, scale = 1;
  std::vector<std::string> notes{};
};
/// Embeds a problem file on the qubits of an annealer. Throws InputError when it does not fit.
EmbedResult embed(const EmbedRequest& request);

}  // namespace gonogo::api
