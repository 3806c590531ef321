// Soft labels of a teacher in the training of a machine.
#include <cmath>
#include <cstdio>

#include "base/math/random.h"
#include "learning/machine/word_machine.h"
#include "learning/rbm/train.h"
#include "learning/sampler/sampler.h"
#include "tests/learning/smooth_boundary.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

const std::vector<int> kPasses = {1, 1, 0, 0, 0, 0, 0, 0, 0, 0};

/// The truth as a teacher, at `count` random points.
Teaching truth(std::size_t count, double weight) {
  Teaching teaching{
      .weight = weight, .points = boundary_table(count, 77).variables, .probability = {}, .label = kPasses};
  for (std::size_t k = 0; k < count; ++k)
    teaching.probability.push_back(
        true_p_go(std::span(teaching.points).subspan(k * kBoundaryVariables, kBoundaryVariables)));
  return teaching;
}

RbmWeights random_machine(const VisibleLayout& layout, std::size_t hidden) {
  RbmWeights weights = RbmWeights::zeros(layout.unit_count(), hidden);
  for (std::size_t k = 0; k < weights.weight.size(); ++k) weights.weight[k] = 0.5 * random_normal(3, 1, k);
  for (std::size_t k = 0; k < weights.visible_bias.size(); ++k) weights.visible_bias[k] = 0.5 * random_normal(3, 2, k);
  for (std::size_t k = 0; k < hidden; ++k) weights.hidden_bias[k] = 0.5 * random_normal(3, 3, k);
  return weights;
}

double p_go(const Posterior& posterior, std::span<const double> x) {
  const std::vector<double> p = posterior.marginal(x).probability;
  return p[0] + p[1];
}

double mean_square_error(const RbmWeights& weights, const TrainingTable& fresh) {
  const Posterior posterior(boundary_layout(), weights);
  double sum = 0;
  for (std::size_t n = 0; n < fresh.row_count(); ++n)
    sum += std::pow(p_go(posterior, fresh.row(n)) - true_p_go(fresh.row(n)), 2);
  return sum / double(fresh.row_count());
}

}  // namespace

TEST_CASE("the teacher's term is the cross entropy of the classes, and its gradient that of finite differences") {
  const VisibleLayout layout = boundary_layout();
  const TrainingTable table = boundary_table(12, 4);
  const Teaching teaching = truth(9, 2.5);
  TrainingSettings settings;
  settings.generative = 0;
  RbmWeights weights = random_machine(layout, 3);
  const auto value = [&](const RbmWeights& machine, const Teaching* taught) {
    return training_objective(machine, layout, table, settings, {}, taught).value;
  };
  const Posterior posterior(layout, weights);
  double expected = 0;
  for (std::size_t k = 0; k < teaching.probability.size(); ++k) {
    const double p = p_go(posterior, std::span(teaching.points).subspan(k * kBoundaryVariables, kBoundaryVariables));
    const double q = teaching.probability[k];
    expected -= 2.5 * (q * std::log(p) + (1 - q) * std::log(1 - p)) / double(teaching.probability.size());
  }
  CHECK(value(weights, &teaching) - value(weights, nullptr) == Approx(expected).epsilon(1e-10));
  const RbmWeights gradient = training_objective(weights, layout, table, settings, {}, &teaching).gradient;
  for (std::size_t k = 0; k < weights.weight.size(); k += 17) {
    const double h = 1e-5, before = weights.weight[k];
    weights.weight[k] = before + h;
    const double more = value(weights, &teaching);
    weights.weight[k] = before - h;
    const double less = value(weights, &teaching);
    weights.weight[k] = before;
    CHECK(gradient.weight[k] == Approx((more - less) / (2 * h)).epsilon(1e-5).margin(1e-8));
  }
}

TEST_CASE("a good teacher brings few trials nearer to the truth, and the seed decides every bit") {
  const VisibleLayout layout = boundary_layout();
  const TrainingTable table = boundary_table(60, 4), fresh = boundary_table(2000, 99);
  TrainingSettings settings;
  settings.epochs = 150;
  const Teaching teaching = truth(512, 3);
  const auto gibbs = make_sampler("block_gibbs");
  const Sampler& sampler = *gibbs;
  const RbmWeights alone = train_rbm(layout, table, settings, sampler).weights,
                   taught = train_rbm(layout, table, settings, sampler, {}, nullptr, &teaching).weights;
  const double without = mean_square_error(alone, fresh), with = mean_square_error(taught, fresh);
  std::printf("mean square error of P(go) on 2000 fresh points: alone %.4f, taught %.4f\n", without, with);
  CHECK(with < 0.5 * without);
  CHECK(taught.weight == train_rbm(layout, table, settings, sampler, {}, nullptr, &teaching).weights.weight);
  const Teaching silent = truth(512, 0);
  CHECK(alone.weight == train_rbm(layout, table, settings, sampler, {}, nullptr, &silent).weights.weight);
}

