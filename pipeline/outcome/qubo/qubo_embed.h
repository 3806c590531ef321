// Embeds problem files onto the qubits of an annealer, and unembeds the rows of its answers.
#pragma once
#include <memory>
#include <optional>

#include "learning/annealer/annealer_sampler.h"
#include "learning/annealer/emulator.h"
#include "learning/qubits/unembed.h"
#include "pipeline/outcome/qubo/problem_file.h"

namespace gonogo::outcome {

struct GraphChoice {
  std::string name = "chimera:12";  // topology:size; ignored if `solver` is given
  std::filesystem::path solver;     // SAPI solver definition with properties.topology
  double dead_share = 0;            // share of dead qubits of the named graph [0, 1), drawn from dead_seed
  std::uint64_t dead_seed = 1;
};
/// Throws InputError for an unknown name and for a solver file that cannot be used.
learning::HardwareGraph chosen_graph(const GraphChoice& choice);
/// h_range and j_range of the solver; those of a D-Wave 2X without one.
learning::CoefficientRanges chosen_ranges(const GraphChoice& choice);

struct EmbedRequest {
  std::filesystem::path problem, out;
  FileChoice from, to;
  GraphChoice graph;
  std::string method = "auto";
  std::optional<double> chain_strength;  // none: torque compensation
  std::optional<std::uint64_t> gauge;    // seed of a random gauge; none: no gauge
  bool auto_scale = false;               // scale to the range of a D-Wave 2X; the sidecar keeps the factor
  std::uint64_t seed = 1;                // of the embedding heuristic
  double time_limit_s = 60;              // of the heuristic; its progress is shown on stderr
};

struct EmbedResult {
  Exported exported;
  std::size_t variables = 0, qubits = 0, longest_chain = 0, masked = 0;
  double chain_strength = 0, scale = 1;
};

/// Writes the problem over qubits and its sidecar. The sidecar holds embedding, gauge, scale and the embedded problem,
/// so an answer can be imported from these two files alone. Throws InputError if the problem does not fit on the graph.
EmbedResult embed_problem_file(const EmbedRequest& request);

/// How many chains broke.
struct ChainReport {
  double break_fraction = 0;
  std::vector<std::pair<std::string, double>> chains;   // rate of each variable
  std::vector<std::pair<std::int64_t, double>> qubits;  // rate of each qubit
};
Json to_json(const ChainReport& report);

/// Turns rows over qubits into rows over the embedded variables: undoes the gauge and resolves broken chains by
/// `policy`. `answer` must have passed check_answer(). Fills the report.
learning::SampleSet unembed_answer(const learning::SampleSet& answer, const Sidecar& sidecar,
                                   learning::BrokenChains policy, std::uint64_t seed, ChainReport& report);

}  // namespace gonogo::outcome
