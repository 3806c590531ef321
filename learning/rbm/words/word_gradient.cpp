#include "learning/rbm/words/word_gradient.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/math/quad.h"

namespace gonogo::learning {
namespace {

constexpr double kLargestField = 80;       // [nat]: eight factors exp(-f) + exp(U) then multiply without overflow
constexpr std::size_t kFactorsAtOnce = 8;  // lanes that are multiplied before their exponents are taken out

std::size_t whole_lanes(std::size_t count) { return (count + kQuad - 1) / kQuad * kQuad; }

/// to += factor * from; both hold whole lanes.
void add_times(const double* from, double factor, std::size_t count, double* to) {
  for (std::size_t j = 0; j < count; j += kQuad) store_quad(load_quad(to + j) + factor * load_quad(from + j), to + j);
}

/// Appends the row's words, those of interpolated values as two with their shares.
void append(const VisibleLayout& layout, std::span<const double> row, bool smooth, WordMixtures& rows) {
  std::size_t first = 0;
  for (std::size_t v = 0; v < layout.variable_count(); ++v) {
    const Encoder& encoder = layout.encoders()[v];
    if (encoder.unit_count() == 0) continue;
    const Encoder::Place place = smooth ? encoder.between(row[v]) : Encoder::Place{encoder.bin_of(row[v]), 0};
    const auto add = [&](int bin, double share) {
      rows.word.push_back(std::uint32_t(first) + std::uint32_t(bin));
      rows.share.push_back(share);
    };
    if (place.share < 1) add(place.left, 1 - place.share);
    if (place.share > 0) add(place.left + 1, place.share);
    first += std::size_t(encoder.bin_count());
  }
  rows.first.push_back(rows.word.size());
}

}  // namespace

std::vector<double> step_rows(const VisibleLayout& layout) {
  std::vector<std::vector<double>> rows;
  bool changed = false;
  const auto add_unit = [&](std::size_t unit) { rows.emplace_back(layout.unit_count(), 0.0)[unit] = 1; };
  for (std::size_t v = 0; v < layout.variable_count(); ++v) {
    const Encoder& encoder = layout.encoders()[v];
    const std::size_t first = layout.offset(v), units = encoder.unit_count();
    if (!has_all_words(encoder.code())) {
      for (std::size_t k = 0; k < units; ++k) add_unit(first + k);
      continue;
    }
    changed = changed || units > 0;
    std::vector<Bit> word(units), next(units);
    for (int bin = 0; bin + 1 < encoder.bin_count(); ++bin) {
      encoder.encode(bin, word);
      encoder.encode(bin + 1, next);
      std::vector<double>& row = rows.emplace_back(layout.unit_count(), 0.0);
      for (std::size_t k = 0; k < units; ++k) row[first + k] = double(next[k]) - double(word[k]);
    }
  }
  if (!changed) return {};
  for (std::size_t y = layout.input_unit_count(); y < layout.unit_count(); ++y) add_unit(y);
  std::vector<double> result;
  for (const std::vector<double>& row : rows) result.insert(result.end(), row.begin(), row.end());
  return result;
}

bool WordGradient::serves(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings) {
  if (settings.negative != NegativePhaseKind::code_words || settings.gradients != GradientDevice::cpu ||
      settings.centred || !settings.masked.empty() || layout.outcome_count() == 0)
    return false;
  for (std::size_t n = 0; n < table.row_count(); ++n)
    for (std::size_t v = 0; v < layout.variable_count(); ++v)
      if (layout.encoders()[v].unit_count() > 0 && std::isnan(table.row(n)[v])) return false;
  return true;
}

WordGradient::WordGradient(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings,
                           const Teaching* teaching)
    : layout_(layout),
      table_(table),
      settings_(settings),
      hidden_(settings.hidden),
      padded_(whole_lanes(settings.hidden)),
      outcomes_(layout.outcome_count()),
      row_field_(padded_),
      inverse_(padded_),
      row_slope_(padded_),
      share_(outcomes_),
      slope_(outcomes_),
      hidden_gradient_(padded_),
      gradient_(RbmWeights::zeros(layout.unit_count(), settings.hidden)) {
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    append(layout, table.row(n), true, smooth_);
    append(layout, table.row(n), false, hard_);
  }
  for (const Encoder& encoder : layout.encoders())
    if (encoder.unit_count() > 0) first_outcome_ += std::size_t(encoder.bin_count());
  const std::size_t words = first_outcome_ + outcomes_;
  field_.resize(words * padded_);
  bias_.resize(padded_);
  field_gradient_.resize(words * padded_);
  bias_gradient_.resize(words);
  odds_.resize(outcomes_ * padded_);
  outcome_bias_.resize(outcomes_);
  take_steps();
  if (!teaching || teaching->weight == 0) return;
  check_teaching(layout, *teaching);
  taught_weight_ = teaching->weight;
  passes_ = teaching->label;
  taught_probability_ = teaching->probability;
  const auto point = [&](std::size_t k) {
    return std::span(teaching->points).subspan(k * layout.variable_count(), layout.variable_count());
  };
  for (std::size_t k = 0; k < taught_probability_.size(); ++k) append(layout, point(k), true, taught_);
  if (teaching->joint_share == 0) return;
  for (const std::size_t k : points_in_box(*teaching, table)) {
    append(layout, point(k), false, joint_);
    joint_probability_.push_back(teaching->probability[k]);
  }
  if (joint_.size() > 0) joint_share_ = teaching->joint_share;
}

