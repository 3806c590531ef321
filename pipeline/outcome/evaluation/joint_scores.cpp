#include "pipeline/outcome/evaluation/joint_scores.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/error.h"
#include "base/files/csv.h"
#include "base/format.h"
#include "base/math/random.h"
#include "learning/score/copula.h"
#include "learning/score/two_sample.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/outcome/sampling/sample_rows.h"
#include "pipeline/outcome/training_data.h"

namespace gonogo::outcome {
namespace {

std::size_t outcome_of(const std::filesystem::path& file, std::size_t number, const std::string& cell) {
  const auto& outcomes = campaign::contract().outcomes;
  const auto found =
      std::find_if(outcomes.begin(), outcomes.end(), [&](const auto& outcome) { return outcome.name == cell; });
  if (found == outcomes.end())
    refuse_csv_line(file, number, "\"" + cell + "\" is no outcome; give one as go or no_go/traction");
  return std::size_t(found - outcomes.begin());
}

/// Position of a variable in the contract, or its size for a column that is none.
std::size_t variable_of(const std::string& name) {
  const auto& variables = campaign::contract().variables;
  return std::size_t(std::find_if(variables.begin(), variables.end(), [&](const auto& v) { return v.name == name; }) -
                     variables.begin());
}

}  // namespace

learning::TrainingTable read_given_rows(const std::filesystem::path& file) {
  const std::vector<CsvLine> lines = read_csv_lines(file, "rows");
  const std::vector<std::string> header = lines.front().cell;
  if (std::find(header.begin(), header.end(), "outcome") == header.end())
    throw InputError(file.string() + ": its header has no column \"outcome\"");
  learning::TrainingTable table;
  table.variable_count = campaign::contract().variables.size();
  for (std::size_t n = 1; n < lines.size(); ++n) {
    const std::size_t number = lines[n].number;
    const std::vector<std::string>& cells = lines[n].cell;
    if (cells.size() != header.size())
      refuse_csv_line(file, number,
                      "has " + std::to_string(cells.size()) + " columns, the header " + std::to_string(header.size()));
    std::vector<double> values(table.variable_count, NAN);
    double weight = 1;
    std::size_t outcome = 0;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const std::size_t variable = variable_of(header[k]);
      if (variable < values.size()) values[variable] = csv_number(file, number, cells[k]);
      if (header[k] == "outcome") outcome = outcome_of(file, number, cells[k]);
      if (header[k] == "weight" || header[k] == "occurrences") weight *= csv_number(file, number, cells[k]);
    }
    if (weight < 0) refuse_csv_line(file, number, "a weight is at least 0");
    if (weight == 0) continue;
    table.variables.insert(table.variables.end(), values.begin(), values.end());
    table.outcome.push_back(outcome);
    table.weight.push_back(weight);
    table.group.push_back(n);
  }
  if (table.row_count() == 0) throw InputError(file.string() + ": holds a header and no rows");
  return table;
}

namespace {

using learning::ScoredRows;

/// Rows as the columns of the inputs that vary, then the number of the outcome.
class Columns {
 public:
  explicit Columns(const learning::VisibleLayout& layout)
      : layout_(layout), passable_(passable_outcomes()), inputs_(varying_inputs(layout)) {}
  std::size_t count() const { return inputs_.size() + 1; }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (std::size_t v : inputs_) names.push_back(layout_.encoders()[v].name());
    names.push_back("outcome");
    return names;
  }

  /// Rows of a table without unknown values, at most `most`, in an order drawn from the seed.
  ScoredRows known_rows(const learning::TrainingTable& table, std::size_t most, std::uint64_t seed) const {
    ScoredRows rows;
    rows.columns = count();
    for (std::size_t n : learning::permutation(table.row_count(), seed, 0)) {
      std::vector<double> row;
      for (std::size_t v : inputs_) row.push_back(table.row(n)[v]);
      row.push_back(double(table.outcome[n]));
      const bool known = std::none_of(row.begin(), row.end(), [](double x) { return std::isnan(x); });
      if (known && rows.count() < most) rows.add(row, table.weight[n]);
    }
    return rows;
  }
  ScoredRows sampled_rows(const SampledRows& sampled) const {
    ScoredRows rows;
    rows.columns = count();
    for (std::size_t n = 0; n < sampled.row_count(); ++n) {
      std::vector<double> row;
      for (std::size_t v : inputs_) row.push_back(sampled.row(n)[v]);
      row.push_back(double(sampled.outcome[n]));
      rows.add(row, 1);
    }
    return rows;
  }

