#include "learning/rbm/words/word_training.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/math/random.h"
#include "learning/rbm/words/word_gradient.h"

namespace gonogo::learning {
namespace {

// Streams of random numbers under one seed; training_run.cpp has 1 and those from 1000, learning/rbm 2 and 3.
constexpr std::uint64_t kWordChains = 2, kBalance = 4;

/// Steps of the optimiser on a list of parameters, as LibTorch takes them.
class Steps {
 public:
  Steps(std::size_t count, const TrainingSettings& settings) : settings_(settings), first_(count), second_(count) {}

  /// Begins an update.
  void begin() {
    first_share_ *= kFirst;
    second_share_ *= kSecond;
  }
  /// Moves parameters whose first is number `at` of the list.
  void take(std::span<double> value, std::span<const double> gradient, std::size_t at, double rate) {
    double *first = first_.data() + at, *second = second_.data() + at;
    if (settings_.optimizer == Optimizer::sgd) {
      for (std::size_t k = 0; k < value.size(); ++k)
        value[k] -= rate * (first[k] = settings_.momentum * first[k] + gradient[k]);
      return;
    }
    constexpr double kSmall = 1e-8;
    const double step = rate / (1 - first_share_), root = std::sqrt(1 - second_share_);
    for (std::size_t k = 0; k < value.size(); ++k) {
      first[k] = kFirst * first[k] + (1 - kFirst) * gradient[k];
      second[k] = kSecond * second[k] + (1 - kSecond) * gradient[k] * gradient[k];
      value[k] -= step * first[k] / (std::sqrt(second[k]) / root + kSmall);
    }
  }

 private:
  static constexpr double kFirst = 0.9, kSecond = 0.999;
  const TrainingSettings& settings_;
  std::vector<double> first_, second_;  // sgd: the velocity; adam: running means of the gradient and of its square
  double first_share_ = 1, second_share_ = 1;
};

/// A training run of a machine of code words whose rows are all known.
class WordRun {
 public:
  WordRun(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings,
          const RbmWeights& start, const Teaching* teaching)
      : table_(table),
        settings_(settings),
        weights_(start),
        words_(layout, start),
        chains_(word_chains(settings)),
        gradient_(layout, table, settings, teaching),
        steps_(start.weight.size() + start.visible_bias.size() + start.hidden_bias.size(), settings) {}

  void epoch(std::size_t number) {
    for (const auto& rows : minibatches(table_.row_count(), settings_, number))
      update(rows, learning_rate(settings_, number));
  }
  const RbmWeights& weights() const { return weights_; }

 private:
  void update(const std::vector<std::size_t>& rows, double rate) {
    words_.set_weights(weights_);
    if (settings_.generative > 0) chains_.run(words_, settings_.sweeps);
    const RbmWeights& gradient = gradient_(words_, weights_, rows, chains_);
    steps_.begin();
    std::size_t at = 0;
    for (auto part : {&RbmWeights::weight, &RbmWeights::visible_bias, &RbmWeights::hidden_bias}) {
      steps_.take(weights_.*part, gradient.*part, at, rate);
      at += (weights_.*part).size();
    }
  }

  const TrainingTable& table_;
  const TrainingSettings& settings_;
  RbmWeights weights_;
  WordMachine words_;
  WordChains chains_;
  WordGradient gradient_;
  Steps steps_;
};

}  // namespace

WordChains word_chains(const TrainingSettings& settings) {
  return WordChains(settings.chains, 1, random_bits(settings.seed, kWordChains, 0));
}

bool are_words(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings) {
  return WordGradient::serves(layout, table, settings);
}

TrainingResult train_words(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings,
                           const EpochHook& hook, const RbmWeights& start, const Teaching* teaching) {
  check_table(layout, table, settings);
  WordRun run(layout, table, settings, start, teaching);
  return run_epochs(run, layout, table, settings, hook);
}

namespace {

/// Mean of the input units over the rows of the table, and over the taught points as far as they share.
std::vector<double> wanted_inputs(const VisibleLayout& layout, const TrainingTable& table, const Teaching* teaching) {
  const UnitCounts counts = count_units(layout, table, true);
  std::vector<double> wanted(layout.input_unit_count());
  for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = counts.known[i] > 0 ? counts.on[i] / counts.known[i] : 0;
  if (!teaching || teaching->joint_share == 0) return wanted;
  const std::vector<std::size_t> points = points_in_box(*teaching, table);
  if (points.empty()) return wanted;
  const std::size_t variables = layout.variable_count();
  for (double& x : wanted) x *= 1 - teaching->joint_share;
  std::vector<Bit> units(wanted.size());
  for (const std::size_t k : points) {
    layout.encode(std::span(teaching->points).subspan(k * variables, variables), units);
    for (std::size_t i = 0; i < wanted.size(); ++i)
      wanted[i] += teaching->joint_share * units[i] / double(points.size());
  }
  return wanted;
}

}  // namespace

RbmWeights balanced_inputs(const VisibleLayout& layout, const TrainingTable& table, RbmWeights weights,
                           std::uint64_t seed, const Teaching* teaching) {
  constexpr std::size_t kChains = 256, kRungs = 4, kBurnIn = 200, kSteps = 500;
  constexpr double kRate = 1;
  const std::vector<double> wanted = wanted_inputs(layout, table, teaching);
  WordChains chains(kChains, kRungs, random_bits(seed, kBalance, 0));
  std::vector<double> sum(wanted.size(), 0.0), mean(wanted.size());
  std::vector<Bit> units(layout.unit_count());
  for (std::size_t step = 0; step < kSteps; ++step) {
    const WordMachine machine(layout, weights);
    chains.run(machine, step == 0 ? kBurnIn : 1);
    std::fill(mean.begin(), mean.end(), 0.0);
    for (std::size_t c = 0; c < kChains; ++c) {
      machine.write_units(chains.row(c), units);
      for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += units[i] / double(kChains);
    }
    const double rate = kRate * double(kSteps - step) / double(kSteps);
    for (std::size_t i = 0; i < mean.size(); ++i) {
      weights.visible_bias[i] += rate * (wanted[i] - mean[i]);
      if (step >= kSteps / 2) sum[i] += weights.visible_bias[i] / double(kSteps - kSteps / 2);
    }
  }
  std::copy(sum.begin(), sum.end(), weights.visible_bias.begin());
  return weights;
}

}  // namespace gonogo::learning
