#include <omp.h>

#include <cmath>
#include <cstdio>
#include <map>

#include "base/error.h"
#include "base/math/random.h"
#include "base/units.h"
#include "learning/sampler/exact.h"
#include "learning/sampler/sampler.h"
#include "tests/learning/toy.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

/// P of every state by brute force over all variables; index = bits, first variable lowest.
std::vector<double> brute_force(const Problem& problem, double& log_z) {
  const std::size_t n = problem.variable_count();
  std::vector<double> p(std::size_t(1) << n);
  double z = 0;
  for (std::size_t state = 0; state < p.size(); ++state) {
    std::vector<std::int8_t> row;
    for (std::size_t i = 0; i < n; ++i) {
      const bool on = state >> i & 1;
      row.push_back(problem.vartype == Vartype::binary ? on : (on ? 1 : -1));
    }
    z += p[state] = std::exp(-energy(problem, row));
  }
  for (double& x : p) x /= z;
  log_z = std::log(z);
  return p;
}

std::size_t state_of(std::span<const std::int8_t> row) {
  std::size_t state = 0;
  for (std::size_t i = 0; i < row.size(); ++i) state |= std::size_t(row[i] > 0) << i;
  return state;
}

Problem frustrated() {  // odd cycles: not bipartite
  Problem problem;
  for (int i = 0; i < 6; ++i) problem.labels.emplace_back(std::int64_t(i));
  for (std::uint32_t a = 0; a < 6; ++a) {
    problem.linear.push_back(0.3 * (a % 3) - 0.2);
    for (std::uint32_t b = a + 1; b < 6; ++b) problem.couplings.push_back({a, b, random_unit(5, a, b) - 0.5});
  }
  problem.vartype = Vartype::spin;
  return problem;
}

struct Fit {
  double chi_squared, degrees, total_variation, floor, spread;
};

/// Pearson's test of row frequencies against exact probabilities, with the total-variation distance and what perfect
/// samples of this number would have: E|n_i/N - p_i| = sqrt(2 p (1 - p) / (pi N)), and the standard deviation of that
/// sum with the states taken as independent: variance (1 - 2/pi) p (1 - p) / N each.
Fit compare(const SampleSet& rows, const std::vector<double>& p) {
  std::vector<double> count(p.size(), 0.0);
  for (std::size_t r = 0; r < rows.row_count(); ++r) count[state_of(rows.row(r))] += 1;
  const double n = double(rows.row_count());
  Fit fit{0, double(p.size()) - 1, 0, 0, 0};
  for (std::size_t i = 0; i < p.size(); ++i) {
    fit.chi_squared += (count[i] - n * p[i]) * (count[i] - n * p[i]) / (n * p[i]);
    fit.total_variation += std::abs(count[i] / n - p[i]) / 2;
    fit.floor += std::sqrt(2 * p[i] * (1 - p[i]) / (kPi * n)) / 2;
    fit.spread += (1 - 2 / kPi) * p[i] * (1 - p[i]) / n / 4;
  }
  fit.spread = std::sqrt(fit.spread);
  return fit;
}

}  // namespace

TEST_CASE("exact answers for the toy machine") {
  const Problem qubo = to_qubo(toy_machine(), toy_labels());
  for (const Problem& problem : {qubo, to_ising(qubo)}) {
    const ExactMoments moments = exact_moments(problem);
    CHECK(moments.log_z == Approx(4.877232620012669).epsilon(0).margin(1e-12));
    const double mean[7] = {.363154922783, .433523027749, .520442406865, .630110784540,
                            .421246972273, .545812079763, .501783999095};
    const bool spin = problem.vartype == Vartype::spin;
    for (std::size_t i = 0; i < 7; ++i)
      CHECK((spin ? (moments.mean[i] + 1) / 2 : moments.mean[i]) == Approx(mean[i]).epsilon(0).margin(1e-10));
  }
  const ExactMoments moments = exact_moments(qubo);
  std::map<std::pair<int, int>, double> pair;
  for (std::size_t k = 0; k < qubo.couplings.size(); ++k)
    pair[{qubo.couplings[k].a, qubo.couplings[k].b}] = moments.pair_mean[k];
  const double v0h[3] = {.125386756, .212781468, .168108483}, v3h[3] = {.250980233, .372898949, .315976131};
  for (int j = 0; j < 3; ++j) {
    CHECK(pair[{0, 4 + j}] == Approx(v0h[j]).epsilon(0).margin(1e-9));
    CHECK(pair[{3, 4 + j}] == Approx(v3h[j]).epsilon(0).margin(1e-9));
  }
}

