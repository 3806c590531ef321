#include "learning/model/posterior.h"

#include <omp.h>

#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/math/random.h"
#include "learning/score/score.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

constexpr double kUnknown = NAN;

VisibleLayout small_layout() {
  return VisibleLayout(
      {Encoder::by_range("a", "-", Code::thermometer, 4, 0, 4), Encoder::by_range("b", "-", Code::gray, 4, 0, 4),
       Encoder::categorical("c", {"x", "y", "z"}), Encoder::by_range("fixed", "m", Code::thermometer, 3, 1, 1)},
      {"go", "slow_go", "no_go"});
}

RbmWeights random_machine(std::size_t visible, std::size_t hidden, double size, std::uint64_t seed) {
  RbmWeights machine = RbmWeights::zeros(visible, hidden);
  std::uint64_t k = 0;
  for (auto* part : {&machine.weight, &machine.visible_bias, &machine.hidden_bias})
    for (double& w : *part) w = size * (2 * random_unit(seed, 1, k++) - 1);
  return machine;
}

/// P(outcome | known bins) by enumerating all visible and hidden states, valid codes only.
std::vector<double> brute_force(const VisibleLayout& layout, const RbmWeights& machine,
                                const std::vector<double>& variables) {
  std::vector<double> p(layout.outcome_count(), 0.0);
  const std::size_t visible = machine.visible_count, hidden = machine.hidden_count;
  for (std::size_t state = 0; state < std::size_t(1) << visible; ++state) {
    std::vector<Bit> row(visible);
    for (std::size_t i = 0; i < visible; ++i) row[i] = state >> i & 1;
    const DecodedRow decoded = layout.decode(row);
    if (!decoded.valid) continue;
    bool match = true;
    for (std::size_t v = 0; v < variables.size(); ++v)
      match &= std::isnan(variables[v]) || decoded.values[v] == variables[v];
    if (!match) continue;
    for (std::size_t h = 0; h < std::size_t(1) << hidden; ++h) {
      double e = 0;
      for (std::size_t i = 0; i < visible; ++i) {
        e -= machine.visible_bias[i] * row[i];
        for (std::size_t j = 0; j < hidden; ++j) e -= machine.weight[i * hidden + j] * row[i] * double(h >> j & 1);
      }
      for (std::size_t j = 0; j < hidden; ++j) e -= machine.hidden_bias[j] * double(h >> j & 1);
      p[*decoded.outcome] += std::exp(-e);
    }
  }
  const double z = p[0] + p[1] + p[2];
  for (double& x : p) x /= z;
  return p;
}

}  // namespace

TEST_CASE("P(outcome | any subset of variables) equals enumeration of the machine") {
  const VisibleLayout layout = small_layout();
  const double size = GENERATE(0.5, 3.0, 30.0);  // the largest needs the overflow-safe path
  const RbmWeights machine = random_machine(layout.unit_count(), 5, size, 11);
  const Posterior posterior(layout, machine);
  for (int subset = 0; subset < 8; ++subset) {
    std::vector<double> x = {2.5, 0.5, 1, 1};
    for (std::size_t v = 0; v < 3; ++v)
      if (subset >> v & 1) x[v] = kUnknown;
    const auto expected = brute_force(layout, machine, x);
    const PosteriorAnswer answer = posterior.marginal(x);
    CHECK(answer.exact);
    for (std::size_t y = 0; y < 3; ++y)
      CHECK(answer.probability[y] == Approx(expected[y]).epsilon(1e-10).margin(1e-14));
    if (subset == 0) {
      std::vector<double> direct(3);
      posterior(x, direct);
      for (std::size_t y = 0; y < 3; ++y) CHECK(direct[y] == Approx(expected[y]).epsilon(1e-10).margin(1e-14));
    }
  }
}

