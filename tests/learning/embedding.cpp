// Embeddings against what is known of the graphs, and embedded problems against enumeration.
#include "learning/qubits/embedding.h"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "base/math/random.h"
#include "learning/qubits/line_chains.h"
#include "learning/qubits/line_embedding.h"
#include "learning/qubo/problem.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

std::size_t longest(const Chains& chains) {
  std::size_t length = 0;
  for (const auto& chain : chains) length = std::max(length, chain.size());
  return length;
}

std::size_t qubits_used(const Chains& chains) {
  std::size_t sum = 0;
  for (const auto& chain : chains) sum += chain.size();
  return sum;
}

Problem random_ising(std::size_t n, double density, std::uint64_t seed) {
  Problem problem;
  problem.vartype = Vartype::spin;
  for (std::uint32_t i = 0; i < n; ++i) {
    problem.labels.emplace_back("u" + std::to_string(i));
    problem.linear.push_back(random_unit(seed, 0, i) - 0.5);
    for (std::uint32_t j = i + 1; j < n; ++j)
      if (random_unit(seed, i + 1, j) < density)
        problem.couplings.push_back({i, j, random_unit(seed, 99, i * n + j) - 0.5});
  }
  problem.offset = 0.7;
  return problem;
}

}  // namespace

TEST_CASE("bicliques of whole graphs are as large as their lines allow") {
  struct Known {
    const char* graph;
    std::size_t side, chain;
  };
  for (const Known& k : {Known{"chimera:12", 48, 12},
                         {"chimera:16", 64, 16},
                         {"pegasus:16", 168, 15},
                         {"pegasus:16", 172, 15},
                         {"zephyr:12", 184, 12},
                         {"zephyr:6", 88, 6}}) {
    CAPTURE(k.graph, k.side);
    const HardwareGraph graph = graph_named(k.graph);
    const Embedding embedding = embed_biclique(graph, k.side, k.side);
    check_chains(graph, embedding.chains);
    CHECK(embedding.chains.size() == 2 * k.side);
    CHECK(embedding.uncoupled.empty());
    CHECK(longest(embedding.chains) == k.chain);
  }
  CHECK(qubits_used(embed_biclique(graph_named("chimera:12"), 48, 48).chains) == 1152);
  // 20 hidden units take five rows of cells: vertical chains need only these
  CHECK(qubits_used(embed_biclique(graph_named("chimera:12"), 48, 20).chains) == 48 * 5 + 20 * 12);
  refused([] { embed_biclique(graph_named("chimera:12"), 49, 48); }, "do not fit");
}

namespace {

HardwareGraph with_dead(const char* name, double share, std::uint64_t seed) {
  const HardwareGraph full = graph_named(name);
  return without(full, random_dead_qubits(full, share, seed));
}

/// Prints and returns the least share of the pairs of K48,48 that stay coupled on C12, over masks first ... last.
double min_coupled(std::uint64_t first, std::uint64_t last) {
  double min = 1, max = 0, sum = 0;
  std::size_t length = 0;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const HardwareGraph graph = with_dead("chimera:12", 0.02, seed);
    const Embedding embedding = embed_biclique(graph, 48, 48);
    check_chains(graph, embedding.chains);
    const double share = 1 - double(embedding.uncoupled.size()) / (48 * 48);
    min = std::min(min, share);
    max = std::max(max, share);
    sum += share;
    length = std::max(length, longest(embedding.chains));
  }
  const auto count = double(last - first + 1);
  std::printf("C12, 2 %% dead, %.0f masks: pairs coupled %.2f %% min, %.2f %% mean, %.2f %% max; longest chain %zu\n",
              count, 100 * min, 100 * sum / count, 100 * max, length);
  return min;
}

}  // namespace

// A dead vertical qubit leaves its row of cells with one vertical qubit less than there are variables, so that one of
// them must end there: no embedding with connected chains keeps every pair of the other rows.
TEST_CASE("with 2 % of the qubits dead 85 % of the pairs of C12 stay coupled") { CHECK(min_coupled(5, 10) >= 0.85); }

TEST_CASE("the same over a hundred masks", "[.table]") { CHECK(min_coupled(1, 100) >= 0.85); }

