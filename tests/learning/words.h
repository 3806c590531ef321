// A small machine with every code, its rows of code words, and their exact probabilities by brute force.
#pragma once
#include <cmath>
#include <vector>

#include "base/math/random.h"
#include "learning/machine/word_machine.h"

namespace gonogo::learning::words {

/// 4 x 3 x 4 bins and 3 outcomes: 144 rows.
inline VisibleLayout mixed_layout() {
  return VisibleLayout({Encoder::by_range("slope", "deg", Code::thermometer, 4, 0, 4),
                        Encoder::by_range("soil", "-", Code::one_hot, 3, 0, 3),
                        Encoder::by_range("fixed", "-", Code::thermometer, 1, 2, 2),
                        Encoder::by_range("speed", "m/s", Code::gray, 4, 0, 4)},
                       {"go", "slow_go", "no_go"});
}

inline RbmWeights random_machine(std::size_t visible, std::size_t hidden, double size, std::uint64_t seed) {
  RbmWeights machine = RbmWeights::zeros(visible, hidden);
  std::uint64_t k = 0;
  for (auto* part : {&machine.weight, &machine.visible_bias, &machine.hidden_bias})
    for (double& w : *part) w = size * (2 * random_unit(seed, 1, k++) - 1);
  return machine;
}

/// All rows of code words as bins of the variables, then the outcome; the last digit runs fastest.
inline std::vector<std::vector<int>> all_rows(const VisibleLayout& layout) {
  std::vector<int> sizes;
  for (const Encoder& encoder : layout.encoders()) sizes.push_back(encoder.bin_count());
  sizes.push_back(int(layout.outcome_count()));
  std::vector<std::vector<int>> rows;
  for (std::vector<int> row(sizes.size(), 0);;) {
    rows.push_back(row);
    std::size_t k = row.size();
    while (k > 0 && ++row[k - 1] == sizes[k - 1]) row[--k] = 0;
    if (k == 0) return rows;
  }
}

inline std::vector<double> units_of(const VisibleLayout& layout, const std::vector<int>& row) {
  std::vector<double> units;
  for (std::size_t v = 0; v < layout.variable_count(); ++v) {
    std::vector<Bit> word(layout.encoders()[v].unit_count());
    layout.encoders()[v].encode(row[v], word);
    units.insert(units.end(), word.begin(), word.end());
  }
  for (std::size_t y = 0; y < layout.outcome_count(); ++y) units.push_back(int(y) == row.back());
  return units;
}

/// Probabilities of all_rows() and their log Z, by free energies.
struct Enumerated {
  std::vector<double> probability;
  double log_z = 0;
};
inline Enumerated enumerate(const VisibleLayout& layout, const RbmWeights& machine) {
  Enumerated result;
  for (const auto& row : all_rows(layout)) result.probability.push_back(-free_energy(machine, units_of(layout, row)));
  result.log_z = log_sum_exp(result.probability);
  normalise_logs(result.probability);
  return result;
}

/// Place in all_rows() of a row that WordChains or ExactWords drew with nothing known. Fixed variables have one bin.
inline std::size_t place_of(const WordMachine& machine, std::span<const std::uint16_t> row) {
  std::size_t place = 0;
  for (std::size_t g = 0; g < row.size(); ++g) place = place * machine.groups()[g].length + row[g];
  return place;
}

}  // namespace gonogo::learning::words