TEST_CASE("weights that double cannot multiply out are summed in logarithms") {
  // Fields of +-900 that cancel: a product on its way would leave the range of double, what it comes to would not.
  const VisibleLayout layout({Encoder::categorical("a", {"x", "y"}), Encoder::categorical("b", {"x", "y"})},
                             {"go", "no_go"});
  for (const double size : {1.0, 20.0, 300.0, 900.0}) {
    RbmWeights machine = RbmWeights::zeros(layout.unit_count(), 2);
    for (std::size_t i = 0; i < 4; ++i) {
      machine.weight[i * 2] = i < 2 ? size : -size;
      machine.weight[i * 2 + 1] = (i < 2 ? -1.01 : 1) * size + double(i);
      machine.visible_bias[i] = 0.3 * double(i);
    }
    for (std::size_t i = 4; i < 6; ++i) machine.weight[i * 2] = machine.weight[i * 2 + 1] = 0.5 * double(i) - 2;
    const Posterior posterior(layout, machine);
    for (const std::vector<double>& x : {std::vector<double>{kUnknown, kUnknown}, {0, kUnknown}, {kUnknown, 1}}) {
      INFO("size " << size);
      // By hand, in logarithms.
      std::vector<double> log_p(2, -INFINITY);
      for (int a = 0; a < 2; ++a)
        for (int b = 0; b < 2; ++b)
          for (std::size_t y = 0; y < 2; ++y) {
            if ((!std::isnan(x[0]) && x[0] != a) || (!std::isnan(x[1]) && x[1] != b)) continue;
            const bool known_a = !std::isnan(x[0]), known_b = !std::isnan(x[1]);
            double term = (known_a ? 0 : 0.3 * a) + (known_b ? 0 : 0.3 * (2 + b));
            for (std::size_t j = 0; j < 2; ++j)
              term += softplus(machine.weight[std::size_t(a) * 2 + j] + machine.weight[std::size_t(2 + b) * 2 + j] +
                               machine.weight[(4 + y) * 2 + j]);
            log_p[y] = log_sum_exp(std::vector<double>{log_p[y], term});
          }
      const double total = log_sum_exp(log_p);
      const auto answer = posterior.marginal(x).probability;
      for (std::size_t y = 0; y < 2; ++y) CHECK(answer[y] == Approx(std::exp(log_p[y] - total)).epsilon(1e-9));
    }
  }
}

TEST_CASE("all unknown variables at once: enumeration of the machine, with and without a known outcome") {
  const VisibleLayout layout = small_layout();
  const RbmWeights machine = random_machine(layout.unit_count(), 5, 2.0, 11);
  const Posterior posterior(layout, machine);
  const std::vector<double> x = {kUnknown, kUnknown, 1, 1};
  // P(a = bin, outcome) by asking the outcome of every bin of a, weighted by P(a = bin).
  const JointAnswer free = posterior.joint(x, std::nullopt), given = posterior.joint(x, 2);
  CHECK(free.exact);
  double total = 0, of_given = 0, mean = 0;
  for (int bin = 0; bin < 4; ++bin) {
    std::vector<double> known = x;
    known[0] = bin + 0.5;
    const double p_bin = free.variables[0].probability[std::size_t(bin)];
    const double joint = p_bin * brute_force(layout, machine, known)[2];
    total += p_bin;
    of_given += joint;
    mean += p_bin * (bin + 0.5);
    CHECK(joint / brute_force(layout, machine, x)[2] ==
          Approx(given.variables[0].probability[std::size_t(bin)]).epsilon(1e-9));
  }
  CHECK(total == Approx(1));
  CHECK(of_given == Approx(free.outcome.probability[2]).epsilon(1e-9));
  CHECK(free.variables[0].mean == Approx(mean));
  CHECK(free.variables[0].low <= free.variables[0].mean);
  CHECK(free.variables[2].probability.empty());
  for (std::size_t y = 0; y < 3; ++y)
    CHECK(free.outcome.probability[y] == Approx(brute_force(layout, machine, x)[y]).epsilon(1e-9));
  CHECK(given.outcome.probability[2] == Approx(1));
  CHECK(given.outcome.probability[0] == 0);

  MarginalOptions sampled;
  sampled.max_terms = 1;
  for (const auto& outcome : {std::optional<std::size_t>(), std::optional<std::size_t>(2)}) {
    const JointAnswer exact = posterior.joint(x, outcome), estimate = posterior.joint(x, outcome, sampled);
    CHECK_FALSE(estimate.exact);
    for (std::size_t v : {0, 1})
      for (std::size_t bin = 0; bin < 4; ++bin) {
        const double error = estimate.variables[v].standard_error[bin];
        CHECK(error < 0.02);
        CHECK(std::abs(estimate.variables[v].probability[bin] - exact.variables[v].probability[bin]) <
              4.5 * error + 1e-9);
      }
  }
}

