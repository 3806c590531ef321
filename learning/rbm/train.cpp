#include "learning/rbm/train.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

#include "base/error.h"
#include "base/math/random.h"
#include "base/parallel/host_loop.h"
#include "base/progress.h"
#include "learning/rbm/negative.h"
#include "learning/rbm/tensors.h"
#include "learning/rbm/word_gradient.h"

namespace gonogo::learning {
namespace {

/// Streams of random numbers under one seed.
enum Stream : std::uint64_t { kInitial = 1, kCompletions = 3, kBalance = 4, kBatches = 1000 };  // 2: the negative phase

/// Number or total weight of rows with each unit on, and with its variable known: [unit]. Units of the outcome come
/// last.
struct UnitCounts {
  std::vector<double> on, known;
};

UnitCounts count_units(const VisibleLayout& layout, const TrainingTable& table, bool weighed = false) {
  UnitCounts counts{std::vector<double>(layout.unit_count(), 0.0), std::vector<double>(layout.unit_count(), 0.0)};
  std::vector<Bit> units(layout.input_unit_count());
  const std::size_t inputs = layout.input_unit_count();
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    layout.encode(table.row(n), units);
    const double weight = weighed ? table.weight[n] : 1;
    for (std::size_t v = 0; v < layout.variable_count(); ++v) {
      if (std::isnan(table.row(n)[v])) continue;
      for (std::size_t i = layout.offset(v); i < layout.offset(v + 1); ++i) {
        counts.on[i] += weight * units[i];
        counts.known[i] += weight;
      }
    }
    if (inputs < counts.on.size()) counts.on[inputs + table.outcome[n]] += weight;
  }
  return counts;
}

/// Biases of the units of variable `v`, by which each of its words alone has its share of the rows. A thermometer's
/// word k has the first k units on, so unit k turns the share of word k into that of word k + 1.
void pin_words(const Encoder& encoder, const TrainingTable& table, std::size_t v, std::span<double> bias) {
  std::vector<double> rows(std::size_t(encoder.bin_count()), 0.5);
  for (std::size_t n = 0; n < table.row_count(); ++n)
    if (!std::isnan(table.row(n)[v])) rows[std::size_t(encoder.bin_of(table.row(n)[v]))] += 1;
  for (std::size_t k = 0; k < bias.size(); ++k)
    bias[k] = encoder.code() == Code::one_hot ? std::log(rows[k]) : std::log(rows[k + 1] / rows[k]);
}

/// Small random weights. Visible biases give every variable and the outcome nearly the marginal that the rows have,
/// half a row added to each unit, word or outcome, so that what never happened starts rare but possible. A machine of
/// code words has the marginals of the words; any other, those of single units.
RbmWeights initial_weights(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings) {
  RbmWeights weights = RbmWeights::zeros(layout.unit_count(), settings.hidden);
  for (std::size_t k = 0; k < weights.weight.size(); ++k)
    weights.weight[k] = settings.initial_weight * random_normal(settings.seed, kInitial, k);
  const UnitCounts counts = count_units(layout, table);
  const std::size_t inputs = layout.input_unit_count();
  for (std::size_t i = 0; i < inputs; ++i)
    weights.visible_bias[i] = std::log((counts.on[i] + 0.5) / (counts.known[i] - counts.on[i] + 0.5));
  for (std::size_t i = inputs; i < counts.on.size(); ++i) weights.visible_bias[i] = std::log(counts.on[i] + 0.5);
  if (settings.negative != NegativePhaseKind::code_words) return weights;
  for (std::size_t v = 0; v < layout.variable_count(); ++v) {
    const Encoder& encoder = layout.encoders()[v];
    if (encoder.unit_count() == 0 || has_all_words(encoder.code())) continue;
    pin_words(encoder, table, v, std::span(weights.visible_bias).subspan(layout.offset(v), encoder.unit_count()));
  }
  return weights;
}

void check_table(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings) {
  if (table.row_count() == 0) throw InputError("training table: no valid trial to train on");
  if (table.variable_count != layout.variable_count())
    throw InputError("training table: " + std::to_string(table.variable_count) + " variables where the layout has " +
                     std::to_string(layout.variable_count()));
  if (layout.outcome_count() == 0 && settings.discriminative > 0)
    throw InputError("training table: a layout without outcomes can only be trained with discriminative 0");
  for (std::size_t y : table.outcome)
    if (y >= std::max<std::size_t>(layout.outcome_count(), 1))
      throw InputError("training table: outcome " + std::to_string(y) + " does not exist");
}

std::unique_ptr<torch::optim::Optimizer> make_optimizer(const Machine& machine, const TrainingSettings& settings) {
  if (settings.optimizer == Optimizer::adam)
    return std::make_unique<torch::optim::Adam>(machine.parameters(),
                                                torch::optim::AdamOptions(settings.learning_rate));
  return std::make_unique<torch::optim::SGD>(
      machine.parameters(), torch::optim::SGDOptions(settings.learning_rate).momentum(settings.momentum));
}

/// The learning rate falls in equal steps from epoch to epoch to its final share.
double learning_rate(const TrainingSettings& settings, std::size_t epoch) {
  const double part = settings.epochs > 1 ? double(epoch - 1) / double(settings.epochs - 1) : 0;
  return settings.learning_rate * (1 + part * (settings.final_learning_rate - 1));
}

/// Rows of the minibatches of an epoch.
std::vector<std::vector<std::size_t>> minibatches(std::size_t count, const TrainingSettings& settings,
                                                  std::size_t epoch) {
  const std::vector<std::size_t> order = permutation(count, settings.seed, kBatches + epoch);
  std::vector<std::vector<std::size_t>> batches(std::max<std::size_t>(1, count / settings.batch));
  for (std::size_t b = 0; b < batches.size(); ++b)
    batches[b].assign(order.begin() + std::ptrdiff_t(count * b / batches.size()),
                      order.begin() + std::ptrdiff_t(count * (b + 1) / batches.size()));
  return batches;
}

/// Mean of the hidden units over rows of visible units.
torch::Tensor hidden_means(const Machine& machine, const torch::Tensor& visible) {
  const torch::NoGradGuard constants;
  return torch::sigmoid(torch::matmul(visible, machine.weight) + machine.hidden_bias()).mean(0);
}

/// 0 for masked weights and 1 for all others: [visible x hidden].
torch::Tensor coupled_weights(const TrainingSettings& settings, const RbmWeights& machine) {
  torch::Tensor coupled =
      torch::ones({std::int64_t(machine.visible_count), std::int64_t(machine.hidden_count)}, torch::kFloat64);
  for (const auto& [visible, hidden] : settings.masked) {
    if (visible >= machine.visible_count || hidden >= machine.hidden_count)
      throw InputError("training: the masked pair (" + std::to_string(visible) + ", " + std::to_string(hidden) +
                       ") lies outside a machine of " + std::to_string(machine.visible_count) + " x " +
                       std::to_string(machine.hidden_count) + " units");
    coupled.index_put_({std::int64_t(visible), std::int64_t(hidden)}, 0.0);
  }
  return coupled;
}

/// One training run: the machine, its optimiser and its negative phase.
class Run {
 public:
  Run(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings, const Sampler& sampler,
      const RbmWeights& start, const Teaching* teaching)
      : layout_(layout),
        table_(table),
        settings_(settings),
        machine_(start, layout.input_unit_count(), torch_device(settings.gradients)),
        optimizer_(make_optimizer(machine_, settings)),
        negative_(layout, settings, sampler, start.visible_bias) {
    if (teaching && teaching->weight > 0) teaching_.emplace(layout, *teaching, machine_.device(), &table);
    if (!settings.masked.empty()) coupled_ = coupled_weights(settings, start).to(machine_.device());
    if (const torch::Tensor steps = step_units(layout); steps.defined()) machine_.steps = steps.to(machine_.device());
    mask_weights();
    if (settings.centred) centre_on_table();
  }

