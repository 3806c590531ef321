#include "learning/rbm/train.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/cancel.h"
#include "base/error.h"
#include "base/random.h"
#include "learning/rbm/tensors.h"

namespace gonogo::learning {
namespace {

/// Streams of random numbers under one seed.
enum Stream : std::uint64_t { kInitial = 1, kChains = 2, kBatches = 1000 };

double normal_draw(std::uint64_t seed, std::uint64_t index) {
  const double u = 1 - random_unit(seed, kInitial, 2 * index), v = random_unit(seed, kInitial, 2 * index + 1);
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
}

void check_table(const VisibleLayout& layout, const TrainingTable& table) {
  if (table.row_count() == 0) throw InputError("training table: no valid trial to train on");
  if (table.variable_count != layout.variable_count())
    throw InputError("training table: " + std::to_string(table.variable_count) + " variables where the layout has " +
                     std::to_string(layout.variable_count()));
  for (std::size_t y : table.outcome)
    if (y >= layout.outcome_count())
      throw InputError("training table: outcome " + std::to_string(y) + " does not exist");
}

/// Small random weights; visible biases at the log odds of the data, half a row added to both sides so that an outcome
/// that never happened starts rare but possible.
RbmWeights initial_weights(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings) {
  RbmWeights weights = RbmWeights::zeros(layout.unit_count(), settings.hidden);
  for (std::size_t k = 0; k < weights.weight.size(); ++k)
    weights.weight[k] = settings.initial_weight * normal_draw(settings.seed, k);
  std::vector<double> on(layout.unit_count(), 0.0), known(layout.unit_count(), 0.0);
  std::vector<Bit> units(layout.input_unit_count());
  const std::size_t inputs = layout.input_unit_count();
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    layout.encode(table.row(n), units);
    for (std::size_t v = 0; v < layout.variable_count(); ++v) {
      if (std::isnan(table.row(n)[v])) continue;
      for (std::size_t i = layout.offset(v); i < layout.offset(v + 1); ++i) {
        on[i] += units[i];
        known[i] += 1;
      }
    }
    on[inputs + table.outcome[n]] += 1;
  }
  for (std::size_t i = 0; i < inputs; ++i) weights.visible_bias[i] = std::log((on[i] + 0.5) / (known[i] - on[i] + 0.5));
  for (std::size_t i = inputs; i < on.size(); ++i) weights.visible_bias[i] = std::log(on[i] + 0.5);
  return weights;
}

torch::Tensor rows_tensor(const SampleSet& samples, std::size_t visible) {
  const std::size_t rows = samples.row_count();
  torch::Tensor result = torch::empty({std::int64_t(rows), std::int64_t(visible)}, torch::kFloat64);
  double* out = result.data_ptr<double>();
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t i = 0; i < visible; ++i) *out++ = samples.row(r)[i];
  return result;
}

/// The negative phase: rows of the machine as it is now, from chains that persist.
class NegativePhase {
 public:
  NegativePhase(const VisibleLayout& layout, const TrainingSettings& settings, const Sampler& sampler)
      : labels_(layout.unit_labels()), settings_(settings), sampler_(sampler) {}

  torch::Tensor draw(const RbmWeights& weights) {
    SampleRequest request;
    request.reads = settings_.chains;
    request.seed = random_bits(settings_.seed, kChains, update_++);
    request.sweeps = settings_.sweeps;
    if (rows_.row_count() > 0) request.start = &rows_;
    rows_ = sampler_.sample(to_qubo(weights, labels_), request);
    return rows_tensor(rows_, weights.visible_count);
  }

 private:
  std::vector<std::string> labels_;
  const TrainingSettings& settings_;
  const Sampler& sampler_;
  SampleSet rows_;
  std::uint64_t update_ = 0;
};

}  // namespace

double conditional_loss(const Posterior& posterior, const TrainingTable& table) {
  double sum = 0, total = 0;
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    sum -= table.weight[n] * std::log(posterior.marginal(table.row(n)).probability[table.outcome[n]]);
    total += table.weight[n];
  }
  return sum / total;
}

