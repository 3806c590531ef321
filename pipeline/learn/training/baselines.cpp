#include "pipeline/learn/training/baselines.h"

namespace gonogo::learn {
namespace {

/// Share of ones, with half a trial of each kind added: never exactly 0 or 1.
double base_rate(std::span<const int> label, const std::vector<std::size_t>& fold, std::size_t without) {
  double ones = 0.5, count = 1;
  for (std::size_t n = 0; n < label.size(); ++n) {
    if (!fold.empty() && fold[n] == without) continue;
    ones += label[n];
    count += 1;
  }
  return ones / count;
}

}  // namespace

std::map<std::string, std::vector<double>> Baselines::forecasts(std::span<const double> points) const {
  std::map<std::string, std::vector<double>> result;
  const std::size_t width = logistic.mean.size(), count = points.size() / width;
  for (std::size_t n = 0; n < count; ++n) {
    const auto point = points.subspan(n * width, width);
    result["logistic_regression"].push_back(logistic(point));
    result["quadratic_logistic"].push_back(quadratic(point));
    result["neural_network"].push_back(network(point));
    result["base_rate"].push_back(base_rate);
  }
  result["gaussian_process"] = process.probabilities(points);
  return result;
}

Baselines fit_baselines(const learning::TrainingTable& table, std::span<const int> label) {
  return {.logistic = learning::fit_logistic(table, label),
          .quadratic = learning::fit_quadratic(table, label),
          .process = learning::fit_gaussian_process(table, label),
          .network = learning::fit_network(table, label),
          .base_rate = base_rate(label, {}, 0)};
}

std::map<std::string, std::vector<double>> cross_validate_baselines(const learning::TrainingTable& table,
                                                                    std::span<const int> label,
                                                                    const std::vector<std::size_t>& fold,
                                                                    std::size_t fold_count) {
  std::map<std::string, std::vector<double>> result;
  result["logistic_regression"] = learning::cross_validate_logistic(table, label, fold, fold_count);
  result["quadratic_logistic"] = learning::cross_validate_quadratic(table, label, fold, fold_count);
  result["neural_network"] = learning::cross_validate_network(table, label, fold, fold_count);
  for (std::size_t n = 0; n < fold.size(); ++n) result["base_rate"].push_back(base_rate(label, fold, fold[n]));
  return result;
}

}  // namespace gonogo::learn