  void epoch(std::size_t number) {
    for (auto& group : optimizer_->param_groups()) group.options().set_lr(learning_rate(settings_, number));
    for (const auto& rows : minibatches(table_.row_count(), settings_, number)) update(rows);
    negative_.end_epoch(machine_.weights());
  }
  RbmWeights weights() const { return machine_.weights(); }

 private:
  void update(const std::vector<std::size_t>& row_numbers) {
    const RowTensors rows = make_rows(layout_, table_, row_numbers, machine_.device());
    const torch::Tensor data = completed_rows(machine_, rows, random_bits(settings_.seed, kCompletions, 0), ++updates_);
    torch::Tensor drawn;
    if (settings_.generative > 0) drawn = negative_.draw(machine_.weights(), data).to(machine_.device());
    optimizer_->zero_grad();
    const double joint_share = teaching_ ? teaching_->joint_share() : 0;
    torch::Tensor loss = objective(machine_, rows, drawn, settings_, table_.row_count(), 1 - joint_share);
    if (teaching_) loss = loss + teaching_->next(machine_, row_numbers.size());
    if (joint_share > 0 && settings_.generative > 0)
      loss = loss + teaching_->next_joint(machine_, settings_.generative, std::max(row_numbers.size(), kJointPoints));
    loss.backward();
    optimizer_->step();
    mask_weights();
    if (!settings_.centred) return;
    const torch::Tensor mean = hidden_means(machine_, data);
    machine_.move_means(machine_.visible_mean, (1 - kSlide) * machine_.hidden_mean + kSlide * mean);
  }

