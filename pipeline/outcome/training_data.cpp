#include "pipeline/outcome/training_data.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/error.h"

namespace gonogo::outcome {
namespace {

void extend_box(TrainingData& data, const std::vector<double>& variables) {
  for (std::size_t v = 0; v < variables.size(); ++v) {
    if (std::isnan(variables[v])) continue;
    data.lower[v] = std::min(data.lower[v], variables[v]);
    data.upper[v] = std::max(data.upper[v], variables[v]);
  }
}

void extend_box(TrainingData& data, const Config& ranges) {
  for (const auto& [name, value] : ranges.json().members()) {
    const std::size_t v = campaign::contract().variable_index(name);
    const std::vector<double> ends = ranges.numbers(name);
    if (ends.size() != 2 || ends[0] > ends[1]) ranges.fail(name, "expected [low, high]");
    data.lower[v] = std::min(data.lower[v], ends[0]);
    data.upper[v] = std::max(data.upper[v], ends[1]);
  }
}

void make_mean_one(std::vector<double>& weight) {
  double sum = 0;
  for (double w : weight) sum += w;
  for (double& w : weight) w *= double(weight.size()) / sum;
}

/// Weights of mean 1; a variable that no trial knows has the contract's whole range as its box.
void finish(TrainingData& data) {
  make_mean_one(data.table.weight);
  for (std::size_t v = 0; v < data.lower.size(); ++v) {
    if (data.lower[v] <= data.upper[v]) continue;
    data.lower[v] = campaign::contract().variables[v].minimum;
    data.upper[v] = campaign::contract().variables[v].maximum;
  }
}

}  // namespace

namespace {

/// Mean speed over the commanded one, cut where it says no more of the outcome; NaN where a trial has none.
double speed_share(const campaign::TrialRecord& record) {
  constexpr double kLeast = -0.5, kMost = 1.5;
  static const std::size_t commanded = campaign::contract().variable_index("commanded_speed");
  const double share = campaign::measure_of(record, "mean_speed") / record.point.variables[commanded];
  return std::isfinite(share) ? std::clamp(share, kLeast, kMost) : NAN;
}

}  // namespace

std::vector<int> passable_outcomes() {
  std::vector<int> passable;
  for (const campaign::Outcome& outcome : campaign::contract().outcomes)
    passable.push_back(outcome.verdict == campaign::Verdict::go || outcome.verdict == campaign::Verdict::slow_go);
  return passable;
}

std::vector<int> passable_labels(const learning::TrainingTable& table) {
  const std::vector<int> passable = passable_outcomes();
  std::vector<int> label;
  for (std::size_t y : table.outcome) label.push_back(passable[y]);
  return label;
}

TrainingData make_training_data(const std::vector<campaign::TrialRecord>& records,
                                const std::optional<Config>& design) {
  TrainingData data;
  const std::size_t variables = campaign::contract().variables.size();
  data.table.variable_count = variables;
  data.lower.assign(variables, INFINITY);
  data.upper.assign(variables, -INFINITY);
  data.outcome_count.assign(campaign::contract().outcomes.size(), 0);
  for (const campaign::TrialRecord& record : records) {
    const campaign::DesignPoint& point = record.point;
    ++data.trials;
    extend_box(data, point.variables);
    if (record.verdict == campaign::Verdict::unknown) {
      ++data.failed;
      data.failed_variables.insert(data.failed_variables.end(), point.variables.begin(), point.variables.end());
      continue;
    }
    if (!(point.proposal_density > 0) || !std::isfinite(point.proposal_density))
      throw InputError("dataset: trial " + std::to_string(point.index) + ": proposal density is not a positive number");
    const std::size_t outcome = campaign::contract().outcome_index(record.verdict, record.reason);
    ++data.outcome_count[outcome];
    data.table.variables.insert(data.table.variables.end(), point.variables.begin(), point.variables.end());
    data.table.outcome.push_back(outcome);
    data.table.weight.push_back(1 / point.proposal_density);
    data.table.group.push_back(point.replicate_of >= 0 ? std::uint64_t(point.replicate_of) : point.index);
    data.table.margin.push_back(speed_share(record));
  }
  if (data.table.row_count() == 0)
    throw InputError("dataset: none of its " + std::to_string(data.trials) +
                     " trials is valid; simulate more trials before training");
  if (design)
    if (const auto ranges = design->object_if("ranges")) extend_box(data, *ranges);
  finish(data);
  return data;
}

void widen_to_own_ranges(TrainingData& data, const campaign::Provenance& provenance, const std::string& where) {
  if (provenance.study.empty()) return;
  const Config study = Config::parse(provenance.study, where + ": study");
  if (const auto design = study.object_if("design"))
    if (const auto ranges = design->object_if("ranges")) extend_box(data, *ranges);
}

void temper_weights(TrainingData& data, double importance) {
  if (importance == 1) return;
  for (double& w : data.table.weight) w = std::pow(w, importance);
  make_mean_one(data.table.weight);
}

namespace {

constexpr std::uint64_t kThin = 0x7468696e;  // stream of random numbers

struct DrawnGroups {
  std::vector<char> drawn;      // [row]
  std::size_t groups_left = 0;  // that were not drawn
};

/// Whole groups of at least `count` rows together, or all of them, drawn by the seed.
DrawnGroups draw_groups(const learning::TrainingTable& table, std::size_t count, std::uint64_t seed,
                        std::uint64_t stream) {
  std::map<std::uint64_t, std::vector<std::size_t>> groups;
  for (std::size_t n = 0; n < table.row_count(); ++n) groups[table.group[n]].push_back(n);
  std::vector<const std::vector<std::size_t>*> members;
  for (const auto& [group, rows] : groups) members.push_back(&rows);
  DrawnGroups result{std::vector<char>(table.row_count(), 0), members.size()};
  std::size_t taken = 0;
  for (std::size_t g : learning::permutation(members.size(), seed, stream)) {
    if (taken >= count) break;
    for (std::size_t row : *members[g]) result.drawn[row] = 1;
    taken += members[g]->size();
    --result.groups_left;
  }
  return result;
}

/// Makes the rows that are marked the whole table.
void keep_rows(TrainingData& data, const std::vector<char>& marked) {
  std::vector<std::size_t> rows;
  for (std::size_t n = 0; n < marked.size(); ++n)
    if (marked[n])
      rows.push_back(n);
    else
      --data.outcome_count[data.table.outcome[n]];
  data.table = data.table.subset(rows);
}

}  // namespace

learning::TrainingTable hold_out(TrainingData& data, std::size_t count, std::uint64_t seed) {
  constexpr std::uint64_t kHoldOut = 0x686f6c64;  // stream of random numbers
  DrawnGroups groups = draw_groups(data.table, count, seed, kHoldOut);
  if (groups.groups_left < 2)
    throw InputError("dataset: " + std::to_string(count) + " trials cannot be held out of " +
                     std::to_string(data.table.row_count()) + " valid ones; leave trials at two points to train on");
  std::vector<std::size_t> held;
  for (std::size_t n = 0; n < groups.drawn.size(); ++n)
    if (groups.drawn[n]) held.push_back(n);
  learning::TrainingTable held_out = data.table.subset(held);
  for (char& drawn : groups.drawn) drawn = !drawn;
  keep_rows(data, groups.drawn);
  return held_out;
}

std::vector<std::uint64_t> drawn_groups(const learning::TrainingTable& table, std::size_t count, std::uint64_t seed) {
  const DrawnGroups groups = draw_groups(table, count, seed, kThin);
  std::set<std::uint64_t> drawn;
  for (std::size_t n = 0; n < table.row_count(); ++n)
    if (groups.drawn[n]) drawn.insert(table.group[n]);
  return {drawn.begin(), drawn.end()};
}

void keep_groups(TrainingData& data, const std::vector<std::uint64_t>& groups) {
  const std::set<std::uint64_t> kept(groups.begin(), groups.end());
  std::vector<char> marked;
  for (const std::uint64_t group : data.table.group) marked.push_back(kept.count(group) > 0);
  keep_rows(data, marked);
}

learning::VisibleLayout make_layout(const TrainingData& data, const LearningSettings& settings) {
  std::vector<learning::Encoder> encoders;
  for (std::size_t v = 0; v < campaign::contract().variables.size(); ++v) {
    const campaign::Variable& variable = campaign::contract().variables[v];
    const auto chosen = settings.encoders.find(variable.name);
    const campaign::EncoderSpec spec = chosen == settings.encoders.end() ? variable.encoder : chosen->second;
    const learning::Code code = learning::code_from_name(spec.code);
    const int bins = learning::Encoder::bins_for_units(code, spec.bits);
    std::vector<double> values;
    for (std::size_t n = 0; n < data.table.row_count(); ++n)
      if (const double x = data.table.row(n)[v]; !std::isnan(x)) values.push_back(x);
    // A variable without a single known value cannot be learned about: one bin, no unit.
    if (values.empty() || data.lower[v] == data.upper[v])
      encoders.push_back(learning::Encoder::by_range(variable.name, variable.unit, learning::Code::thermometer, 1,
                                                     data.lower[v], data.upper[v]));
    else if (const auto edges = settings.edges.find(variable.name); edges != settings.edges.end())
      encoders.push_back(
          learning::Encoder::by_edges(variable.name, variable.unit, code, edges->second, data.lower[v], data.upper[v]));
    else if (settings.quantile_bins)
      encoders.push_back(learning::Encoder::by_quantile(variable.name, variable.unit, code, bins, std::move(values)));
    else
      encoders.push_back(
          learning::Encoder::by_range(variable.name, variable.unit, code, bins, data.lower[v], data.upper[v]));
  }
  std::vector<std::string> outcomes;
  for (const campaign::Outcome& outcome : campaign::contract().outcomes) outcomes.push_back(outcome.name);
  return learning::VisibleLayout(std::move(encoders), std::move(outcomes));
}

void describe_trials(const TrainingData& data, bool uniform_inputs, learning::Model& model) {
  model.sampled_lower = data.lower;
  model.sampled_upper = data.upper;
  model.training_points = data.table.variables;
  model.training_weights = data.table.weight;
  model.training_outcomes.assign(data.table.outcome.begin(), data.table.outcome.end());
  if (uniform_inputs) model.input_prior = learning::uniform_prior(model.layout);
}

std::vector<std::size_t> varying_inputs(const learning::VisibleLayout& layout) {
  std::vector<std::size_t> result;
  for (std::size_t v = 0; v < layout.variable_count(); ++v)
    if (layout.encoders()[v].unit_count() > 0) result.push_back(v);
  return result;
}

}  // namespace gonogo::outcome
