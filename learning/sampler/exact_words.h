// Exact log Z and independent rows of a machine of code words (word_machine.h): the hidden units are enumerated and the
// words summed in closed form, or the words are enumerated and the hidden units summed.
#pragma once
#include <cstdint>
#include <vector>

#include "learning/sampler/word_machine.h"

namespace gonogo::learning {

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
