#include "learning/rbm/train.h"
#include "tests/learning/machine_likelihood.h"

#include <omp.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <memory>

#include "base/error.h"
#include "base/math/random.h"
#include "learning/rbm/regression/baselines.h"
#include "learning/sampler/exact.h"
#include "learning/score/score.h"
#include "tests/learning/smooth_boundary.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

/// Variables of one unit each: rows are free bit patterns.
VisibleLayout bit_layout(int bits) {
  std::vector<Encoder> encoders;
  for (int i = 0; i < bits; ++i)
    encoders.push_back(Encoder::by_range("bit" + std::to_string(i), "-", Code::thermometer, 2, 0, 1));
  return VisibleLayout(std::move(encoders), {"no", "yes"});
}

TrainingTable bit_table(const std::vector<std::vector<int>>& rows) {
  TrainingTable table;
  table.variable_count = rows.front().size() - 1;
  for (const auto& row : rows) {
    for (std::size_t v = 0; v + 1 < row.size(); ++v) table.variables.push_back(row[v] ? 0.75 : 0.25);
    table.outcome.push_back(std::size_t(row.back()));
    table.weight.push_back(1);
    table.group.push_back(table.group.size());
  }
  return table;
}

double p_go(const Posterior& posterior, std::span<const double> x) {
  std::vector<double> p(posterior.outcome_count());
  posterior(x, p);
  return p[0] + p[1];
}

}  // namespace

TEST_CASE("the gradient equals finite differences of the objective, also with unknown variables") {
  const VisibleLayout layout(
      {Encoder::by_range("a", "-", Code::thermometer, 4, 0, 4), Encoder::by_range("b", "-", Code::one_hot, 3, 0, 3)},
      {"go", "slow", "no"});
  TrainingTable table;
  table.variable_count = 2;
  table.variables = {0.3, 1.2, 2.7, NAN, NAN, NAN, 3.9, 0.1, 1.4, 2.2};
  table.outcome = {0, 1, 2, 2, 0};
  table.weight = {1, 0.5, 2, 1, 0.5};
  table.group = {0, 1, 2, 3, 4};
  TrainingSettings settings;
  settings.generative = 0.3;
  RbmWeights machine = RbmWeights::zeros(layout.unit_count(), 4);
  std::uint64_t k = 0;
  for (auto* part : {&machine.weight, &machine.visible_bias, &machine.hidden_bias})
    for (double& w : *part) w = random_unit(4, 4, k++) - 0.5;
  const SampleSet negative =
      make_sampler("exact")->sample(to_qubo(machine, layout.unit_labels()), {.reads = 30, .seed = 2});
  const Objective at = training_objective(machine, layout, table, settings, negative);
  const auto check = [&](std::vector<double> RbmWeights::*part) {
    for (std::size_t i = 0; i < (machine.*part).size(); ++i) {
      RbmWeights up = machine, down = machine;
      (up.*part)[i] += 1e-5;
      (down.*part)[i] -= 1e-5;
      const double difference = (training_objective(up, layout, table, settings, negative).value -
                                 training_objective(down, layout, table, settings, negative).value) /
                                2e-5;
      CHECK((at.gradient.*part)[i] == Approx(difference).epsilon(1e-6).margin(1e-8));
    }
  };
  check(&RbmWeights::weight);
  check(&RbmWeights::visible_bias);
  check(&RbmWeights::hidden_bias);

  // The conditional term alone, against the posterior that answers questions.
  settings.generative = 0;
  settings.weight_decay = 0;
  CHECK(training_objective(machine, layout, table, settings, negative).value * 5 ==
        Approx(conditional_loss(Posterior(layout, machine),
                                [&] {
                                  TrainingTable known = table.subset({0, 4});
                                  return known;
                                }()) *
                   1.5 +
               0.5 * conditional_loss(Posterior(layout, machine),
                                      [&] {
                                        TrainingTable part = table.subset({1});
                                        part.variables = {2.7, NAN};
                                        return part;
                                      }()) +
               2 * conditional_loss(Posterior(layout, machine), table.subset({2})) +
               conditional_loss(Posterior(layout, machine), table.subset({3})))
            .epsilon(1e-10));
}