TrainingResult train_rbm(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings,
                         const Sampler& sampler, const EpochHook& hook) {
  check_table(layout, table);
  const OneTorchThread one_thread;
  Machine machine(initial_weights(layout, table, settings), layout.input_unit_count());
  torch::optim::Adam adam(machine.parameters(), torch::optim::AdamOptions(settings.learning_rate));
  NegativePhase negative(layout, settings, sampler);
  TrainingResult result;
  const std::size_t count = table.row_count(), batches = std::max<std::size_t>(1, count / settings.batch);
  for (std::size_t epoch = 1; epoch <= settings.epochs; ++epoch) {
    stop_if_cancelled();
    const std::vector<std::size_t> order = permutation(count, settings.seed, kBatches + epoch);
    for (std::size_t b = 0; b < batches; ++b) {
      const std::vector<std::size_t> rows(order.begin() + std::ptrdiff_t(count * b / batches),
                                          order.begin() + std::ptrdiff_t(count * (b + 1) / batches));
      const torch::Tensor drawn = settings.generative > 0 ? negative.draw(machine.weights()) : torch::Tensor();
      adam.zero_grad();
      objective(machine, make_rows(layout, table, rows), drawn, settings, count).backward();
      adam.step();
    }
    if (epoch % settings.report_every != 0 && epoch != settings.epochs) continue;
    const RbmWeights now = machine.weights();
    result.log.push_back({double(epoch), conditional_loss(Posterior(layout, now), table), NAN});
    if (hook && !hook(epoch, now)) break;
  }
  result.weights = machine.weights();
  return result;
}

Objective training_objective(const RbmWeights& weights, const VisibleLayout& layout, const TrainingTable& table,
                             const TrainingSettings& settings, const SampleSet& negative) {
  const OneTorchThread one_thread;
  Machine machine(weights, layout.input_unit_count());
  std::vector<std::size_t> all(table.row_count());
  std::iota(all.begin(), all.end(), std::size_t(0));
  const torch::Tensor loss = objective(machine, make_rows(layout, table, all),
                                       rows_tensor(negative, weights.visible_count), settings, table.row_count());
  loss.backward();
  return {loss.item<double>(), machine.gradient()};
}

CrossValidation cross_validate(const VisibleLayout& layout, const TrainingTable& table,
                               const TrainingSettings& settings, const Sampler& sampler, std::size_t fold_count,
                               const std::function<void(std::size_t)>& progress) {
  check_table(layout, table);
  const std::size_t outcomes = layout.outcome_count();
  const std::vector<std::size_t> fold = assign_folds(table, fold_count, settings.seed);
  CrossValidation result;
  std::vector<std::vector<double>> probability;  // [report][row x outcome]
  for (std::size_t f = 0; f < fold_count; ++f) {
    std::vector<std::size_t> training, held_out;
    for (std::size_t n = 0; n < fold.size(); ++n) (fold[n] == f ? held_out : training).push_back(n);
    if (training.empty()) throw InputError("cross-validation: fewer groups of trials than folds");
    std::size_t report = 0;
    const auto look = [&](std::size_t epoch, const RbmWeights& weights) {
      const Posterior posterior(layout, weights);
      if (probability.size() <= report) {
        probability.emplace_back(table.row_count() * outcomes);
        result.log.push_back({double(epoch), 0, 0});
      }
      for (std::size_t n : held_out) {
        const auto answer = posterior.marginal(table.row(n)).probability;
        std::copy(answer.begin(), answer.end(), probability[report].begin() + std::ptrdiff_t(n * outcomes));
      }
      ++report;
      return true;
    };
    const TrainingResult trained = train_rbm(layout, table.subset(training), settings, sampler, look);
    for (std::size_t r = 0; r < trained.log.size(); ++r)
      result.log[r].training_loss += trained.log[r].training_loss / double(fold_count);
    if (progress) progress(f + 1);
  }
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
