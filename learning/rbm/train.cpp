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

namespace gonogo::learning {
namespace {

constexpr std::uint64_t kCompletions = 3;  // stream of random numbers; learning/rbm/words has others

std::unique_ptr<torch::optim::Optimizer> make_optimizer(const Machine& machine, const TrainingSettings& settings) {
  if (settings.optimizer == Optimizer::adam)
    return std::make_unique<torch::optim::Adam>(machine.parameters(),
                                                torch::optim::AdamOptions(settings.learning_rate));
  return std::make_unique<torch::optim::SGD>(
      machine.parameters(), torch::optim::SGDOptions(settings.learning_rate).momentum(settings.momentum));
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

}  // namespace

bool gradients_on_gpu() { return torch::cuda::is_available(); }

bool trains_by_words(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings,
                     const Sampler& sampler) {
  return sampler.name() == "block_gibbs" && are_words(layout, table, settings);
}

TrainingResult train_rbm(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings,
                         const Sampler& sampler, const EpochHook& hook, const RbmWeights* start,
                         const Teaching* teaching) {
  check_table(layout, table, settings);
  const RbmWeights first = start ? *start : initial_weights(layout, table, settings);
  if (trains_by_words(layout, table, settings, sampler))
    return train_words(layout, table, settings, hook, first, teaching);
  const OneTorchThread one_thread;
  Run run(layout, table, settings, sampler, first, teaching);
  return run_epochs(run, layout, table, settings, hook);
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
