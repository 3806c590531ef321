#include "learning/sampler/exact_words.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/random.h"

namespace gonogo::learning {
namespace {

double hidden_states(const WordMachine& machine) { return std::ldexp(1.0, int(machine.hidden_count())); }

double word_states(const WordMachine& machine) {
  double states = 1;
  for (const WordGroup& group : machine.groups()) states *= double(group.length);
  return states;
}

/// Hidden units are the cheaper side where one of their states costs as much as a few states of words.
bool hidden_is_smaller(const WordMachine& machine) {
  return hidden_states(machine) * double(machine.word_count()) <
         word_states(machine) * double(std::max<std::size_t>(machine.hidden_count(), 1));
}

}  // namespace

bool ExactWords::possible(const WordMachine& machine) {
  return std::min(hidden_states(machine), word_states(machine)) <= kMaxStates;
}

ExactWords::ExactWords(const WordMachine& machine) : machine_(machine) {
  if (!possible(machine))
    throw InputError("exact sampling: the machine has " + std::to_string(machine.hidden_count()) +
                     " hidden units, and neither they nor its free variables have at most 2^20 combinations; give more "
                     "variables, or take another sampler");
  by_hidden_ =
      word_states(machine) > kMaxStates || (hidden_states(machine) <= kMaxStates && hidden_is_smaller(machine));
  cumulative_.resize(std::size_t(by_hidden_ ? hidden_states(machine) : word_states(machine)));
  std::vector<double> word_bias(machine.word_bias().begin(), machine.word_bias().end());
  std::vector<double> hidden_bias(machine.hidden_bias().begin(), machine.hidden_bias().end());
  if (by_hidden_)
    enumerate_hidden(0, 0, 0, word_bias);
  else
    enumerate_words(0, 0, 0, hidden_bias);
  log_z_ = log_sum_exp(cumulative_);
  double sum = 0;
  for (double& x : cumulative_) x = sum += std::exp(x - log_z_);
}

/// state: bit j is hidden unit j. score: [word] given the units so far.
void ExactWords::enumerate_hidden(std::size_t unit, std::size_t state, double bias, std::vector<double>& score) {
  if (unit == machine_.hidden_count()) {
    for (const WordGroup& group : machine_.groups())
      bias += log_sum_exp(std::span(score).subspan(group.first, group.length));
    cumulative_[state] = bias;
    return;
  }
  enumerate_hidden(unit + 1, state, bias, score);
  const std::vector<double> before = score;
  const auto add = machine_.hidden_field(unit);
  for (std::size_t w = 0; w < score.size(); ++w) score[w] += add[w];
  enumerate_hidden(unit + 1, state | std::size_t(1) << unit, bias + machine_.hidden_bias()[unit], score);
  score = before;
}

/// state: the words as digits, the first group the most significant.
void ExactWords::enumerate_words(std::size_t group, std::size_t state, double bias, std::vector<double>& field) {
  if (group == machine_.groups().size()) {
    for (double x : field) bias += softplus(x);
    cumulative_[state] = bias;
    return;
  }
  const WordGroup& words = machine_.groups()[group];
  const std::vector<double> before = field;
  for (std::size_t k = 0; k < words.length; ++k) {
    const auto add = machine_.field(words.first + k);
    for (std::size_t j = 0; j < field.size(); ++j) field[j] = before[j] + add[j];
    enumerate_words(group + 1, state * words.length + k, bias + machine_.word_bias()[words.first + k], field);
  }
  field = before;
}

std::vector<std::uint16_t> ExactWords::draw(std::uint64_t seed, std::uint64_t row) const {
  const double u = random_unit(seed, row, 0) * cumulative_.back();
  const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end(), u);
  std::size_t state = std::min(std::size_t(found - cumulative_.begin()), cumulative_.size() - 1);
  const std::vector<WordGroup>& groups = machine_.groups();
  std::vector<std::uint16_t> words(groups.size());
  if (!by_hidden_) {
    for (std::size_t g = groups.size(); g-- > 0; state /= groups[g].length)
      words[g] = std::uint16_t(state % groups[g].length);
    return words;
  }
  std::vector<double> score(machine_.word_bias().begin(), machine_.word_bias().end());
  for (std::size_t j = 0; j < machine_.hidden_count(); ++j) {
    if (!(state >> j & 1)) continue;
    const auto add = machine_.hidden_field(j);
    for (std::size_t w = 0; w < score.size(); ++w) score[w] += add[w];
  }
  for (std::size_t g = 0; g < groups.size(); ++g)
    words[g] = std::uint16_t(
        draw_word(std::span(score).subspan(groups[g].first, groups[g].length), random_unit(seed, row, 1 + g)));
  return words;
}

}  // namespace gonogo::learning