TEST_CASE("the prior on weights is one of functions of the value, whatever the code") {
  const std::size_t hidden = 3;
  TrainingTable table;
  table.variable_count = 1;
  table.variables = {3.2, 0.4};
  table.outcome = {0, 1};
  table.weight = {1, 1};
  table.group = {0, 1};
  TrainingSettings settings;
  settings.hidden = hidden;
  settings.generative = 0;
  settings.discriminative = 1e-12;  // nearly the prior alone
  settings.weight_decay = 1.7;
  // f_j(bin) rises by steps a_j: one weight for each edge of a thermometer, 2^k a_j for unit k of a binary code.
  const std::vector<double> rise = {0.3, -0.8, 0.5};
  const auto prior = [&](Code code) {
    const VisibleLayout layout({Encoder::by_range("x", "-", code, 8, 0, 8)}, {"go", "no"});
    RbmWeights weights = RbmWeights::zeros(layout.unit_count(), hidden);
    for (std::size_t k = 0; k < layout.input_unit_count(); ++k)
      for (std::size_t j = 0; j < hidden; ++j)
        weights.weight[k * hidden + j] = rise[j] * (code == Code::binary ? double(1 << k) : 1);
    weights.weight.back() = 0.4;
    return training_objective(weights, layout, table, settings, {}).value;
  };
  double expected = 0.4 * 0.4;
  for (const double a : rise) expected += 7 * a * a;
  CHECK(prior(Code::thermometer) == Approx(1.7 / 4 * expected).epsilon(1e-10));
  CHECK(prior(Code::binary) == Approx(1.7 / 4 * expected).epsilon(1e-10));
}

TEST_CASE("persistent chains reach the maximum likelihood of a tiny problem") {
  // Even parity of three bits beside a copy of the first: 8 patterns of equal probability, entropy log 8; an
  // independent model cannot beat 4 log 2.
  std::vector<std::vector<int>> rows;
  for (int s = 0; s < 8; ++s)
    rows.push_back({s & 1, s >> 1 & 1, s >> 2 & 1, s & 1, (s & 1) + (s >> 1 & 1) + (s >> 2 & 1) >= 2});
  const VisibleLayout layout = bit_layout(4);
  const TrainingTable table = bit_table(rows);
  std::vector<double> visible;
  for (const auto& row : rows) {
    visible.insert(visible.end(), row.begin(), row.end() - 1);
    visible.push_back(1 - row.back());
    visible.push_back(row.back());
  }
  TrainingSettings settings;
  settings.hidden = 10;
  settings.discriminative = 0;
  settings.generative = 1;
  settings.weight_decay = 0.02;
  settings.batch = 8;
  settings.epochs = 2000;
  settings.report_every = 2000;
  settings.learning_rate = 0.01;
  settings.chains = 500;
  settings.sweeps = 20;
  const double best = -std::log(8.0), independent = -5 * std::log(2.0);
  const auto reached = [&](const std::string& sampler) {
    return mean_log_likelihood(train_rbm(layout, table, settings, *make_sampler(sampler)).weights, visible);
  };
  const double exact = reached("exact"), gibbs = reached("block_gibbs");
  std::printf(
      "log-likelihood per row: best possible %.4f, exact samples %.4f, persistent block Gibbs %.4f, independent "
      "units %.4f\n",
      best, exact, gibbs, independent);
  CHECK(exact < best + 1e-9);
  CHECK(exact > best - 0.13);
  CHECK(gibbs > exact - 0.2);
}

TEST_CASE("training gives the same bits with one and two threads, and others for another seed") {
  const VisibleLayout layout = boundary_layout();
  const TrainingTable table = boundary_table(60, 3);
  TrainingSettings settings;
  settings.epochs = 20;
  const auto sampler = make_sampler("block_gibbs");
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const TrainingResult one = train_rbm(layout, table, settings, *sampler);
  omp_set_num_threads(2);
  const TrainingResult two = train_rbm(layout, table, settings, *sampler);
  CHECK(omp_get_max_threads() == 2);
  omp_set_num_threads(threads);
  CHECK(one.weights == two.weights);
  settings.seed = 2;
  CHECK_FALSE(train_rbm(layout, table, settings, *sampler).weights == one.weights);
}

