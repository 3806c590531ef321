// How machines are trained: optimisers, starting points of the negative phase, centred units, densities without
// outcomes.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/math/random.h"
#include "learning/rbm/train.h"
#include "tests/learning/machine_likelihood.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

VisibleLayout bits(std::size_t count) {
  std::vector<Encoder> encoders;
  for (std::size_t i = 0; i < count; ++i)
    encoders.push_back(Encoder::by_range("bit" + std::to_string(i), "-", Code::thermometer, 2, 0, 1));
  return VisibleLayout(std::move(encoders), {});
}

/// Rows of {0, 1}; NaN where unknown.
TrainingTable density_table(const std::vector<double>& rows, std::size_t width) {
  TrainingTable table;
  table.variable_count = width;
  for (double x : rows) table.variables.push_back(0.25 + 0.5 * x);
  table.outcome.assign(rows.size() / width, 0);
  table.weight.assign(rows.size() / width, 1.0);
  for (std::size_t n = 0; n < rows.size() / width; ++n) table.group.push_back(n);
  return table;
}

/// Whatever is asked, these rows.
class FixedRows final : public Sampler {
 public:
  explicit FixedRows(std::vector<double> rows) : rows_(std::move(rows)) {}
  std::string name() const override { return "fixed"; }
  SampleSet sample(const Problem& problem, const SampleRequest&) const override {
    SampleSet set;
    set.labels = problem.labels;
    const std::size_t visible = 5, count = rows_.size() / visible;
    for (std::size_t r = 0; r < count; ++r)
      for (std::size_t i = 0; i < problem.variable_count(); ++i)
        set.values.push_back(i < visible ? std::int8_t(rows_[r * visible + i]) : 0);
    set.energies.assign(count, 0);
    set.occurrences.assign(count, 1);
    return set;
  }

 private:
  std::vector<double> rows_;
};

std::vector<double> random_rows(std::size_t count, std::size_t width, double p, std::uint64_t seed) {
  std::vector<double> rows;
  for (std::size_t k = 0; k < count * width; ++k) rows.push_back(random_unit(seed, 5, k) < p);
  return rows;
}

std::vector<double> complement(std::vector<double> rows) {
  for (double& x : rows) x = 1 - x;
  return rows;
}

/// The machine over 1 - v: same probabilities, visible units turned.
RbmWeights turned(const RbmWeights& machine) {
  RbmWeights result = machine;
  for (double& a : result.visible_bias) a = -a;
  for (double& w : result.weight) w = -w;
  for (std::size_t i = 0; i < machine.visible_count; ++i)
    for (std::size_t j = 0; j < machine.hidden_count; ++j)
      result.hidden_bias[j] += machine.weight[i * machine.hidden_count + j];
  return result;
}

double largest_difference(const RbmWeights& x, const RbmWeights& y) {
  double max = 0;
  for (auto part : {&RbmWeights::weight, &RbmWeights::visible_bias, &RbmWeights::hidden_bias})
    for (std::size_t k = 0; k < (x.*part).size(); ++k) max = std::max(max, std::abs((x.*part)[k] - (y.*part)[k]));
  return max;
}

TrainingSettings one_step() {
  TrainingSettings settings;
  settings.hidden = 3;
  settings.discriminative = 0;
  settings.generative = 1;
  settings.weight_decay = 0;
  settings.batch = 1000;
  settings.epochs = settings.report_every = 1;
  settings.optimizer = Optimizer::sgd;
  settings.learning_rate = 0.3;
  settings.initial_weight = 0.5;
  return settings;
}

/// The 2^4 + 2^4 - 2 patterns of bars or stripes on 4 x 4 pixels (MacKay 2003, section 43.3).
std::vector<double> bars_and_stripes() {
  std::vector<double> rows;
  for (int pattern = 0; pattern < 16; ++pattern)
    for (int k = 0; k < 16; ++k) rows.push_back(pattern >> (k / 4) & 1);
  for (int pattern = 1; pattern < 15; ++pattern)
    for (int k = 0; k < 16; ++k) rows.push_back(pattern >> (k % 4) & 1);
  return rows;
}

}  // namespace

