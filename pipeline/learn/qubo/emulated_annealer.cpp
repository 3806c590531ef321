#include "pipeline/learn/qubo/emulated_annealer.h"

#include <map>

#include "base/error.h"

namespace gonogo::learn {
namespace {

/// The chains of an embedded file on this graph.
learning::Embedding recorded_embedding(const learning::EmbeddingRecord& record, const learning::HardwareGraph& graph) {
  learning::Embedding embedding;
  for (const auto& chain : record.chains) embedding.chains.emplace_back(chain.begin(), chain.end());
  embedding.uncoupled = record.uncoupled;
  learning::check_chains(graph, embedding.chains);
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

learning::CorrectedAnnealer corrected(const learning::Device& device, learning::Embedding embedding,
                                      std::size_t post_sweeps) {
  learning::CorrectionSettings settings;
  settings.first_scale = device.temperature;
  settings.susceptibility = device.errors.susceptibility;
  settings.ranges = device.ranges;
  settings.post_sweeps = post_sweeps;
  return learning::CorrectedAnnealer(std::make_shared<learning::Emulator>(device), device.graph, std::move(embedding),
                                     settings);
}

learning::SampleSet corrected_rows(const LoadedProblem& loaded, const learning::Device& device,
                                   const learning::SampleRequest& request, std::size_t post_sweeps) {
  const bool embedded = loaded.sidecar && loaded.sidecar->embedding;
  const learning::Problem logical = embedded ? loaded.sidecar->embedding->source : learning::to_ising(loaded.problem);
  learning::Embedding embedding = embedded ? recorded_embedding(*loaded.sidecar->embedding, device.graph)
                                           : learning::embed(device.graph, logical, "auto");
  const learning::CorrectedAnnealer annealer = corrected(device, std::move(embedding), post_sweeps);
  if (embedded) return on_qubits(annealer.sample(logical, request), loaded.problem, *loaded.sidecar);
  return annealer.sample(loaded.problem, request);
}

}  // namespace

learning::Device emulated_device(const DeviceChoice& choice) {
  return {.graph = chosen_graph(choice.graph),
          .ranges = {},
          .errors = {},
          .temperature = choice.temperature,
          .auto_scale = false,
          .serial = choice.graph.dead_seed};
}

learning::CorrectedAnnealer corrected_annealer(const learning::Problem& problem, const learning::Device& device,
                                               std::size_t post_sweeps) {
  return corrected(device, learning::embed(device.graph, learning::to_ising(problem), "auto"), post_sweeps);
}

Json sample_emulated(const std::filesystem::path& problem, const std::filesystem::path& answer,
                     const DeviceChoice& choice, const learning::SampleRequest& request, const FileChoice& file) {
  const learning::Device device = emulated_device(choice);
  if (choice.as_programmed) return sample_problem(problem, answer, learning::Emulator(device), request, file);
  const LoadedProblem loaded = load_problem(problem, file);
  learning::SampleSet rows = corrected_rows(loaded, device, request, choice.post_sweeps);
  Json left = rows.info;
  Json json = write_answer(loaded.problem, std::move(rows), "emulator", request, answer);
  json["correction"] = std::move(left);
  return json;
}

}  // namespace gonogo::learn