  void mask_weights() {
    const torch::NoGradGuard constants;
    if (coupled_.defined()) machine_.weight *= coupled_;
  }

  void centre_on_table() {
    std::vector<std::size_t> all(table_.row_count());
    std::iota(all.begin(), all.end(), std::size_t(0));
    const RowTensors rows = make_rows(layout_, table_, all, machine_.device());
    const torch::Tensor data = completed_rows(machine_, rows, random_bits(settings_.seed, kCompletions, 0), 0);
    machine_.move_means(data.mean(0), hidden_means(machine_, data));
  }

  static constexpr double kSlide = 0.01;  // share of the minibatch in the sliding mean of the hidden units
  const VisibleLayout& layout_;
  const TrainingTable& table_;
  const TrainingSettings& settings_;
  Machine machine_;
  std::unique_ptr<torch::optim::Optimizer> optimizer_;
  NegativePhase negative_;
  std::optional<TeachingTerm> teaching_;
  torch::Tensor coupled_;  // 0 where a weight is masked, 1 elsewhere; undefined without masks
  std::uint64_t updates_ = 0;
};

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

/// Calls run.epoch() for every epoch, and the hook after those that report.
template <class Run>
TrainingResult run_epochs(Run& run, const VisibleLayout& layout, const TrainingTable& table,
                          const TrainingSettings& settings, const EpochHook& hook) {
  TrainingResult result;
  for (std::size_t epoch = 1; epoch <= settings.epochs; ++epoch) {
    stop_if_cancelled();
    run.epoch(epoch);
    if (epoch % settings.report_every != 0 && epoch != settings.epochs) continue;
    const RbmWeights now = run.weights();
    const double loss = layout.outcome_count() > 0 ? conditional_loss(Posterior(layout, now), table) : NAN;
    result.log.push_back({double(epoch), loss, NAN});
    if (hook && !hook(epoch, now)) break;
  }
  result.weights = run.weights();
  return result;
}

}  // namespace

bool gradients_on_gpu() { return torch::cuda::is_available(); }

double conditional_loss(const Posterior& posterior, const TrainingTable& table) {
  double sum = 0, total = 0;
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    sum -= table.weight[n] * std::log(posterior.marginal(table.row(n)).probability[table.outcome[n]]);
    total += table.weight[n];
  }
  return sum / total;
}

bool trains_by_words(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings,
                     const Sampler& sampler) {
  return sampler.name() == "block_gibbs" && WordGradient::serves(layout, table, settings);
}

