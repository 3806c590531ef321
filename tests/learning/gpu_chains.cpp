// Chains on the GPU against those of the CPU and against exact answers.
#include <cmath>
#include <cstdio>

#include "learning/model/weights.h"
#include "learning/sampler/exact.h"
#include "learning/sampler/sampler.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::learning;
using namespace gonogo::test;

namespace {

std::vector<std::string> labels(std::size_t count) {
  std::vector<std::string> result;
  for (std::size_t i = 0; i < count; ++i) result.push_back("v" + std::to_string(i));
  return result;
}

/// `steps`: weights are whole multiples of 1 / steps, or any numbers where it is 0.
Problem random_problem(std::size_t visible, std::size_t hidden, double size, int steps) {
  Draw draw(visible * 1000 + hidden);
  const auto number = [&] {
    const double x = draw.between(-size, size);
    return steps > 0 ? std::round(x * steps) / steps : x;
  };
  RbmWeights machine = RbmWeights::zeros(visible, hidden);
  for (double& w : machine.weight) w = number();
  for (double& b : machine.visible_bias) b = number();
  for (double& b : machine.hidden_bias) b = number();
  return to_qubo(machine, labels(visible));
}

std::size_t differing_rows(const SampleSet& a, const SampleSet& b) {
  std::size_t count = 0;
  for (std::size_t r = 0; r < a.row_count(); ++r)
    count += !std::equal(a.row(r).begin(), a.row(r).end(), b.row(r).begin());
  return count;
}

const Sampler& gpu_sampler() {
  static const auto sampler = make_sampler("block_gibbs", {{"on_gpu", true}});
  return *sampler;
}

const Sampler& cpu_sampler() {
  static const auto sampler = make_sampler("block_gibbs");
  return *sampler;
}

}  // namespace

TEST_CASE("with weights that 16 bits hold the GPU's rows are the CPU's") {
  for (const auto& [visible, hidden] :
       {std::pair<std::size_t, std::size_t>{168, 168}, {1, 1}, {5, 7}, {30, 17}, {16, 15}, {40, 201}, {220, 9}}) {
    const Problem problem = random_problem(visible, hidden, 1, 64);
    // Of 20,000 chains of the largest machine, blocks share groups (chain_share.h).
    for (const std::size_t reads : {50u, 12'000u, 20'000u}) {
      const SampleRequest request{.reads = reads, .seed = 3, .sweeps = reads == 50 ? 40u : 4u};
      const SampleSet cpu = cpu_sampler().sample(problem, request), gpu = gpu_sampler().sample(problem, request);
      // A draw within 2^-24 of its probability may fall to either side.
      INFO(visible << " x " << hidden << ", " << reads << " chains");
      CHECK(double(differing_rows(cpu, gpu)) <= 1 + 3e-7 * double(visible + hidden) * double(reads * request.sweeps));
    }
  }
}

TEST_CASE("a chain of the GPU has the same bits in any batch, and after an interruption") {
  const Problem problem = random_problem(168, 168, 0.4, 0);
  const SampleSet few = gpu_sampler().sample(problem, {.reads = 100, .seed = 5, .sweeps = 7});
  const SampleSet many = gpu_sampler().sample(problem, {.reads = 20'000, .seed = 5, .sweeps = 7});
  CHECK(std::equal(few.values.begin(), few.values.end(), many.values.begin()));
  const SampleSet first = gpu_sampler().sample(problem, {.reads = 100, .seed = 5, .sweeps = 3});
  const SampleSet rest =
      gpu_sampler().sample(problem, {.reads = 100, .seed = 5, .sweeps = 4, .start = &first, .first_sweep = 3});
  CHECK(rest.values == few.values);
  CHECK(rest.values != gpu_sampler().sample(problem, {.reads = 100, .seed = 6, .sweeps = 7}).values);
}

TEST_CASE("the GPU's rows follow the exact distribution") {
  const Problem qubo = random_problem(6, 5, 2, 0);
  for (const bool spin : {false, true}) {
    const Problem problem = spin ? to_ising(qubo) : qubo;
    const std::size_t states = std::size_t(1) << problem.variable_count(), reads = 400'000;
    std::vector<double> p(states), count(states);
    double z = 0;
    for (std::size_t s = 0; s < states; ++s) {
      std::vector<std::int8_t> row;
      for (std::size_t i = 0; i < problem.variable_count(); ++i)
        row.push_back(std::int8_t((s >> i & 1) ? 1 : spin ? -1 : 0));
      z += p[s] = std::exp(-energy(problem, row));
    }
    const SampleSet rows = gpu_sampler().sample(problem, {.reads = reads, .seed = 11, .sweeps = 60});
    for (std::size_t r = 0; r < reads; ++r) {
      std::size_t s = 0;
      for (std::size_t i = 0; i < problem.variable_count(); ++i) s |= std::size_t(rows.row(r)[i] > 0) << i;
      count[s] += 1;
    }
    double chi_squared = 0, distance = 0, floor = 0;
    for (std::size_t s = 0; s < states; ++s) {
      const double expected = p[s] / z * double(reads);
      chi_squared += (count[s] - expected) * (count[s] - expected) / expected;
      distance += std::abs(count[s] - expected) / double(reads) / 2;
      floor += std::sqrt(2 * p[s] / z * (1 - p[s] / z) / (kPi * double(reads))) / 2;
    }
    const double degrees = double(states) - 1, deviation = (chi_squared - degrees) / std::sqrt(2 * degrees);
    std::printf("%s: chi2 %.0f for %.0f degrees of freedom (z %.2f); total variation %.5f, finite-sample floor %.5f\n",
                spin ? "SPIN" : "BINARY", chi_squared, degrees, deviation, distance, floor);
    CHECK(std::abs(deviation) < 4);
    CHECK(distance < 1.1 * floor);
  }
}

TEST_CASE("the moments of a machine of the GPU's are exact within their errors") {
  const Problem problem = random_problem(60, 18, 0.5, 0);
  const ExactMoments exact = exact_moments(problem);
  const std::size_t reads = 200'000;
  const SampleSet rows = gpu_sampler().sample(problem, {.reads = reads, .seed = 2, .sweeps = 200});
  double worst = 0;
  for (std::size_t i = 0; i < problem.variable_count(); ++i) {
    double mean = 0;
    for (std::size_t r = 0; r < reads; ++r) mean += rows.row(r)[i] / double(reads);
    worst = std::max(worst, std::abs(mean - exact.mean[i]) / std::sqrt(exact.mean[i] * (1 - exact.mean[i]) / reads));
  }
  for (std::size_t k = 0; k < problem.couplings.size(); ++k) {
    const Coupling& c = problem.couplings[k];
    double mean = 0;
    for (std::size_t r = 0; r < reads; ++r) mean += rows.row(r)[c.a] * rows.row(r)[c.b] / double(reads);
    const double p = exact.pair_mean[k];
    worst = std::max(worst, std::abs(mean - p) / std::sqrt(p * (1 - p) / reads));
  }
  std::printf("largest z of %zu moments %.2f\n", problem.variable_count() + problem.couplings.size(), worst);
  CHECK(worst < 4.5);
}

TEST_CASE("machines that the GPU cannot hold are refused with the sizes") {
  refused([] { (void)gpu_sampler().sample(random_problem(2000, 500, 1, 0), {.reads = 1}); }, "500 units");
  Problem large = random_problem(3, 2, 1, 0);
  large.couplings[0].value = 1e5;
  refused([&] { (void)gpu_sampler().sample(large, {.reads = 1}); }, "65504");
}