TEST_CASE("the toy machine's free energy, conditional and ground state") {
  const RbmWeights toy = toy_machine();
  double on = 0, off = 0, z = 0;
  for (int state = 0; state < 16; ++state) {
    const std::vector<double> v = {double(state & 1), double(state >> 1 & 1), double(state >> 2 & 1),
                                   double(state >> 3)};
    const double weight = std::exp(-free_energy(toy, v));
    z += weight;
    if (v[0] == 1 && v[1] == 0) (v[3] == 1 ? on : off) += weight;
  }
  CHECK(std::log(z) == Approx(4.877232620012669).epsilon(0).margin(1e-12));
  CHECK(on / (on + off) == Approx(0.645112712510801).epsilon(0).margin(1e-12));
  const Problem qubo = to_qubo(toy, toy_labels());
  double lowest = 0;
  std::size_t ground = 0;
  for (std::size_t state = 0; state < 128; ++state) {
    std::vector<std::int8_t> row;
    for (std::size_t i = 0; i < 7; ++i) row.push_back(std::int8_t(state >> i & 1));
    if (energy(qubo, row) < lowest) {
      lowest = energy(qubo, row);
      ground = state;
    }
  }
  CHECK(lowest == Approx(-1.125).margin(1e-14));
  CHECK(ground == 0b1101000);  // v = 0001, h = 011, first variable lowest
}

TEST_CASE("exact moments equal brute force on a problem that is not bipartite") {
  const Problem problem = frustrated();
  double log_z = 0;
  const std::vector<double> p = brute_force(problem, log_z);
  const ExactMoments moments = exact_moments(problem);
  CHECK(moments.log_z == Approx(log_z).margin(1e-12));
  for (std::size_t k = 0; k < problem.couplings.size(); ++k) {
    double expected = 0;
    for (std::size_t s = 0; s < p.size(); ++s)
      expected += p[s] * ((s >> problem.couplings[k].a & 1) == (s >> problem.couplings[k].b & 1) ? 1 : -1);
    CHECK(moments.pair_mean[k] == Approx(expected).margin(1e-12));
  }
}

TEST_CASE("samples follow the exact distribution") {
  const std::string name = GENERATE("exact", "block_gibbs");
  const auto sampler = make_sampler(name);
  RbmWeights machine = toy_machine();
  for (double& w : machine.weight) w *= 3;  // couplings strong enough to matter
  const Problem qubo = to_qubo(machine, toy_labels());
  const bool spin = GENERATE(false, true);
  const Problem problem = spin ? to_ising(qubo) : qubo;
  double log_z = 0;
  const std::vector<double> p = brute_force(problem, log_z);
  const SampleSet rows = sampler->sample(problem, {.reads = 40000, .seed = 7, .sweeps = 100});
  const Fit fit = compare(rows, p);
  const double z = (fit.chi_squared - fit.degrees) / std::sqrt(2 * fit.degrees);
  std::printf("%s %s: chi2 %.1f for %.0f degrees of freedom (z %.2f); total variation %.5f, finite-sample floor %.5f\n",
              name.c_str(), vartype_name(problem.vartype).c_str(), fit.chi_squared, fit.degrees, z, fit.total_variation,
              fit.floor);
  CHECK(std::abs(z) < 4);
  CHECK(fit.total_variation < 1.25 * fit.floor);

  const ExactMoments exact = exact_moments(problem);
  double worst = 0;
  for (std::size_t k = 0; k < problem.couplings.size(); ++k) {
    const Coupling& c = problem.couplings[k];
    double sum = 0, square = 0;
    for (std::size_t r = 0; r < rows.row_count(); ++r) {
      const double x = rows.row(r)[c.a] * rows.row(r)[c.b];
      sum += x / 40000;
      square += x * x / 40000;
    }
    worst = std::max(worst, std::abs(sum - exact.pair_mean[k]) / std::sqrt((square - sum * sum) / 40000));
  }
  std::printf("%s: largest z of %zu pair moments %.2f\n", name.c_str(), problem.couplings.size(), worst);
  CHECK(worst < 4);
}