TEST_CASE("chains that grow over unused qubits stay chains, gain the pairs they count, and lose none by trimming") {
  std::size_t gained = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const HardwareGraph graph = with_dead("chimera:8", 0.04, seed);
    VariablePairs pairs;
    for (std::uint32_t i = 0; i < 32; ++i)
      for (std::uint32_t j = 32; j < 64; ++j) pairs.emplace_back(i, j);
    Chains whole(64);  // the longest segment of every line
    for (int u : {0, 1})
      for (const Segment& s : segments(graph, u))
        if (s.qubits.size() > whole[std::size_t(32 * u) + s.line].size())
          whole[std::size_t(32 * u) + s.line] = s.qubits;
    BicliqueChains chains(graph, 32, whole);
    const auto missing = [&] { return uncoupled_pairs(graph, chains.chains(), pairs).size(); };
    const std::size_t before = missing();
    CHECK(chains.coupled_pairs() == pairs.size() - before);
    chains.lengthen();
    check_chains(graph, chains.chains());
    CHECK(chains.coupled_pairs() == pairs.size() - missing());
    CHECK(missing() <= before);
    CHECK(longest(chains.chains()) <= 2 * longest(whole));
    gained += before - missing();
    const std::size_t grown = qubits_used(chains.chains()), coupled = chains.coupled_pairs();
    chains.trim();
    check_chains(graph, chains.chains());
    CHECK(chains.coupled_pairs() == coupled);
    CHECK(qubits_used(chains.chains()) <= grown);
  }
  std::printf("20 masks of C8, 4 %% dead: %zu pairs gained by growing\n", gained);
  CHECK(gained > 20);
}

TEST_CASE("cliques have the known sizes and chain lengths") {
  for (const auto& [name, count, chain] :
       {std::tuple("chimera:4", 16, 5), {"chimera:12", 48, 13}, {"pegasus:4", 24, 6}, {"zephyr:4", 56, 8}}) {
    CAPTURE(name);
    const HardwareGraph graph = graph_named(name);
    const Embedding embedding = embed_clique(graph, std::size_t(count));
    check_chains(graph, embedding.chains);
    CHECK(embedding.uncoupled.empty());
    std::printf("clique of %d on %s: longest chain %zu, %zu qubits\n", count, name, longest(embedding.chains),
                qubits_used(embedding.chains));
    CHECK(longest(embedding.chains) <= std::size_t(chain));
  }
  const HardwareGraph full = graph_named("chimera:8");
  const HardwareGraph graph = without(full, random_dead_qubits(full, 0.02, 3));
  const Embedding embedding = embed_clique(graph, 20);
  check_chains(graph, embedding.chains);
  CHECK(embedding.uncoupled.empty());  // 12 crosses to spare make up for the dead
}

TEST_CASE("the heuristic embeds any pairs that fit, with dead qubits, the same for the same seed") {
  const HardwareGraph full = graph_named("chimera:4");
  const HardwareGraph graph = without(full, random_dead_qubits(full, 0.05, 2));
  const Problem problem = random_ising(16, 0.35, 3);
  const Embedding embedding = embed(graph, problem, "heuristic");
  check_chains(graph, embedding.chains);
  CHECK(embedding.uncoupled.empty());
  CHECK(embed(graph, problem, "heuristic").chains == embedding.chains);
  std::printf("heuristic: 16 variables, %zu couplings: %zu of %zu qubits, longest chain %zu\n",
              problem.couplings.size(), qubits_used(embedding.chains), graph.qubits().size(),
              longest(embedding.chains));
  Problem triangle = random_ising(8, 0, 1);  // eight variables on eight qubits, whose graph has no odd ring
  triangle.couplings = {{0, 1, 1}, {0, 2, 1}, {1, 2, 1}};
  refused([&] { embed(graph_named("chimera:1"), triangle, "heuristic"); }, "no embedding found");
  refused([&] { embed(graph_named("chimera:1"), random_ising(9, 0, 1), "heuristic"); }, "need at least 9 qubits");
  refused([&] { embed(graph, problem, "best"); }, "biclique");
  CHECK(embed(graph, problem, "auto").uncoupled.empty());
}

TEST_CASE("what no embedding can hold is refused at once, with the reason, and the search keeps its time limit") {
  const auto begin = std::chrono::steady_clock::now();
  refused([&] { embed(graph_named("chimera:12"), random_ising(60, 1, 1), "auto"); }, "treewidth");
  refused([&] { embed(graph_named("chimera:4"), random_ising(64, 1, 1), "heuristic"); }, "qubits");
  refused([&] { embed(graph_named("chimera:8"), random_ising(60, 0.4, 1), "heuristic", {.time_limit_s = 0.3}); },
          "within 0.3 s");
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
  CHECK(passed.count() < 5);
}