TEST_CASE("with a prior unknown variables are summed out over it, whatever the machine says of its inputs") {
  const VisibleLayout layout = small_layout();
  const RbmWeights machine = random_machine(layout.unit_count(), 5, 2.0, 11);
  const InputPrior prior = {{0.1, 0.2, 0.3, 0.4}, {0.7, 0, 0.2, 0.1}, {0.25, 0.25, 0.5}, {1}};
  const Posterior posterior(layout, machine, prior);
  const std::vector<double> x = {kUnknown, kUnknown, 1, 1};
  std::vector<double> expected(3, 0.0), of_a(4, 0.0);  // P(outcome); P(bin of a, third outcome)
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t b = 0; b < 4; ++b) {
      const auto p = brute_force(layout, machine, {double(a) + 0.5, double(b) + 0.5, 1, 1});
      for (std::size_t y = 0; y < 3; ++y) expected[y] += prior[0][a] * prior[1][b] * p[y];
      of_a[a] += prior[0][a] * prior[1][b] * p[2];
    }
  const PosteriorAnswer answer = posterior.marginal(x);
  const JointAnswer free = posterior.joint(x, std::nullopt), given = posterior.joint(x, 2);
  for (std::size_t y = 0; y < 3; ++y) {
    CHECK(answer.probability[y] == Approx(expected[y]).epsilon(1e-10));
    CHECK(free.outcome.probability[y] == Approx(expected[y]).epsilon(1e-10));
  }
  for (std::size_t a = 0; a < 4; ++a) {
    CHECK(free.variables[0].probability[a] == Approx(prior[0][a]).epsilon(1e-10));
    CHECK(given.variables[0].probability[a] == Approx(of_a[a] / expected[2]).epsilon(1e-10));
  }
  CHECK(given.variables[1].probability[1] == 0);
  std::vector<double> direct(3), own(3);
  posterior(std::vector<double>{1.2, 0.3, 1, 1}, direct);
  Posterior(layout, machine)(std::vector<double>{1.2, 0.3, 1, 1}, own);
  CHECK(direct == own);  // nothing unknown: the prior says nothing

  MarginalOptions drawn;
  drawn.max_terms = 1;
  for (const auto& outcome : {std::optional<std::size_t>(), std::optional<std::size_t>(2)}) {
    const JointAnswer exact = posterior.joint(x, outcome), estimate = posterior.joint(x, outcome, drawn);
    CHECK_FALSE(estimate.exact);
    for (std::size_t v : {0, 1})
      for (std::size_t bin = 0; bin < 4; ++bin) {
        const double error = estimate.variables[v].standard_error[bin];
        CHECK(error < 0.01);
        CHECK(std::abs(estimate.variables[v].probability[bin] - exact.variables[v].probability[bin]) <=
              4.5 * error + 1e-12);
      }
    for (std::size_t y = 0; y < 3; ++y)
      CHECK(std::abs(estimate.outcome.probability[y] - exact.outcome.probability[y]) <=
            4.5 * estimate.outcome.standard_error[y] + 1e-12);
  }
  CHECK_THROWS_AS(Posterior(layout, machine, {{1}, {1}}), InputError);
  CHECK_THROWS_AS(Posterior(layout, machine, {{0.1, 0.2, 0.3, 0.3}, prior[1], prior[2], {1}}), InputError);
  const InputPrior uniform = uniform_prior(VisibleLayout(
      {Encoder::by_edges("a", "-", Code::thermometer, {1, 3}, 0, 4), Encoder::categorical("c", {"x", "y", "z", "w"})},
      {"go", "no_go"}));
  CHECK(uniform[0] == std::vector<double>{0.25, 0.5, 0.25});
  CHECK(uniform[1] == std::vector<double>(4, 0.25));
}