TEST_CASE("folds keep replicates together and are balanced") {
  TrainingTable table = boundary_table(100, 1);
  for (std::size_t n = 0; n < 100; n += 10) table.group[n + 1] = table.group[n];
  const auto fold = assign_folds(table, 5, 3);
  std::vector<int> size(5, 0);
  for (std::size_t n = 0; n < 100; ++n) ++size[fold[n]];
  for (int count : size) CHECK(std::abs(count - 20) <= 2);
  for (std::size_t n = 0; n < 100; n += 10) CHECK(fold[n] == fold[n + 1]);
}

TEST_CASE("logistic regression recovers known coefficients") {
  const TrainingTable table = boundary_table(20000, 5);
  std::vector<int> go;
  for (std::size_t y : table.outcome) go.push_back(y < 2);
  const LogisticModel model = fit_logistic(table, go);
  CHECK(model.weight[0] / model.scale[0] == Approx(-0.28).epsilon(0.05));
  CHECK(model.weight[2] / model.scale[2] == Approx(0.14).epsilon(0.05));
  CHECK(model.weight[3] / model.scale[3] == Approx(-2.0).epsilon(0.05));
  CHECK(std::abs(model.weight[1]) < 0.08);
}

TEST_CASE("logistic regression adds to log odds that are given, as far as its penalties let it") {
  const TrainingTable table = boundary_table(80, 6);
  std::vector<int> go;
  for (std::size_t y : table.outcome) go.push_back(y < 2);
  std::vector<double> given;
  for (std::size_t n = 0; n < table.row_count(); ++n) given.push_back(0.5 - 0.1 * table.row(n)[0]);
  std::vector<double> ridge(table.variable_count, 10.0);
  ridge[0] = 2;
  ridge.push_back(0.3);  // of the constant
  const LogisticModel model = fit_logistic(table, go, given, ridge);
  // The penalised likelihood is stationary there. It is concave, so that this is its maximum.
  std::vector<double> slope = ridge;
  for (std::size_t v = 0; v < slope.size(); ++v) slope[v] *= model.weight[v];
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    const double p = 1 / (1 + std::exp(-given[n] - model.log_odds(table.row(n))));
    for (std::size_t v = 0; v < slope.size(); ++v)
      slope[v] +=
          table.weight[n] * (p - go[n]) * (v < table.variable_count ? model.standardised(v, table.row(n)[v]) : 1.0);
  }
  for (const double s : slope) CHECK(std::abs(s) < 1e-8);
  CHECK(std::abs(model.weight[0]) > 0.1);
  for (double& r : ridge) r = 1e9;
  for (const double w : fit_logistic(table, go, given, ridge).weight) CHECK(std::abs(w) < 1e-6);
}

