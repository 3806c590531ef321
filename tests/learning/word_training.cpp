// Training with a negative phase of whole code words: the gradient, and the density that it reaches.
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "learning/machine/word_machine.h"
#include "learning/rbm/train.h"
#include "tests/learning/words.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

/// Rows of the mixed layout whose slope and speed go together and decide the outcome.
TrainingTable related_table(const VisibleLayout& layout, std::size_t count, std::uint64_t seed) {
  TrainingTable table;
  table.variable_count = layout.variable_count();
  for (std::size_t n = 0; n < count; ++n) {
    const double slope = 4 * random_unit(seed, n, 0);
    const double speed = random_unit(seed, n, 1) < 0.8 ? 3.99 - 0.99 * slope : 4 * random_unit(seed, n, 2);
    const double soil = std::floor(3 * std::pow(random_unit(seed, n, 3), 2)) + 0.5;
    for (double x : {slope, soil, 2.0, speed}) table.variables.push_back(x);
    const double edge = slope + 0.5 * soil + 0.3 * (random_unit(seed, n, 4) - 0.5);
    table.outcome.push_back(edge < 1.5 ? 0 : edge < 2.5 ? 1 : 2);
    table.weight.push_back(1);
    table.group.push_back(n);
  }
  return table;
}

std::vector<int> bins_of(const VisibleLayout& layout, const TrainingTable& table, std::size_t n) {
  std::vector<int> row;
  for (std::size_t v = 0; v < layout.variable_count(); ++v) row.push_back(layout.encoders()[v].bin_of(table.row(n)[v]));
  row.push_back(int(table.outcome[n]));
  return row;
}

/// Mean log P(row) of a machine of code words.
double log_likelihood(const VisibleLayout& layout, const RbmWeights& machine, const TrainingTable& table) {
  double sum = 0;
  for (std::size_t n = 0; n < table.row_count(); ++n)
    sum -= free_energy(machine, words::units_of(layout, bins_of(layout, table, n)));
  return sum / double(table.row_count()) - words::enumerate(layout, machine).log_z;
}

SampleSet one_row(const VisibleLayout& layout, const RbmWeights& machine, const std::vector<int>& row) {
  SampleSet set;
  set.labels = to_qubo(machine, layout.unit_labels()).labels;
  for (double unit : words::units_of(layout, row)) set.values.push_back(std::int8_t(unit));
  set.values.resize(set.labels.size(), 0);
  set.energies = {0};
  set.occurrences = {1};
  return set;
}

TrainingSettings generative() {
  TrainingSettings settings;
  settings.discriminative = 0;
  settings.generative = 1;
  settings.weight_decay = 0;
  settings.negative = NegativePhaseKind::code_words;
  return settings;
}

}  // namespace

TEST_CASE("with rows of code words the objective's gradient is that of the exact log-likelihood over code words") {
  const VisibleLayout layout = words::mixed_layout();
  const TrainingTable table = related_table(layout, 25, 3);
  RbmWeights machine = words::random_machine(layout.unit_count(), 3, 1, 5);
  const std::vector<double> probability = words::enumerate(layout, machine).probability;
  const auto rows = words::all_rows(layout);
  // The gradient is linear in the rows: its mean over all of them, by their probabilities, is the exact one.
  RbmWeights gradient = RbmWeights::zeros(layout.unit_count(), 3);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const RbmWeights part =
        training_objective(machine, layout, table, generative(), one_row(layout, machine, rows[r])).gradient;
    for (auto member : {&RbmWeights::weight, &RbmWeights::visible_bias, &RbmWeights::hidden_bias})
      for (std::size_t k = 0; k < (part.*member).size(); ++k)
        (gradient.*member)[k] += probability[r] * (part.*member)[k];
  }
  constexpr double h = 1e-5;
  for (auto member : {&RbmWeights::weight, &RbmWeights::visible_bias, &RbmWeights::hidden_bias})
    for (std::size_t k = 0; k < (machine.*member).size(); ++k) {
      const double here = (machine.*member)[k];
      (machine.*member)[k] = here + h;
      const double above = -log_likelihood(layout, machine, table);
      (machine.*member)[k] = here - h;
      const double below = -log_likelihood(layout, machine, table);
      (machine.*member)[k] = here;
      CHECK((gradient.*member)[k] == Approx((above - below) / (2 * h)).margin(1e-8));
    }
}