TEST_CASE("many combinations and outcomes are summed as the mean of single answers") {
  std::vector<Encoder> encoders;
  for (const int bins : {5, 5, 9, 3, 5})
    encoders.push_back(Encoder::by_range("v" + std::to_string(bins), "-", Code::thermometer, bins, 0, bins));
  const VisibleLayout layout(encoders, {"a", "b", "c", "d", "e", "f", "g"});
  const Posterior posterior(layout, random_machine(layout.unit_count(), 11, 1.5, 3), uniform_prior(layout));
  const std::vector<double> asked = {2.3, kUnknown, kUnknown, kUnknown, kUnknown};
  std::vector<double> x = asked, p(7), expected(7, 0.0);
  for (int k = 0; k < 5 * 9 * 3 * 5; ++k) {
    for (std::size_t v = 1, rest = std::size_t(k); v < 5; ++v) {
      const auto bins = std::size_t(encoders[v].bin_count());
      x[v] = encoders[v].value(int(rest % bins));
      rest /= bins;
    }
    posterior(x, p);
    for (std::size_t y = 0; y < 7; ++y) expected[y] += p[y] / (5 * 9 * 3 * 5);
  }
  const std::vector<double> answer = posterior.marginal(asked).probability;
  for (std::size_t y = 0; y < 7; ++y) CHECK(answer[y] == Approx(expected[y]).epsilon(1e-12));
}

namespace {

VisibleLayout slope_layout() {
  return VisibleLayout({Encoder::by_range("along", "deg", Code::thermometer, 9, -20, 30),
                        Encoder::by_range("load", "kg", Code::thermometer, 5, 0, 1),
                        Encoder::by_range("across", "deg", Code::thermometer, 5, -20, 20),
                        Encoder::by_range("depth", "m", Code::thermometer, 5, 0, 1),
                        Encoder::by_range("fixed", "m", Code::thermometer, 3, 1, 1)},
                       {"go", "slow_go", "sinkage", "traction", "power", "timeout"});
}

std::vector<double> every(double first, double last, double step) {
  std::vector<double> values;
  for (int i = 0; first + i * step <= last; ++i) values.push_back(first + i * step);
  return values;
}

/// Largest difference of on_grid() to marginal() at every node.
double grid_error(const Posterior& posterior, std::vector<double> x, const std::vector<double>& along,
                  const std::vector<double>& across) {
  const std::size_t outcomes = posterior.outcome_count();
  std::vector<double> answers(along.size() * across.size() * outcomes);
  posterior.on_grid(x, {0, 2, along, across}, answers);
  double most = 0;
  for (std::size_t n = 0; n < along.size() * across.size(); ++n) {
    x[0] = along[n / across.size()];
    x[2] = across[n % across.size()];
    const PosteriorAnswer expected = posterior.marginal(x);
    for (std::size_t y = 0; y < outcomes; ++y)
      most = std::max(most, std::abs(answers[n * outcomes + y] - expected.probability[y]));
  }
  return most;
}

}  // namespace

TEST_CASE("on a grid of known variables every node is the answer at its point") {
  const VisibleLayout layout = slope_layout();
  const double size = GENERATE(0.5, 3.0, 300.0);  // products of the largest leave the range of double
  const Posterior posterior(layout, random_machine(layout.unit_count(), 12, size, 21), uniform_prior(layout));
  const std::vector<double> x = {kUnknown, 0.3, kUnknown, 0.8, 1};  // the grid's own do not count
  CHECK(grid_error(posterior, x, every(-25, 35, 1.3), every(-25, 25, 1.7)) < 1e-12);
  CHECK(grid_error(posterior, x, {3.5}, every(-25, 25, 0.5)) < 1e-12);
  CHECK(grid_error(posterior, x, every(-25, 35, 0.5), {0}) < 1e-12);
}

TEST_CASE("on a grid with unknown variables sums are interpolated within the stated error") {
  const VisibleLayout layout = slope_layout();
  const double size = GENERATE(0.5, 3.0);
  const bool with_prior = GENERATE(true, false);
  const Posterior posterior(layout, random_machine(layout.unit_count(), 12, size, 22),
                            with_prior ? uniform_prior(layout) : InputPrior());
  const std::vector<double> x = {kUnknown, kUnknown, kUnknown, kUnknown, 1};
  CHECK(grid_error(posterior, x, every(-25, 35, 0.5), every(-25, 25, 0.5)) < kGridError);
  CHECK(grid_error(posterior, x, every(0, 35, 1 / 32.), {0}) < kGridError);
  // A grid too coarse to interpolate on is summed node by node.
  CHECK(grid_error(posterior, x, every(-25, 35, 13), every(-25, 25, 17)) == 0);
}

