#include "pipeline/learn/evaluation/joint_scores.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/line.h"
#include "learning/score/copula.h"
#include "learning/score/distance.h"
#include "pipeline/learn/sampling/sample_rows.h"
#include "pipeline/learn/training/training_data.h"

namespace gonogo::learn {
namespace {

using learning::ScoredRows;

/// Rows as the columns of the inputs that vary, then the number of the outcome.
class Columns {
 public:
  explicit Columns(const learning::VisibleLayout& layout) : layout_(layout), passable_(passable_outcomes()) {
    for (std::size_t v = 0; v < layout.variable_count(); ++v)
      if (layout.encoders()[v].unit_count() > 0) inputs_.push_back(v);
  }
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

Json distance_json(const learning::TableDistance& distance, const std::vector<std::string>& names) {
  Json json;
  json["mean"] = distance.mean;
  json["largest"] = distance.largest;
  std::vector<std::string> of = {names[distance.largest_a]};
  if (distance.largest_b != distance.largest_a) of.push_back(names[distance.largest_b]);
  json["of"] = Json(of);
  return json;
}

Json scores_of(const Columns& columns, const ScoredRows& rows, const ScoredRows& held_out, std::uint64_t seed) {
  const learning::BoostSettings settings{.seed = seed};
  const ScoredRows bins = columns.bins(rows), held_out_bins = columns.bins(held_out);
  Json json;
  json["auc_bins"] =
      learning::two_sample_auc(columns.outcome_apart(bins), columns.outcome_apart(held_out_bins), settings);
  json["auc_values"] = learning::two_sample_auc(columns.outcome_apart(rows), columns.outcome_apart(held_out), settings);
  json["trained_brier"] = trained_brier(columns, rows, held_out, seed);
  json["marginals"] = distance_json(learning::marginal_distance(bins, held_out_bins), columns.names());
  json["pairs"] = distance_json(learning::pair_distance(bins, held_out_bins), columns.names());
  return json;
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

Json joint_scores(const Predictor& predictor, const learning::TrainingTable& trained,
                  const learning::TrainingTable& held_out, std::uint64_t seed,
                  const std::optional<learning::TrainingTable>& given) {
  const learning::Model& model = predictor.model();
  const Columns columns(model.layout);
  learning::TrainingTable weighed = held_out;
  for (double& w : weighed.weight) w = std::pow(w, importance_of(model));
  const ScoredRows all = columns.known_rows(trained, SIZE_MAX, seed);
  ScoredRows real = columns.known_rows(weighed, kMaxJointRows, seed);
  const std::size_t count = std::min(all.count(), real.count());
  Json json;
  if (count < kMinJointRows || columns.count() < 3) {
    json["left_out"] = line(
        "%zu training and %zu held-out trials without unknown values and %zu inputs that vary; %zu "
        "trials of each kind and two inputs are needed",
        all.count(), real.count(), columns.count() - 1, kMinJointRows);
    return json;
  }
  std::vector<std::size_t> first;
  for (std::size_t n = 0; n < count; ++n) first.push_back(n);
  real = real.subset(first);
  const SampledRows machine = model_rows(predictor, RowSource::machine, count, seed);
  const Json mixing = rows_report(
      predictor, {.known = std::vector<double>(model.layout.variable_count(), NAN), .outcome = {}, .device = {}},
      machine);
  json["rows"] = Json(std::uint64_t(count));
  json["sampler"] = machine.sampler;
  json["largest_r_hat"] = mixing.at("largest_r_hat");
  Json& kinds = json["kinds"] = Json::object();
  kinds["machine"] = scores_of(columns, columns.sampled_rows(machine), real, seed);
  if (!model.input_prior.empty())
    kinds["prior"] =
        scores_of(columns, columns.sampled_rows(model_rows(predictor, RowSource::prior, count, seed)), real, seed);
  kinds["gaussian_copula"] = scores_of(columns, learning::GaussianCopula(all, seed).draw(count, seed), real, seed);
  kinds["trials"] = scores_of(columns, all.subset(first), real, seed);
  if (given) kinds["given"] = scores_of(columns, given_rows(columns, *given, count, seed), real, seed);
  return json;
}

std::string joint_text(const Json& scores) {
  if (const Json* reason = scores.find("left_out")) return "joint distribution: not scored, " + reason->string() + "\n";
  std::string text = line(
      "joint distribution: %lld rows of each kind against held-out trials; an AUC of 0.5 cannot be told apart\n"
      "%-28s %9s %11s %14s %17s %17s\n",
      static_cast<long long>(scores.at("rows").integer()), "", "AUC, bins", "AUC, values", "Brier, trained",
      "marginals: mean,", "pairs: mean,");
  text += line("%-28s %9s %11s %14s %17s %17s\n", "", "", "", "on the rows", "largest distance", "largest distance");
  const std::vector<std::pair<const char*, const char*>> names = {{"machine", "the machine's joint"},
                                                                  {"prior", "prior times P(outcome | x)"},
                                                                  {"gaussian_copula", "Gaussian copula"},
                                                                  {"trials", "training trials: the floor"},
                                                                  {"given", "the rows given"}};
  for (const auto& [key, name] : names) {
    const Json* kind = scores.at("kinds").find(key);
    if (!kind) continue;
    text += line("%-28s %9.3f %11.3f %14.4f     %5.3f  %5.3f      %5.3f  %5.3f\n", name, kind->at("auc_bins").number(),
                 kind->at("auc_values").number(), kind->at("trained_brier").number(),
                 kind->at("marginals").at("mean").number(), kind->at("marginals").at("largest").number(),
                 kind->at("pairs").at("mean").number(), kind->at("pairs").at("largest").number());
  }
  if (scores.at("largest_r_hat").is_number() && scores.at("sampler").string() != "exact")
    text += line("the machine's rows: R-hat at most %.3f\n", scores.at("largest_r_hat").number());
  return text;
}

}  // namespace gonogo::learn