TEST_CASE("annealers' rows follow the exact distribution, also on frustrated problems") {
  const std::string name = GENERATE("anneal at fixed beta", "anneal", "tempering", "population");
  const bool dense = GENERATE(false, true);
  Problem problem = frustrated();
  if (!dense) std::erase_if(problem.couplings, [](const Coupling& c) { return c.b != c.a + 1 && c.b != c.a + 5; });
  for (Coupling& c : problem.couplings) c.value *= 2.5;
  SamplerSettings settings;
  if (name == "anneal at fixed beta") settings["beta_start"] = 1.0;
  const auto sampler = make_machine_sampler(name == "anneal at fixed beta" ? "anneal" : name, settings);
  double log_z = 0;
  const std::vector<double> p = brute_force(problem, log_z);
  const std::size_t reads = 10000;
  const SampleSet rows =
      sampler->sample(problem, {.reads = reads, .seed = 3, .sweeps = name == "population" ? 1500u : 60u});
  const Fit fit = compare(rows, p);
  const double z = (fit.chi_squared - fit.degrees) / std::sqrt(2 * fit.degrees);
  double kl = 0;
  std::vector<double> count(p.size(), 0.0);
  for (std::size_t r = 0; r < reads; ++r) count[state_of(rows.row(r))] += 1.0 / double(reads);
  for (std::size_t i = 0; i < p.size(); ++i)
    if (count[i] > 0) kl += count[i] * std::log(count[i] / p[i]);
  std::printf("%s %s: chi2 z %.2f; total variation %.5f, floor %.5f +- %.5f; KL %.6f, floor %.6f nat\n", name.c_str(),
              dense ? "dense" : "ring", z, fit.total_variation, fit.floor, fit.spread, kl,
              fit.degrees / (2 * double(reads)));
  CHECK(std::abs(z) < 4);
  CHECK(fit.total_variation < fit.floor + 4 * fit.spread);
  const ExactMoments exact = exact_moments(problem);
  double worst = 0;
  for (std::size_t k = 0; k < problem.couplings.size(); ++k) {
    double mean = 0;
    for (std::size_t r = 0; r < reads; ++r)
      mean += rows.row(r)[problem.couplings[k].a] * rows.row(r)[problem.couplings[k].b] / double(reads);
    worst = std::max(worst, std::abs(mean - exact.pair_mean[k]) /
                                std::sqrt((1 - exact.pair_mean[k] * exact.pair_mean[k]) / double(reads)));
  }
  std::printf("%s: largest z of %zu pair moments %.2f\n", name.c_str(), problem.couplings.size(), worst);
  CHECK(worst < 4);
  if (name == "population") CHECK(rows.info.at("log_z").number() == Approx(log_z).margin(0.02));
}

TEST_CASE("mean energies have the closed form at any scale of energies and any temperature") {
  const std::string name = GENERATE("anneal", "tempering", "population");
  const double size = GENERATE(1e-3, 1.0, 1e3), beta = GENERATE(1e-3, 1.0, 5e3);
  Problem problem;  // 20 spins in a field and 10 pairs, none of them coupled with another
  problem.vartype = Vartype::spin;
  for (std::uint32_t i = 0; i < 40; ++i) {
    problem.labels.emplace_back(std::int64_t(i));
    problem.linear.push_back(i < 20 ? size : 0);
    if (i >= 20 && i % 2 == 0) problem.couplings.push_back({i, i + 1, size});
  }
  SamplerSettings settings{{"beta_end", beta}};
  if (name == "tempering") settings["beta_start"] = beta / 100;
  constexpr std::size_t kReads = 200;
  const SampleSet rows = make_sampler(name, settings)->sample(problem, {.reads = kReads, .seed = 5, .sweeps = 100});
  double mean = 0;
  for (std::size_t r = 0; r < kReads; ++r) mean += energy(problem, rows.row(r)) / double(kReads);
  const double expected = -30 * size * std::tanh(beta * size);
  const double spread = std::sqrt(30.0) * size / std::cosh(std::min(beta * size, 300.0));
  INFO(name << ", fields of " << size << ", beta " << beta << ": mean " << mean << ", expected " << expected);
  CHECK(std::abs(mean - expected) < 5 * spread / std::sqrt(double(kReads)) + 1e-9 * size);
}

