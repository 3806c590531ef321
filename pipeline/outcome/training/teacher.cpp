#include "pipeline/outcome/training/teacher.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "learning/rbm/gaussian_process.h"
#include "pipeline/campaign/design/sobol.h"
#include "pipeline/outcome/training_data.h"

namespace gonogo::outcome {

TeacherShare teacher_share(const LearningSettings& settings) {
  const double weight = settings.teacher.value_or(10);
  const bool is_box = settings.training.negative == learning::NegativePhaseKind::code_words && settings.importance == 1;
  return {weight, is_box ? weight / (1 + weight) : 0};
}

std::vector<double> taught_points(const std::vector<double>& lower, const std::vector<double>& upper, std::size_t count,
                                  std::uint64_t seed) {
  std::vector<double> points;
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t v = 0; v < lower.size(); ++v)
      points.push_back(lower[v] + (upper[v] - lower[v]) * campaign::scrambled_sobol(std::uint32_t(k), seed, int(v)));
  return points;
}

namespace {

/// Rows with more inputs at their end. points: [row x width]; added: [row x count]
std::vector<double> with_inputs(const std::vector<double>& points, std::size_t width, const std::vector<double>& added,
                                std::size_t count) {
  std::vector<double> result;
  auto more = added.begin();
  for (auto row = points.begin(); row != points.end(); row += std::ptrdiff_t(width), more += std::ptrdiff_t(count)) {
    result.insert(result.end(), row, row + std::ptrdiff_t(width));
    result.insert(result.end(), more, more + std::ptrdiff_t(count));
  }
  return result;
}

/// The first `variables` of every row.
std::vector<double> variables_of(const std::vector<double>& points, std::size_t width, std::size_t variables) {
  std::vector<double> result;
  for (auto row = points.begin(); row != points.end(); row += std::ptrdiff_t(width))
    result.insert(result.end(), row, row + std::ptrdiff_t(variables));
  return result;
}

/// Log odds of a forecast, which is never quite sure [nat].
std::vector<double> log_odds(const Forecast& forecast, const std::vector<double>& points) {
  constexpr double kDoubt = 0.005;
  std::vector<double> result = forecast.p_go(points);
  for (double& p : result) {
    p = std::clamp(p, kDoubt, 1 - kDoubt);
    p = std::log(p / (1 - p));
  }
  return result;
}

/// What the processes see beside the variables. points: [row x width]
std::vector<double> with_knowledge(const OtherTrials& known, std::vector<double> points, std::size_t width,
                                   std::size_t variables) {
  const std::vector<double> asked = variables_of(points, width, variables);
  if (known.composed) {
    points = with_inputs(points, width, known.composed->inputs(asked), ComposedVehicle::kInputs);
    width += ComposedVehicle::kInputs;
  }
  if (known.forecast) points = with_inputs(points, width, log_odds(*known.forecast, asked), 1);
  return points;
}

/// Log odds of every row. inputs: [row x width]
std::vector<double> log_odds(const learning::LogisticModel& model, const std::vector<double>& inputs,
                             std::size_t width) {
  std::vector<double> result;
  for (std::size_t first = 0; first < inputs.size(); first += width)
    result.push_back(model.log_odds(std::span(inputs).subspan(first, width)));
  return result;
}

/// Share of the commanded speed that the family's trials expect of points [x variables]; empty without them.
std::vector<double> family_shares(const OtherTrials& known, const std::vector<double>& points, std::size_t variables) {
  if (!known.family_speed) return {};
  return (*known.family_speed)(with_input(known.forecast->in_family(points), variables, size_across));
}

/// What the second mean sees beside a forecast: the variables, the size of the slope across, and r.
std::vector<double> with_shares(const std::vector<double>& points, std::size_t variables,
                                const std::vector<double>& shares) {
  return with_inputs(with_input(points, variables, size_across), variables + 1, shares, 1);
}

/// The rows with these inputs.
learning::TrainingTable with_variables(const learning::TrainingTable& rows, std::vector<double> inputs) {
  learning::TrainingTable result = rows;
  result.variable_count = inputs.size() / rows.row_count();
  result.variables = std::move(inputs);
  return result;
}

void add(std::vector<double>& sum, const std::vector<double>& values) {
  for (std::size_t k = 0; k < values.size(); ++k) sum[k] += values[k];
}

// Penalties beside a forecast, on standardised inputs [nat]: few trials move its log odds by some 0.3 along a variable,
// and by some 1 with the speed to expect (docs/log/learning.md).
constexpr double kRidgeOfVariables = 10, kRidgeOfShare = 1, kRidgeOfConstant = 0.3;

}  // namespace

