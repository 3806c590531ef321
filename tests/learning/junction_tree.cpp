// The junction tree against enumeration, and samplers against the junction tree on 128 qubits.
#include "learning/sampler/exact.h"

#include <cmath>
#include <cstdio>

#include "base/math/random.h"
#include "learning/qubits/graph.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

Problem on_graph(const HardwareGraph& graph, double scale, std::uint64_t seed) {
  Problem problem;
  problem.vartype = Vartype::spin;
  for (Qubit q : graph.qubits()) {
    problem.labels.emplace_back(std::int64_t(q));
    problem.linear.push_back(0.4 * (random_unit(seed, 0, q) - 0.5));
  }
  for (const auto& [a, b] : graph.couplers())
    problem.couplings.push_back({a, b, scale * (2 * random_unit(seed, a + 1, b) - 1)});
  return problem;
}

/// Largest and root-mean-square z of all first and second moments of a set of rows.
struct Scores {
  double largest = 0, mean_square = 0;
};

Scores moment_scores(const SampleSet& rows, const Problem& problem, const ExactMoments& exact) {
  const double n = double(rows.row_count());
  Scores scores;
  std::size_t count = 0;
  const auto add = [&](double sum, double expected) {
    const double z = (sum / n - expected) / std::sqrt((1 - expected * expected) / n);
    scores.largest = std::max(scores.largest, std::abs(z));
    scores.mean_square += z * z;
    ++count;
  };
  for (std::size_t i = 0; i < problem.variable_count(); ++i) {
    double sum = 0;
    for (std::size_t r = 0; r < rows.row_count(); ++r) sum += rows.row(r)[i];
    add(sum, exact.mean[i]);
  }
  for (std::size_t k = 0; k < problem.couplings.size(); ++k) {
    double sum = 0;
    for (std::size_t r = 0; r < rows.row_count(); ++r)
      sum += rows.row(r)[problem.couplings[k].a] * rows.row(r)[problem.couplings[k].b];
    add(sum, exact.pair_mean[k]);
  }
  scores.mean_square /= double(count);
  return scores;
}

}  // namespace

TEST_CASE("the junction tree agrees with enumeration") {
  const auto vartype = GENERATE(Vartype::spin, Vartype::binary);
  Problem problem = on_graph(chimera(2, 1), 1.5, 3);  // 16 qubits
  problem.offset = 0.3;
  problem = to_vartype(problem, vartype);
  const JunctionTree tree(problem);
  CHECK(tree.width() == 4);
  const ExactMoments expected = exact_moments(problem), found = tree.moments();
  CHECK(tree.log_z() == Approx(expected.log_z).margin(1e-11));
  for (std::size_t i = 0; i < 16; ++i) CHECK(found.mean[i] == Approx(expected.mean[i]).margin(1e-12));
  for (std::size_t k = 0; k < problem.couplings.size(); ++k)
    CHECK(found.pair_mean[k] == Approx(expected.pair_mean[k]).margin(1e-12));
}

TEST_CASE("a long chain and separate parts have the closed form") {
  Problem problem;
  problem.vartype = Vartype::spin;
  double expected = 0;
  for (std::uint32_t i = 0; i < 200; ++i) {
    problem.labels.emplace_back(std::int64_t(i));
    problem.linear.push_back(0);
    expected += std::log(2.0);
    if (i % 50 == 49 || i == 199) continue;
    const double J = random_unit(2, 0, i) - 0.5;
    problem.couplings.push_back({i, i + 1, J});
    expected += std::log(std::cosh(J));
  }
  const ExactMoments moments = JunctionTree(problem).moments();
  CHECK(moments.log_z == Approx(expected).margin(1e-10));
  for (std::size_t k = 0; k < problem.couplings.size(); ++k)
    CHECK(moments.pair_mean[k] == Approx(-std::tanh(problem.couplings[k].value)).margin(1e-12));
}

TEST_CASE("samplers on C4, 128 qubits, against its junction tree") {
  const Problem problem = on_graph(graph_named("chimera:4"), 0.7, 11);
  const ExactMoments exact = exact_moments(problem);
  for (const char* name : {"exact", "block_gibbs", "anneal", "tempering"}) {
    const std::size_t reads = name == std::string("exact") ? 1000 : 500;
    const SampleSet rows = make_machine_sampler(name)->sample(problem, {.reads = reads, .seed = 5, .sweeps = 120});
    const Scores scores = moment_scores(rows, problem, exact);
    std::printf("C4 %s: %zu moments, largest z %.2f, mean z^2 %.3f\n", name,
                problem.variable_count() + problem.couplings.size(), scores.largest, scores.mean_square);
    CHECK(scores.largest < 4.5);
    CHECK(scores.mean_square < 1.25);
  }
}

TEST_CASE("problems of high treewidth are refused") {
  Problem problem;
  for (std::uint32_t i = 0; i < 40; ++i) {
    problem.labels.emplace_back(std::int64_t(i));
    problem.linear.push_back(0);
    for (std::uint32_t j = i + 1; j < 40; ++j) problem.couplings.push_back({i, j, 1});
  }
  refused([&] { JunctionTree tree(problem); }, "treewidth");
}
