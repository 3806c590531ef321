#include "learning/rbm/logistic.h"

#include <cmath>

#include "base/error.h"
#include "learning/rbm/tensors.h"

namespace gonogo::learning {
double LogisticModel::operator()(std::span<const double> variables) const {
  double sum = weight.back();
  for (std::size_t v = 0; v < variables.size(); ++v) sum += weight[v] * standardised(v, variables[v]);
  return 1 / (1 + std::exp(-sum));
}

LogisticModel fit_logistic(const TrainingTable& table, std::span<const int> label, double ridge) {
  GONOGO_ASSERT(label.size() == table.row_count());
  const OneTorchThread one_thread;
  LogisticModel model;
  static_cast<Standardisation&>(model) = standardisation_of(table);
  const std::int64_t rows = std::int64_t(table.row_count()), columns = std::int64_t(table.variable_count) + 1;
  torch::Tensor x = torch::ones({rows, columns}, torch::kFloat64), y = torch::zeros({rows}, torch::kFloat64);
  auto cell = x.accessor<double, 2>();
  for (std::int64_t n = 0; n < rows; ++n) {
    for (std::int64_t v = 0; v + 1 < columns; ++v)
      cell[n][v] = model.standardised(std::size_t(v), table.row(std::size_t(n))[std::size_t(v)]);
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
  return out_of_fold(table, label, fold, fold_count, [&](const TrainingTable& rows, std::span<const int> labels) {
    return fit_logistic(rows, labels, ridge);
  });
}

}  // namespace gonogo::learning