TEST_CASE("one step of gradient descent is the rate times the gradient, also with a falling rate and momentum") {
  const VisibleLayout layout = bits(5);
  const std::vector<double> data = random_rows(7, 5, 0.7, 1), drawn = random_rows(9, 5, 0.4, 2);
  const TrainingTable table = density_table(data, 5);
  TrainingSettings settings = one_step();
  const FixedRows sampler(drawn);
  RbmWeights start = RbmWeights::zeros(5, 3);
  for (std::size_t k = 0; k < start.weight.size(); ++k) start.weight[k] = random_unit(3, 3, k) - 0.5;
  const auto gradient = [&](const RbmWeights& at) {
    return training_objective(at, layout, table, settings, sampler.sample(to_qubo(at, layout.unit_labels()), {}))
        .gradient;
  };
  const auto stepped = [](RbmWeights at, const RbmWeights& g, double rate) {
    for (auto part : {&RbmWeights::weight, &RbmWeights::visible_bias, &RbmWeights::hidden_bias})
      for (std::size_t k = 0; k < (at.*part).size(); ++k) (at.*part)[k] -= rate * (g.*part)[k];
    return at;
  };
  const RbmWeights g1 = gradient(start), once = stepped(start, g1, 0.3);
  CHECK(largest_difference(train_rbm(layout, table, settings, sampler, {}, &start).weights, once) < 1e-14);
  settings.epochs = 2;
  settings.momentum = 0.9;
  settings.final_learning_rate = 0.5;
  RbmWeights g2 = gradient(once);
  for (auto part : {&RbmWeights::weight, &RbmWeights::visible_bias, &RbmWeights::hidden_bias})
    for (std::size_t k = 0; k < (g2.*part).size(); ++k) (g2.*part)[k] += 0.9 * (g1.*part)[k];
  const RbmWeights twice = stepped(once, g2, 0.15);
  CHECK(largest_difference(train_rbm(layout, table, settings, sampler, {}, &start).weights, twice) < 1e-14);
}

TEST_CASE("centred training of the complement gives the turned machine; without centring it does not") {
  const VisibleLayout layout = bits(5);
  const std::vector<double> data = random_rows(7, 5, 0.8, 1), drawn = random_rows(9, 5, 0.6, 2);
  TrainingSettings settings = one_step();
  settings.epochs = 20;
  RbmWeights start = RbmWeights::zeros(5, 3);
  for (std::size_t k = 0; k < start.weight.size(); ++k) start.weight[k] = random_unit(3, 3, k) - 0.5;
  const RbmWeights turned_start = turned(start);
  const auto difference = [&](bool centred) {
    settings.centred = centred;
    const RbmWeights straight =
        train_rbm(layout, density_table(data, 5), settings, FixedRows(drawn), {}, &start).weights;
    const RbmWeights other =
        train_rbm(layout, density_table(complement(data), 5), settings, FixedRows(complement(drawn)), {}, &turned_start)
            .weights;
    CHECK(largest_difference(straight, start) > 0.1);
    return largest_difference(turned(straight), other);
  };
  CHECK(difference(true) < 1e-10);
  CHECK(difference(false) > 0.1);
}

TEST_CASE("contrastive chains start at the rows: no sweep, no gradient; unknown units are completed first") {
  const VisibleLayout layout = bits(5);
  std::vector<double> data = random_rows(7, 5, 0.7, 1);
  TrainingSettings settings = one_step();
  settings.negative = NegativePhaseKind::contrastive;
  settings.sweeps = 0;
  const auto gibbs = make_sampler("block_gibbs");
  RbmWeights start = RbmWeights::zeros(5, 3);
  for (std::size_t k = 0; k < start.weight.size(); ++k) start.weight[k] = random_unit(3, 3, k) - 0.5;
  const auto moved = [&](const std::vector<double>& rows) {
    return largest_difference(train_rbm(layout, density_table(rows, 5), settings, *gibbs, {}, &start).weights, start);
  };
  CHECK(moved(data) < 1e-14);
  settings.sweeps = 1;
  CHECK(moved(data) > 0.01);
  data[3] = NAN;  // its completions differ, so that the two phases are those of different rows
  settings.sweeps = 0;
  CHECK(moved(data) < 0.3);
  CHECK_THROWS_AS(train_rbm(layout, density_table(data, 5), settings, *make_sampler("exact")), InputError);
}