TrainingResult train_rbm(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings,
                         const Sampler& sampler, const EpochHook& hook, const RbmWeights* start,
                         const Teaching* teaching) {
  check_table(layout, table, settings);
  const RbmWeights first = start ? *start : initial_weights(layout, table, settings);
  if (trains_by_words(layout, table, settings, sampler)) {
    WordRun run(layout, table, settings, first, teaching);
    return run_epochs(run, layout, table, settings, hook);
  }
  const OneTorchThread one_thread;
  Run run(layout, table, settings, sampler, first, teaching);
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

Objective training_objective(const RbmWeights& weights, const VisibleLayout& layout, const TrainingTable& table,
                             const TrainingSettings& settings, const SampleSet& negative, const Teaching* teaching) {
  const OneTorchThread one_thread;
  Machine machine(weights, layout.input_unit_count(), torch_device(settings.gradients));
  if (const torch::Tensor steps = step_units(layout); steps.defined()) machine.steps = steps.to(machine.device());
  std::vector<std::size_t> all(table.row_count());
  std::iota(all.begin(), all.end(), std::size_t(0));
  const torch::Tensor drawn = rows_tensor(negative, weights.visible_count).to(machine.device());
  torch::Tensor loss =
      objective(machine, make_rows(layout, table, all, machine.device()), drawn, settings, table.row_count());
  if (teaching) loss = loss + TeachingTerm(layout, *teaching, machine.device()).all(machine);
  loss.backward();
  return {loss.item<double>(), machine.gradient()};
}

namespace {

/// Trains without `held_out`, whose probabilities it takes at every report epoch.
FoldResult train_fold(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings,
                      const Sampler& sampler, const std::vector<std::size_t>& training,
                      const std::vector<std::size_t>& held_out, const EpochHook& watch, const Teaching* teaching) {
  FoldResult result;
  const auto look = [&](std::size_t epoch, const RbmWeights& weights) {
    if (watch) watch(epoch, weights);
    const Posterior posterior(layout, weights);
    for (std::size_t n : held_out) {
      const auto answer = posterior.marginal(table.row(n)).probability;
      result.probability.insert(result.probability.end(), answer.begin(), answer.end());
    }
    return true;
  };
  result.log = train_rbm(layout, table.subset(training), settings, sampler, look, nullptr, teaching).log;
  return result;
}

struct FoldRows {
  std::vector<std::size_t> training, held_out;
};

/// The results of all folds, of which `threads` are trained at a time (0: as many as there are cores).
std::vector<FoldResult> trained_folds(const VisibleLayout& layout, const TrainingTable& table,
                                      const TrainingSettings& settings, const Sampler& sampler,
                                      const std::vector<FoldRows>& rows, int threads, const FoldCalls& calls) {
  std::vector<FoldResult> result(rows.size());
  std::mutex one_at_a_time;
  std::size_t done = 0;
  const auto call = [&](const auto& function) {
    const std::lock_guard lock(one_at_a_time);
    return function();
  };
  const EpochHook look = [&](std::size_t epoch, const RbmWeights& weights) {
    return call([&] { return !calls.watch || calls.watch(epoch, weights); });
  };
  for_each_on_host(
      rows.size() + (calls.beside ? 1 : 0), 1,
      [&](std::size_t f) {
        if (f == rows.size()) return calls.beside();
        if (rows[f].training.empty()) throw InputError("cross-validation: fewer groups of trials than folds");
        std::optional<FoldResult> kept = call([&] { return calls.store.find ? calls.store.find(f) : std::nullopt; });
        if (!kept) {
          const auto taught = call([&] { return calls.teaching ? calls.teaching(f) : nullptr; });
          kept = train_fold(layout, table, settings, sampler, rows[f].training, rows[f].held_out, look, taught.get());
          if (calls.store.keep) call([&] { calls.store.keep(f, *kept); });
        }
        result[f] = std::move(*kept);
        call([&] {
          if (calls.progress) calls.progress(++done);
        });
      },
      threads);
  return result;
}

/// Adds a fold to the mean training losses and to the probabilities [report epoch][row x outcome].
void add_fold(const FoldResult& fold, const std::vector<std::size_t>& held_out, std::size_t fold_count,
              std::size_t row_count, std::size_t outcomes, CrossValidation& result,
              std::vector<std::vector<double>>& probability) {
  for (std::size_t r = 0; r < fold.log.size(); ++r) {
    if (probability.size() <= r) {
      probability.emplace_back(row_count * outcomes);
      result.log.push_back({fold.log[r].epoch, 0, 0});
    }
    result.log[r].training_loss += fold.log[r].training_loss / double(fold_count);
    for (std::size_t k = 0; k < held_out.size(); ++k)
      std::copy_n(fold.probability.begin() + std::ptrdiff_t((r * held_out.size() + k) * outcomes), outcomes,
                  probability[r].begin() + std::ptrdiff_t(held_out[k] * outcomes));
  }
}

}  // namespace

CrossValidation cross_validate(const VisibleLayout& layout, const TrainingTable& table,
                               const TrainingSettings& settings, const Sampler& sampler, std::size_t fold_count,
                               const FoldCalls& calls) {
  check_table(layout, table, settings);
  const std::size_t outcomes = layout.outcome_count();
  const std::vector<std::size_t> fold = assign_folds(table, fold_count, settings.seed);
  std::vector<FoldRows> rows(fold_count);
  for (std::size_t n = 0; n < fold.size(); ++n)
    for (std::size_t f = 0; f < fold_count; ++f) (fold[n] == f ? rows[f].held_out : rows[f].training).push_back(n);
  const bool together = trains_by_words(layout, table, settings, sampler);
  const std::vector<FoldResult> done = trained_folds(layout, table, settings, sampler, rows, together ? 0 : 1, calls);
  CrossValidation result;
  std::vector<std::vector<double>> probability;  // [report][row x outcome]
  for (std::size_t f = 0; f < fold_count; ++f)
    add_fold(done[f], rows[f].held_out, fold_count, table.row_count(), outcomes, result, probability);
  std::size_t best = 0;
  const double total = std::accumulate(table.weight.begin(), table.weight.end(), 0.0);
  for (std::size_t r = 0; r < probability.size(); ++r) {
    for (std::size_t n = 0; n < table.row_count(); ++n)
      result.log[r].held_out_loss -=
          table.weight[n] * std::log(probability[r][n * outcomes + table.outcome[n]]) / total;
    if (result.log[r].held_out_loss < result.log[best].held_out_loss) best = r;
  }
  result.best_epoch = std::size_t(result.log[best].epoch);
  result.probability = probability[best];
  return result;
}

}  // namespace gonogo::learning
