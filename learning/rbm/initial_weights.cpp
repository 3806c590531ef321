#include "learning/rbm/initial_weights.h"

#include <cmath>

#include "base/normal.h"

namespace gonogo::learning {
namespace {

constexpr std::uint64_t kInitial = 1;  // stream of random numbers

/// Number of rows with each unit on, and with its variable known: [unit]. Units of the outcome come last.
struct UnitCounts {
  std::vector<double> on, known;
};

UnitCounts count_units(const VisibleLayout& layout, const TrainingTable& table) {
  UnitCounts counts{std::vector<double>(layout.unit_count(), 0.0), std::vector<double>(layout.unit_count(), 0.0)};
  std::vector<Bit> units(layout.input_unit_count());
  const std::size_t inputs = layout.input_unit_count();
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    layout.encode(table.row(n), units);
    for (std::size_t v = 0; v < layout.variable_count(); ++v) {
      if (std::isnan(table.row(n)[v])) continue;
      for (std::size_t i = layout.offset(v); i < layout.offset(v + 1); ++i) {
        counts.on[i] += units[i];
        counts.known[i] += 1;
      }
    }
    if (inputs < counts.on.size()) counts.on[inputs + table.outcome[n]] += 1;
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

}  // namespace

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
    if (encoder.unit_count() == 0 || encoder.code() == Code::gray) continue;  // a Gray code has no other words
    pin_words(encoder, table, v, std::span(weights.visible_bias).subspan(layout.offset(v), encoder.unit_count()));
  }
  return weights;
}

}  // namespace gonogo::learning