TEST_CASE("a biclique with a side longer than the lines lies on crosses and the lines of both directions") {
  for (const auto& [wide, narrow, dead] : {std::tuple(52, 8, 0.0), {72, 12, 0.0}, {52, 8, 0.02}, {60, 12, 0.02}}) {
    CAPTURE(wide, narrow, dead);
    const HardwareGraph graph = with_dead("chimera:12", dead, 1);
    const Embedding embedding = embed_crossed_biclique(graph, std::size_t(wide), std::size_t(narrow));
    check_chains(graph, embedding.chains);
    std::printf("K%d,%d on C12, %.0f %% dead: %zu qubits, longest chain %zu, %zu pairs uncoupled\n", wide, narrow,
                100 * dead, qubits_used(embedding.chains), longest(embedding.chains), embedding.uncoupled.size());
    CHECK(double(embedding.uncoupled.size()) <= (dead > 0 ? 0.05 : 0.0) * wide * narrow);
  }
  refused([] { embed_crossed_biclique(graph_named("chimera:12"), 90, 8); }, "do not fit");
  const HardwareGraph graph = with_dead("chimera:12", 0.06, 2);
  const Embedding turned = embed_two_sides(graph, 10, 60);
  VariablePairs pairs;
  for (std::uint32_t i = 0; i < 10; ++i)
    for (std::uint32_t j = 10; j < 70; ++j) pairs.emplace_back(i, j);
  CHECK(turned.chains.size() == 70);
  CHECK(turned.uncoupled == uncoupled_pairs(graph, turned.chains, pairs));
  Problem problem = random_ising(60, 0, 1);
  for (std::uint32_t i = 0; i < 52; ++i)
    for (std::uint32_t j = 52; j < 60; ++j) problem.couplings.push_back({i, j, 0.1});
  const Embedding found = embed(graph_named("chimera:12"), problem, "auto");
  check_chains(graph_named("chimera:12"), found.chains);
  CHECK(found.uncoupled.empty());
}

TEST_CASE("chains that are torn, shared or on dead qubits are refused") {
  const HardwareGraph graph = without(graph_named("chimera:2"), std::vector<Qubit>{5});
  CHECK_NOTHROW(check_chains(graph, {{0, 4}, {1, 6}}));
  refused([&] { check_chains(graph, {{0, 5}}); }, "working");
  refused([&] { check_chains(graph, {{0, 1}}); }, "connected");
  refused([&] { check_chains(graph, {{0, 4}, {4}}); }, "twice");
  refused([&] { check_chains(graph, {{}}); }, "no qubits");
  refused([&] { check_chains(graph, {{400}}); }, "working");
}

TEST_CASE(
    "an unbroken row of the embedded problem has the source's energy, a broken one more by the chain's coupling") {
  const HardwareGraph graph = graph_named("chimera:2");
  const Problem problem = random_ising(6, 0.6, 8);
  const EmbeddedProblem embedded = embed_problem(problem, graph, embed(graph, problem, "auto"), 1.5);
  CHECK(embedded.record.uncoupled.empty());
  CHECK(embedded.record.source == problem);
  std::vector<std::size_t> variable;
  for (const Label& label : embedded.problem.labels)
    for (std::size_t v = 0; v < 6; ++v)
      for (std::int64_t q : embedded.record.chains[v])
        if (Label(q) == label) variable.push_back(v);
  for (std::size_t state = 0; state < 64; ++state) {
    std::vector<std::int8_t> row, qubits;
    for (std::size_t v = 0; v < 6; ++v) row.push_back(state >> v & 1 ? 1 : -1);
    for (std::size_t v : variable) qubits.push_back(row[v]);
    CHECK(energy(embedded.problem, qubits) == Approx(energy(problem, row)).margin(1e-12));
  }
}

TEST_CASE("couplings without a coupler are taken out of the problem and named") {
  const HardwareGraph graph =
      without(graph_named("chimera:1"), std::vector<Qubit>{}, std::vector<std::pair<Qubit, Qubit>>{{1, 6}});
  Problem problem = random_ising(8, 0, 1);
  for (std::uint32_t a = 0; a < 4; ++a)
    for (std::uint32_t b = 4; b < 8; ++b) problem.couplings.push_back({a, b, 1.0 + a + 10 * b});
  const Embedding embedding = embed(graph, problem, "biclique");
  REQUIRE(embedding.uncoupled.size() == 1);
  const EmbeddedProblem embedded = embed_problem(problem, graph, embedding, 1);
  CHECK(embedded.record.uncoupled == embedding.uncoupled);
  CHECK(embedded.record.source.couplings.size() == 15);
  CHECK(embedded.problem.couplings.size() == 15);
}

TEST_CASE("chain strengths of Ocean") {
  Problem triangle = random_ising(3, 1, 1);
  for (Coupling& c : triangle.couplings) c.value = 1;
  CHECK(torque_compensation(triangle) == Approx(1.9996979771955565).epsilon(1e-14));  // dwave-system's documentation
  Problem qubo;  // all ones on and above the diagonal, on its Ising form with prefactor 3: dwave-system issue 343
  for (std::uint32_t a = 0; a < 5; ++a) {
    qubo.labels.emplace_back(std::int64_t(a));
    qubo.linear.push_back(1);
    for (std::uint32_t b = a + 1; b < 5; ++b) qubo.couplings.push_back({a, b, 1});
  }
  CHECK(torque_compensation(to_ising(qubo), 3) == Approx(1.5).epsilon(1e-14));
  for (Coupling& c : triangle.couplings) c.value = 0;
  CHECK(torque_compensation(triangle) == 1);
  triangle.linear = {0.5, -2, 1};
  CHECK(largest_coefficient(triangle) == 2);
}
