#include "learning/hardware/embedding.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "base/error.h"
#include "base/format.h"
#include "learning/sampler/bipartite.h"

namespace gonogo::learning {
namespace {

constexpr std::uint32_t kNone = UINT32_MAX;

std::vector<std::uint32_t> owners(const HardwareGraph& graph, const Chains& chains) {
  std::vector<std::uint32_t> owner(graph.chip_size(), kNone);
  for (std::size_t c = 0; c < chains.size(); ++c)
    for (Qubit q : chains[c]) owner[q] = std::uint32_t(c);
  return owner;
}

/// Couplers between each pair of chains that has one, and inside chains.
struct Couplers {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::pair<Qubit, Qubit>>> between;
  std::vector<std::pair<Qubit, Qubit>> inside;
};

Couplers sort_couplers(const HardwareGraph& graph, const Chains& chains) {
  const std::vector<std::uint32_t> owner = owners(graph, chains);
  Couplers result;
  for (const auto& coupler : graph.couplers()) {
    const std::uint32_t a = owner[coupler.first], b = owner[coupler.second];
    if (a == kNone || b == kNone) continue;
    if (a == b)
      result.inside.push_back(coupler);
    else
      result.between[{std::min(a, b), std::max(a, b)}].push_back(coupler);
  }
  return result;
}

VariablePairs coupled_variables(const Problem& problem) {
  VariablePairs pairs;
  for (const Coupling& c : problem.couplings) pairs.emplace_back(c.a, c.b);
  return pairs;
}

/// The biclique of the two sides of a bipartite problem, in the problem's order of variables.
Embedding embed_sides(const HardwareGraph& graph, const Problem& problem) {
  Problem binary = problem;
  binary.vartype = Vartype::binary;  // only the couplings' places matter
  const auto sides = split_in_two(binary);
  if (!sides) throw InputError("embedding biclique: the variables do not fall into two sides; use clique or heuristic");
  const Embedding found = embed_two_sides(graph, sides->left.size(), sides->right.size());
  Embedding result;
  result.chains.resize(problem.variable_count());
  for (std::size_t k = 0; k < sides->left.size(); ++k) result.chains[sides->left[k]] = found.chains[k];
  for (std::size_t k = 0; k < sides->right.size(); ++k)
    result.chains[sides->right[k]] = found.chains[sides->left.size() + k];
  return result;
}

Embedding automatic(const HardwareGraph& graph, const Problem& problem, const HeuristicSettings& settings) {
  std::string reasons;
  std::optional<Embedding> best;
  for (const char* method : {"biclique", "clique", "heuristic"}) {
    try {
      Embedding embedding = embed(graph, problem, method, settings);
      if (!best || embedding.uncoupled.size() < best->uncoupled.size()) best = std::move(embedding);
      if (best->uncoupled.empty() || std::string(method) == "biclique") break;
    } catch (const InputError& error) {
      reasons += std::string(reasons.empty() ? "" : "; ") + error.what();
    }
  }
  if (!best) throw InputError("the problem cannot be embedded: " + reasons);
  return *best;
}

}  // namespace

void check_chains(const HardwareGraph& graph, const Chains& chains) {
  std::vector<std::uint32_t> owner(graph.chip_size(), kNone);
  for (std::size_t c = 0; c < chains.size(); ++c) {
    const std::string where = "chain of variable " + std::to_string(c) + ": ";
    if (chains[c].empty()) throw InputError(where + "has no qubits");
    for (Qubit q : chains[c]) {
      if (!graph.works(q)) throw InputError(where + "qubit " + std::to_string(q) + " is not a working one");
      if (owner[q] != kNone) throw InputError(where + "qubit " + std::to_string(q) + " is used twice");
      owner[q] = std::uint32_t(c);
    }
    std::vector<Qubit> reached = {chains[c][0]};
    owner[reached[0]] = kNone;  // marks what was reached
    for (std::size_t k = 0; k < reached.size(); ++k)
      for (Qubit next : graph.neighbours(reached[k]))
        if (owner[next] == c) {
          owner[next] = kNone;
          reached.push_back(next);
        }
    if (reached.size() != chains[c].size()) throw InputError(where + "its qubits are not connected");
    for (Qubit q : chains[c]) owner[q] = std::uint32_t(c);
  }
}

VariablePairs uncoupled_pairs(const HardwareGraph& graph, const Chains& chains, const VariablePairs& pairs) {
  const Couplers couplers = sort_couplers(graph, chains);
  VariablePairs missing;
  for (const auto& pair : pairs)
    if (!couplers.between.count(pair)) missing.push_back(pair);
  return missing;
}

Embedding embed(const HardwareGraph& graph, const Problem& problem, const std::string& method,
                const HeuristicSettings& settings) {
  const VariablePairs pairs = coupled_variables(problem);
  Embedding embedding;
  if (method == "auto")
    embedding = automatic(graph, problem, settings);
  else if (method == "biclique")
    embedding = embed_sides(graph, problem);
  else if (method == "clique")
    embedding = embed_clique(graph, problem.variable_count());
  else if (method == "heuristic")
    embedding = embed_heuristic(graph, problem.variable_count(), pairs, settings);
  else
    throw InputError("embedding \"" + method + "\" does not exist; use auto, biclique, clique or heuristic");
  check_chains(graph, embedding.chains);
  embedding.uncoupled = uncoupled_pairs(graph, embedding.chains, pairs);
  return embedding;
}

double torque_compensation(const Problem& ising, double prefactor) {
  GONOGO_ASSERT(ising.vartype == Vartype::spin);
  double square = 0;
  for (const Coupling& c : ising.couplings) square += c.value * c.value;
  if (square == 0) return 1;
  const double count = double(ising.couplings.size());
  return prefactor * std::sqrt(square / count) * std::sqrt(2 * count / double(ising.variable_count()));
}

double largest_coefficient(const Problem& ising) {
  double largest = 0;
  for (double h : ising.linear) largest = std::max(largest, std::abs(h));
  for (const Coupling& c : ising.couplings) largest = std::max(largest, std::abs(c.value));
  return largest;
}

EmbeddedProblem embed_problem(const Problem& problem, const HardwareGraph& graph, const Embedding& embedding,
                              double chain_strength) {
  check_chains(graph, embedding.chains);
  if (!(chain_strength >= 0) || !std::isfinite(chain_strength))
    throw InputError("chain strength " + number_text(chain_strength) + " is not a finite number from 0 on");
  EmbeddedProblem result;
  EmbeddingRecord& record = result.record;
  record.graph = graph.name();
  record.chain_strength = chain_strength;
  record.source = to_ising(problem);
  record.uncoupled = uncoupled_pairs(graph, embedding.chains, coupled_variables(problem));
  std::erase_if(record.source.couplings, [&](const Coupling& c) {
    return std::binary_search(record.uncoupled.begin(), record.uncoupled.end(), std::pair(c.a, c.b));
  });
  Problem& qubits = result.problem;
  qubits.vartype = Vartype::spin;
  qubits.offset = record.source.offset;
  std::map<Qubit, double> field;
  for (std::size_t v = 0; v < embedding.chains.size(); ++v) {
    record.chains.emplace_back(embedding.chains[v].begin(), embedding.chains[v].end());
    for (Qubit q : embedding.chains[v]) field[q] = record.source.linear[v] / double(embedding.chains[v].size());
  }
  std::map<Qubit, std::uint32_t> place;
  for (const auto& [q, h] : field) {
    place[q] = std::uint32_t(qubits.linear.size());
    qubits.labels.emplace_back(std::int64_t(q));
    qubits.linear.push_back(h);
  }
  const Couplers couplers = sort_couplers(graph, embedding.chains);
  for (const Coupling& c : record.source.couplings) {
    const auto& shared = couplers.between.at({c.a, c.b});
    for (const auto& [a, b] : shared) qubits.couplings.push_back({place[a], place[b], c.value / double(shared.size())});
  }
  for (const auto& [a, b] : couplers.inside) {
    qubits.couplings.push_back({place[a], place[b], -chain_strength});
    qubits.offset += chain_strength;
  }
  std::sort(qubits.couplings.begin(), qubits.couplings.end(),
            [](const Coupling& x, const Coupling& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
  return result;
}

}  // namespace gonogo::learning