void WordGradient::take_steps() {
  const std::vector<double> step = step_rows(layout_);
  if (step.empty()) return;
  const std::size_t visible = layout_.unit_count();
  step_product_.assign(visible * visible, 0.0);
  for (std::size_t first = 0; first < step.size(); first += visible)
    for (std::size_t i = 0; i < visible; ++i)
      for (std::size_t k = 0; k < visible; ++k) step_product_[i * visible + k] += step[first + i] * step[first + k];
}

void WordGradient::take_words(const WordMachine& words) {
  for (std::size_t w = 0; w < words.word_count(); ++w)
    std::copy_n(words.field(w).begin(), hidden_, field_.begin() + std::ptrdiff_t(w * padded_));
  std::copy_n(words.hidden_bias().begin(), hidden_, bias_.begin());
  largest_outcome_field_ = 0;
  for (std::size_t y = 0; y < outcomes_; ++y) {
    const double* field = field_.data() + (first_outcome_ + y) * padded_;
    for (std::size_t j = 0; j < hidden_; ++j)
      largest_outcome_field_ = std::max(largest_outcome_field_, std::abs(field[j]));
    std::copy_n(field, padded_, odds_.begin() + std::ptrdiff_t(y * padded_));
    outcome_bias_[y] = words.word_bias()[first_outcome_ + y];
  }
  take_exponentials(odds_);
  for (std::size_t y = 0; y < outcomes_; ++y)  // a unit beyond the hidden ones is never on
    std::fill_n(odds_.begin() + std::ptrdiff_t(y * padded_ + hidden_), padded_ - hidden_, 0.0);
}

void WordGradient::add_word(std::size_t word, double share) {
  add_times(field_.data() + word * padded_, share, padded_, row_field_.data());
}

void WordGradient::spread(std::size_t word, double share, double slope) {
  add_times(row_slope_.data(), share, padded_, field_gradient_.data() + word * padded_);
  bias_gradient_[word] += share * slope;
}

/// P(y | x) by the products of the header, as mantissa and exponent.
void WordGradient::outcome_shares() {
  double largest = largest_outcome_field_;
  for (std::size_t j = 0; j < hidden_; ++j) largest = std::max(largest, std::abs(row_field_[j]));
  if (!(largest < kLargestField)) return outcome_shares_by_logs();
  constexpr std::int64_t kMantissa = (std::int64_t(1) << 52) - 1, kOne = std::int64_t(1023) << 52;
  double highest = -INFINITY;
  for (std::size_t y = 0; y < outcomes_; ++y) {
    const double* odds = odds_.data() + y * padded_;
    Quad product = Quad{} + 1.0;
    QuadBits exponent = {};
    for (std::size_t j = 0; j < padded_;) {
      for (const std::size_t end = std::min(padded_, j + kFactorsAtOnce * kQuad); j < end; j += kQuad)
        product *= load_quad(inverse_.data() + j) + load_quad(odds + j);
      const QuadBits bits = (QuadBits)product;
      exponent += (bits >> 52) - 1023;
      product = (Quad)((bits & kMantissa) | kOne);
    }
    const double mantissa = (product[0] * product[1]) * (product[2] * product[3]);
    const std::int64_t octaves = exponent[0] + exponent[1] + exponent[2] + exponent[3];
    share_[y] = outcome_bias_[y] + std::log(mantissa) + double(octaves) * std::numbers::ln2;
    highest = std::max(highest, share_[y]);
  }
  double total = 0;
  for (double& x : share_) x -= highest;
  take_exponentials(share_);
  for (const double x : share_) total += x;
  for (double& x : share_) x /= total;
}

