// A machine of code words: every variable takes one of its code words, and the outcome one of its units.
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

 private:
  void add_group(const RbmWeights& weights, std::ptrdiff_t variable, std::size_t offset,
                 const std::vector<std::vector<Bit>>& words);

  std::vector<WordGroup> groups_;
  std::vector<std::size_t> offset_;      // [group] first unit in the layout
  std::vector<std::vector<Bit>> units_;  // [word][unit of its group]
  std::vector<double> hidden_bias_, word_bias_, field_, hidden_field_;
};

/// Index in a group drawn from its scores (logs of weights). u: uniform in (0, 1). `scores` are overwritten.
std::size_t draw_word(std::span<double> scores, double u);

}  // namespace gonogo::learning
