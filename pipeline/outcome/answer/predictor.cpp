#include "pipeline/outcome/answer/predictor.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "base/parallel/host_loop.h"
#include "learning/model/posterior.h"
#include "learning/score/score.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/outcome/training_data.h"

namespace gonogo::outcome {
namespace {

bool knows(const learning::VisibleLayout& layout, const std::string& variable) {
  for (const learning::Encoder& encoder : layout.encoders())
    if (encoder.name() == variable) return true;
  return false;
}

/// Puts the variable at place `v`, where all trials have 0 of it.
void add_variable(learning::Model& model, const campaign::Variable& variable, std::size_t v) {
  const auto at = [v](auto& list) { return list.begin() + std::ptrdiff_t(v); };
  std::vector<learning::Encoder> encoders = model.layout.encoders();
  encoders.insert(at(encoders),
                  learning::Encoder::by_range(variable.name, variable.unit, learning::Code::thermometer, 1, 0, 0));
  const std::size_t before = model.layout.variable_count();
  model.layout = learning::VisibleLayout(std::move(encoders), model.layout.outcomes());
  model.sampled_lower.insert(at(model.sampled_lower), 0);
  model.sampled_upper.insert(at(model.sampled_upper), 0);
  if (!model.input_prior.empty()) model.input_prior.insert(at(model.input_prior), {1.0});
  std::vector<double> points;
  for (std::size_t n = 0; n < model.training_outcomes.size(); ++n) {
    const auto row = model.training_points.begin() + std::ptrdiff_t(n * before);
    points.insert(points.end(), row, row + std::ptrdiff_t(v));
    points.push_back(0);
    points.insert(points.end(), row + std::ptrdiff_t(v), row + std::ptrdiff_t(before));
  }
  model.training_points = std::move(points);
}

}  // namespace

learning::Model read_contract_model(const std::filesystem::path& file) {
  learning::Model model = learning::read_model(file);
  for (std::size_t v = 0; v < campaign::contract().variables.size(); ++v) {
    const campaign::Variable& variable = campaign::contract().variables[v];
    if (campaign::is_task_variable(variable) && v <= model.layout.variable_count() &&
        !knows(model.layout, variable.name))
      add_variable(model, variable, v);
  }
  check_contract(model, file.string());
  return model;
}

void check_contract(const learning::Model& model, const std::string& source) {
  bool same = model.layout.variable_count() == campaign::contract().variables.size() &&
              model.layout.outcome_count() == campaign::contract().outcomes.size();
  for (std::size_t v = 0; same && v < campaign::contract().variables.size(); ++v)
    same = model.layout.encoders()[v].name() == campaign::contract().variables[v].name;
  for (std::size_t y = 0; same && y < campaign::contract().outcomes.size(); ++y)
    same = model.layout.outcomes()[y] == campaign::contract().outcomes[y].name;
  if (!same)
    throw InputError(source +
                     ": was trained with other variables or outcomes than this program's contract; train again");
}

Predictor Predictor::read(const std::filesystem::path& model_file) {
  return Predictor(read_contract_model(model_file));
}

Predictor::Predictor(learning::Model model)
    : model_(std::make_shared<const learning::Model>(std::move(model))),
      posterior_(model_->layout, model_->weights, model_->input_prior),
      novelty_(*model_) {
  check_contract(*model_, "model");
  const std::vector<int> passable = passable_outcomes();
  go_weight_.assign(passable.begin(), passable.end());
}

std::vector<double> Predictor::outcome_probabilities(std::span<const double> variables) const {
  return marginal(variables).probability;
}

learning::PosteriorAnswer Predictor::marginal(std::span<const double> variables,
                                              const learning::MarginalOptions& options) const {
  if (variables.size() != model_->layout.variable_count())
    throw InputError("predictor: " + std::to_string(variables.size()) + " variables given, " +
                     std::to_string(model_->layout.variable_count()) + " needed");
  return calibrated(posterior_.marginal(variables, options));
}

learning::PosteriorAnswer Predictor::calibrated(learning::PosteriorAnswer answer) const {
  if (model_->calibration_power == 1) return answer;
  const std::vector<double> before = answer.probability;
  learning::sharpen(answer.probability, model_->calibration_power);
  for (std::size_t y = 0; y < before.size(); ++y) {  // first order, the other outcomes taken together
    const double q = answer.probability[y], spread = before[y] * (1 - before[y]);
    if (spread > 0) answer.standard_error[y] *= model_->calibration_power * q * (1 - q) / spread;
  }
  return answer;
}

learning::JointAnswer Predictor::reconstruct(std::span<const double> variables,
                                             std::optional<std::size_t> outcome) const {
  learning::JointAnswer answer = posterior_.joint(variables, outcome);
  if (!outcome) answer.outcome = calibrated(std::move(answer.outcome));
  return answer;
}

double Predictor::p_go(std::span<const double> variables) const { return p_go(variables, learning::MarginalOptions()); }

double Predictor::p_go(std::span<const double> variables, const learning::MarginalOptions& options) const {
  const std::vector<double> p = marginal(variables, options).probability;
  double sum = 0;
  for (std::size_t y = 0; y < p.size(); ++y) sum += go_weight_[y] * p[y];
  return sum;
}

namespace {

constexpr std::size_t kBlock = 256;  // points that a thread takes at a time

}  // namespace

template <class Store>
void Predictor::for_each_point(std::span<const double> points, Store store) const {
  const std::size_t width = model_->layout.variable_count(), count = points.size() / width;
  for_each_on_host((count + kBlock - 1) / kBlock, 1, [&](std::size_t block) {
    std::vector<double> p(go_weight_.size());
    for (std::size_t n = block * kBlock; n < std::min(count, (block + 1) * kBlock); ++n) {
      const auto point = points.subspan(n * width, width);
      if (needs_summation(point))
        p = posterior_.marginal(point).probability;
      else
        posterior_(point, p);
      if (model_->calibration_power != 1) learning::sharpen(p, model_->calibration_power);
      store(n, p);
    }
  });
}

bool Predictor::needs_summation(std::span<const double> point) const {
  for (std::size_t v = 0; v < point.size(); ++v)
    if (std::isnan(point[v]) && model_->layout.encoders()[v].unit_count() > 0) return true;
  return false;  // a variable that all trials held fixed has no units to sum over
}

void Predictor::p_go(std::span<const double> points, std::span<double> result) const {
  GONOGO_ASSERT(points.size() == result.size() * model_->layout.variable_count());
  for_each_point(points, [&](std::size_t n, const std::vector<double>& p) {
    double sum = 0;
    for (std::size_t y = 0; y < p.size(); ++y) sum += go_weight_[y] * p[y];
    result[n] = sum;
  });
}

void Predictor::outcome_probabilities(std::span<const double> points, std::span<double> result) const {
  GONOGO_ASSERT(points.size() * go_weight_.size() == result.size() * model_->layout.variable_count());
  for_each_point(points, [&](std::size_t n, const std::vector<double>& p) {
    std::copy(p.begin(), p.end(), result.begin() + std::ptrdiff_t(n * p.size()));
  });
}

void Predictor::on_slopes(std::span<const double> points, std::span<const double> along, std::span<const double> across,
                          std::span<double> result, const SlopeSums& sums) const {
  const std::size_t width = model_->layout.variable_count(), count = points.size() / width;
  const std::size_t outcomes = go_weight_.size(), answers = along.size() * across.size() * outcomes;
  GONOGO_ASSERT(result.size() == count * answers);
  const std::size_t v_along = campaign::contract().variable_index("slope_along"),
                    v_across = campaign::contract().variable_index("slope_across");
  learning::VariableGrid grid{v_along, v_across, along, across};
  if (across.size() == 1) grid = {v_across, v_along, across, along};  // the second variable is computed side by side
  const learning::PreparedGrid prepared = posterior_.prepared(grid);
  const auto answer = [&](std::size_t n, std::span<double> own) {
    posterior_.on_prepared(points.subspan(n * width, width), prepared, own);
    if (model_->calibration_power == 1) return;
    for (std::size_t i = 0; i < answers; i += outcomes)
      learning::sharpen(own.subspan(i, outcomes), model_->calibration_power);
  };
  std::vector<std::size_t> known;
  for (std::size_t n = 0; n < count; ++n) {
    std::vector<double> point(points.begin() + std::ptrdiff_t(n * width),
                              points.begin() + std::ptrdiff_t((n + 1) * width));
    point[v_along] = point[v_across] = 0;
    const std::span<double> own = result.subspan(n * answers, answers);
    if (!needs_summation(point))
      known.push_back(n);
    else if (sums)
      sums(point, own, [&](std::span<double> fresh) { answer(n, fresh); });
    else
      answer(n, own);  // on all threads by itself
  }
  for_each_on_host(known.size(), 1,
                   [&](std::size_t k) { answer(known[k], result.subspan(known[k] * answers, answers)); });
}

void Predictor::novelty_uphill(std::span<const double> variables, std::span<const double> slopes,
                               std::span<double> result) const {
  std::vector<double> point(variables.begin(), variables.end());
  point[campaign::contract().variable_index("slope_across")] = 0;
  novelty_.along(point, campaign::contract().variable_index("slope_along"), slopes, result);
}

std::string Predictor::outside_variable(std::span<const double> variables) const {
  for (std::size_t v = 0; v < variables.size(); ++v) {
    const double low = model_->sampled_lower[v], high = model_->sampled_upper[v];
    const double slack = 1e-9 * std::max({std::abs(low), std::abs(high), high - low});
    if (variables[v] < low - slack || variables[v] > high + slack) return model_->layout.encoders()[v].name();
  }
  return "";
}

bool Predictor::inside_sampled_box(std::span<const double> variables) const {
  return outside_variable(variables).empty();
}

}  // namespace gonogo::outcome