void WordGradient::outcome_shares_by_logs() {
  for (std::size_t y = 0; y < outcomes_; ++y) {
    share_[y] = outcome_bias_[y];
    const double* field = field_.data() + (first_outcome_ + y) * padded_;
    for (std::size_t j = 0; j < hidden_; ++j) share_[y] += softplus(row_field_[j] + field[j]);
  }
  normalise_logs(share_);
}

/// slopes(share_, slope_) gives the gradient by the score of every outcome.
template <class Slopes>
void WordGradient::add_row(const WordMixtures& rows, std::size_t row, const Slopes& slopes) {
  row_field_ = bias_;
  for (std::size_t k = rows.first[row]; k < rows.first[row + 1]; ++k) add_word(rows.word[k], rows.share[k]);
  for (std::size_t j = 0; j < padded_; ++j) inverse_[j] = -row_field_[j];
  take_exponentials(inverse_);
  outcome_shares();
  slopes(share_, slope_);
  std::fill(row_slope_.begin(), row_slope_.end(), 0.0);
  double total = 0;
  for (std::size_t y = 0; y < outcomes_; ++y) {
    const double slope = slope_[y];
    const double* odds = odds_.data() + y * padded_;
    double* gradient = field_gradient_.data() + (first_outcome_ + y) * padded_;
    for (std::size_t j = 0; j < padded_; j += kQuad) {
      const Quad on = load_quad(odds + j);
      const Quad part = slope * on / (load_quad(inverse_.data() + j) + on);
      store_quad(load_quad(row_slope_.data() + j) + part, row_slope_.data() + j);
      store_quad(load_quad(gradient + j) + part, gradient + j);
    }
    bias_gradient_[first_outcome_ + y] += slope;
    total += slope;
  }
  add_times(row_slope_.data(), 1, padded_, hidden_gradient_.data());
  for (std::size_t k = rows.first[row]; k < rows.first[row + 1]; ++k) spread(rows.word[k], rows.share[k], total);
}

/// The gradient of `slope` times the score of the row whose words were added, the outcome's among them; its words are
/// then to be spread.
void WordGradient::add_complete(double slope) {
  for (std::size_t j = 0; j < padded_; j += kQuad)
    store_quad(slope / (1.0 + exponential(-load_quad(row_field_.data() + j))), row_slope_.data() + j);
  add_times(row_slope_.data(), 1, padded_, hidden_gradient_.data());
}

void WordGradient::add_machine_rows(const WordMachine& words, const WordChains& chains) {
  const double slope = settings_.generative / double(chains.chains());
  const std::vector<WordGroup>& groups = words.groups();
  for (std::size_t c = 0; c < chains.chains(); ++c) {
    const std::span<const std::uint16_t> row = chains.row(c);
    row_field_ = bias_;
    for (std::size_t g = 0; g < row.size(); ++g) add_word(groups[g].first + row[g], 1);
    add_complete(slope);
    for (std::size_t g = 0; g < row.size(); ++g) spread(groups[g].first + row[g], 1, slope);
  }
}

