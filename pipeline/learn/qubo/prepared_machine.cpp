#include "pipeline/learn/qubo/prepared_machine.h"

#include <cmath>
#include <iterator>

#include "base/format.h"
#include "learning/encoding/code_penalty.h"
#include "learning/sampler/sampler.h"
#include "pipeline/learn/qubo/code_machine.h"
#include "pipeline/learn/qubo/decode_answer.h"
#include "pipeline/learn/qubo/outcome_balance.h"

namespace gonogo::learn {
namespace {

constexpr double kEnoughWeighed = 0.1;  // share of the reads that weighed rows must be worth without a penalty
constexpr double kEnoughWords = 0.9;    // share of rows that a penalty must leave as code words
constexpr learning::SampleRequest kTrial = {.reads = 200, .seed = 1, .sweeps = 300};

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

std::optional<CodeMachine::Exact> exact_sums(const learning::Problem& machine, const learning::VisibleLayout& layout,
                                             const std::vector<double>& fixed) {
  Sidecar sidecar;
  sidecar.layout = layout;
  const auto free = CodeMachine::of(learning::clamp(machine, fixed), sidecar);
  return free ? free->exact() : std::nullopt;
}

std::string percent(double share) { return number_text(100 * share, 2) + " %"; }

}  // namespace

double measured_penalty(const learning::Problem& machine, const learning::VisibleLayout& layout,
                        const std::vector<double>& fixed) {
  constexpr double kStrengths[] = {8, 12, 16, 24, 32};
  for (const double strength : kStrengths)
    if (word_share(machine, layout, fixed, strength) >= kEnoughWords) return strength;
  return kStrengths[std::size(kStrengths) - 1];
}

PreparedMachine prepared_machine(const learning::Model& model, const std::vector<double>& fixed) {
  PreparedMachine result{learning::to_qubo(model.weights, model.layout.unit_labels()), 0, ""};
  const auto plain = exact_sums(result.machine, model.layout, fixed);
  if (plain && plain->word_share > 0.999) return result;
  const std::string weighed = "import weighs all code words by the hidden units, and the reads are worth ",
                    of_rows = " of as many independent rows";
  std::string reason;
  if (plain) {
    reason = percent(plain->word_share) + " of the machine's rows are code words";
    if (plain->weighed_share >= kEnoughWeighed) {
      result.note = reason + ". No penalty is needed: " + weighed + percent(plain->weighed_share) + of_rows +
                    ". Tools that read rows themselves need --penalty";
      return result;
    }
    reason += ", and weighed reads would be worth " + percent(plain->weighed_share) + ". So ";
  }
  result.machine = balanced_machine(model);
  const auto balanced = exact_sums(result.machine, model.layout, fixed);
  if (balanced && balanced->weighed_share >= kEnoughWeighed) {
    result.note = reason +
                  "the outcome's units are balanced, which changes no energy of a code word and couples no units of a "
                  "variable: " +
                  weighed + percent(balanced->weighed_share) + of_rows;
    return result;
  }
  result.penalty = measured_penalty(result.machine, model.layout, fixed);
  result.note = reason + "units that are no code word get a penalty of " + number_text(result.penalty) +
                ", which couples units of a variable: sample with tempering, anneal or population";
  return result;
}

}  // namespace gonogo::learn
