// A machine of code words, and rows of it, by chains or exact. Every variable takes one of its code words, and the
// outcome one of its units.
//
//   P(w, h) ~ exp(sum_g (a.v(w_g) + v(w_g)' W h) + b.h)
//
// w_g is the word of group g, v(w_g) its units. A group is a variable or the outcome. Given h the groups are
// independent softmax units, so block Gibbs draws a whole word at once (Salakhutdinov, Mnih, Hinton, ICML 2007, section
// 2). Words that are no code words do not exist, so codes with invalid words lose nothing.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "learning/encoding/layout.h"
#include "learning/model/weights.h"
#include "learning/sampler/chains/chain_random.h"

namespace gonogo::learning {

struct WordGroup {
  std::ptrdiff_t variable = -1;       // index in the layout; -1: the outcome
  std::size_t first = 0, length = 0;  // words first .. first + length - 1 of the machine: one per bin
};

/// What is known of a row.
struct KnownPart {
  std::vector<double> variables;  // [variable count], NaN: free; or empty: all free
  std::optional<std::size_t> outcome;
};

class WordMachine {
 public:
  /// Known variables enter by their smooth code (Encoder::encode_smooth), as in Posterior. They and fixed variables
  /// have no group. Throws InputError for weights that do not match the layout and for an outcome that does not exist.
  WordMachine(const VisibleLayout& layout, const RbmWeights& weights, const KnownPart& known = {});
  /// Of words that are given by what they add: word_bias [word], field [word x hidden]; lengths: words of each group.
  /// Such a machine has no units to write.
  WordMachine(const std::vector<std::size_t>& lengths, std::vector<double> word_bias, std::vector<double> field,
              std::vector<double> hidden_bias);

  /// Takes other weights of the same layout. For machines of which nothing is known.
  void set_weights(const RbmWeights& weights);

  const std::vector<WordGroup>& groups() const { return groups_; }
  std::size_t word_count() const { return word_bias_.size(); }  // of all groups
  std::size_t hidden_count() const { return hidden_bias_.size(); }
  std::span<const double> hidden_bias() const { return hidden_bias_; }  // b, and what the known units add to it
  std::span<const double> word_bias() const { return word_bias_; }      // a.v [word]
  /// v' W: what a word adds to the fields of the hidden units [hidden].
  std::span<const double> field(std::size_t word) const {
    return std::span(field_).subspan(word * hidden_count(), hidden_count());
  }
  /// W h' of one hidden unit: what it adds to the scores of all words [word].
  std::span<const double> hidden_field(std::size_t hidden) const {
    return std::span(hidden_field_).subspan(hidden * word_count(), word_count());
  }
  /// log of the unnormalised probability of a row of words at inverse temperature `beta`, hidden units summed out.
  /// words: [group] index inside the group.
  double log_weight(std::span<const std::uint16_t> words, double beta = 1) const;
  /// The row's units of free variables and of the outcome. units: [unit_count()] of the layout; others stay as they
  /// are.
  void write_units(std::span<const std::uint16_t> words, std::span<Bit> units) const;
  /// Adds to every unit what the words have in which it is on. field: [word x stride], of which hidden_count() count;
  /// bias: [word].
  void add_by_unit(std::span<const double> field, std::size_t stride, std::span<const double> bias,
                   RbmWeights& sum) const;

 private:
  void transpose_fields();
  void add_group(std::ptrdiff_t variable, std::size_t offset, const std::vector<std::vector<Bit>>& words);
  void take_fields(const RbmWeights& weights);

  std::vector<WordGroup> groups_;
  std::vector<std::size_t> offset_;      // [group] first unit in the layout
  std::vector<std::vector<Bit>> units_;  // [word][unit of its group]
  std::vector<double> hidden_bias_, word_bias_, field_, hidden_field_;
};

/// Index in a group drawn from its scores (logs of weights). u: uniform in (0, 1). `scores` are overwritten.
std::size_t draw_word(std::span<double> scores, double u);

/// Block Gibbs over the code words of a machine. A sweep draws the hidden units given the words, then
/// every group's word given the hidden units. With more than one rung, each chain has replicas at inverse temperatures
/// 0 ... 1 that exchange their rows after every sweep (Hukushima, Nemoto, J. Phys. Soc. Japan 65:1604, 1996).
class WordChains {
 public:
  static constexpr std::size_t kMaxRungs = 64;
  /// Throws InputError without a chain, and for rungs outside 1 .. kMaxRungs.
  WordChains(std::size_t chains, std::size_t rungs, std::uint64_t seed);

  /// Sweeps all chains. Machines of successive calls may have other weights, but the same groups. The first call starts
  /// from uniform words. Draws depend on (seed, chain, sweep) alone, so the bits do not depend on threads.
  void run(const WordMachine& machine, std::size_t sweeps);

  std::size_t chains() const { return chains_; }
  /// Row of a chain at inverse temperature 1: [group] index of the word inside its group.
  std::span<const std::uint16_t> row(std::size_t chain) const { return state(chain, rungs_ - 1); }

 private:
  std::span<const std::uint16_t> state(std::size_t chain, std::size_t rung) const {
    return std::span(words_).subspan((chain * rungs_ + rung) * groups_, groups_);
  }
  std::span<std::uint16_t> state(std::size_t chain, std::size_t rung) {
    return std::span(words_).subspan((chain * rungs_ + rung) * groups_, groups_);
  }
  double beta(std::size_t rung) const { return rungs_ > 1 ? double(rung) / double(rungs_ - 1) : 1.0; }
  void start(const WordMachine& machine);
  void run_chain(const WordMachine& machine, std::size_t sweeps, std::size_t chain);
  void exchange(const WordMachine& machine, std::size_t chain, std::size_t rung, double u);

  std::size_t chains_, rungs_, groups_ = 0;
  std::uint64_t seed_, sweeps_done_ = 0;
  std::vector<std::uint16_t> words_;  // [chain x rung x group]
};

/// Exact log Z and independent rows of a machine of code words: the hidden units are enumerated and the
/// words summed in closed form, or the words are enumerated and the hidden units summed.
class ExactWords {
 public:
  static constexpr double kMaxStates = 1 << 20;
  /// Whether hidden units or words have at most kMaxStates combinations.
  static bool possible(const WordMachine& machine);
  /// Throws InputError where it is not possible. `machine` must outlive the object.
  explicit ExactWords(const WordMachine& machine);

  double log_z() const { return log_z_; }
  /// Row `row` of the seed: [group] index of the word inside its group. Rows are independent.
  std::vector<std::uint16_t> draw(std::uint64_t seed, std::uint64_t row) const;

 private:
  void enumerate_hidden(std::size_t unit, std::size_t state, double bias, std::vector<double>& score);
  void enumerate_words(std::size_t group, std::size_t state, double bias, std::vector<double>& field);

  const WordMachine& machine_;
  bool by_hidden_;
  std::vector<double> cumulative_;  // [state] of the probabilities
  double log_z_ = 0;
};

}  // namespace gonogo::learning