/// The data of both likelihoods.
void WordGradient::add_trials(std::span<const std::size_t> rows, double trial_share) {
  const double count = double(rows.size());
  for (const std::size_t n : rows) {
    const std::size_t label = table_.outcome[n];
    const double weight = table_.weight[n] / count;
    if (settings_.discriminative > 0)
      add_row(smooth_, n, [&](std::span<const double> share, std::span<double> slope) {
        for (std::size_t y = 0; y < outcomes_; ++y)
          slope[y] = settings_.discriminative * weight * (share[y] - double(y == label));
      });
    if (settings_.generative == 0) continue;
    const double slope = -settings_.generative * trial_share * weight;
    const std::size_t first = hard_.first[n], end = hard_.first[n + 1];
    row_field_ = bias_;
    for (std::size_t k = first; k < end; ++k) add_word(hard_.word[k], 1);
    add_word(first_outcome_ + label, 1);
    add_complete(slope);
    for (std::size_t k = first; k < end; ++k) spread(hard_.word[k], 1, slope);
    spread(first_outcome_ + label, 1, slope);
  }
}

/// P(y | x, class of y) times the teacher's probability of that class.
void WordGradient::taught_shares(double probability, std::span<const double> share, std::span<double> taught) const {
  constexpr double kTiny = 1e-300;  // both classes are possible, but rounding may leave nothing of one
  double passes = kTiny, fails = kTiny;
  for (std::size_t y = 0; y < outcomes_; ++y) (passes_[y] ? passes : fails) += share[y];
  for (std::size_t y = 0; y < outcomes_; ++y)
    taught[y] = share[y] * (passes_[y] ? probability / passes : (1 - probability) / fails);
}

void WordGradient::add_taught(std::size_t count) {
  const std::size_t wanted = std::min(count, taught_.size()),
                    first = first_of_next(next_taught_, wanted, taught_.size());
  const double weight = taught_weight_ / double(wanted);
  for (std::size_t k = first; k < first + wanted; ++k)
    add_row(taught_, k, [&](std::span<const double> share, std::span<double> slope) {
      taught_shares(taught_probability_[k], share, slope);
      for (std::size_t y = 0; y < outcomes_; ++y) slope[y] = weight * (share[y] - slope[y]);
    });
}

void WordGradient::add_joint(std::size_t count) {
  const std::size_t wanted = std::min(count, joint_.size()), first = first_of_next(next_joint_, wanted, joint_.size());
  const double weight = joint_share_ * settings_.generative / double(wanted);
  for (std::size_t k = first; k < first + wanted; ++k)
    add_row(joint_, k, [&](std::span<const double> share, std::span<double> slope) {
      taught_shares(joint_probability_[k], share, slope);
      for (double& x : slope) x *= -weight;
    });
}

/// The prior on what a step from bin to bin adds, and on the hidden units' biases.
void WordGradient::add_prior(const RbmWeights& weights) {
  const double strength = settings_.weight_decay / double(table_.row_count());
  const std::size_t visible = weights.visible_count;
  for (std::size_t j = 0; j < hidden_; ++j) gradient_.hidden_bias[j] += strength * weights.hidden_bias[j];
  if (step_product_.empty()) {
    for (std::size_t k = 0; k < weights.weight.size(); ++k) gradient_.weight[k] += strength * weights.weight[k];
    return;
  }
  for (std::size_t i = 0; i < visible; ++i)
    for (std::size_t other = 0; other < visible; ++other) {
      const double factor = strength * step_product_[i * visible + other];
      if (factor == 0) continue;
      for (std::size_t j = 0; j < hidden_; ++j)
        gradient_.weight[i * hidden_ + j] += factor * weights.weight[other * hidden_ + j];
    }
}

const RbmWeights& WordGradient::operator()(const WordMachine& words, const RbmWeights& weights,
                                           std::span<const std::size_t> rows, const WordChains& chains) {
  take_words(words);
  for (auto* sum : {&field_gradient_, &bias_gradient_, &hidden_gradient_, &gradient_.weight, &gradient_.visible_bias})
    std::fill(sum->begin(), sum->end(), 0.0);
  add_trials(rows, 1 - joint_share_);
  if (settings_.generative > 0) add_machine_rows(words, chains);
  if (taught_.size() > 0) add_taught(rows.size());
  if (joint_share_ > 0 && settings_.generative > 0) add_joint(std::max(rows.size(), kJointPoints));
  words.add_by_unit(field_gradient_, padded_, bias_gradient_, gradient_);
  std::copy_n(hidden_gradient_.begin(), hidden_, gradient_.hidden_bias.begin());
  add_prior(weights);
  return gradient_;
}

}  // namespace gonogo::learning