TEST_CASE("rows of every sampler of any problem are the same bits for any threads") {
  const std::string name = GENERATE(from_range(
      sampler_names([](const SamplerKind& kind) { return kind.any_problem && kind.origin == RowOrigin::here; })));
  const Problem problem = frustrated();
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const SampleSet one = make_sampler(name)->sample(problem, {.reads = 9, .seed = 9, .sweeps = 60});
  omp_set_num_threads(3);
  const SampleSet three = make_sampler(name)->sample(problem, {.reads = 9, .seed = 9, .sweeps = 60});
  omp_set_num_threads(threads);
  CHECK(one == three);
  if (!sampler_named(name).follows_energies) return;  // every seed may find the same optimum
  CHECK(!(make_sampler(name)->sample(problem, {.reads = 9, .seed = 10, .sweeps = 60}) == one));
}

TEST_CASE("a biased sampler would fail the test above") {
  RbmWeights machine = toy_machine();
  const Problem problem = to_qubo(machine, toy_labels());
  machine.weight[5] += 0.15;
  double log_z = 0;
  const Fit fit = compare(make_sampler("block_gibbs")->sample(problem, {.reads = 40000, .seed = 7, .sweeps = 100}),
                          brute_force(to_qubo(machine, toy_labels()), log_z));
  CHECK((fit.chi_squared - fit.degrees) / std::sqrt(2 * fit.degrees) > 4);
}

TEST_CASE("block Gibbs rows are the same bits for any threads, batch and interruption") {
  RbmWeights machine = RbmWeights::zeros(20, 11);
  for (std::size_t k = 0; k < machine.weight.size(); ++k) machine.weight[k] = random_unit(1, 2, k) - 0.5;
  std::vector<std::string> labels;
  for (int i = 0; i < 20; ++i) labels.push_back("v" + std::to_string(i));
  const Problem problem = to_qubo(machine, labels);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const SampleSet one = make_sampler("block_gibbs")->sample(problem, {.reads = 33, .seed = 9, .sweeps = 7});
  omp_set_num_threads(2);
  const SampleSet two = make_sampler("block_gibbs")->sample(problem, {.reads = 33, .seed = 9, .sweeps = 7});
  omp_set_num_threads(threads);
  CHECK(one == two);

  const SampleSet few = make_sampler("block_gibbs")->sample(problem, {.reads = 5, .seed = 9, .sweeps = 7});
  CHECK(std::equal(few.values.begin(), few.values.end(), one.values.begin()));

  const SampleSet begun = make_sampler("block_gibbs")->sample(problem, {.reads = 33, .seed = 9, .sweeps = 3});
  const SampleSet ended =
      make_sampler("block_gibbs")
          ->sample(problem, {.reads = 33, .seed = 9, .sweeps = 4, .start = &begun, .first_sweep = 3});
  CHECK(ended == one);
  CHECK_FALSE(make_sampler("block_gibbs")->sample(problem, {.reads = 33, .seed = 10, .sweeps = 7}) == one);
}

TEST_CASE("samplers refuse what they cannot do") {
  CHECK_THROWS_AS(make_sampler("block_gibbs")->sample(frustrated(), {}), InputError);
  refused([] { make_sampler("annealer"); }, "did you mean \"anneal\"?");
  const RbmWeights large = RbmWeights::zeros(40, 30);
  CHECK_THROWS_AS(exact_moments(to_qubo(large, std::vector<std::string>(40, "v"))), InputError);
}

TEST_CASE("a sampler's settings are complete, of their types and in range") {
  refused([] { make_sampler("anneal", {{"replicas", std::int64_t(3)}}); }, "it has beta_start, beta_end");
  refused([] { make_sampler("tempering", {{"replicas", std::int64_t(1)}}); }, "replicas must be at least 2, found 1");
  refused([] { make_sampler("tempering", {{"replicas", 2.5}}); }, "replicas must be a whole number");
  refused([] { make_sampler("anneal", {{"beta_end", double(NAN)}}); }, "finite");
  refused([] { make_sampler("file"); }, "no folder is given");
  refused(
      [] {
        make_sampler("command", {{"program", std::vector<std::string>{"true"}}, {"time_limit_s", 0.0}});
      },
      "time_limit_s must be above 0");
  CHECK_NOTHROW(make_sampler("anneal", {{"beta_end", std::int64_t(2)}}));
  for (const SamplerKind* kind : samplers()) {
    CAPTURE(kind->name);
    CHECK(&sampler_named(kind->name) == kind);
    CHECK(std::string(kind->about).back() == '.');
    for (const SamplerParameter& parameter : kind->parameters)  // one option, one meaning
      for (const SamplerKind* other : samplers())
        for (const SamplerParameter& same : other->parameters)
          CHECK((std::string(parameter.option) == same.option) == (std::string(parameter.name) == same.name));
  }
}
