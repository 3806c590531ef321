#include "learning/rbm/logistic.h"

#include <cmath>

#include "base/error.h"
#include "learning/rbm/tensors.h"

namespace gonogo::learning {
namespace {

void set_scaling(const TrainingTable& table, LogisticModel& model) {
  for (std::size_t v = 0; v < table.variable_count; ++v) {
    double sum = 0, square = 0, count = 0;
    for (std::size_t n = 0; n < table.row_count(); ++n) {
      const double x = table.row(n)[v];
      if (std::isnan(x)) continue;
      sum += x;
      count += 1;
    }
    const double mean = count > 0 ? sum / count : 0;
    for (std::size_t n = 0; n < table.row_count(); ++n) {
      const double x = table.row(n)[v];
      if (!std::isnan(x)) square += (x - mean) * (x - mean);
    }
    model.mean.push_back(mean);
    model.scale.push_back(square > 0 ? std::sqrt(square / count) : 1);
  }
}

double standardised(const LogisticModel& model, std::size_t v, double x) {
  return std::isnan(x) ? 0 : (x - model.mean[v]) / model.scale[v];
}

}  // namespace

double LogisticModel::operator()(std::span<const double> variables) const {
  double sum = weight.back();
  for (std::size_t v = 0; v < variables.size(); ++v) sum += weight[v] * standardised(*this, v, variables[v]);
  return 1 / (1 + std::exp(-sum));
}

LogisticModel fit_logistic(const TrainingTable& table, std::span<const int> label, double ridge) {
  GONOGO_ASSERT(label.size() == table.row_count());
  const OneTorchThread one_thread;
  LogisticModel model;
  set_scaling(table, model);
  const std::int64_t rows = std::int64_t(table.row_count()), columns = std::int64_t(table.variable_count) + 1;
  torch::Tensor x = torch::ones({rows, columns}, torch::kFloat64), y = torch::zeros({rows}, torch::kFloat64);
  auto cell = x.accessor<double, 2>();
  for (std::int64_t n = 0; n < rows; ++n) {
    for (std::int64_t v = 0; v + 1 < columns; ++v)
      cell[n][v] = standardised(model, std::size_t(v), table.row(std::size_t(n))[std::size_t(v)]);
    y[n] = label[std::size_t(n)];
  }
  const torch::Tensor row_weight = torch::tensor(table.weight, torch::kFloat64);
  torch::Tensor penalty = torch::full({columns}, ridge, torch::kFloat64);
  penalty[columns - 1] = 1e-9;  // keeps the system solvable when only one class occurs
  torch::Tensor w = torch::zeros({columns}, torch::kFloat64);
  for (int iteration = 0; iteration < 50; ++iteration) {
    const torch::Tensor p = torch::sigmoid(torch::matmul(x, w));
    const torch::Tensor gradient = torch::matmul(x.t(), row_weight * (p - y)) + penalty * w;
    const torch::Tensor curvature = torch::matmul(x.t() * (row_weight * p * (1 - p)), x) + torch::diag(penalty);
    const torch::Tensor step = torch::linalg_solve(curvature, gradient.unsqueeze(1)).squeeze(1).clamp(-5, 5);
    w = w - step;
    if (step.abs().max().item<double>() < 1e-10) break;
  }
  model.weight.assign(w.data_ptr<double>(), w.data_ptr<double>() + w.numel());
  return model;
}

std::vector<double> cross_validate_logistic(const TrainingTable& table, std::span<const int> label,
                                            const std::vector<std::size_t>& fold, std::size_t fold_count,
                                            double ridge) {
  std::vector<double> result(table.row_count());
  for (std::size_t f = 0; f < fold_count; ++f) {
    std::vector<std::size_t> training;
    std::vector<int> training_label;
    for (std::size_t n = 0; n < fold.size(); ++n) {
      if (fold[n] == f) continue;
      training.push_back(n);
      training_label.push_back(label[n]);
    }
    const LogisticModel model = fit_logistic(table.subset(training), training_label, ridge);
    for (std::size_t n = 0; n < fold.size(); ++n)
      if (fold[n] == f) result[n] = model(table.row(n));
  }
  return result;
}

}  // namespace gonogo::learning