TEST_CASE("a grid has the same bits for any number of threads") {
  const VisibleLayout layout = slope_layout();
  const Posterior posterior(layout, random_machine(layout.unit_count(), 12, 2, 23), uniform_prior(layout));
  const std::vector<double> x = {0, kUnknown, 0, kUnknown, 1}, along = every(-25, 35, 0.5), across = every(-25, 25, 1);
  std::vector<std::vector<double>> answers;
  for (const int threads : {1, 2, 5}) {
    omp_set_num_threads(threads);
    answers.emplace_back(along.size() * across.size() * posterior.outcome_count());
    posterior.on_grid(x, {0, 2, along, across}, answers.back());
  }
  CHECK(answers[1] == answers[0]);
  CHECK(answers[2] == answers[0]);
}

TEST_CASE("tempering answers where clamped chains without it stay in the mode they start in") {
  // Outcome and variable agree in one of two modes that are held by strong weights: P = 1/2 each by symmetry.
  const VisibleLayout layout({Encoder::by_range("a", "-", Code::thermometer, 9, 0, 9)}, {"go", "no_go"});
  RbmWeights machine = RbmWeights::zeros(10, 3);
  for (std::size_t j = 0; j < 3; ++j) {
    for (std::size_t i = 0; i < 8; ++i) machine.weight[i * 3 + j] = 3;
    machine.weight[8 * 3 + j] = 8;
    machine.hidden_bias[j] = -16;
  }
  for (std::size_t i = 0; i < 8; ++i) machine.visible_bias[i] = -4.5;
  machine.visible_bias[8] = -12;
  const Posterior posterior(layout, machine);
  MarginalOptions options{.max_terms = 1, .chains = 64, .sweeps = 300, .burn_in = 50, .rungs = 10, .seed = 3};
  const std::vector<double> x = {kUnknown};
  const double exact = posterior.joint(x, std::nullopt).outcome.probability[0];
  const PosteriorAnswer tempered = posterior.joint(x, std::nullopt, options).outcome;
  std::printf("two modes: exact %.3f, tempered %.3f +- %.3f\n", exact, tempered.probability[0],
              tempered.standard_error[0]);
  CHECK(std::abs(tempered.probability[0] - exact) < 4 * tempered.standard_error[0] + 0.01);
  CHECK(tempered.standard_error[0] < 0.03);
}

TEST_CASE("clamped Gibbs agrees with summation within its stated error, for any number of threads") {
  const VisibleLayout layout = small_layout();
  const RbmWeights machine = random_machine(layout.unit_count(), 6, 1.5, 3);
  const Posterior posterior(layout, machine);
  const std::vector<double> x = {kUnknown, kUnknown, 1, 1};
  MarginalOptions sampled;
  sampled.max_terms = 1;
  const PosteriorAnswer exact = posterior.marginal(x), estimate = posterior.marginal(x, sampled);
  CHECK_FALSE(estimate.exact);
  for (std::size_t y = 0; y < 3; ++y) {
    std::printf("outcome %zu: exact %.5f, clamped Gibbs %.5f +- %.5f\n", y, exact.probability[y],
                estimate.probability[y], estimate.standard_error[y]);
    CHECK(estimate.standard_error[y] < 0.02);
    CHECK(std::abs(estimate.probability[y] - exact.probability[y]) < 4 * estimate.standard_error[y] + 1e-9);
  }
  const int threads = omp_get_max_threads();
  omp_set_num_threads(2);
  const auto two = posterior.marginal(x, sampled).probability;
  omp_set_num_threads(1);
  const auto one = posterior.marginal(x, sampled).probability;
  omp_set_num_threads(threads);
  CHECK(one == two);
}

