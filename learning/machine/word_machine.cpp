#include "learning/machine/word_machine.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/math/quad.h"
#include "base/math/random.h"
#include "base/parallel/host_loop.h"

namespace gonogo::learning {
namespace {

std::vector<std::vector<Bit>> code_words(const Encoder& encoder) {
  std::vector<std::vector<Bit>> words;
  for (int bin = 0; bin < encoder.bin_count(); ++bin)
    encoder.encode(bin, words.emplace_back(encoder.unit_count(), Bit(0)));
  return words;
}

/// Index drawn in proportion to weights, of which one is 1 and none is more. u: uniform in (0, 1).
std::size_t draw_share(std::span<const double> weights, double u) {
  double total = 0;
  for (const double x : weights) total += x;
  std::size_t k = 0;
  for (double left = u * total - weights[0]; left >= 0 && k + 1 < weights.size();) left -= weights[++k];
  return k;
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
      add_group(std::ptrdiff_t(v), layout.offset(v), code_words(encoder));
      continue;
    }
    std::vector<double> units(encoder.unit_count());
    encoder.encode_smooth(known.variables[v], units);
    for (std::size_t k = 0; k < units.size(); ++k) add_known(layout.offset(v) + k, units[k]);
  }
  if (known.outcome)
    add_known(layout.input_unit_count() + *known.outcome, 1);
  else if (layout.outcome_count() > 0)
    add_group(-1, layout.input_unit_count(), outcome_words(layout.outcome_count()));
  take_fields(weights);
}

void WordMachine::set_weights(const RbmWeights& weights) {
  hidden_bias_ = weights.hidden_bias;
  take_fields(weights);
}

WordMachine::WordMachine(const std::vector<std::size_t>& lengths, std::vector<double> word_bias,
                         std::vector<double> field, std::vector<double> hidden_bias)
    : hidden_bias_(std::move(hidden_bias)), word_bias_(std::move(word_bias)), field_(std::move(field)) {
  std::size_t first = 0;
  for (std::size_t length : lengths) {
    groups_.push_back({-1, first, length});
    first += length;
  }
  GONOGO_ASSERT(first == word_count() && field_.size() == first * hidden_count());
  transpose_fields();
}

void WordMachine::transpose_fields() {
  const std::size_t hidden = hidden_count();
  hidden_field_.resize(field_.size());
  for (std::size_t w = 0; w < word_count(); ++w)
    for (std::size_t j = 0; j < hidden; ++j) hidden_field_[j * word_count() + w] = field_[w * hidden + j];
}

void WordMachine::add_group(std::ptrdiff_t variable, std::size_t offset, const std::vector<std::vector<Bit>>& words) {
  groups_.push_back({variable, units_.size(), words.size()});
  offset_.push_back(offset);
  units_.insert(units_.end(), words.begin(), words.end());
}

void WordMachine::take_fields(const RbmWeights& weights) {
  const std::size_t hidden = hidden_count();
  word_bias_.assign(units_.size(), 0.0);
  field_.assign(units_.size() * hidden, 0.0);
  for (std::size_t g = 0; g < groups_.size(); ++g)
    for (std::size_t w = groups_[g].first; w < groups_[g].first + groups_[g].length; ++w)
      for (std::size_t k = 0; k < units_[w].size(); ++k) {
        if (!units_[w][k]) continue;
        word_bias_[w] += weights.visible_bias[offset_[g] + k];
        const double* from = weights.weight.data() + (offset_[g] + k) * hidden;
        for (std::size_t j = 0; j < hidden; ++j) field_[w * hidden + j] += from[j];
      }
  transpose_fields();
}

