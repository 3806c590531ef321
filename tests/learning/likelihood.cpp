#include "tests/learning/machine_likelihood.h"

#include <omp.h>

#include <cmath>
#include <cstdio>

#include "base/math/random.h"
#include "learning/machine/ladder.h"
#include "learning/sampler/exact.h"
#include "tests/learning/toy.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

RbmWeights random_machine(std::size_t visible, std::size_t hidden, double size, std::uint64_t seed) {
  RbmWeights machine = RbmWeights::zeros(visible, hidden);
  std::uint64_t k = 0;
  for (auto* part : {&machine.weight, &machine.visible_bias, &machine.hidden_bias})
    for (double& w : *part) w = size * (2 * random_unit(seed, 1, k++) - 1);
  return machine;
}

/// Visible parts of independent rows of the machine.
std::vector<double> rows_of(const RbmWeights& machine, std::size_t count, std::uint64_t seed) {
  std::vector<std::string> labels;
  for (std::size_t i = 0; i < machine.visible_count; ++i) labels.push_back("v" + std::to_string(i));
  const SampleSet samples = make_sampler("exact")->sample(to_qubo(machine, labels), {.reads = count, .seed = seed});
  std::vector<double> rows;
  for (std::size_t r = 0; r < count; ++r)
    for (std::size_t i = 0; i < machine.visible_count; ++i) rows.push_back(samples.row(r)[i]);
  return rows;
}

double exact_log_z(const RbmWeights& machine) {
  std::vector<std::string> labels;
  for (std::size_t i = 0; i < machine.visible_count; ++i) labels.push_back("v" + std::to_string(i));
  return exact_moments(to_qubo(machine, labels)).log_z;
}

}  // namespace

TEST_CASE("annealed importance sampling finds log Z and its error; RAISE stays below the log-likelihood (20 x 12)") {
  const RbmWeights machine = random_machine(20, 12, 3, 5);
  const std::vector<double> rows = rows_of(machine, 200, 3), base = independent_bias(rows, 20);
  const double log_z = exact_log_z(machine), exact = mean_log_likelihood(machine, rows);
  const AnnealingSettings settings{.steps = 2000, .chains = 100, .row_chains = 1, .seed = 1};
  const LogZEstimate z = annealed_log_z(machine, base, settings);
  std::printf("log Z: exact %.4f, AIS %.4f [%.4f, %.4f], %.0f of 100 chains effective\n", log_z, z.log_z, z.low, z.high,
              z.effective_chains);
  CHECK(std::abs(z.log_z - log_z) < 0.1);
  CHECK(z.low < log_z);
  CHECK(z.high > log_z);
  std::vector<double> raise;
  for (std::size_t steps : {10, 100, 1000}) {
    AnnealingSettings part = settings;
    part.steps = steps;
    raise.push_back(raise_log_likelihood(machine, base, rows, part).mean);
    std::printf("log-likelihood per row: exact %.4f, AIS %.4f, RAISE in %zu steps %.4f\n", exact,
                exact + log_z - z.log_z, steps, raise.back());
  }
  CHECK(raise[0] < exact);
  CHECK(raise[1] < exact);
  CHECK(raise[0] < raise[2]);
  CHECK(raise[2] == Approx(exact).margin(0.1));
}

TEST_CASE("with one step the estimators are importance sampling, whose mean is known in closed form") {
  // No weights: f_beta needs no walk at all, and every weight is Z / Z_0.
  RbmWeights machine = random_machine(9, 4, 1.0, 2);
  std::fill(machine.weight.begin(), machine.weight.end(), 0.0);
  double log_z = 0;
  for (double a : machine.visible_bias) log_z += softplus(a);
  for (double b : machine.hidden_bias) log_z += softplus(b);
  const LogZEstimate z = annealed_log_z(machine, machine.visible_bias, {.steps = 1, .chains = 5, .seed = 1});
  CHECK(z.log_z == Approx(log_z).epsilon(1e-13));
  CHECK(z.effective_chains == Approx(5));
  const std::vector<double> rows = rows_of(machine, 20, 1);
  const RaiseEstimate raise = raise_log_likelihood(machine, machine.visible_bias, rows, {.steps = 1, .chains = 2});
  CHECK(raise.mean == Approx(mean_log_likelihood(machine, rows)).epsilon(1e-12));
}

TEST_CASE("the weights of AIS have mean Z on the toy machine, the bracket is exact there, threads change no bit") {
  const RbmWeights toy = toy_machine();
  const std::vector<double> base(4, 0.0), rows = rows_of(toy, 50, 1);
  double sum = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed)
    sum += std::exp(annealed_log_z(toy, base, {.steps = 3, .chains = 50, .seed = seed}).log_z) / 400;
  CHECK(std::log(sum) == Approx(4.877232620012669).margin(0.005));
  const LikelihoodBracket bracket = bracket_log_likelihood(toy, rows);
  CHECK(bracket.exact);
  CHECK(bracket.mean == Approx(mean_log_likelihood(toy, rows)).epsilon(1e-14));
  const int threads = omp_get_max_threads();
  omp_set_num_threads(2);
  const double two = annealed_log_z(toy, base, {.steps = 20, .chains = 7}).log_z;
  omp_set_num_threads(1);
  const double one = annealed_log_z(toy, base, {.steps = 20, .chains = 7}).log_z;
  omp_set_num_threads(threads);
  CHECK(one == two);
}

TEST_CASE("chains on a ladder visit two far modes as often as they are probable, and single chains do not") {
  // All ones or all zeros, held by strong weights; the ones are e^1 times as probable.
  RbmWeights machine = RbmWeights::zeros(12, 3);
  for (double& w : machine.weight) w = 3;
  for (double& b : machine.hidden_bias) b = -18;
  for (double& a : machine.visible_bias) a = -4.5 + 1 / 12.0;
  const std::vector<double> base(12, 0.0);
  const auto share_of_ones = [&](std::size_t rungs) {
    std::vector<RbmWeights> ladder;
    for (std::size_t r = 0; r < rungs; ++r)
      ladder.push_back(interpolated(machine, base, rungs > 1 ? double(r) / double(rungs - 1) : 1));
    LadderChains chains(200, 12, 3, 9);
    double high = 0, looks = 0;
    chains.run(ladder, 200);
    for (int look = 0; look < 30; ++look) {
      chains.run(ladder, 40);
      for (std::size_t c = 0; c < chains.chains(); ++c) {
        int on = 0;
        for (Bit bit : chains.top(c)) on += bit;
        high += on > 6;
        looks += 1;
      }
    }
    return high / looks;
  };
  // The exact share by enumeration of all rows.
  double more = 0;
  std::vector<double> row(12);
  const double log_z = exact_log_z(machine);
  for (int state = 0; state < 4096; ++state) {
    int on = 0;
    for (int i = 0; i < 12; ++i) on += int(row[std::size_t(i)] = state >> i & 1);
    if (on > 6) more += std::exp(-free_energy(machine, row) - log_z);
  }
  const double ladder = share_of_ones(12), single = share_of_ones(1);
  std::printf("share of the upper mode: exact %.4f, ladder of 12 rungs %.4f, one rung %.4f\n", more, ladder, single);
  CHECK(ladder == Approx(more).margin(0.03));
  CHECK(std::abs(single - more) > 0.1);
}
