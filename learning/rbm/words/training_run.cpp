#include "learning/rbm/words/training_run.h"

#include <algorithm>
#include <string>

#include "base/error.h"
#include "base/math/random.h"

namespace gonogo::learning {
namespace {

constexpr std::uint64_t kInitial = 1, kBatches = 1000;  // streams of random numbers; epochs add to kBatches

/// Biases of the units of variable `v`, by which each of its words alone has its share of the rows. A thermometer's
/// word k has the first k units on, so unit k turns the share of word k into that of word k + 1.
void pin_words(const Encoder& encoder, const TrainingTable& table, std::size_t v, std::span<double> bias) {
  std::vector<double> rows(std::size_t(encoder.bin_count()), 0.5);
  for (std::size_t n = 0; n < table.row_count(); ++n)
    if (!std::isnan(table.row(n)[v])) rows[std::size_t(encoder.bin_of(table.row(n)[v]))] += 1;
  for (std::size_t k = 0; k < bias.size(); ++k)
    bias[k] = encoder.code() == Code::one_hot ? std::log(rows[k]) : std::log(rows[k + 1] / rows[k]);
}

}  // namespace

UnitCounts count_units(const VisibleLayout& layout, const TrainingTable& table, bool weighed) {
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

double learning_rate(const TrainingSettings& settings, std::size_t epoch) {
  const double part = settings.epochs > 1 ? double(epoch - 1) / double(settings.epochs - 1) : 0;
  return settings.learning_rate * (1 + part * (settings.final_learning_rate - 1));
}

std::vector<std::vector<std::size_t>> minibatches(std::size_t count, const TrainingSettings& settings,
                                                  std::size_t epoch) {
  const std::vector<std::size_t> order = permutation(count, settings.seed, kBatches + epoch);
  std::vector<std::vector<std::size_t>> batches(std::max<std::size_t>(1, count / settings.batch));
  for (std::size_t b = 0; b < batches.size(); ++b)
    batches[b].assign(order.begin() + std::ptrdiff_t(count * b / batches.size()),
                      order.begin() + std::ptrdiff_t(count * (b + 1) / batches.size()));
  return batches;
}

double conditional_loss(const Posterior& posterior, const TrainingTable& table) {
  double sum = 0, total = 0;
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    sum -= table.weight[n] * std::log(posterior.marginal(table.row(n)).probability[table.outcome[n]]);
    total += table.weight[n];
  }
  return sum / total;
}

}  // namespace gonogo::learning