  ScoredRows bins(ScoredRows rows) const {
    for (std::size_t n = 0; n < rows.count(); ++n)
      for (std::size_t k = 0; k < inputs_.size(); ++k) {
        double& x = rows.values[n * rows.columns + k];
        x = layout_.encoders()[inputs_[k]].bin_of(x);
      }
    return rows;
  }
  /// The outcome as a column for each, so that trees can part any one from the others.
  ScoredRows outcome_apart(const ScoredRows& rows) const {
    ScoredRows result;
    result.columns = inputs_.size() + layout_.outcome_count();
    for (std::size_t n = 0; n < rows.count(); ++n) {
      std::vector<double> row(rows.row(n).begin(), rows.row(n).end() - 1);
      row.resize(result.columns, 0.0);
      row[inputs_.size() + std::size_t(rows.row(n).back())] = 1;
      result.add(row, rows.weight[n]);
    }
    return result;
  }
  ScoredRows inputs_only(const ScoredRows& rows) const {
    ScoredRows result;
    result.columns = inputs_.size();
    for (std::size_t n = 0; n < rows.count(); ++n) result.add(rows.row(n).first(inputs_.size()), rows.weight[n]);
    return result;
  }
  std::vector<int> passed(const ScoredRows& rows) const {
    std::vector<int> result;
    for (std::size_t n = 0; n < rows.count(); ++n) result.push_back(passable_[std::size_t(rows.row(n).back())]);
    return result;
  }

 private:
  const learning::VisibleLayout& layout_;
  std::vector<int> passable_;
  std::vector<std::size_t> inputs_;  // variables
};

double trained_brier(const Columns& columns, const ScoredRows& rows, const ScoredRows& held_out, std::uint64_t seed) {
  const learning::BoostedTrees trees(columns.inputs_only(rows), columns.passed(rows),
                                     {.trees = 300, .depth = 3, .learning_rate = 0.05, .seed = seed});
  const ScoredRows inputs = columns.inputs_only(held_out);
  const std::vector<int> passed = columns.passed(held_out);
  double sum = 0, total = 0;
  for (std::size_t n = 0; n < inputs.count(); ++n) {
    sum += inputs.weight[n] * std::pow(trees(inputs.row(n)) - passed[n], 2);
    total += inputs.weight[n];
  }
  return sum / total;
}

JointScores::Distance named_distance(const learning::TableDistance& distance, const std::vector<std::string>& names) {
  JointScores::Distance result{distance.mean, distance.largest, {names[distance.largest_a]}};
  if (distance.largest_b != distance.largest_a) result.of.push_back(names[distance.largest_b]);
  return result;
}

JointScores::Kind scored_kind(const std::string& name, const Columns& columns, const ScoredRows& rows,
                              const ScoredRows& held_out, std::uint64_t seed) {
  const learning::BoostSettings settings{.seed = seed};
  const ScoredRows bins = columns.bins(rows), held_out_bins = columns.bins(held_out);
  return {
      .name = name,
      .auc_bins = learning::two_sample_auc(columns.outcome_apart(bins), columns.outcome_apart(held_out_bins), settings),
      .auc_values = learning::two_sample_auc(columns.outcome_apart(rows), columns.outcome_apart(held_out), settings),
      .trained_brier = trained_brier(columns, rows, held_out, seed),
      .marginals = named_distance(learning::marginal_distance(bins, held_out_bins), columns.names()),
      .pairs = named_distance(learning::pair_distance(bins, held_out_bins), columns.names())};
}

/// The power of prior / proposal that training weighed trials by; 1 in models that do not say.
double importance_of(const learning::Model& model) {
  const Json* settings = model.provenance.find("settings");
  const Json* importance = settings ? settings->find("importance") : nullptr;
  return importance ? importance->number() : 1;
}