TEST_CASE("bars and stripes of 4 x 4 pixels are learned to better than -3.6 nat per pattern") {
  const std::vector<double> patterns = bars_and_stripes();
  const VisibleLayout layout = bits(16);
  const TrainingTable table = density_table(patterns, 16);
  TrainingSettings settings;
  settings.hidden = 16;
  settings.discriminative = 0;
  settings.generative = 1;
  settings.weight_decay = 0;
  settings.batch = 30;
  settings.epochs = settings.report_every = 1500;
  settings.learning_rate = 0.02;
  settings.final_learning_rate = 0.05;
  settings.centred = true;
  settings.chains = 100;
  settings.sweeps = 2;
  settings.rungs = 6;
  const auto gibbs = make_sampler("block_gibbs");
  const auto reached = [&](NegativePhaseKind kind) {
    settings.negative = kind;
    return mean_log_likelihood(train_rbm(layout, table, settings, *gibbs).weights, patterns);
  };
  const double tempering = reached(NegativePhaseKind::tempering), trajectory = reached(NegativePhaseKind::trajectory);
  std::printf("bars and stripes, nat per pattern: best possible %.3f, tempering %.3f, trajectory %.3f\n",
              -std::log(30.0), tempering, trajectory);
  CHECK(tempering > -3.6);
  CHECK(trajectory > -3.6);
  CHECK(tempering < -std::log(30.0));
}

TEST_CASE("with a third of the units unknown a density is learned to what its entropy allows") {
  // Two independent pairs of equal units: 4 patterns, log 4.
  std::vector<double> rows, known;
  for (std::size_t n = 0; n < 400; ++n) {
    const int a = int(n & 1), b = int(n >> 1 & 1);
    for (int x : {a, a, b, b}) known.push_back(x);
  }
  rows = known;
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (random_unit(8, 1, k) < 1.0 / 3) rows[k] = NAN;
  TrainingSettings settings;
  settings.hidden = 4;
  settings.discriminative = 0;
  settings.generative = 1;
  settings.weight_decay = 0.1;
  settings.epochs = settings.report_every = 250;
  settings.learning_rate = 0.03;
  settings.final_learning_rate = 0.05;
  settings.initial_weight = 0.5;
  settings.chains = 200;
  settings.sweeps = 3;
  const RbmWeights machine = train_rbm(bits(4), density_table(rows, 4), settings, *make_sampler("block_gibbs")).weights;
  const double reached = mean_log_likelihood(machine, known);
  std::printf("two pairs with a third unknown: %.4f nat per row, best possible %.4f\n", reached, -std::log(4.0));
  CHECK(reached > -std::log(4.0) - 0.1);
}

TEST_CASE("masked weights stay 0, also in centred units, and the others learn") {
  const TrainingTable table = density_table(random_rows(60, 5, 0.3, 3), 5);
  for (const bool centred : {false, true}) {
    TrainingSettings settings;
    settings.hidden = 3;
    settings.epochs = 5;
    settings.discriminative = 0;
    settings.generative = 1;
    settings.centred = centred;
    settings.masked = {{0, 1}, {4, 2}};
    const RbmWeights machine = train_rbm(bits(5), table, settings, *make_sampler("block_gibbs")).weights;
    for (std::size_t i = 0; i < 5; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        CHECK((machine.weight[i * 3 + j] == 0) == ((i == 0 && j == 1) || (i == 4 && j == 2)));
    settings.masked = {{5, 0}};
    CHECK_THROWS_AS(train_rbm(bits(5), table, settings, *make_sampler("block_gibbs")), InputError);
  }
}
