#include "pipeline/outcome/qubo/prepared_machine.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/format.h"
#include "base/math/random.h"
#include "learning/encoding/layout.h"
#include "learning/machine/word_machine.h"
#include "learning/sampler/sampler.h"
#include "pipeline/outcome/qubo/code_machine.h"
#include "pipeline/outcome/qubo/decode_answer.h"

namespace gonogo::outcome {
namespace {

constexpr std::uint64_t kHidden = 0x62616c;  // stream of random numbers
constexpr std::size_t kChains = 64, kRungs = 4, kDraws = 8, kBurnIn = 200, kEvery = 20;

/// One row of the machine's code words: its hidden units, and the scores of the outcome's units given them.
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

namespace {

constexpr double kEnoughWeighed = 0.1;  // share of the reads that weighed rows must be worth without a penalty
constexpr double kEnoughWords = 0.9;    // share of rows that a penalty must leave as code words
constexpr double kAllWords = 0.999;     // share of code words that needs no mention
constexpr learning::SampleRequest kTrial = {.reads = 200, .seed = 1, .sweeps = 300};
constexpr learning::SampleRequest kMeasured = {.reads = 1000, .seed = 1, .sweeps = 300};

/// Share of code words among rows of the penalised problem.
double word_share(const learning::Problem& machine, const learning::VisibleLayout& layout,
                  const std::vector<double>& fixed, double strength) {
  const learning::Problem problem =
      learning::clamp(learning::with_code_penalty(machine, layout, fixed, strength), fixed);
  const learning::SampleSet rows = learning::make_sampler("tempering")->sample(problem, kTrial);
  Sidecar sidecar;
  sidecar.layout = layout;
  for (std::size_t v = 0; v < layout.variable_count(); ++v)  // a fixed variable is known, whatever its value
    if (layout.encoders()[v].unit_count() > 0 && !std::isnan(fixed[layout.offset(v)]))
      sidecar.clamped[layout.encoders()[v].name()] = layout.encoders()[v].value(0);
  const DecodedAnswer decoded = decode_answer(sidecar, rows, Decoding::discard, nullptr, 1);
  return decoded.valid / decoded.reads;
}

std::string percent(double share) { return number_text(100 * share, 2) + " %"; }

}  // namespace

std::optional<WordShares> word_shares(const learning::Problem& machine, const learning::VisibleLayout& layout,
                                      const std::vector<double>& fixed) {
  const learning::Problem problem = learning::clamp(machine, fixed);
  const auto free = CodeMachine::of(problem, layout);
  if (!free) return std::nullopt;
  if (const auto sums = free->exact()) return WordShares{sums->word_share, sums->weighed_share, true};
  const learning::SampleSet rows = learning::make_sampler("tempering")->sample(free->binary(), kMeasured);
  double sum = 0, square = 0;
  for (std::size_t r = 0; r < rows.row_count(); ++r) {
    const CodeMachine::Given given = free->given(rows.row(r));
    const double share = std::exp(given.log_words - given.log_all);
    sum += share;
    square += share * share;
  }
  return WordShares{sum / double(rows.row_count()), sum * sum / square / double(rows.row_count()), false};
}

double measured_penalty(const learning::Problem& machine, const learning::VisibleLayout& layout,
                        const std::vector<double>& fixed) {
  constexpr double kStrengths[] = {8, 12, 16, 24, 32};
  for (const double strength : kStrengths)
    if (word_share(machine, layout, fixed, strength) >= kEnoughWords) return strength;
  return kStrengths[std::size(kStrengths) - 1];
}

PreparedMachine prepared_machine(const learning::Model& model, const std::vector<double>& fixed) {
  PreparedMachine result{learning::to_qubo(model.weights, model.layout.unit_labels()), 0, ""};
  const auto plain = word_shares(result.machine, model.layout, fixed);
  if (plain && plain->words > kAllWords) return result;
  const auto words = [](const WordShares& shares) {
    return (shares.exact ? "" : "about ") + percent(shares.words) + " of the machine's rows are code words";
  };
  const auto worth = [](const WordShares& shares) {
    return "import weighs all code words by the hidden units, and the reads are worth " + percent(shares.weighed) +
           " of as many independent rows";
  };
  if (plain && plain->weighed >= kEnoughWeighed) {
    result.note =
        words(*plain) + ". No penalty is needed: " + worth(*plain) + ". Tools that read rows themselves need --penalty";
    return result;
  }
  std::string before;
  if (plain) before = words(*plain) + ", and weighed reads would be worth " + percent(plain->weighed) + ". So ";
  result.machine = balanced_machine(model);
  const auto balanced = word_shares(result.machine, model.layout, fixed);
  if (balanced && balanced->weighed >= kEnoughWeighed) {
    result.note = before +
                  "the outcome's units are balanced, which changes no energy of a code word and couples no units of a "
                  "variable. Then " +
                  words(*balanced) + ", " + worth(*balanced);
    return result;
  }
  result.penalty = measured_penalty(result.machine, model.layout, fixed);
  result.note = before + "units that are no code word get a penalty of " + number_text(result.penalty) +
                ", which couples units of a variable: sample with tempering, anneal or population";
  return result;
}

}  // namespace gonogo::outcome
