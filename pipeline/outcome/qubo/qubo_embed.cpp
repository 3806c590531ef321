#include "pipeline/outcome/qubo/qubo_embed.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "base/error.h"
#include "base/format.h"
#include "base/progress.h"
#include "learning/qubo/json.h"

namespace gonogo::outcome {
namespace {

/// The graph of a solver: its topology without the qubits and couplers that it does not list.
learning::HardwareGraph graph_of_solver(const std::filesystem::path& path) {
  const Json json = Json::read(path);
  const learning::SapiSolver solver = learning::solver_from_json(json, path.string());
  const learning::JsonReader topology =
      learning::JsonReader(json, path.string(), "").object("properties").object("topology");
  const auto shape = topology.integers("shape", 1, 64);
  std::string name = topology.text("type") + ":";
  for (std::size_t k = 0; k < shape.size(); ++k) {
    if (topology.text("type") == "pegasus" && k > 0) break;
    name += (k == 0 ? "" : topology.text("type") == "chimera" && k == 1 ? "x" : ":") + std::to_string(shape[k]);
  }
  const learning::HardwareGraph full = learning::graph_named(name);
  std::vector<learning::Qubit> qubits(solver.qubits.begin(), solver.qubits.end());
  std::vector<std::pair<learning::Qubit, learning::Qubit>> couplers;
  for (const auto& [a, b] : solver.couplers) {
    if (!full.coupled(learning::Qubit(a), learning::Qubit(b)))
      topology.fail("type", "qubits " + std::to_string(a) + " and " + std::to_string(b) + " do not couple in " + name);
    couplers.emplace_back(learning::Qubit(a), learning::Qubit(b));
  }
  return learning::HardwareGraph(solver.name, full.size(), full.chip_size(), std::move(qubits), couplers);
}

/// Embeds with the heuristic's progress on stderr.
learning::Embedding shown_embedding(const learning::HardwareGraph& graph, const learning::Problem& ising,
                                    const EmbedRequest& request) {
  learning::HeuristicSettings settings{.seed = request.seed, .time_limit_s = request.time_limit_s};
  std::optional<Progress> progress;
  std::size_t laid = 0;
  settings.watch = [&](std::size_t attempt, std::size_t round) {
    if (!progress) progress.emplace("embed", "chains laid", 0);
    progress->update(++laid, "try " + std::to_string(attempt + 1) + ", round " + std::to_string(round + 1) +
                                 ", at most " + number_text(request.time_limit_s) + " s");
  };
  return learning::embed(graph, ising, request.method, settings);
}

learning::SampleSet as_spins(learning::SampleSet samples) {
  if (samples.vartype == learning::Vartype::spin) return samples;
  for (std::int8_t& value : samples.values) value = value > 0 ? 1 : -1;
  samples.vartype = learning::Vartype::spin;
  return samples;
}

}  // namespace

learning::HardwareGraph chosen_graph(const GraphChoice& choice) {
  if (!choice.solver.empty()) return graph_of_solver(choice.solver);
  const learning::HardwareGraph full = learning::graph_named(choice.name);
  return learning::without(full, learning::random_dead_qubits(full, choice.dead_share, choice.dead_seed));
}

learning::CoefficientRanges chosen_ranges(const GraphChoice& choice) {
  learning::CoefficientRanges ranges;
  if (choice.solver.empty()) return ranges;
  const Json json = Json::read(choice.solver);
  const learning::JsonReader properties = learning::JsonReader(json, choice.solver.string(), "").object("properties");
  for (auto [key, low, high] :
       {std::tuple("h_range", &ranges.h_low, &ranges.h_high), std::tuple("j_range", &ranges.j_low, &ranges.j_high)}) {
    if (!properties.find(key)) continue;
    const std::vector<double> ends = properties.numbers(key);
    if (ends.size() != 2 || !(ends[0] < 0 && ends[1] > 0)) properties.fail(key, "must be two numbers around 0");
    *low = ends[0];
    *high = ends[1];
  }
  return ranges;
}

EmbedResult embed_problem_file(const EmbedRequest& request) {
  const LoadedProblem loaded = load_problem(request.problem, request.from);
  if (loaded.sidecar && loaded.sidecar->embedding)
    throw InputError(request.problem.string() + ": is embedded already; give the problem it was made from");
  const learning::HardwareGraph graph = chosen_graph(request.graph);
  const learning::Problem ising = learning::to_ising(loaded.problem);
  const learning::Embedding embedding = shown_embedding(graph, ising, request);
  EmbedResult result;
  result.chain_strength = request.chain_strength.value_or(learning::torque_compensation(ising));
  learning::EmbeddedProblem embedded = learning::embed_problem(ising, graph, embedding, result.chain_strength);
  const learning::CoefficientRanges ranges = chosen_ranges(request.graph);
  const double fitting = learning::auto_scale_factor(embedded.problem, ranges);
  if (request.auto_scale) result.scale = fitting;
  learning::Problem problem = learning::scaled(embedded.problem, result.scale);
  LoadedProblem out;
  out.sidecar = loaded.sidecar.value_or(Sidecar{});
  out.sidecar->scale *= result.scale;
  if (request.gauge) {
    out.sidecar->gauge = learning::random_gauge(problem.variable_count(), *request.gauge);
    problem = learning::apply_gauge(problem, out.sidecar->gauge);
  }
  result.variables = ising.variable_count();
  result.qubits = problem.variable_count();
  result.masked = embedded.record.uncoupled.size();
  for (const auto& chain : embedded.record.chains) result.longest_chain = std::max(result.longest_chain, chain.size());
  out.sidecar->embedding = std::move(embedded.record);
  out.problem = std::move(problem);
  result.exported = convert_problem(out, request.out, request.to);
  if (!request.auto_scale && fitting < 1)
    result.exported.notes.push_back(line(
        "coefficients lie beyond the machine's ranges, h %g to %g and J %g to %g: --auto-scale would program %.3g of "
        "them, at a temperature as much higher; gonogo qubo sample corrects for scale and temperature itself",
        ranges.h_low, ranges.h_high, ranges.j_low, ranges.j_high, fitting));
  if (result.masked > 0)
    result.exported.notes.push_back(std::to_string(result.masked) + " of " + std::to_string(ising.couplings.size()) +
                                    " couplings have no coupler between their chains and are masked");
  return result;
}

learning::SampleSet unembed_answer(const learning::SampleSet& answer, const Sidecar& sidecar,
                                   learning::BrokenChains policy, std::uint64_t seed, ChainReport& report) {
  learning::SampleSet spins = as_spins(answer);
  if (!sidecar.gauge.empty()) spins = learning::apply_gauge(spins, sidecar.gauge);
  const learning::Unembedded result = learning::unembed(spins, *sidecar.embedding, policy, seed);
  for (double rate : result.chain_break_rate) report.break_fraction += rate / double(result.chain_break_rate.size());
  std::size_t k = 0;
  for (std::size_t v = 0; v < sidecar.embedding->chains.size(); ++v) {
    report.chains.emplace_back(learning::label_text(sidecar.embedding->source.labels[v]), result.chain_break_rate[v]);
    for (std::int64_t qubit : sidecar.embedding->chains[v])
      report.qubits.emplace_back(qubit, result.qubit_break_rate[k++]);
  }
  return result.samples;
}

Json to_json(const ChainReport& report) {
  Json chains = Json::object(), qubits = Json::object();
  for (const auto& [variable, rate] : report.chains) chains[variable] = rate;
  for (const auto& [qubit, rate] : report.qubits) qubits[std::to_string(qubit)] = rate;
  return Json::Object{{"chain_break_fraction", report.break_fraction},
                      {"chain_break_rate", std::move(chains)},
                      {"qubit_break_rate", std::move(qubits)}};
}

}  // namespace gonogo::outcome