SampledRows model_rows(const Predictor& predictor, RowSource source, std::size_t count, std::uint64_t seed) {
  RowRequest request{.rows = count,
                     .known = std::vector<double>(predictor.model().layout.variable_count(), NAN),
                     .outcome = {},
                     .source = source,
                     .chains = 20,
                     .rungs = 4,
                     .burn_in = 500,
                     .every = 20,
                     .device = {},
                     .seed = seed};
  return sample_rows(predictor, request);
}

ScoredRows given_rows(const Columns& columns, const learning::TrainingTable& given, std::size_t count,
                      std::uint64_t seed) {
  ScoredRows rows = columns.known_rows(given, count, seed);
  if (rows.count() < kMinJointRows)
    throw InputError(line("%zu of the %zu rows given know the outcome and all inputs that vary; %zu are needed",
                          rows.count(), given.row_count(), kMinJointRows));
  const double mean = std::accumulate(rows.weight.begin(), rows.weight.end(), 0.0) / double(rows.count());
  for (double& weight : rows.weight) weight /= mean;
  return rows;
}

}  // namespace

JointScores joint_scores(const Predictor& predictor, const learning::TrainingTable& trained,
                         const learning::TrainingTable& held_out, std::uint64_t seed,
                         const std::optional<learning::TrainingTable>& given) {
  const learning::Model& model = predictor.model();
  const Columns columns(model.layout);
  learning::TrainingTable weighed = held_out;
  for (double& w : weighed.weight) w = std::pow(w, importance_of(model));
  const ScoredRows all = columns.known_rows(trained, SIZE_MAX, seed);
  ScoredRows real = columns.known_rows(weighed, kMaxJointRows, seed);
  const std::size_t count = std::min(all.count(), real.count());
  JointScores scores;
  if (count < kMinJointRows || columns.count() < 3) {
    scores.left_out = line(
        "%zu training and %zu held-out trials without unknown values and %zu inputs that vary; %zu "
        "trials of each kind and two inputs are needed",
        all.count(), real.count(), columns.count() - 1, kMinJointRows);
    return scores;
  }
  std::vector<std::size_t> first;
  for (std::size_t n = 0; n < count; ++n) first.push_back(n);
  real = real.subset(first);
  const SampledRows machine = model_rows(predictor, RowSource::machine, count, seed);
  scores.rows = count;
  scores.sampler = machine.sampler;
  scores.largest_r_hat = machine.of_outcome.r_hat;
  for (const learning::Mixing& mixing : machine.of_variable)
    scores.largest_r_hat = std::fmax(scores.largest_r_hat, mixing.r_hat);
  const auto add = [&](const char* name, const ScoredRows& rows) {
    scores.kinds.push_back(scored_kind(name, columns, rows, real, seed));
  };
  add("machine", columns.sampled_rows(machine));
  if (!model.input_prior.empty())
    add("prior", columns.sampled_rows(model_rows(predictor, RowSource::prior, count, seed)));
  add("gaussian_copula", learning::GaussianCopula(all, seed).draw(count, seed));
  add("trials", all.subset(first));
  if (given) add("given", given_rows(columns, *given, count, seed));
  return scores;
}

namespace {

double passing_share(const Columns& columns, const ScoredRows& rows) {
  const std::vector<int> passed = columns.passed(rows);
  double sum = 0, total = 0;
  for (std::size_t n = 0; n < rows.count(); ++n) {
    sum += rows.weight[n] * passed[n];
    total += rows.weight[n];
  }
  return sum / total;
}

/// Two halves of the trials, as whole groups: the floor, and the trials that both are compared with.
struct Halves {
  ScoredRows floor, real;
};

Halves halves_of(const Columns& columns, const learning::TrainingTable& trials, std::uint64_t seed) {
  constexpr std::uint64_t kHalves = 0x68616c66;  // stream of random numbers
  std::vector<std::size_t> half[2];
  for (std::size_t n = 0; n < trials.row_count(); ++n)
    half[random_bits(seed, kHalves, trials.group[n]) % 2].push_back(n);
  Halves halves{columns.known_rows(trials.subset(half[0]), kMaxJointRows, seed), {}};
  halves.real = columns.known_rows(trials.subset(half[1]), halves.floor.count(), seed);
  return halves;
}

}  // namespace