TEST_CASE("cross-validation teaches every fold by the teacher of that fold") {
  const VisibleLayout layout = boundary_layout();
  const TrainingTable table = boundary_table(40, 4);
  TrainingSettings settings;
  settings.epochs = 10;  // one report: the same best epoch
  std::vector<std::size_t> asked;
  const auto teacher = [&](std::size_t fold) {
    asked.push_back(fold);
    return std::make_shared<const Teaching>(truth(64, fold == 1 ? 20 : 0));
  };
  const CrossValidation plain = cross_validate(layout, table, settings, *make_sampler("block_gibbs"), 3);
  const CrossValidation taught =
      cross_validate(layout, table, settings, *make_sampler("block_gibbs"), 3, {.teaching = teacher});
  CHECK(asked == std::vector<std::size_t>{0, 1, 2});
  REQUIRE(plain.best_epoch == taught.best_epoch);
  const std::vector<std::size_t> fold = assign_folds(table, 3, settings.seed);
  for (std::size_t n = 0; n < fold.size(); ++n)
    CHECK((plain.probability[n * 10] == taught.probability[n * 10]) == (fold[n] != 1));
}

namespace {

/// How far the words of every variable, and P(go), lie from those of fresh rows, in rows of a machine's joint.
struct JointErrors {
  double bins = 0;  // largest difference of a bin's share
  double p_go = 0;
};

JointErrors joint_errors(const RbmWeights& weights, const TrainingTable& fresh) {
  const VisibleLayout layout = boundary_layout();
  const WordMachine machine(layout, weights);
  WordChains chains(4000, 4, 5);
  chains.run(machine, 300);
  std::vector<double> difference(machine.word_count(), 0.0);
  for (std::size_t c = 0; c < chains.chains(); ++c)
    for (std::size_t g = 0; g < machine.groups().size(); ++g)
      difference[machine.groups()[g].first + chains.row(c)[g]] += 1 / double(chains.chains());
  for (std::size_t n = 0; n < fresh.row_count(); ++n)
    for (const WordGroup& group : machine.groups()) {
      const std::size_t bin = group.variable < 0 ? fresh.outcome[n]
                                                 : std::size_t(layout.encoders()[std::size_t(group.variable)].bin_of(
                                                       fresh.row(n)[std::size_t(group.variable)]));
      difference[group.first + bin] -= 1 / double(fresh.row_count());
    }
  JointErrors errors;
  for (const WordGroup& group : machine.groups()) {
    if (group.variable < 0)
      errors.p_go = std::abs(difference[group.first] + difference[group.first + 1]);
    else
      for (std::size_t k = 0; k < group.length; ++k)
        errors.bins = std::max(errors.bins, std::abs(difference[group.first + k]));
  }
  return errors;
}

}  // namespace

TEST_CASE("points of a teacher that share in the joint distribution bring it nearer to the truth") {
  const VisibleLayout layout = boundary_layout();
  const TrainingTable table = boundary_table(60, 4), fresh = boundary_table(4000, 99);
  TrainingSettings settings;
  settings.epochs = 800;
  settings.negative = NegativePhaseKind::code_words;
  settings.chains = 256;
  settings.sweeps = 1;
  settings.generative = 0.2;
  settings.final_learning_rate = 0.05;
  const auto gibbs = make_sampler("block_gibbs");
  Teaching teaching = truth(1024, 3);
  const RbmWeights alone = train_rbm(layout, table, settings, *gibbs, {}, nullptr, &teaching).weights;
  teaching.joint_share = 0.75;
  const RbmWeights shared = train_rbm(layout, table, settings, *gibbs, {}, nullptr, &teaching).weights;
  const RbmWeights balanced = balanced_inputs(layout, table, shared, 1, &teaching);
  const JointErrors of_alone = joint_errors(alone, fresh), of_shared = joint_errors(shared, fresh),
                    of_balanced = joint_errors(balanced, fresh);
  std::printf(
      "largest error of a bin's share, of P(go): trials alone %.3f, %.3f; shared %.3f, %.3f; balanced %.3f, %.3f\n",
      of_alone.bins, of_alone.p_go, of_shared.bins, of_shared.p_go, of_balanced.bins, of_balanced.p_go);
  CHECK(of_shared.bins < 0.8 * of_alone.bins);
  CHECK(of_balanced.bins < 0.06);
  CHECK(of_balanced.bins < of_shared.bins);
  const Posterior before(layout, shared), after(layout, balanced);
  for (std::size_t n = 0; n < 50; ++n)
    CHECK(before.marginal(fresh.row(n)).probability == after.marginal(fresh.row(n)).probability);
}

TEST_CASE("a teacher that does not fit the layout is refused") {
  const VisibleLayout layout = boundary_layout();
  const TrainingTable table = boundary_table(12, 4);
  TrainingSettings settings;
  settings.epochs = 1;
  const auto train_with = [&](const Teaching& teaching) {
    train_rbm(layout, table, settings, *make_sampler("block_gibbs"), {}, nullptr, &teaching);
  };
  Teaching teaching = truth(8, 1);
  teaching.probability[3] = 1.5;
  refused([&] { train_with(teaching); }, "no probability");
  teaching = truth(8, 1);
  teaching.points.pop_back();
  refused([&] { train_with(teaching); }, "do not match");
  teaching = truth(8, 1);
  teaching.label.assign(10, 1);
  refused([&] { train_with(teaching); }, "both classes");
}