TEST_CASE("probabilities are continuous in a number and clamp beyond the end bins") {
  const VisibleLayout layout = small_layout();
  const Posterior posterior(layout, random_machine(layout.unit_count(), 6, 2, 5));
  std::vector<double> before, now(3);
  for (double a = -1; a <= 5; a += 0.001) {
    posterior(std::vector<double>{a, 1.3, 2, 1}, now);
    for (std::size_t y = 0; y < before.size(); ++y) CHECK(std::abs(now[y] - before[y]) < 0.02);
    before = now;
  }
  std::vector<double> low(3), lower(3);
  posterior(std::vector<double>{0.5, 1.3, 2, 1}, low);
  posterior(std::vector<double>{-7, 1.3, 2, 1}, lower);
  CHECK(low == lower);
}

TEST_CASE("scores of hand-made forecasts") {
  const std::vector<double> p = {0.9, 0.8, 0.3, 0.1};
  const std::vector<int> y = {1, 0, 0, 0};
  CHECK(brier_score(p, y) == Approx((0.01 + 0.64 + 0.09 + 0.01) / 4));
  CHECK(log_loss(p, y) == Approx(-(std::log(0.9) + std::log(0.2) + std::log(0.7) + std::log(0.9)) / 4));
  CHECK(accuracy(p, y) == Approx(0.75));
  const auto bins = reliability(p, y, 2);
  REQUIRE(bins.size() == 2);
  CHECK(bins[0].mean_forecast == Approx(0.2));
  CHECK(bins[0].frequency == Approx(0));
  CHECK(bins[1].frequency == Approx(0.5));
  CHECK(bins[1].low == Approx(0.0945312).epsilon(1e-4));  // Wilson interval of 1 in 2
  CHECK(bins[1].high == Approx(0.9054688).epsilon(1e-4));
  CHECK(calibration_error(bins) == Approx((0.2 + 0.35) / 2));
}

TEST_CASE("the score floor is what perfectly calibrated forecasts reach") {
  std::vector<double> p;
  double variance = 0;
  for (int i = 0; i < 200; ++i) {
    p.push_back((i + 0.5) / 200);
    variance += p.back() * (1 - p.back()) / 200;
  }
  const ScoreFloor floor = score_floor(p, 10, 1);
  CHECK(floor.brier_mean == Approx(variance).epsilon(0.02));
  CHECK(floor.calibration_mean > 0.02);
  int inside = 0;
  for (std::uint64_t trial = 0; trial < 200; ++trial) {
    std::vector<int> y;
    for (std::size_t i = 0; i < p.size(); ++i) y.push_back(random_unit(77, trial, i) < p[i]);
    inside += calibration_error(reliability(p, y, 10)) <= floor.calibration_high;
  }
  CHECK(inside >= 178);  // 95 % of 200, minus four standard deviations
  CHECK(inside <= 200);
}

TEST_CASE("quantiles and deviation of an unknown variable spread probability over the width of its bins") {
  const VisibleLayout layout({Encoder::by_range("a", "-", Code::thermometer, 5, 10, 20),
                              Encoder::by_edges("b", "-", Code::thermometer, {1, 7}, 0, 8)},
                             {"go", "no_go"});
  const RbmWeights nothing = RbmWeights::zeros(layout.unit_count(), 2);  // outcomes say nothing: the prior stays
  const std::vector<double> x = {kUnknown, kUnknown};
  const JointAnswer even = Posterior(layout, nothing, uniform_prior(layout)).joint(x, 1);
  CHECK(even.variables[0].low == Approx(10.5));
  CHECK(even.variables[0].high == Approx(19.5));
  CHECK(even.variables[0].deviation == Approx(10 / std::sqrt(12.0)));
  CHECK(even.variables[1].low == Approx(0.4));
  CHECK(even.variables[1].high == Approx(7.6));
  CHECK(even.variables[1].deviation == Approx(8 / std::sqrt(12.0)));
  // 0.5 in the first bin of b, 0.5 in the last: a tenth and nine tenths of them are below the quantiles.
  const JointAnswer ends = Posterior(layout, nothing, {{0, 0, 1, 0, 0}, {0.5, 0, 0.5}}).joint(x, 0);
  CHECK(ends.variables[0].low == Approx(14.1));
  CHECK(ends.variables[0].high == Approx(15.9));
  CHECK(ends.variables[1].low == Approx(0.1));
  CHECK(ends.variables[1].high == Approx(7.9));
}
