#include "pipeline/learn/sampling/unit_rows.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/line.h"
#include "base/random.h"
#include "learning/encoding/code_penalty.h"
#include "pipeline/learn/qubo/code_machine.h"
#include "pipeline/learn/qubo/outcome_balance.h"
#include "pipeline/learn/qubo/prepared_machine.h"

namespace gonogo::learn {
namespace {

enum Stream : std::uint64_t { kReads = 11, kAgain = 12, kWords = 13 };

bool sampled_as_it_is(const std::string& sampler) { return sampler == "block_gibbs" || sampler == "emulator"; }

learning::Problem clamped_problem(const learning::Model& model, const learning::KnownPart& known, bool penalised) {
  const learning::VisibleLayout& layout = model.layout;
  const learning::Problem whole = balanced_machine(model);
  std::vector<double> fixed(whole.variable_count(), NAN);
  for (std::size_t v = 0; v < layout.variable_count(); ++v)
    if (!std::isnan(known.variables[v]))
      layout.encoders()[v].encode_smooth(known.variables[v],
                                         std::span(fixed).subspan(layout.offset(v), layout.encoders()[v].unit_count()));
  const double strength = penalised ? measured_penalty(whole, layout, fixed) : 0;
  const learning::Problem problem = learning::with_code_penalty(whole, layout, fixed, strength);
  if (known.outcome)
    for (std::size_t y = 0; y < layout.outcome_count(); ++y) fixed[layout.input_unit_count() + y] = y == *known.outcome;
  return learning::clamp(problem, fixed);
}

learning::SampleSet reads_of(const learning::Problem& problem, const RowRequest& request) {
  learning::SampleRequest asked;
  asked.reads = request.rows;
  asked.sweeps = std::max<std::size_t>(request.burn_in, 1);
  asked.seed = random_bits(request.seed, kReads, 0);
  if (request.sampler == "emulator")
    return corrected_annealer(problem, emulated_device(request.device), request.device.post_sweeps)
        .sample(problem, asked);
  return learning::make_sampler(request.sampler)->sample(problem, asked);
}

/// Reads in proportion to their weights, by equal steps through the sum of the weights: [reads] of read numbers.
std::vector<std::size_t> drawn_again(const std::vector<double>& log_weight, double u, const std::string& sampler) {
  std::vector<double> weight = log_weight;
  learning::normalise_logs(weight);
  const double count = double(weight.size());
  double square = 0;
  for (double w : weight) square += w * w;
  if (1 / square < kMinWorth * count)
    throw InputError(
        line("sampler %s: words that are no code words leave %.0f of %.0f reads, weighed; take "
             "code_words, tempering or anneal",
             sampler.c_str(), 1 / square, count));
  std::vector<std::size_t> chosen;
  double sum = 0;
  for (std::size_t r = 0; r < weight.size(); ++r) {
    sum += weight[r] * count;
    while (chosen.size() < weight.size() && double(chosen.size()) + u < sum) chosen.push_back(r);
  }
  while (chosen.size() < weight.size()) chosen.push_back(weight.size() - 1);  // rounding at the end of the sum
  return chosen;
}

}  // namespace

std::vector<std::vector<std::uint16_t>> unit_rows(const learning::Model& model, const learning::KnownPart& known,
                                                  const RowRequest& request) {
  const learning::Problem problem = clamped_problem(model, known, !sampled_as_it_is(request.sampler));
  Sidecar sidecar;
  sidecar.layout = model.layout;
  const std::optional<CodeMachine> machine = CodeMachine::of(problem, sidecar);
  if (!machine) throw InputError("sampler " + request.sampler + ": a variable of this model has too many units for it");
  const learning::SampleSet reads = reads_of(problem, request);
  std::vector<CodeMachine::Given> given;
  std::vector<double> log_weight;
  for (std::size_t r = 0; r < reads.row_count(); ++r) {
    given.push_back(machine->given(reads.row(r)));
    log_weight.push_back(given.back().log_words - given.back().log_all);
  }
  std::vector<std::vector<std::uint16_t>> rows;
  for (std::size_t r : drawn_again(log_weight, random_unit(request.seed, kAgain, 0), request.sampler)) {
    std::vector<std::uint16_t>& row = rows.emplace_back();
    for (std::size_t g = 0; g < machine->groups().size(); ++g) {
      const std::vector<double>& p = given[r].probability[g];
      std::size_t k = 0;
      const std::uint64_t draw = (rows.size() - 1) * machine->groups().size() + g;
      for (double left = random_unit(request.seed, kWords, draw) - p[0]; left >= 0 && k + 1 < p.size();) left -= p[++k];
      row.push_back(std::uint16_t(k));
    }
  }
  return rows;
}

}  // namespace gonogo::learn
