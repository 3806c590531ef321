#include "pipeline/outcome/qubo/decode_answer.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/format.h"
#include "base/math/random.h"
#include "learning/encoding/encoder.h"

namespace gonogo::outcome {
namespace {

constexpr std::uint64_t kInside = 0x696e736964;  // stream of random numbers

/// Column of the answer for each visible unit; -1 for units of clamped variables, which the problem does not hold.
std::vector<std::ptrdiff_t> unit_columns(const Sidecar& sidecar, const learning::SampleSet& answer) {
  std::map<std::string, std::ptrdiff_t> column;
  for (std::size_t k = 0; k < answer.labels.size(); ++k)
    column[learning::label_text(answer.labels[k])] = std::ptrdiff_t(k);
  std::vector<std::ptrdiff_t> result;
  for (const std::string& label : sidecar.layout.unit_labels()) {
    const auto found = column.find(label);
    result.push_back(found == column.end() ? -1 : found->second);
  }
  return result;
}

/// Code words of clamped variables stand in for the units that were taken out.
std::vector<learning::Bit> clamped_row(const Sidecar& sidecar) {
  std::vector<learning::Bit> row(sidecar.layout.unit_count(), 0);
  for (const auto& [name, value] : sidecar.clamped) {
    const std::size_t v = sidecar.layout.variable_index(name);
    const learning::Encoder& encoder = sidecar.layout.encoders()[v];
    encoder.encode(encoder.bin_of(value), std::span(row).subspan(sidecar.layout.offset(v), encoder.unit_count()));
  }
  return row;
}

/// Rows that are sorted by energy, as services return them, are not in the order in which they were drawn.
learning::ReadOrder order_of(const learning::SampleSet& answer) {
  learning::ReadOrder order;
  const auto& energies = answer.energies;
  order.as_drawn = energies.size() < 3 || !std::is_sorted(energies.begin(), energies.end());
  const Json* groups = answer.info.is_object() ? answer.info.find("programmings") : nullptr;
  if (order.as_drawn && groups && groups->is_integer() && groups->integer() > 0)
    order.groups = std::size_t(groups->integer());
  return order;
}

void make_room(const Sidecar& sidecar, const learning::SampleSet& answer, DecodedAnswer& result) {
  result.occurrences = answer.occurrences;
  result.order = order_of(answer);
  result.weight.assign(answer.row_count(), 0.0);
  result.outcome.assign(sidecar.layout.outcome_count(), std::vector<double>(answer.row_count(), 0.0));
  result.mean.assign(sidecar.layout.variable_count(), std::vector<double>(answer.row_count(), 0.0));
  result.square = result.mean;
}

/// Decodes by a rule, row by row.
void take_rows(const Sidecar& sidecar, const learning::SampleSet& answer, learning::DecodeRule rule,
               DecodedAnswer& result) {
  const std::vector<std::ptrdiff_t> column = unit_columns(sidecar, answer);
  std::vector<learning::Bit> row = clamped_row(sidecar);
  for (std::size_t r = 0; r < answer.row_count(); ++r) {
    for (std::size_t i = 0; i < column.size(); ++i)
      if (column[i] >= 0) row[i] = answer.row(r)[std::size_t(column[i])] > 0;
    const learning::DecodedRow decoded = sidecar.layout.decode(row, rule);
    result.reads += double(answer.occurrences[r]);
    const bool complete =
        std::none_of(decoded.values.begin(), decoded.values.end(), [](double x) { return std::isnan(x); });
    if (!complete || !decoded.outcome) continue;
    (decoded.valid ? result.valid : result.repaired) += double(answer.occurrences[r]);
    if (result.decoding == Decoding::weigh) continue;
    DecodedAnswer::Row item{.values = decoded.values,
                            .outcome = *decoded.outcome,
                            .energy = answer.energies[r],
                            .occurrences = answer.occurrences[r],
                            .weight = 1};
    for (const auto& [name, value] : sidecar.clamped) item.values[sidecar.layout.variable_index(name)] = value;
    result.weight[r] = 1;
    result.outcome[item.outcome][r] = 1;
    for (std::size_t v = 0; v < item.values.size(); ++v) {
      result.mean[v][r] = item.values[v];
      result.square[v][r] = item.values[v] * item.values[v];
    }
    result.rows.push_back(std::move(item));
  }
}

/// The values of variables that every row shares: clamped ones, and those with a single bin.
std::vector<double> shared_values(const Sidecar& sidecar) {
  std::vector<double> values;
  for (const learning::Encoder& encoder : sidecar.layout.encoders()) values.push_back(encoder.value(0));
  for (const auto& [name, value] : sidecar.clamped) values[sidecar.layout.variable_index(name)] = value;
  return values;
}

std::size_t drawn_bin(const std::vector<double>& probability, double u) {
  for (std::size_t bin = 0; bin + 1 < probability.size(); ++bin) {
    if (u < probability[bin]) return bin;
    u -= probability[bin];
  }
  return probability.size() - 1;
}

/// Adds what row r's hidden units say of the code words, and a row drawn by them.
void weigh_row(const Sidecar& sidecar, const learning::SampleSet& answer, const CodeMachine& machine,
               const CodeMachine::Given& given, std::size_t r, std::uint64_t seed, DecodedAnswer& result) {
  DecodedAnswer::Row item{.values = shared_values(sidecar),
                          .outcome = 0,
                          .energy = answer.energies[r],
                          .occurrences = answer.occurrences[r],
                          .weight = result.weight[r]};
  for (std::size_t v = 0; v < item.values.size(); ++v) {
    result.mean[v][r] = item.values[v];
    result.square[v][r] = item.values[v] * item.values[v];
  }
  for (std::size_t g = 0; g < machine.groups().size(); ++g) {
    const auto& probability = given.probability[g];
    const std::size_t bin = drawn_bin(probability, random_unit(seed, r, g));
    const std::ptrdiff_t variable = machine.groups()[g].variable;
    if (variable < 0) {
      for (std::size_t y = 0; y < probability.size(); ++y) result.outcome[y][r] = probability[y];
      item.outcome = bin;
      continue;
    }
    const learning::Encoder& encoder = sidecar.layout.encoders()[std::size_t(variable)];
    double mean = 0, square = 0;
    for (std::size_t b = 0; b < probability.size(); ++b) {
      const double value = encoder.value(int(b));
      mean += probability[b] * value;
      square += probability[b] * value * value;
    }
    result.mean[std::size_t(variable)][r] = mean;
    result.square[std::size_t(variable)][r] = square;
    item.values[std::size_t(variable)] = encoder.value(int(bin));
  }
  result.rows.push_back(std::move(item));
}

void weigh_rows(const Sidecar& sidecar, const learning::SampleSet& answer, const CodeMachine& machine,
                std::uint64_t seed, double beta, DecodedAnswer& result) {
  std::vector<CodeMachine::Given> given;
  std::vector<double> log_weight;
  for (std::size_t r = 0; r < answer.row_count(); ++r) {
    given.push_back(machine.given(answer.row(r)));
    log_weight.push_back(given.back().log_words - given.back().log_all + (beta - 1) * answer.energies[r]);
  }
  const double highest = log_weight.empty() ? 0 : *std::max_element(log_weight.begin(), log_weight.end());
  for (std::size_t r = 0; r < answer.row_count(); ++r) {
    result.weight[r] = std::exp(log_weight[r] - highest);
    weigh_row(sidecar, answer, machine, given[r], r, seed, result);
  }
}

/// Derivative of the frequency of outcome y by the beta that weights are corrected for: its covariance with the energy.
double slope_by_beta(const DecodedAnswer& decoded, std::size_t y, double frequency) {
  double covariance = 0, total = 0;
  for (std::size_t r = 0; r < decoded.rows.size(); ++r) {
    const double weight = decoded.weight[r] * double(decoded.occurrences[r]);
    covariance += weight * (decoded.outcome[y][r] - frequency) * decoded.rows[r].energy;
    total += weight;
  }
  return covariance / total;
}

/// Frequency of outcome y with its standard error. A count of nothing but zeros or ones has an error, too: one read of
/// either kind is added for it (Agresti and Coull, Am. Stat. 52:119, 1998).
learning::SeriesMean frequency(const DecodedAnswer& decoded, std::size_t y) {
  learning::SeriesMean found =
      learning::series_mean(decoded.outcome[y], decoded.weight, decoded.occurrences, decoded.order);
  if (decoded.beta_error > 0)
    found.standard_error = std::hypot(found.standard_error, decoded.beta_error * slope_by_beta(decoded, y, found.mean));
  if (decoded.decoding == Decoding::weigh) return found;
  const double n = found.independent_reads, p = (n * found.mean + 1) / (n + 2);
  found.standard_error = std::max(found.standard_error, std::sqrt(p * (1 - p) / (n + 2)));
  return found;
}

constexpr double kChance = 4;  // standard errors that chance explains, of the largest of some ten outcomes
/// Independent reads of an outcome below which the spread of weighed rows says little of the error: most answers hold
/// none of the few rows that make up its probability.
constexpr double kRare = 10;

void add_outcomes(const Sidecar& sidecar, const DecodedAnswer& decoded, const CodeMachine* machine,
                  AnswerSummary& summary) {
  const CodeMachine::Reference own = machine ? machine->outcomes() : CodeMachine::Reference();
  double worst = 0;
  for (std::size_t y = 0; y < sidecar.layout.outcome_count(); ++y) {
    AnswerSummary::Outcome outcome{.name = sidecar.layout.outcomes()[y], .frequency = frequency(decoded, y)};
    const learning::SeriesMean& found = outcome.frequency;
    if (!own.probability.empty()) {
      const double p = own.probability[y];
      double error = found.standard_error;
      if (decoded.decoding != Decoding::weigh || p * found.independent_reads < kRare)
        error = std::max(error, std::sqrt(p * (1 - p) / found.independent_reads));
      outcome.machine = p;
      outcome.machine_error = own.standard_error[y];
      outcome.difference = (found.mean - p) / std::max(std::hypot(error, outcome.machine_error), 1e-12);
      if (std::abs(outcome.difference) > std::abs(worst)) {
        worst = outcome.difference;
        summary.bias.outcome = outcome.name;
        summary.bias.difference = worst;
      }
    }
    summary.independent_reads = std::min(summary.independent_reads, found.independent_reads);
    summary.outcomes.push_back(std::move(outcome));
  }
  summary.bias.verdict = std::abs(worst) > kChance ? "biased" : own.probability.empty() ? "not checked" : "none found";
}

constexpr double kRounding = 1e-12;  // relative variance that only rounding makes

void add_variables(const Sidecar& sidecar, const DecodedAnswer& decoded, AnswerSummary& summary) {
  for (std::size_t v = 0; v < sidecar.layout.variable_count(); ++v) {
    const learning::SeriesMean mean =
        learning::series_mean(decoded.mean[v], decoded.weight, decoded.occurrences, decoded.order);
    const learning::SeriesMean square =
        learning::series_mean(decoded.square[v], decoded.weight, decoded.occurrences, decoded.order);
    const double variance = square.mean - mean.mean * mean.mean;
    const bool constant = variance < kRounding * square.mean;
    summary.variables.push_back({sidecar.layout.encoders()[v].name(), sidecar.layout.encoders()[v].unit(), mean.mean,
                                 constant ? 0 : mean.standard_error, constant ? 0 : std::sqrt(variance)});
  }
}

}  // namespace

DecodedAnswer decode_answer(const Sidecar& sidecar, const learning::SampleSet& answer, Decoding decoding,
                            const CodeMachine* machine, std::uint64_t seed,
                            const std::optional<learning::BetaEstimate>& rows_beta) {
  DecodedAnswer result;
  result.decoding = decoding;
  make_room(sidecar, answer, result);
  const bool repair = decoding == Decoding::repair;
  take_rows(sidecar, answer, repair ? learning::DecodeRule::repair : learning::DecodeRule::discard, result);
  if (decoding != Decoding::weigh) return result;
  GONOGO_ASSERT(machine);
  if (machine->has_free_units()) result.valid = result.reads;
  weigh_rows(sidecar, answer, *machine, seed, rows_beta ? rows_beta->beta : 1, result);
  if (rows_beta) result.beta_error = (rows_beta->high - rows_beta->low) / (2 * 1.96);
  return result;
}

std::string rows_csv(const Sidecar& sidecar, const DecodedAnswer& decoded, std::optional<std::uint64_t> inside) {
  const bool weighed = decoded.decoding == Decoding::weigh;
  const std::vector<learning::Encoder>& encoders = sidecar.layout.encoders();
  std::string text;
  for (const learning::Encoder& encoder : encoders) text += encoder.name() + ",";
  text += weighed ? "outcome,energy,occurrences,weight\n" : "outcome,energy,occurrences\n";
  for (std::size_t n = 0; n < decoded.rows.size(); ++n) {
    const DecodedAnswer::Row& row = decoded.rows[n];
    for (std::size_t v = 0; v < encoders.size(); ++v) {
      const bool drawn = inside && !sidecar.clamped.count(encoders[v].name());
      const double x = drawn ? learning::value_inside(encoders[v], encoders[v].bin_of(row.values[v]),
                                                      random_unit(*inside, kInside, n * encoders.size() + v))
                             : row.values[v];
      text += Json(x).dump() + ",";
    }
    text += sidecar.layout.outcomes()[row.outcome] + "," + Json(row.energy).dump() + "," +
            std::to_string(row.occurrences) + (weighed ? "," + Json(row.weight).dump() : "") + "\n";
  }
  return text;
}

AnswerSummary summarise(const Sidecar& sidecar, const DecodedAnswer& decoded, const CodeMachine* machine) {
  AnswerSummary summary;
  summary.decoding = decoded.decoding;
  summary.reads = decoded.reads;
  summary.valid = decoded.valid;
  summary.repaired = decoded.repaired;
  summary.invalid_share = decoded.reads > 0 ? 1 - decoded.valid / decoded.reads : 0;
  summary.free_units = machine && machine->has_free_units();
  summary.rows_as_drawn = decoded.order.as_drawn;
  if (decoded.rows.empty()) return summary;
  summary.independent_reads = decoded.reads;
  add_outcomes(sidecar, decoded, machine, summary);
  add_variables(sidecar, decoded, summary);
  return summary;
}

Json to_json(const AnswerSummary& summary) {
  Json json = Json::Object{{"reads", summary.reads},
                           {"decoding", decoding_name(summary.decoding)},
                           {"valid", summary.valid},
                           {"repaired", summary.repaired},
                           {"invalid_share", summary.invalid_share},
                           {"rows_as_drawn", summary.rows_as_drawn}};
  Json bias = Json::object();
  if (!summary.outcomes.empty()) {
    bias["verdict"] = summary.bias.verdict;
    if (!summary.bias.outcome.empty()) {
      bias["outcome"] = summary.bias.outcome;
      bias["difference_in_errors"] = summary.bias.difference;
    }
    Json outcomes = Json::object(), variables = Json::object();
    for (const AnswerSummary::Outcome& outcome : summary.outcomes) {
      Json& entry = outcomes[outcome.name] = Json::Object{{"frequency", outcome.frequency.mean},
                                                          {"standard_error", outcome.frequency.standard_error},
                                                          {"correlation_time", outcome.frequency.correlation_time}};
      if (std::isnan(outcome.machine)) continue;
      entry["machine"] = outcome.machine;
      entry["machine_standard_error"] = outcome.machine_error;
      entry["difference_in_errors"] = outcome.difference;
    }
    for (const AnswerSummary::Variable& variable : summary.variables)
      variables[variable.name] = Json::Object{{"unit", variable.unit},
                                              {"mean", variable.mean},
                                              {"standard_error", variable.standard_error},
                                              {"standard_deviation", variable.standard_deviation}};
    json["outcomes"] = std::move(outcomes);
    json["variables"] = std::move(variables);
  }
  json["independent_reads"] = summary.independent_reads;
  if (summary.temperature) {
    const learning::BetaEstimate& beta = summary.temperature->beta;
    json["temperature"] = Json::Object{
        {"beta", beta.beta}, {"low", beta.low}, {"high", beta.high}, {"verdict", summary.temperature->verdict}};
  }
  json["bias"] = std::move(bias);
  return json;
}

namespace {

/// At most `most` rows, evenly from all.
learning::SampleSet thinned(const learning::SampleSet& answer, std::size_t most) {
  learning::SampleSet rows = answer;
  if (answer.row_count() <= most) return rows;
  rows.values.clear(), rows.energies.clear(), rows.occurrences.clear();
  for (std::size_t k = 0; k < most; ++k) {
    const std::size_t r = k * answer.row_count() / most;
    rows.values.insert(rows.values.end(), answer.row(r).begin(), answer.row(r).end());
    rows.energies.push_back(answer.energies[r]);
    rows.occurrences.push_back(answer.occurrences[r]);
  }
  return rows;
}

}  // namespace

RowTemperature row_temperature(const learning::Problem& problem, const learning::SampleSet& answer) {
  constexpr double kMargin = 0.01;       // of beta: what broken chains and rounding of a device leave
  constexpr std::size_t kEnough = 4000;  // rows, for an error of beta of about 1 %
  const auto is_zero = [](double x) { return x == 0; };
  const bool is_flat = std::all_of(problem.linear.begin(), problem.linear.end(), is_zero) &&
                       std::all_of(problem.couplings.begin(), problem.couplings.end(),
                                   [](const learning::Coupling& c) { return c.value == 0; });
  if (is_flat) return {{1, 1, 1}, "right"};  // rows of every temperature follow the same distribution
  RowTemperature result{learning::pseudo_likelihood_beta(problem, thinned(answer, kEnough)), "right"};
  const learning::BetaEstimate& beta = result.beta;
  if (!std::isfinite(beta.beta) || beta.high - beta.low > 1)
    result.verdict = "unknown";
  else if (beta.low - kMargin > 1 || beta.high + kMargin < 1)
    result.verdict = "wrong";
  return result;
}

void expect_temperature(const RowTemperature& temperature, const ImportLimits& limits, const std::string& source) {
  const learning::BetaEstimate& beta = temperature.beta;
  if (std::isinf(limits.temperature)) return;
  if (temperature.verdict == "unknown")
    throw InputError(source + ": its rows tell no temperature" +
                     (std::isfinite(beta.beta)
                          ? ": beta lies between " + number_text(beta.low, 3) + " and " + number_text(beta.high, 3) +
                                "; draw more rows"
                          : ", because each is a local minimum of the energy; sample the problem at beta 1, do not "
                            "minimise it"));
  if (temperature.verdict == "right" || std::abs(beta.beta - 1) <= limits.temperature) return;
  throw InputError(source + ": its rows have beta " + number_text(beta.beta, 3) +
                   " (95 %: " + number_text(beta.low, 3) + " to " + number_text(beta.high, 3) +
                   ") where the problem means 1, so their frequencies are not the machine's; sample with an inverse "
                   "temperature of 1, or for a device multiply the problem by " +
                   number_text(1 / beta.beta, 3) + " (--max-beta-error allows more)");
}

void expect_enough(const AnswerSummary& summary, const ImportLimits& limits, const std::string& source) {
  const bool weighed = summary.decoding == Decoding::weigh;
  const double found = weighed ? summary.independent_reads : summary.valid + summary.repaired;
  const double share = summary.reads > 0 ? found / summary.reads : 0;
  if (found >= limits.reads && share >= limits.share) return;
  const std::string what = weighed ? " reads are worth " + number_text(std::floor(found)) + " independent ones ("
                                   : " reads can be decoded: " + number_text(found) + " (";
  throw InputError(source + ": its " + number_text(summary.reads) + what + number_text(100 * share, 3) +
                   " %); an answer needs at least " + number_text(limits.reads) + " and " +
                   number_text(100 * limits.share) +
                   " % of the reads. Draw more rows, decode with weigh, or export with a penalty; --min-reads and "
                   "--min-share change the limits");
}

std::string decoding_name(Decoding decoding) {
  return decoding == Decoding::weigh ? "weigh" : decoding == Decoding::discard ? "discard" : "repair";
}

}  // namespace gonogo::outcome
