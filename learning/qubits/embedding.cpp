#include "learning/qubits/embedding.h"

#include <algorithm>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/dijkstra_shortest_paths.hpp>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

#include "base/error.h"
#include "base/format.h"
#include "base/math/random.h"
#include "base/progress.h"
#include "learning/qubits/line_embedding.h"
#include "learning/sampler/chains/bipartite.h"

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
  sort_couplings(qubits.couplings);
  return result;
}

// Overlapping chains made disjoint by prices, after Cai, Macready and Roy, "A practical heuristic for finding graph
// minors", arXiv:1406.2741: a variable's chain is torn out and laid anew along cheapest paths to its neighbours'
// chains, where a qubit's price grows with the number of chains on it.

namespace {

using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS, boost::no_property,
                                    boost::property<boost::edge_weight_t, double>>;
using Vertex = boost::graph_traits<Graph>::vertex_descriptor;

constexpr double kHistoryStep = 0.5;
constexpr double kUnreached = std::numeric_limits<double>::max();

/// Cheapest ways from a chain: the cost of a qubit is what the qubits on the way to it, itself included, are worth.
struct Ways {
  std::vector<double> cost;
  std::vector<Vertex> before;
};

/// The largest minimum degree of any part of a graph: a lower bound of its treewidth.
std::size_t degeneracy(const std::vector<std::vector<std::uint32_t>>& neighbours) {
  std::vector<std::size_t> degree;
  for (const auto& list : neighbours) degree.push_back(list.size());
  std::vector<char> gone(degree.size(), 0);
  std::size_t largest = 0;
  for (std::size_t step = 0; step < degree.size(); ++step) {
    std::size_t least = degree.size();
    for (std::size_t v = 0; v < degree.size(); ++v)
      if (!gone[v] && (least == degree.size() || degree[v] < degree[least])) least = v;
    largest = std::max(largest, degree[least]);
    gone[least] = 1;
    for (std::uint32_t other : neighbours[least])
      if (!gone[other]) --degree[other];
  }
  return largest;
}

class Embedder {
 public:
  Embedder(const HardwareGraph& graph, std::size_t variables, const VariablePairs& pairs, std::uint64_t seed)
      : hardware_(graph),
        graph_(graph.chip_size()),
        use_(graph.chip_size(), 0),
        history_(graph.chip_size(), 1.0),
        chains_(variables),
        wanted_(variables),
        seed_(seed) {
    for (const auto& [a, b] : graph.couplers()) {
      boost::add_edge(a, b, 1.0, graph_);
      boost::add_edge(b, a, 1.0, graph_);
    }
    for (const auto& [a, b] : pairs) {
      wanted_[a].push_back(b);
      wanted_[b].push_back(a);
    }
  }

  /// Lays every variable anew, in an order of its own for each round; prices rise with `base`.
  template <class Laid>
  void round(std::uint64_t number, double base, Laid laid) {
    base_ = base;
    std::vector<std::uint32_t> order(chains_.size());
    std::iota(order.begin(), order.end(), 0u);
    for (std::size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[random_bits(seed_, number, k) % k]);
    for (std::uint32_t v : order) {
      stop_if_cancelled();
      take_out(v);
      lay(v);
      laid();
    }
    for (std::size_t q = 0; q < use_.size(); ++q)
      if (use_[q] > 1) history_[q] += kHistoryStep;
  }
  std::size_t max_use() const { return std::size_t(*std::max_element(use_.begin(), use_.end())); }
  std::size_t length() const {
    std::size_t sum = 0;
    for (const auto& chain : chains_) sum += chain.size();
    return sum;
  }
  const Chains& chains() const { return chains_; }

 private:
  double price(Qubit q) const { return history_[q] * std::pow(base_, use_[q]); }

  void take_out(std::uint32_t v) {
    for (Qubit q : chains_[v]) --use_[q];
    chains_[v].clear();
  }

  Ways ways_from(const std::vector<Qubit>& chain) {
    const auto weight = boost::get(boost::edge_weight, graph_);
    for (auto [edge, end] = boost::edges(graph_); edge != end; ++edge)
      boost::put(weight, *edge, price(Qubit(boost::target(*edge, graph_))));
    Ways ways{std::vector<double>(use_.size(), kUnreached), std::vector<Vertex>(use_.size())};
    std::iota(ways.before.begin(), ways.before.end(), Vertex(0));
    boost::dijkstra_shortest_paths(graph_, chain.begin(), chain.end(), ways.before.data(), ways.cost.data(), weight,
                                   boost::get(boost::vertex_index, graph_), std::less<double>(), std::plus<double>(),
                                   kUnreached, 0.0, boost::default_dijkstra_visitor());
    return ways;
  }

  Qubit cheapest_free(std::uint32_t v) const {
    const auto& qubits = hardware_.qubits();
    const std::size_t start = random_bits(seed_, 1'000'000 + v, 0) % qubits.size();
    Qubit best = qubits[start];
    for (std::size_t k = 0; k < qubits.size(); ++k) {
      const Qubit q = qubits[(start + k) % qubits.size()];
      if (use_[q] < use_[best]) best = q;
    }
    return best;
  }