TEST_CASE("one hundred trials with a smooth boundary give smooth, monotone, calibrated probabilities") {
  const VisibleLayout layout = boundary_layout();
  const TrainingTable table = boundary_table(100, 100), fresh = boundary_table(4000, 999);
  const auto sampler = make_sampler("block_gibbs");
  TrainingSettings settings;
  const CrossValidation folds = cross_validate(layout, table, settings, *sampler, 5);
  settings.epochs = folds.best_epoch;
  const Posterior posterior(layout, train_rbm(layout, table, settings, *sampler).weights);
  std::vector<int> go, fresh_go;
  for (std::size_t y : table.outcome) go.push_back(y < 2);
  for (std::size_t y : fresh.outcome) fresh_go.push_back(y < 2);
  const LogisticModel logistic = fit_logistic(table, go);
  double base = 0;
  for (int y : go) base += y / 100.0;
  std::vector<double> p, p_logistic, truth;
  for (std::size_t n = 0; n < fresh.row_count(); ++n) {
    p.push_back(p_go(posterior, fresh.row(n)));
    p_logistic.push_back(logistic(fresh.row(n)));
    truth.push_back(true_p_go(fresh.row(n)));
  }
  const double brier = brier_score(p, fresh_go), brier_logistic = brier_score(p_logistic, fresh_go);
  const double brier_truth = brier_score(truth, fresh_go);
  const double brier_base = brier_score(std::vector<double>(p.size(), base), fresh_go);
  std::printf(
      "Brier on 4000 fresh points: machine %.4f, logistic regression %.4f, true probabilities %.4f, base rate %.4f "
      "(%zu epochs)\n",
      brier, brier_logistic, brier_truth, brier_base, folds.best_epoch);
  CHECK(brier < 0.6 * brier_base);
  CHECK(brier < brier_logistic + 0.01);

  double worst_rise = 0, worst_step = 0;
  for (std::size_t n = 0; n < 200; ++n) {
    std::vector<double> x(fresh.row(n).begin(), fresh.row(n).end());
    double last = 0, rise = 0;
    for (int k = 0; k <= 140; ++k) {
      x[0] = 0.25 * k;
      const double now = p_go(posterior, x);
      if (k > 0) {
        rise += std::max(0.0, now - last);
        worst_step = std::max(worst_step, std::abs(now - last));
      }
      last = now;
    }
    worst_rise = std::max(worst_rise, rise);
  }
  std::printf("P(go) along the slope: largest rise %.4f, largest step per quarter degree %.4f\n", worst_rise,
              worst_step);
  CHECK(worst_rise < 0.02);
  CHECK(worst_step < 0.04);
}

TEST_CASE("folds that an earlier run finished are not trained again, and the result keeps its bits") {
  const VisibleLayout layout = boundary_layout();
  const TrainingTable table = boundary_table(60, 7);
  const auto sampler = make_sampler("block_gibbs");
  TrainingSettings settings;
  settings.epochs = 20;
  std::map<std::size_t, FoldResult> kept;
  FoldStore store;
  store.keep = [&](std::size_t fold, const FoldResult& result) { kept[fold] = result; };
  const CrossValidation whole = cross_validate(layout, table, settings, *sampler, 3, {.store = store});
  REQUIRE(kept.size() == 3);
  kept.erase(1);
  std::vector<std::size_t> trained;
  store.find = [&](std::size_t fold) {
    return kept.count(fold) > 0 ? std::optional<FoldResult>(kept[fold]) : std::nullopt;
  };
  store.keep = [&](std::size_t fold, const FoldResult&) { trained.push_back(fold); };
  const CrossValidation again = cross_validate(layout, table, settings, *sampler, 3, {.store = store});
  CHECK(trained == std::vector<std::size_t>{1});
  CHECK(again.probability == whole.probability);
  CHECK(again.best_epoch == whole.best_epoch);
  for (std::size_t r = 0; r < whole.log.size(); ++r) CHECK(again.log[r].training_loss == whole.log[r].training_loss);
}

TEST_CASE("work beside the folds is done once and leaves their bits alone; its error is that of the whole") {
  const VisibleLayout layout = boundary_layout();
  const TrainingTable table = boundary_table(60, 7);
  const auto sampler = make_sampler("block_gibbs");
  TrainingSettings settings;
  settings.epochs = 20;
  int done = 0;
  const CrossValidation alone = cross_validate(layout, table, settings, *sampler, 3),
                        beside = cross_validate(layout, table, settings, *sampler, 3, {.beside = [&] { ++done; }});
  CHECK(done == 1);
  CHECK(beside.probability == alone.probability);
  CHECK_THROWS_WITH(
      cross_validate(layout, table, settings, *sampler, 3, {.beside = [] { throw InputError("beside"); }}), "beside");
}

TEST_CASE("tables that do not fit are refused") {
  const VisibleLayout layout = boundary_layout();
  const auto sampler = make_sampler("exact");
  CHECK_THROWS_AS(train_rbm(layout, TrainingTable{7, {}, {}, {}, {}, {}}, {}, *sampler), InputError);
  TrainingTable table = boundary_table(10, 1);
  table.outcome[3] = 10;
  CHECK_THROWS_AS(train_rbm(layout, table, {}, *sampler), InputError);
}
