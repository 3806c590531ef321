#include "learning/qubits/unembed.h"

#include <cmath>

#include "learning/sampler/exact.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

/// Two variables on chains {0, 4, 1} and {5}; energies s0 - 0.5 s1 + 0.25 s0 s1.
EmbeddingRecord record() {
  EmbeddingRecord result;
  result.graph = "chimera:1";
  result.chains = {{0, 1, 4}, {5}};
  result.source.vartype = Vartype::spin;
  result.source.labels = {"a", "b"};
  result.source.linear = {1, -0.5};
  result.source.couplings = {{0, 1, 0.25}};
  return result;
}

SampleSet rows(std::vector<std::int8_t> values, std::vector<std::int64_t> occurrences) {
  SampleSet samples;
  samples.vartype = Vartype::spin;
  for (std::int64_t q : {5, 4, 1, 0}) samples.labels.emplace_back(q);
  samples.values = std::move(values);
  samples.energies.assign(occurrences.size(), 0.0);
  samples.occurrences = std::move(occurrences);
  return samples;
}

}  // namespace

TEST_CASE("policies for broken chains") {
  const SampleSet answer = rows({1, -1, -1, -1,  // whole
                                 -1, 1, 1, -1},  // qubit 0 differs
                                {3, 1});
  const Unembedded vote = unembed(answer, record(), BrokenChains::majority_vote, 1);
  CHECK(vote.samples.values == std::vector<std::int8_t>{-1, 1, 1, -1});
  CHECK(vote.samples.energies == std::vector<double>{-1 - 0.5 - 0.25, 1 + 0.5 - 0.25});
  CHECK(vote.chain_break_fraction == std::vector<double>{0, 0.5});
  CHECK(vote.chain_break_rate == std::vector<double>{0.25, 0});
  CHECK(vote.qubit_break_rate == std::vector<double>{0.25, 0, 0, 0});
  const Unembedded whole = unembed(answer, record(), BrokenChains::discard, 1);
  CHECK(whole.samples.values == std::vector<std::int8_t>{-1, 1});
  CHECK(whole.samples.occurrences == std::vector<std::int64_t>{3});
  const Unembedded down = unembed(answer, record(), BrokenChains::minimize_energy, 1);
  CHECK(down.samples.values == std::vector<std::int8_t>{-1, 1, -1, -1});  // field on a: 1 - 0.25 > 0
  int up = 0;
  for (std::uint64_t seed = 0; seed < 3000; ++seed)
    up += unembed(answer, record(), BrokenChains::weighted_random, seed).samples.values[2] > 0;
  CHECK(std::abs(up - 2000) < 4 * std::sqrt(3000 * 2.0 / 9));  // two of its three qubits are up
  refused([] { broken_chains_named("vote"); }, "majority_vote");
  SampleSet missing = answer;
  missing.labels[0] = std::int64_t(6);
  refused([&] { unembed(missing, record(), BrokenChains::discard, 1); }, "5");
}

TEST_CASE("a gauge turns problem and rows alike") {
  const Problem problem = record().source;
  const std::vector<std::int8_t> gauge = {-1, 1};
  const Problem turned = apply_gauge(problem, gauge);
  const SampleSet answer = make_sampler("exact")->sample(turned, {.reads = 50, .seed = 2});
  const SampleSet back = apply_gauge(answer, gauge);
  for (std::size_t r = 0; r < 50; ++r) CHECK(energy(problem, back.row(r)) == Approx(answer.energies[r]));
  int minus = 0;
  for (std::int8_t sign : random_gauge(10000, 4)) minus += sign < 0;
  CHECK(std::abs(minus - 5000) < 200);
}

TEST_CASE("auto_scale uses the whole range and check_ranges names what leaves it") {
  Problem problem = record().source;
  CHECK(auto_scale_factor(problem, {}) == 2);  // h = 1 of 2 is the largest share
  CHECK_NOTHROW(check_ranges(scaled(problem, 2), {}));
  refused([&] { check_ranges(scaled(problem, 2.01), {}); }, "linear bias of a");
  problem.couplings[0].value = -3;
  CHECK(auto_scale_factor(problem, {}) == Approx(1.0 / 3));
  refused([&] { check_ranges(problem, {}); }, "coupling of a and b");
  CoefficientRanges extended;
  extended.j_low = -4;
  extended.per_qubit_coupling = {-1.5, 9};
  CHECK(auto_scale_factor(problem, extended) == 0.5);
  refused([&] { check_ranges(problem, extended); }, "sum of couplings");
  CHECK(auto_scale_factor(scaled(problem, 0), {}) == 1);
}