Teacher::Teacher(const learning::TrainingTable& rows, const OtherTrials& others) : variables_(rows.variable_count) {
  if (!others.empty()) known_.own = others.own;
  known_.composed = others.composed;
  known_.forecast = others.forecast;
  known_.family_speed = others.family_speed;
  learning::TrainingTable table = with_input(others.joined(rows), size_across);
  const std::vector<int> label = passable_labels(table);
  const std::vector<double> asked = variables_of(table.variables, table.variable_count, variables_);
  if (known_.forecast) {
    std::vector<double> ridge(variables_ + 1, kRidgeOfVariables);
    ridge.push_back(kRidgeOfConstant);
    correction_ = learning::fit_logistic(with_variables(table, with_input(asked, variables_, size_across)), label,
                                         log_odds(*known_.forecast, asked), ridge);
  }
  table.variables = with_knowledge(others, std::move(table.variables), table.variable_count, variables_);
  table.variable_count = table.variables.size() / table.row_count();
  const learning::GaussianProcessSettings settings{.variances = false};
  plain_ = learning::fit_gaussian_process(table, label, settings, mean(asked));
  if (!SpeedShare::can_learn(table)) return;
  const SpeedShare share(table, family_shares(known_, asked, variables_));
  const learning::LogisticModel passes = passes_by_share(table, label, asked, share.of_rows());
  learning::GaussianProcessModel rest = learning::fit_gaussian_process(
      table, label, settings, graded_mean(passes, asked, share.of_rows()), plain_.search());
  graded_.emplace(Graded{share, passes, std::move(rest)});
}

std::vector<double> Teacher::seen(const std::vector<double>& points) const {
  const std::size_t width = variables_ + known_.own.size();
  return with_knowledge(known_, with_input(known_.at_own(points, variables_), width, size_across), width + 1,
                        variables_);
}

std::vector<double> Teacher::mean(const std::vector<double>& points) const {
  if (!known_.forecast) return {};
  std::vector<double> odds = log_odds(*known_.forecast, points);
  add(odds, log_odds(*correction_, with_input(points, variables_, size_across), variables_ + 1));
  return odds;
}

learning::LogisticModel Teacher::passes_by_share(const learning::TrainingTable& rows, const std::vector<int>& label,
                                                 const std::vector<double>& points,
                                                 const std::vector<double>& shares) const {
  constexpr double kRidge = 0.1;  // of a and b [nat]
  if (!known_.forecast) return learning::fit_logistic(with_variables(rows, shares), label, kRidge);
  std::vector<double> ridge(variables_ + 1, kRidgeOfVariables);
  ridge.insert(ridge.end(), {kRidgeOfShare, kRidgeOfConstant});
  return learning::fit_logistic(with_variables(rows, with_shares(points, variables_, shares)), label,
                                log_odds(*known_.forecast, points), ridge);
}

std::vector<double> Teacher::graded_mean(const learning::LogisticModel& passes, const std::vector<double>& points,
                                         const std::vector<double>& shares) const {
  if (!known_.forecast) return log_odds(passes, shares, 1);
  std::vector<double> odds = log_odds(*known_.forecast, points);
  add(odds, log_odds(passes, with_shares(points, variables_, shares), variables_ + 2));
  return odds;
}

std::vector<double> Teacher::operator()(const std::vector<double>& points) const {
  const std::vector<double> own = seen(points);
  if (!graded_) return plain_.most_probable(own, mean(points));
  const std::vector<double> share = graded_->share(own, family_shares(known_, points, variables_));
  std::vector<double> p = graded_->rest.most_probable(own, graded_mean(graded_->passes, points, share));
  const std::vector<double> q = plain_.most_probable(own, mean(points));
  for (std::size_t k = 0; k < p.size(); ++k) p[k] = (p[k] + q[k]) / 2;
  return p;
}

std::vector<double> process_baseline(const learning::TrainingTable& rows, const OtherTrials& others,
                                     const std::vector<double>& points) {
  const learning::TrainingTable table = others.joined(rows);
  const OtherTrials own{{}, others.empty() ? std::vector<double>() : others.own, {}};
  return learning::fit_gaussian_process(table, passable_labels(table))
      .probabilities(own.at_own(points, rows.variable_count));
}

std::shared_ptr<const learning::Teaching> teaching(TeacherShare share, std::vector<double> points,
                                                   std::vector<double> probability) {
  return std::make_shared<const learning::Teaching>(learning::Teaching{.weight = share.weight,
                                                                       .points = std::move(points),
                                                                       .probability = std::move(probability),
                                                                       .label = passable_outcomes(),
                                                                       .joint_share = share.joint_share});
}

std::shared_ptr<const learning::Teaching> teach_all(const learning::TrainingTable& table, const OtherTrials& others,
                                                    std::vector<double> points, TeacherShare share) {
  if (share.weight == 0) return nullptr;
  std::vector<double> probability = Teacher(table, others)(points);
  return teaching(share, std::move(points), std::move(probability));
}

}  // namespace gonogo::outcome