void WordMachine::add_by_unit(std::span<const double> field, std::size_t stride, std::span<const double> bias,
                              RbmWeights& sum) const {
  const std::size_t hidden = hidden_count();
  for (std::size_t g = 0; g < groups_.size(); ++g)
    for (std::size_t w = groups_[g].first; w < groups_[g].first + groups_[g].length; ++w)
      for (std::size_t k = 0; k < units_[w].size(); ++k) {
        if (!units_[w][k]) continue;
        sum.visible_bias[offset_[g] + k] += bias[w];
        double* to = sum.weight.data() + (offset_[g] + k) * hidden;
        for (std::size_t j = 0; j < hidden; ++j) to[j] += field[w * stride + j];
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
  for (double& x : scores) x -= highest;
  take_exponentials(scores);
  return draw_share(scores, u);
}

namespace {

constexpr std::uint64_t kStarts = std::uint64_t(1) << 62;  // rows of random numbers that no sweep reaches

/// Work space of one chain.
struct Space {
  std::vector<double> field, on;   // [hidden]: fields, and 1 + exp(-beta field)
  std::vector<double> score;       // [word]
  std::vector<const double*> add;  // fields of the hidden units that are on
};

/// score += the sum of these lists, which are as long. Sums stay in registers for kBlock words at a time.
void add_all(const std::vector<const double*>& add, std::vector<double>& score) {
  constexpr std::size_t kBlock = 4 * kQuad;
  std::size_t w = 0;
  for (; w + kBlock <= score.size(); w += kBlock) {
    Quad sum[4];
    for (std::size_t k = 0; k < 4; ++k) sum[k] = load_quad(score.data() + w + k * kQuad);
    for (const double* from : add)
      for (std::size_t k = 0; k < 4; ++k) sum[k] += load_quad(from + w + k * kQuad);
    for (std::size_t k = 0; k < 4; ++k) store_quad(sum[k], score.data() + w + k * kQuad);
  }
  for (; w < score.size(); ++w)
    for (const double* from : add) score[w] += from[w];
}

void sweep(const WordMachine& machine, double beta, ChainRandom& random, std::span<std::uint16_t> words, Space& space) {
  const std::span<const double> bias = machine.hidden_bias(), word_bias = machine.word_bias();
  const std::vector<WordGroup>& groups = machine.groups();
  space.field.assign(bias.begin(), bias.end());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto add = machine.field(groups[g].first + words[g]);
    for (std::size_t j = 0; j < add.size(); ++j) space.field[j] += add[j];
  }
  space.on.resize(space.field.size());
  for (std::size_t j = 0; j < space.on.size(); ++j) space.on[j] = -beta * space.field[j];
  take_exponentials(space.on);
  space.add.clear();
  for (std::size_t j = 0; j < space.on.size(); ++j)
    if (random(j) * (1 + space.on[j]) < 1) space.add.push_back(machine.hidden_field(j).data());
  space.score.assign(word_bias.begin(), word_bias.end());
  add_all(space.add, space.score);
  for (const WordGroup& group : groups) {
    const auto scores = std::span(space.score).subspan(group.first, group.length);
    const double highest = *std::max_element(scores.begin(), scores.end());
    for (double& x : scores) x = beta * (x - highest);
  }
  take_exponentials(space.score);
  for (std::size_t g = 0; g < groups.size(); ++g)
    words[g] = std::uint16_t(draw_share(std::span<const double>(space.score).subspan(groups[g].first, groups[g].length),
                                        random(machine.hidden_count() + g)));
}

}  // namespace

WordChains::WordChains(std::size_t chains, std::size_t rungs, std::uint64_t seed)
    : chains_(chains), rungs_(rungs), seed_(seed) {
  if (chains == 0) throw InputError("sampler: at least one chain is needed");
  if (rungs < 1 || rungs > kMaxRungs) throw InputError("sampler: rungs must lie between 1 and 64");
}

void WordChains::start(const WordMachine& machine) {
  groups_ = machine.groups().size();
  words_.resize(chains_ * rungs_ * groups_);
  for (std::size_t chain = 0; chain < chains_; ++chain) {
    ChainRandom random(seed_, chain, rungs_ * groups_);
    random.begin(kStarts);
    for (std::size_t rung = 0; rung < rungs_; ++rung)
      for (std::size_t g = 0; g < groups_; ++g)
        state(chain, rung)[g] = std::uint16_t(random(rung * groups_ + g) * double(machine.groups()[g].length));
  }
}

void WordChains::exchange(const WordMachine& machine, std::size_t chain, std::size_t rung, double u) {
  const auto here = state(chain, rung), above = state(chain, rung + 1);
  const double low = beta(rung), high = beta(rung + 1);
  const double gain = machine.log_weight(above, low) + machine.log_weight(here, high) - machine.log_weight(here, low) -
                      machine.log_weight(above, high);
  if (std::log(u) < gain) std::swap_ranges(here.begin(), here.end(), above.begin());
}

void WordChains::run_chain(const WordMachine& machine, std::size_t sweeps, std::size_t chain) {
  static thread_local Space space;
  ChainRandom random(seed_, chain, machine.hidden_count() + groups_ + 1);
  for (std::size_t s = 0; s < sweeps; ++s) {
    const std::uint64_t number = sweeps_done_ + s;
    for (std::size_t rung = 0; rung < rungs_; ++rung) {
      random.begin(number * rungs_ + rung);
      sweep(machine, beta(rung), random, state(chain, rung), space);
    }
    for (std::size_t rung = std::size_t(number % 2); rung + 1 < rungs_; rung += 2) {
      random.begin(number * rungs_ + rung);
      exchange(machine, chain, rung, random(machine.hidden_count() + groups_));
    }
  }
}

void WordChains::run(const WordMachine& machine, std::size_t sweeps) {
  if (words_.empty()) start(machine);
  GONOGO_ASSERT(machine.groups().size() == groups_);
  constexpr std::size_t kChainsAtOnce = 32;  // a sweep of one takes a microsecond or two
  for_each_on_host(chains_, kChainsAtOnce, [&](std::size_t chain) { run_chain(machine, sweeps, chain); });
  sweeps_done_ += sweeps;
}

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
