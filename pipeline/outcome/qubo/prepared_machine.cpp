#include "pipeline/outcome/qubo/prepared_machine.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "learning/encoding/layout.h"
#include "learning/machine/free_units.h"
#include "learning/sampler/sampler.h"

namespace gonogo::outcome {
namespace {

constexpr double kEnoughWeighed = 0.5;  // share of the reads that weighed rows of the plain machine are worth
/// With 48 hidden units these fit 280 qubits of a Pegasus P16 and 220 of a Zephyr Z15.
constexpr std::size_t kMostFreeUnits = 20;
constexpr learning::SampleRequest kMeasured = {.reads = 400, .seed = 1, .sweeps = 200};

std::string percent(double share) { return number_text(100 * share, 2) + " %"; }

/// Whether every pattern of the visible units is a row of code words.
bool has_code_words_only(const CodeMachine& machine) {
  return std::all_of(machine.groups().begin(), machine.groups().end(), [](const CodeGroup& group) {
    return group.unit.size() < 32 && group.word.size() == std::size_t(1) << group.unit.size();
  });
}

/// Values of the units of known variables and of a known outcome, NaN for all others.
std::vector<double> unit_values(const learning::Model& model, const learning::KnownPart& known) {
  const learning::VisibleLayout& layout = model.layout;
  std::vector<double> values(model.weights.visible_count + model.weights.hidden_count, NAN);
  for (std::size_t v = 0; v < known.variables.size(); ++v)
    if (!std::isnan(known.variables[v]))
      layout.encoders()[v].encode_smooth(
          known.variables[v], std::span(values).subspan(layout.offset(v), layout.encoders()[v].unit_count()));
  for (std::size_t y = 0; known.outcome && y < layout.outcome_count(); ++y)
    values[layout.input_unit_count() + y] = y == *known.outcome;
  return values;
}

}  // namespace

CodeMachine PreparedMachine::code_machine(const learning::VisibleLayout& layout) const {
  if (words) return CodeMachine::with_free_units(*words, problem, layout);
  std::optional<CodeMachine> machine = CodeMachine::of(problem, layout);
  GONOGO_ASSERT(machine);  // units of a plain machine are not coupled with one another
  return std::move(*machine);
}

WordShares word_shares(const CodeMachine& machine) {
  if (const auto sums = machine.exact()) return {sums->word_share, sums->weighed_share, true};
  const learning::SampleSet rows = learning::make_sampler("tempering")->sample(machine.binary(), kMeasured);
  std::vector<double> log_share;
  for (std::size_t r = 0; r < rows.row_count(); ++r) {
    const CodeMachine::Given given = machine.given(rows.row(r));
    log_share.push_back(given.log_words - given.log_all);
  }
  const double largest = *std::max_element(log_share.begin(), log_share.end());
  double sum = 0, square = 0;
  for (const double x : log_share) {
    sum += std::exp(x - largest);
    square += std::exp(2 * (x - largest));
  }
  const double count = double(rows.row_count());
  return {machine.has_free_units() ? 1 : std::exp(largest) * sum / count, sum * sum / square / count, false};
}

learning::Problem plain_machine(const learning::Model& model, const learning::KnownPart& known) {
  return penalised_machine(model, known, 0);
}

learning::Problem penalised_machine(const learning::Model& model, const learning::KnownPart& known, double strength) {
  const std::vector<double> fixed = unit_values(model, known);
  const learning::Problem whole = learning::to_qubo(model.weights, model.layout.unit_labels());
  return learning::clamp(learning::with_code_penalty(whole, model.layout, fixed, strength), fixed);
}

std::string penalty_note(const learning::Problem& penalised, const learning::VisibleLayout& layout, double strength) {
  const std::optional<CodeMachine> machine = CodeMachine::of(penalised, layout);
  if (!machine || has_code_words_only(*machine)) return "";
  const WordShares shares = word_shares(*machine);
  const std::string words = (shares.exact ? "" : "about ") + percent(shares.words) + " of the rows are code words";
  if (strength > 0) return "With a penalty of " + number_text(strength) + " " + words;
  return "Without a penalty " + words + ", and weighed reads are worth " + percent(shares.weighed) +
         " of as many independent rows. Leave --penalty out to have the better of plain and free units chosen";
}

PreparedMachine machine_of_free_units(const learning::Model& model, const learning::KnownPart& known) {
  const learning::WordMachine machine(model.layout, model.weights, known);
  const std::size_t count = std::clamp<std::size_t>(machine.word_count() - machine.groups().size(), 1, kMostFreeUnits);
  std::vector<std::string> labels;
  for (std::size_t k = 0; k < count; ++k) labels.push_back("free:" + std::to_string(k));
  return {learning::to_qubo(learning::fitted_free_units(machine, count), labels), plain_machine(model, known), ""};
}

PreparedMachine prepared_machine(const learning::Model& model, const learning::KnownPart& known) {
  PreparedMachine plain{plain_machine(model, known), std::nullopt, ""};
  const CodeMachine own = plain.code_machine(model.layout);
  if (has_code_words_only(own)) return plain;
  const auto sums = own.exact();
  std::string before;
  if (sums) {
    const std::string words = percent(sums->word_share) + " of the machine's rows are code words";
    if (sums->weighed_share >= kEnoughWeighed) {
      plain.note =
          words + ". No penalty is needed: import weighs all code words by the hidden units, and the reads are worth " +
          percent(sums->weighed_share) + " of as many independent rows. Tools that read rows themselves need --penalty";
      return plain;
    }
    before = words + ", and weighed reads would be worth " + percent(sums->weighed_share) + ". So ";
  }
  PreparedMachine result = machine_of_free_units(model, known);
  const WordShares after = word_shares(result.code_machine(model.layout));
  result.note = before +
                "free units stand for the code words, and couple no two units of a side. Every row gives code words "
                "by its hidden units, and weighed reads are worth " +
                (after.exact ? "" : "about ") + percent(after.weighed) +
                " of as many independent rows. Tools that read rows themselves need --penalty";
  return result;
}

}  // namespace gonogo::outcome