  void lay(std::uint32_t v) {
    std::vector<Ways> ways;
    for (std::uint32_t neighbour : wanted_[v])
      if (!chains_[neighbour].empty()) ways.push_back(ways_from(chains_[neighbour]));
    std::vector<Qubit> chain;
    if (ways.empty()) {
      chain.push_back(cheapest_free(v));
    } else {
      const Qubit root = cheapest_root(ways);
      chain.push_back(root);
      for (const Ways& way : ways)  // from the root back to, not including, the neighbour's chain
        for (Vertex q = root; way.before[q] != q; q = way.before[q]) chain.push_back(Qubit(q));
    }
    std::sort(chain.begin(), chain.end());
    chain.erase(std::unique(chain.begin(), chain.end()), chain.end());
    for (Qubit q : chain) ++use_[q];
    chains_[v] = std::move(chain);
  }

  /// Least sum of the ways' costs; the root's own price, in every one of them, counts once.
  Qubit cheapest_root(const std::vector<Ways>& ways) const {
    Qubit best = hardware_.qubits().front();
    double lowest = kUnreached;
    for (Qubit q : hardware_.qubits()) {
      double sum = price(q);
      for (const Ways& way : ways) {
        if (way.cost[q] == kUnreached) sum = kUnreached;
        if (sum == kUnreached) break;
        // on a neighbour's own chain: the price of the qubit that would be shared
        sum += way.before[q] == q ? price(q) * base_ : way.cost[q] - price(q);
      }
      if (sum < lowest) {
        lowest = sum;
        best = q;
      }
    }
    if (lowest == kUnreached)
      throw InputError("graph " + hardware_.name() + ": falls into parts that are not connected");
    return best;
  }

  const HardwareGraph& hardware_;
  Graph graph_;
  std::vector<int> use_;         // chains on each qubit
  std::vector<double> history_;  // grows with every round in which a qubit is on several chains
  Chains chains_;
  std::vector<std::vector<std::uint32_t>> wanted_;
  std::uint64_t seed_;
  double base_ = 2;
};

/// Counts that no embedding can meet. A chain of L qubits has at most L (d - 2) + 2 couplers to others, with d the most
/// couplers of a qubit. On Chimera no chain of minors has a minimum degree above the treewidth, which is the number of
/// lines of the shorter direction.
void refuse_too_large(const HardwareGraph& graph, std::size_t variables, const VariablePairs& pairs) {
  std::vector<std::vector<std::uint32_t>> wanted(variables);
  for (const auto& [a, b] : pairs) {
    wanted[a].push_back(b);
    wanted[b].push_back(a);
  }
  std::size_t most = 3, qubits = 0;
  for (Qubit q : graph.qubits()) most = std::max(most, graph.neighbours(q).size());
  for (const auto& list : wanted) qubits += list.size() <= most ? 1 : (list.size() - 2 + most - 3) / (most - 2);
  if (qubits > graph.qubits().size())
    throw InputError("graph " + graph.name() + ": " + std::to_string(variables) + " variables need at least " +
                     std::to_string(qubits) + " qubits, " + std::to_string(graph.qubits().size()) + " work");
  if (graph.size().topology != Topology::chimera) return;
  const std::size_t width = std::min(lines(graph.size(), 0).size(), lines(graph.size(), 1).size());
  if (const std::size_t degree = degeneracy(wanted); degree > width)
    throw InputError("graph " + graph.name() + ": the couplings are too dense; some variables have " +
                     std::to_string(degree) + " partners among one another, " + std::to_string(width) +
                     " are possible (the treewidth); use a larger graph");
}

}  // namespace

Embedding embed_heuristic(const HardwareGraph& graph, std::size_t variables, const VariablePairs& pairs,
                          const HeuristicSettings& settings) {
  refuse_too_large(graph, variables, pairs);
  const auto begin = std::chrono::steady_clock::now();
  for (std::size_t attempt = 0; attempt < settings.tries; ++attempt) {
    Embedder embedder(graph, variables, pairs, random_bits(settings.seed, 0, attempt));
    Chains best;
    std::size_t shortest = SIZE_MAX;
    for (std::size_t round = 0; round < settings.rounds; ++round) {
      embedder.round(round, std::min(2.0 + 0.5 * double(round), 8.0), [&] {
        if (settings.watch) settings.watch(attempt, round);
        const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
        if (passed.count() > settings.time_limit_s)
          throw InputError("graph " + graph.name() + ": no embedding found within " +
                           number_text(settings.time_limit_s) +
                           " s; use a larger graph or fewer couplings, or wait "
                           "longer with --time-limit");
      });
      if (variables > 0 && embedder.max_use() > 1) continue;
      if (embedder.length() >= shortest) break;  // no overlaps, and no shorter than before
      shortest = embedder.length();
      best = embedder.chains();
    }
    if (shortest == SIZE_MAX) continue;
    return {best, uncoupled_pairs(graph, best, pairs)};
  }
  throw InputError("graph " + graph.name() + ": no embedding found in " + std::to_string(settings.tries) +
                   " tries; use a larger graph or fewer couplings");
}

}  // namespace gonogo::learning