namespace {

/// A teacher that knows the edge of related_table(), at `count` points.
Teaching edge_teaching(const VisibleLayout& layout, std::size_t count, double joint_share) {
  const TrainingTable points = related_table(layout, count, 9);
  Teaching teaching{
      .weight = 2, .points = points.variables, .probability = {}, .label = {1, 1, 0}, .joint_share = joint_share};
  for (std::size_t k = 0; k < count; ++k) teaching.probability.push_back(points.outcome[k] < 2 ? 0.9 : 0.2);
  return teaching;
}

/// Largest difference of the machines that LibTorch and the closed form train from the same start. A row of next to no
/// weight that leaves a variable unknown makes train_rbm() take LibTorch.
double largest_difference(const TrainingSettings& settings, const Teaching& teaching, double size) {
  const VisibleLayout layout = words::mixed_layout();
  TrainingTable table = related_table(layout, 30, 3);
  for (std::size_t n = 0; n < table.row_count(); ++n) table.weight[n] = 0.5 + random_unit(4, 1, n);
  std::copy_n(table.row(1).begin(), table.variable_count, table.variables.begin());
  table.weight[0] = 1e-30;
  const RbmWeights start = words::random_machine(layout.unit_count(), settings.hidden, size, 5);
  const auto sampler = make_sampler("block_gibbs");
  const RbmWeights closed = train_rbm(layout, table, settings, *sampler, {}, &start, &teaching).weights;
  table.variables[0] = NAN;
  const RbmWeights torch = train_rbm(layout, table, settings, *sampler, {}, &start, &teaching).weights;
  double worst = 0, moved = 0;
  for (auto member : {&RbmWeights::weight, &RbmWeights::visible_bias, &RbmWeights::hidden_bias})
    for (std::size_t k = 0; k < (closed.*member).size(); ++k) {
      worst = std::max(worst, std::abs((closed.*member)[k] - (torch.*member)[k]));
      moved = std::max(moved, std::abs((closed.*member)[k] - (start.*member)[k]));
    }
  CHECK(moved > 1e-3);
  return worst;
}

}  // namespace

TEST_CASE("a step by the gradient in closed form is LibTorch's, for every term of the objective") {
  const VisibleLayout layout = words::mixed_layout();
  TrainingSettings settings = generative();
  settings.epochs = settings.report_every = 1;
  settings.batch = 1000;
  settings.chains = 16;
  settings.discriminative = 0.8;
  settings.generative = 0.3;
  settings.weight_decay = 2;
  settings.optimizer = Optimizer::sgd;
  settings.learning_rate = 0.5;
  for (const std::size_t hidden : {std::size_t(1), std::size_t(4), std::size_t(7)}) {
    settings.hidden = hidden;
    for (const double joint_share : {0.0, 0.7}) {
      INFO(hidden << " hidden units, joint share " << joint_share);
      CHECK(largest_difference(settings, edge_teaching(layout, 20, joint_share), 1) < 1e-13);
      CHECK(largest_difference(settings, edge_teaching(layout, 200, joint_share), 1) < 1e-13);
      Teaching every_third = edge_teaching(layout, 200, joint_share);
      every_third.joint_every = 3;
      CHECK(largest_difference(settings, every_third, 1) < 1e-13);
      CHECK(largest_difference(settings, edge_teaching(layout, 20, joint_share), 60) < 1e-9);  // sums by logarithms
    }
  }
  for (double TrainingSettings::*term : {&TrainingSettings::discriminative, &TrainingSettings::generative}) {
    TrainingSettings without = settings;
    without.*term = 0;
    CHECK(largest_difference(without, edge_teaching(layout, 20, 0.7), 1) < 1e-13);
  }
}