std::optional<JointSummary> scored_joint(const Predictor& predictor, const learning::TrainingTable& trials,
                                         std::uint64_t seed) {
  constexpr std::size_t kFewest = 20, kEnough = 1000, kMostSplits = 10, kDrawn = 4000;
  const Columns columns(predictor.model().layout);
  const Halves first = halves_of(columns, trials, seed);
  if (first.real.count() < kFewest || columns.count() < 3) return std::nullopt;
  const ScoredRows machine = columns.sampled_rows(model_rows(predictor, RowSource::machine, kDrawn, seed));
  // One half of few trials may be easy or hard by chance, so that the scores are means over several pairs of halves.
  const std::size_t splits = std::clamp<std::size_t>(kEnough / trials.row_count(), 1, kMostSplits);
  JointSummary summary{.rows = first.real.count(), .splits = splits};
  for (std::size_t k = 0; k < splits; ++k) {
    const Halves halves = k == 0 ? first : halves_of(columns, trials, seed + k);
    std::vector<std::size_t> part;  // of the machine's rows, other ones for every pair
    for (std::size_t n = 0; n < halves.real.count(); ++n) part.push_back((k * first.real.count() + n) % kDrawn);
    const JointScores::Kind own = scored_kind("machine", columns, machine.subset(part), halves.real, seed),
                            same = scored_kind("trials", columns, halves.floor, halves.real, seed);
    const double share = 1 / double(splits);
    summary.auc_bins += share * own.auc_bins;
    summary.auc_values += share * own.auc_values;
    summary.trained_brier += share * own.trained_brier;
    summary.floor_bins += share * same.auc_bins;
    summary.floor_values += share * same.auc_values;
    summary.floor_brier += share * same.trained_brier;
  }
  summary.passable = passing_share(columns, machine);
  summary.trials_passable = passing_share(columns, columns.known_rows(trials, SIZE_MAX, seed));
  return summary;
}

Json to_json(const JointScores& scores) {
  if (!scores.left_out.empty()) return Json::Object{{"left_out", scores.left_out}};
  const auto distance_json = [](const JointScores::Distance& distance) {
    return Json::Object{{"mean", distance.mean}, {"largest", distance.largest}, {"of", Json(distance.of)}};
  };
  Json kinds = Json::object();
  for (const JointScores::Kind& kind : scores.kinds)
    kinds[kind.name] = Json::Object{{"auc_bins", kind.auc_bins},
                                    {"auc_values", kind.auc_values},
                                    {"trained_brier", kind.trained_brier},
                                    {"marginals", distance_json(kind.marginals)},
                                    {"pairs", distance_json(kind.pairs)}};
  return Json::Object{{"rows", scores.rows},
                      {"sampler", scores.sampler},
                      {"largest_r_hat", scores.largest_r_hat},
                      {"kinds", std::move(kinds)}};
}

std::string joint_text(const JointScores& scores) {
  if (!scores.left_out.empty()) return "joint distribution: not scored, " + scores.left_out + "\n";
  std::string text = line(
      "joint distribution: %zu rows of each kind against held-out trials; an AUC of 0.5 cannot be told apart\n"
      "%-28s %9s %11s %14s %17s %17s\n",
      scores.rows, "", "AUC, bins", "AUC, values", "Brier, trained", "marginals: mean,", "pairs: mean,");
  text += line("%-28s %9s %11s %14s %17s %17s\n", "", "", "", "on the rows", "largest distance", "largest distance");
  const std::map<std::string, const char*> words = {{"machine", "the machine's joint"},
                                                    {"prior", "prior times P(outcome | x)"},
                                                    {"gaussian_copula", "Gaussian copula"},
                                                    {"trials", "training trials: the floor"},
                                                    {"given", "the rows given"}};
  for (const JointScores::Kind& kind : scores.kinds)
    text += line("%-28s %9.3f %11.3f %14.4f     %5.3f  %5.3f      %5.3f  %5.3f\n", words.at(kind.name), kind.auc_bins,
                 kind.auc_values, kind.trained_brier, kind.marginals.mean, kind.marginals.largest, kind.pairs.mean,
                 kind.pairs.largest);
  if (!std::isnan(scores.largest_r_hat) && scores.sampler != "exact")
    text += line("the machine's rows: R-hat at most %.3f\n", scores.largest_r_hat);
  return text;
}

}  // namespace gonogo::outcome
