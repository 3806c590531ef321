#include "pipeline/outcome/sampling/sample_rows.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/math/random.h"
#include "base/progress.h"
#include "learning/encoding/encoder.h"
#include "learning/encoding/layout.h"
#include "learning/machine/word_machine.h"
#include "pipeline/outcome/qubo/code_machine.h"
#include "pipeline/outcome/qubo/prepared_machine.h"
#include "pipeline/outcome/training_data.h"

namespace gonogo::outcome {
namespace {

/// Streams of random numbers under one seed. kPriorStream stands last: draws from the prior add their number to it.
enum RowStream : std::uint64_t {
  kChainStream = 1,
  kExactStream = 2,
  kInsideStream = 3,
  kReadStream = 11,
  kAgainStream = 12,
  kWordStream = 13,
  kPriorStream = 4
};

constexpr double kMinWorth = 0.05;  // least share of the reads that their weights may be worth

learning::SampleSet reads_of(const learning::Problem& problem, const RowRequest& request) {
  learning::SampleRequest asked;
  asked.reads = request.rows;
  asked.sweeps = std::max<std::size_t>(request.burn_in, 1);
  asked.seed = random_bits(request.seed, kReadStream, 0);
  if (request.sampler == learning::kEmulator)
    return corrected_annealer(problem, emulated_device(request.device), request.device.post_sweeps)
        .sample(problem, asked);
  return learning::make_machine_sampler(request.sampler)->sample(problem, asked);
}

/// Reads in proportion to their weights, by equal steps through the sum of the weights: [reads] of read numbers.
std::vector<std::size_t> drawn_again(const std::vector<double>& log_weight, double u, const std::string& sampler) {
  std::vector<double> weight = log_weight;
  learning::normalise_logs(weight);
  const double count = double(weight.size());
  double square = 0;
  for (double w : weight) square += w * w;
  if (1 / square < kMinWorth * count)
    throw InputError(line("sampler %s: its reads, weighed, are worth %.0f of %.0f; take code_words or tempering",
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

/// Words of `request.rows` rows by samplers of single units, as an annealer draws them: [row][group] of the machine
/// with what is known clamped. Free units stand for the words, and the hidden units of every read give them. Reads are
/// weighed, and drawn again by their weights. Throws InputError where the weights leave fewer than kMinWorth of the
/// reads.
std::vector<std::vector<std::uint16_t>> unit_rows(const learning::Model& model, const learning::KnownPart& known,
                                                  const RowRequest& request) {
  const PreparedMachine prepared = machine_of_free_units(model, known);
  const learning::Problem& problem = prepared.problem;
  const CodeMachine machine = prepared.code_machine(model.layout);
  const learning::SampleSet reads = reads_of(problem, request);
  std::vector<CodeMachine::Given> given;
  std::vector<double> log_weight;
  for (std::size_t r = 0; r < reads.row_count(); ++r) {
    given.push_back(machine.given(reads.row(r)));
    log_weight.push_back(given.back().log_words - given.back().log_all);
  }
  std::vector<std::vector<std::uint16_t>> rows;
  for (std::size_t r : drawn_again(log_weight, random_unit(request.seed, kAgainStream, 0), request.sampler)) {
    std::vector<std::uint16_t>& row = rows.emplace_back();
    for (std::size_t g = 0; g < machine.groups().size(); ++g) {
      const std::vector<double>& p = given[r].probability[g];
      std::size_t k = 0;
      const std::uint64_t draw = (rows.size() - 1) * machine.groups().size() + g;
      for (double left = random_unit(request.seed, kWordStream, draw) - p[0]; left >= 0 && k + 1 < p.size();)
        left -= p[++k];
      row.push_back(std::uint16_t(k));
    }
  }
  return rows;
}

constexpr double kMinProbable = 1e-4;  // of a given outcome, for draws from the prior

using WordRows = std::vector<std::vector<std::uint16_t>>;  // [row][group]

void check(const Predictor& predictor, const RowRequest& request) {
  const std::vector<std::string> names = row_samplers();
  if (request.rows == 0) throw InputError("sample: at least one row is needed");
  if (request.chains == 0 || request.every == 0) throw InputError("sample: chains and sweeps between rows start at 1");
  if (std::find(names.begin(), names.end(), request.sampler) == names.end()) {
    std::string known;
    for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
    throw InputError("sampler \"" + request.sampler + "\" does not exist; use one of: " + known);
  }
  if (request.known.size() != predictor.model().layout.variable_count())
    throw InputError("sample: " + std::to_string(request.known.size()) + " values where the model has " +
                     std::to_string(predictor.model().layout.variable_count()) + " variables");
  if (request.source == RowSource::prior && request.sampler != "auto")
    throw InputError("sample: rows from the prior are drawn directly; leave out the sampler " + request.sampler);
}

/// Number of a row's chain. Chains take turns; independent rows are parts in order.
std::vector<std::uint32_t> chain_numbers(std::size_t rows, std::size_t chains, bool independent) {
  std::vector<std::uint32_t> chain;
  for (std::size_t n = 0; n < rows; ++n) chain.push_back(std::uint32_t(independent ? n * chains / rows : n % chains));
  return chain;
}

WordRows chain_rows(const learning::WordMachine& machine, const RowRequest& request, std::size_t rungs) {
  learning::WordChains chains(request.chains, rungs, random_bits(request.seed, kChainStream, 0));
  WordRows rows;
  for (std::size_t draw = 0; rows.size() < request.rows; ++draw) {
    stop_if_cancelled();
    chains.run(machine, draw == 0 ? request.burn_in + request.every : request.every);
    for (std::size_t c = 0; c < chains.chains() && rows.size() < request.rows; ++c)
      rows.emplace_back(chains.row(c).begin(), chains.row(c).end());
  }
  return rows;
}

WordRows exact_rows(const learning::WordMachine& machine, const RowRequest& request) {
  const learning::ExactWords drawer(machine);
  WordRows rows;
  for (std::size_t n = 0; n < request.rows; ++n)
    rows.push_back(drawer.draw(random_bits(request.seed, kExactStream, 0), n));
  return rows;
}

/// A value of the bin. u: uniform in [0, 1), or less than 0 for the middle.
double value_in(const learning::Encoder& encoder, int bin, double u) {
  return u < 0 ? encoder.value(bin) : learning::value_inside(encoder, bin, u);
}

/// Draws the variables that a row does not know: those without words over their box.
void fill_row(const learning::VisibleLayout& layout, const learning::WordMachine& machine, const RowRequest& request,
              const std::vector<std::uint16_t>& words, std::size_t number, SampledRows& rows) {
  std::vector<double> values = request.known;
  const auto inside = [&](std::size_t v) {
    return request.inside ? random_unit(request.seed, kInsideStream, number * values.size() + v) : -1;
  };
  std::size_t outcome = request.outcome.value_or(0);
  for (std::size_t g = 0; g < words.size(); ++g) {
    const std::ptrdiff_t v = machine.groups()[g].variable;
    if (v < 0)
      outcome = words[g];
    else
      values[std::size_t(v)] = value_in(layout.encoders()[std::size_t(v)], int(words[g]), inside(std::size_t(v)));
  }
  for (std::size_t v = 0; v < values.size(); ++v)
    if (std::isnan(values[v])) values[v] = value_in(layout.encoders()[v], 0, inside(v));
  rows.values.insert(rows.values.end(), values.begin(), values.end());
  rows.outcome.push_back(outcome);
}

SampledRows machine_rows(const Predictor& predictor, const RowRequest& request) {
  const learning::Model& model = predictor.model();
  const learning::KnownPart known{request.known, request.outcome};
  const learning::WordMachine machine(model.layout, model.weights, known);
  SampledRows rows;
  rows.sampler = request.sampler;
  if (request.sampler == "auto") rows.sampler = learning::ExactWords::possible(machine) ? "exact" : "tempering";
  WordRows words;
  if (rows.sampler == "exact")
    words = exact_rows(machine, request);
  else if (rows.sampler == "code_words" || rows.sampler == "tempering")
    words = chain_rows(machine, request, rows.sampler == "tempering" ? request.rungs : 1);
  else
    words = unit_rows(model, known, request);
  rows.independent = rows.sampler != "code_words" && rows.sampler != "tempering";
  for (std::size_t n = 0; n < words.size(); ++n) fill_row(model.layout, machine, request, words[n], n, rows);
  return rows;
}

/// A point of the prior, known values kept. Draw number `draw` of the seed.
std::vector<double> prior_point(const learning::Model& model, const RowRequest& request, std::uint64_t draw) {
  std::vector<double> point = request.known;
  for (std::size_t v = 0; v < point.size(); ++v) {
    if (!std::isnan(point[v])) continue;
    const std::vector<double>& prior = model.input_prior[v];
    int bin = 0;
    double left = random_unit(request.seed, kPriorStream + draw, 2 * v) - prior[0];
    while (left >= 0 && bin + 1 < int(prior.size())) left -= prior[std::size_t(++bin)];
    const double u = request.inside ? random_unit(request.seed, kPriorStream + draw, 2 * v + 1) : -1;
    point[v] = value_in(model.layout.encoders()[v], bin, u);
  }
  return point;
}

SampledRows prior_rows(const Predictor& predictor, const RowRequest& request) {
  const learning::Model& model = predictor.model();
  if (model.input_prior.empty())
    throw InputError(
        "model: it has no prior of its inputs, since the study's unknown_inputs is \"machine\"; draw its "
        "rows from the machine");
  if (request.outcome && predictor.outcome_probabilities(request.known)[*request.outcome] < kMinProbable)
    throw InputError("outcome " + model.layout.outcomes()[*request.outcome] +
                     ": its probability at the values given is below 0.0001; give other values");
  SampledRows rows;
  rows.sampler = "prior";
  rows.independent = true;
  for (std::uint64_t draw = 0; rows.row_count() < request.rows; ++draw) {
    if (draw % 1024 == 0) stop_if_cancelled();
    const std::vector<double> point = prior_point(model, request, draw);
    const std::vector<double> p = predictor.outcome_probabilities(point);
    const double u = random_unit(request.seed, kPriorStream + draw, 2 * point.size());
    std::size_t y = 0;
    for (double left = u - p[0]; left >= 0 && y + 1 < p.size();) left -= p[++y];
    if (request.outcome && y != *request.outcome) continue;
    rows.values.insert(rows.values.end(), point.begin(), point.end());
    rows.outcome.push_back(y);
  }
  return rows;
}

/// Numbers of one column, chain after chain, as many of each as the shortest chain has.
std::vector<double> by_chain(const SampledRows& rows, const std::vector<double>& column) {
  std::vector<std::vector<double>> chain(rows.chains);
  for (std::size_t n = 0; n < column.size(); ++n) chain[rows.chain[n]].push_back(column[n]);
  std::size_t shortest = column.size();
  for (const auto& draws : chain) shortest = std::min(shortest, draws.size());
  std::vector<double> result;
  for (const auto& draws : chain) result.insert(result.end(), draws.begin(), draws.begin() + std::ptrdiff_t(shortest));
  return result;
}

void measure_mixing(SampledRows& rows) {
  const std::vector<int> passable = passable_outcomes();
  std::vector<double> column(rows.row_count());
  for (std::size_t v = 0; v < rows.variable_count; ++v) {
    for (std::size_t n = 0; n < column.size(); ++n) column[n] = rows.row(n)[v];
    rows.of_variable.push_back(learning::mixing(by_chain(rows, column), rows.chains));
  }
  for (std::size_t n = 0; n < column.size(); ++n) column[n] = passable[rows.outcome[n]];
  rows.of_outcome = learning::mixing(by_chain(rows, column), rows.chains);
}

}  // namespace

std::vector<std::string> row_samplers() {
  std::vector<std::string> names = {"auto", "exact", "code_words", "tempering"};
  for (const std::string& name :
       learning::sampler_names_and_emulator([](const learning::SamplerKind& kind) { return kind.draws_here(); }))
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

SampledRows sample_rows(const Predictor& predictor, const RowRequest& request) {
  check(predictor, request);
  SampledRows rows =
      request.source == RowSource::prior ? prior_rows(predictor, request) : machine_rows(predictor, request);
  rows.variable_count = request.known.size();
  rows.chains = std::min(request.chains, request.rows);
  rows.chain = chain_numbers(request.rows, rows.chains, rows.independent);
  measure_mixing(rows);
  return rows;
}

}  // namespace gonogo::outcome