TEST_CASE("updates in closed form follow LibTorch's, with Adam and with momentum") {
  TrainingSettings settings = generative();
  settings.epochs = 5;
  settings.report_every = 2;
  settings.hidden = 5;
  settings.batch = 8;
  settings.chains = 16;
  settings.discriminative = 1;
  settings.generative = 0.2;
  settings.weight_decay = 1;
  settings.learning_rate = 0.02;
  settings.final_learning_rate = 0.1;
  const Teaching teaching = edge_teaching(words::mixed_layout(), 20, 0.5);
  CHECK(largest_difference(settings, teaching, 1) < 1e-10);
  settings.optimizer = Optimizer::sgd;
  settings.momentum = 0.9;
  CHECK(largest_difference(settings, teaching, 1) < 1e-12);
}

TEST_CASE("training over code words learns the density, and every marginal; over all words it does not") {
  const VisibleLayout layout = words::mixed_layout();
  const TrainingTable table = related_table(layout, 2000, 1), fresh = related_table(layout, 4000, 2);
  std::vector<double> frequency(words::all_rows(layout).size(), 0.0);
  const auto rows = words::all_rows(layout);
  double entropy = 0;
  for (std::size_t n = 0; n < fresh.row_count(); ++n)
    frequency[std::size_t(std::find(rows.begin(), rows.end(), bins_of(layout, fresh, n)) - rows.begin())] +=
        1.0 / double(fresh.row_count());
  for (double f : frequency)
    if (f > 0) entropy -= f * std::log(f);

  TrainingSettings settings = generative();
  settings.hidden = 16;
  settings.weight_decay = 1;
  settings.epochs = settings.report_every = 100;
  settings.batch = 64;
  settings.final_learning_rate = 0.05;
  settings.chains = 256;
  settings.sweeps = 4;
  const auto gibbs = make_sampler("block_gibbs");
  const auto trained = [&](NegativePhaseKind kind) {
    settings.negative = kind;
    return train_rbm(layout, table, settings, *gibbs).weights;
  };
  const RbmWeights machine = trained(NegativePhaseKind::code_words);
  const double reached = log_likelihood(layout, machine, fresh);
  const double all_words = log_likelihood(layout, trained(NegativePhaseKind::persistent), fresh);
  std::printf("fresh rows: code words %.4f nat, all words %.4f, at most %.4f\n", reached, all_words, -entropy);
  CHECK(reached > -entropy - 0.13);
  CHECK(reached > all_words);

  const std::vector<double> probability = words::enumerate(layout, machine).probability;
  for (std::size_t v = 0; v <= layout.variable_count(); ++v) {
    std::vector<double> difference(4, 0.0);
    for (std::size_t r = 0; r < rows.size(); ++r) difference[std::size_t(rows[r][v])] += probability[r] - frequency[r];
    for (double d : difference) CHECK(std::abs(d) < 0.03);
  }
  settings.negative = NegativePhaseKind::code_words;
  CHECK_THROWS_AS(train_rbm(layout, table, settings, *make_sampler("exact")), InputError);
}

TEST_CASE("without weights a machine of code words starts at the marginals of its rows") {
  const VisibleLayout layout = words::mixed_layout();
  const TrainingTable table = related_table(layout, 3000, 1);
  TrainingSettings settings = generative();
  settings.initial_weight = 0;
  settings.optimizer = Optimizer::sgd;
  settings.learning_rate = 1e-12;
  settings.epochs = 1;
  const RbmWeights start = train_rbm(layout, table, settings, *make_sampler("block_gibbs")).weights;
  const auto rows = words::all_rows(layout);
  const std::vector<double> probability = words::enumerate(layout, start).probability;
  for (std::size_t v = 0; v < 2; ++v)  // thermometer and one_hot; two Gray bits cannot have every marginal
    for (int bin = 0; bin < layout.encoders()[v].bin_count(); ++bin) {
      double share = 0, own = 0;
      for (std::size_t n = 0; n < table.row_count(); ++n) share += bins_of(layout, table, n)[v] == bin;
      for (std::size_t r = 0; r < rows.size(); ++r)
        if (rows[r][v] == bin) own += probability[r];
      CHECK(own == Approx(share / 3000).margin(1e-3));
    }
}
