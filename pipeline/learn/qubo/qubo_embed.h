// Problem files laid onto qubits, and rows of such problems brought back.
#pragma once
#include <optional>

#include "learning/hardware/emulator.h"
#include "learning/hardware/unembed.h"
#include "pipeline/learn/qubo/qubo_exchange.h"

namespace gonogo::learn {

struct GraphChoice {
  std::string name = "chimera:12";  // unless a solver definition is given
  std::filesystem::path solver;     // SAPI solver definition with properties.topology
  double dead_share = 0;            // of the named graph's qubits, drawn by dead_seed
  std::uint64_t dead_seed = 1;
};
learning::HardwareGraph chosen_graph(const GraphChoice& choice);

struct EmbedRequest {
  std::filesystem::path problem, out;
  FileChoice from, to;
  GraphChoice graph;
  std::string method = "auto";
  std::optional<double> chain_strength;  // default: torque compensation
  std::optional<std::uint64_t> gauge;    // seed of a random gauge; default: none
  bool auto_scale = false;               // scale to the full range of a D-Wave 2X; the sidecar keeps the factor
  std::uint64_t seed = 1;                // of the heuristic
};

struct EmbedResult {
  Exported exported;
  std::size_t variables = 0, qubits = 0, longest_chain = 0, masked = 0;
  double chain_strength = 0, scale = 1;
};

/// Writes the problem over qubits with a sidecar that holds embedding, gauge, scale and the embedded problem, so that
/// an answer can be imported with these two files alone.
EmbedResult embed_problem_file(const EmbedRequest& request);

/// Rows over qubits to rows over the embedded variables: gauge undone, chains decided by `policy`. `answer` has passed
/// check_answer(). `report` gets the policy and the break rates.
learning::SampleSet unembed_answer(const learning::SampleSet& answer, const Sidecar& sidecar,
                                   learning::BrokenChains policy, std::uint64_t seed, Json& report);

/// All samplers of learning/, and "emulator": a D-Wave 2X with the dead qubits of `graph` (chimera:12).
struct DeviceChoice {
  GraphChoice graph;
  double temperature = 0.2;
};
std::unique_ptr<learning::Sampler> make_any_sampler(const std::string& name, const learning::SamplerSettings& settings,
                                                    const DeviceChoice& device);

}  // namespace gonogo::learn
