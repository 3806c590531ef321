#include "pipeline/learn/qubo/outcome_balance.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "learning/sampler/word_chains.h"
#include "learning/sampler/word_machine.h"

namespace gonogo::learn {
namespace {

constexpr std::uint64_t kHidden = 0x62616c;  // stream of random numbers
constexpr std::size_t kChains = 64, kRungs = 4, kDraws = 8, kBurnIn = 200, kEvery = 20;

/// What one row of the machine's code words says: its hidden units, and the scores of the outcome's units given them.
struct Row {
  std::vector<double> hidden;  // 1, then 0 or 1 [1 + hidden]
  std::vector<double> score;   // [outcome]
};

Row row_of(const learning::WordMachine& machine, const learning::WordGroup& outcome,
           std::span<const std::uint16_t> words, std::uint64_t number) {
  Row row{{1}, {}};
  const auto bias = machine.word_bias();
  for (std::size_t y = 0; y < outcome.length; ++y) row.score.push_back(bias[outcome.first + y]);
  for (std::size_t j = 0; j < machine.hidden_count(); ++j) {
    double field = machine.hidden_bias()[j];
    for (std::size_t g = 0; g < words.size(); ++g) field += machine.field(machine.groups()[g].first + words[g])[j];
    const bool on = random_unit(kHidden, number, j) < 1 / (1 + std::exp(-field));
    row.hidden.push_back(on);
    for (std::size_t y = 0; on && y < outcome.length; ++y) row.score[y] += machine.hidden_field(j)[outcome.first + y];
  }
  return row;
}

std::vector<Row> rows_of(const learning::WordMachine& machine, const learning::WordGroup& outcome) {
  learning::WordChains chains(kChains, kRungs, kHidden);
  std::vector<Row> rows;
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    chains.run(machine, draw == 0 ? kBurnIn : kEvery);
    for (std::size_t c = 0; c < chains.chains(); ++c)
      rows.push_back(row_of(machine, outcome, chains.row(c), rows.size()));
  }
  return rows;
}

/// Mean over the rows of (outcome units on in the mean - 1) times the hidden units.
std::vector<double> gradient(const std::vector<Row>& rows, const std::vector<double>& shift) {
  std::vector<double> result(shift.size(), 0.0);
  for (const Row& row : rows) {
    double added = 0, on = 0;
    for (std::size_t k = 0; k < shift.size(); ++k) added += shift[k] * row.hidden[k];
    for (const double score : row.score) on += 1 / (1 + std::exp(-(score + added)));
    for (std::size_t k = 0; k < shift.size(); ++k) result[k] += (on - 1) * row.hidden[k] / double(rows.size());
  }
  return result;
}

/// c, then w, by Nesterov's method. The steps are safe: no curvature exceeds outcomes (1 + hidden) / 4.
std::vector<double> least_shift(const std::vector<Row>& rows) {
  constexpr std::size_t kSteps = 500;
  const std::size_t size = rows.front().hidden.size();
  const double step = 4 / double(rows.front().score.size() * size);
  std::vector<double> shift(size, 0.0), ahead = shift;
  for (std::size_t n = 0; n < kSteps; ++n) {
    const std::vector<double> slope = gradient(rows, ahead);
    for (std::size_t k = 0; k < size; ++k) {
      const double next = ahead[k] - step * slope[k];
      ahead[k] = next + double(n) / double(n + 3) * (next - shift[k]);
      shift[k] = next;
    }
  }
  return shift;
}

}  // namespace

learning::Problem balanced_machine(const learning::Model& model) {
  const learning::WordMachine machine(model.layout, model.weights);
  const auto outcome = std::find_if(machine.groups().begin(), machine.groups().end(),
                                    [](const learning::WordGroup& group) { return group.variable < 0; });
  if (outcome == machine.groups().end()) return learning::to_qubo(model.weights, model.layout.unit_labels());
  const std::vector<double> shift = least_shift(rows_of(machine, *outcome));
  learning::RbmWeights weights = model.weights;
  for (std::size_t i = model.layout.input_unit_count(); i < weights.visible_count; ++i) {
    weights.visible_bias[i] += shift[0];
    for (std::size_t j = 0; j < weights.hidden_count; ++j) weights.weight[i * weights.hidden_count + j] += shift[1 + j];
  }
  for (std::size_t j = 0; j < weights.hidden_count; ++j) weights.hidden_bias[j] -= shift[1 + j];
  learning::Problem problem = learning::to_qubo(weights, model.layout.unit_labels());
  problem.offset += shift[0];
  return problem;
}

}  // namespace gonogo::learn
