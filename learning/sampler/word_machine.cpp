#include "learning/sampler/word_machine.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace gonogo::learning {
namespace {

std::vector<std::vector<Bit>> code_words(const Encoder& encoder) {
  std::vector<std::vector<Bit>> words;
  for (int bin = 0; bin < encoder.bin_count(); ++bin)
    encoder.encode(bin, words.emplace_back(encoder.unit_count(), Bit(0)));
  return words;
}

std::vector<std::vector<Bit>> outcome_words(std::size_t count) {
  std::vector<std::vector<Bit>> words(count, std::vector<Bit>(count, Bit(0)));
  for (std::size_t y = 0; y < count; ++y) words[y][y] = 1;
  return words;
}

}  // namespace

WordMachine::WordMachine(const VisibleLayout& layout, const RbmWeights& weights, const KnownPart& known)
    : hidden_bias_(weights.hidden_bias) {
  if (weights.visible_count != layout.unit_count())
    throw InputError("machine: " + std::to_string(weights.visible_count) + " visible units where the layout has " +
                     std::to_string(layout.unit_count()));
  if (!known.variables.empty() && known.variables.size() != layout.variable_count())
    throw InputError("machine: " + std::to_string(known.variables.size()) + " known values where the layout has " +
                     std::to_string(layout.variable_count()) + " variables");
  if (known.outcome && *known.outcome >= layout.outcome_count())
    throw InputError("machine: outcome " + std::to_string(*known.outcome) + " does not exist");
  const std::size_t hidden = hidden_count();
  const auto add_known = [&](std::size_t unit, double value) {
    for (std::size_t j = 0; j < hidden; ++j) hidden_bias_[j] += value * weights.weight[unit * hidden + j];
  };
  for (std::size_t v = 0; v < layout.variable_count(); ++v) {
    const Encoder& encoder = layout.encoders()[v];
    if (encoder.unit_count() == 0) continue;
    if (known.variables.empty() || std::isnan(known.variables[v])) {
      add_group(weights, std::ptrdiff_t(v), layout.offset(v), code_words(encoder));
      continue;
    }
    std::vector<double> units(encoder.unit_count());
    encoder.encode_smooth(known.variables[v], units);
    for (std::size_t k = 0; k < units.size(); ++k) add_known(layout.offset(v) + k, units[k]);
  }
  if (known.outcome)
    add_known(layout.input_unit_count() + *known.outcome, 1);
  else if (layout.outcome_count() > 0)
    add_group(weights, -1, layout.input_unit_count(), outcome_words(layout.outcome_count()));
  hidden_field_.resize(field_.size());
  for (std::size_t w = 0; w < word_count(); ++w)
    for (std::size_t j = 0; j < hidden; ++j) hidden_field_[j * word_count() + w] = field_[w * hidden + j];
}

void WordMachine::add_group(const RbmWeights& weights, std::ptrdiff_t variable, std::size_t offset,
                            const std::vector<std::vector<Bit>>& words) {
  const std::size_t hidden = hidden_count();
  groups_.push_back({variable, word_count(), words.size()});
  offset_.push_back(offset);
  for (const std::vector<Bit>& word : words) {
    const std::size_t at = field_.size();
    field_.resize(at + hidden, 0.0);
    double bias = 0;
    for (std::size_t k = 0; k < word.size(); ++k) {
      if (!word[k]) continue;
      bias += weights.visible_bias[offset + k];
      for (std::size_t j = 0; j < hidden; ++j) field_[at + j] += weights.weight[(offset + k) * hidden + j];
    }
    word_bias_.push_back(bias);
    units_.push_back(word);
  }
}

double WordMachine::log_weight(std::span<const std::uint16_t> words, double beta) const {
  GONOGO_ASSERT(words.size() == groups_.size());
  std::vector<double> sum = hidden_bias_;
  double result = 0;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const std::size_t word = groups_[g].first + words[g];
    result += beta * word_bias_[word];
    const auto add = field(word);
    for (std::size_t j = 0; j < sum.size(); ++j) sum[j] += add[j];
  }
  for (double x : sum) result += softplus(beta * x);
  return result;
}

void WordMachine::write_units(std::span<const std::uint16_t> words, std::span<Bit> units) const {
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const std::vector<Bit>& word = units_[groups_[g].first + words[g]];
    std::copy(word.begin(), word.end(), units.begin() + std::ptrdiff_t(offset_[g]));
  }
}

std::size_t draw_word(std::span<double> scores, double u) {
  const double highest = *std::max_element(scores.begin(), scores.end());
  double total = 0;
  for (double& x : scores) total += x = std::exp(x - highest);
  std::size_t k = 0;
  for (double left = u * total - scores[0]; left >= 0 && k + 1 < scores.size();) left -= scores[++k];
  return k;
}

}  // namespace gonogo::learning
