#include "learning/rbm/baselines.h"

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/math/random.h"
#include "learning/rbm/tensors.h"

namespace gonogo::learning {

Standardisation standardisation_of(const TrainingTable& table) {
  Standardisation result;
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
    result.mean.push_back(mean);
    result.scale.push_back(square > 0 ? std::sqrt(square / count) : 1);
  }
  return result;
}

double LogisticModel::log_odds(std::span<const double> variables) const {
  double sum = weight.back();
  for (std::size_t v = 0; v < variables.size(); ++v) sum += weight[v] * standardised(v, variables[v]);
  return sum;
}

double LogisticModel::operator()(std::span<const double> variables) const {
  return 1 / (1 + std::exp(-log_odds(variables)));
}

namespace {

/// Columns that are not zero throughout once they are standardised. The others have no weight, and products of many
/// variables that a table does not use would make the system large.
std::vector<std::size_t> varying_columns(const TrainingTable& table, const Standardisation& scaling) {
  std::vector<std::size_t> columns;
  for (std::size_t v = 0; v < table.variable_count; ++v)
    for (std::size_t n = 0; n < table.row_count(); ++n)
      if (scaling.standardised(v, table.row(n)[v]) != 0) {
        columns.push_back(v);
        break;
      }
  return columns;
}

}  // namespace

LogisticModel fit_logistic(const TrainingTable& table, std::span<const int> label, double ridge) {
  GONOGO_ASSERT(label.size() == table.row_count());
  const OneTorchThread one_thread;
  LogisticModel model;
  static_cast<Standardisation&>(model) = standardisation_of(table);
  const std::vector<std::size_t> varying = varying_columns(table, model);
  const std::int64_t rows = std::int64_t(table.row_count()), columns = std::int64_t(varying.size()) + 1;
  torch::Tensor x = torch::ones({rows, columns}, torch::kFloat64);
  const torch::Tensor y = torch::tensor(std::vector<double>(label.begin(), label.end()), torch::kFloat64);
  auto cell = x.accessor<double, 2>();
  for (std::int64_t n = 0; n < rows; ++n)
    for (std::size_t v = 0; v < varying.size(); ++v)
      cell[n][std::int64_t(v)] = model.standardised(varying[v], table.row(std::size_t(n))[varying[v]]);
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
  model.weight.assign(table.variable_count + 1, 0.0);
  for (std::size_t v = 0; v < varying.size(); ++v) model.weight[varying[v]] = w[std::int64_t(v)].item<double>();
  model.weight.back() = w[columns - 1].item<double>();
  return model;
}

namespace {

constexpr std::size_t kFolds = 5;
constexpr double kLeast = 1e-12;  // of a probability, so that one wrong certainty does not decide

/// z, then all products; NaN where a variable is unknown. Returns [variables + variables (variables + 1) / 2].
std::vector<double> terms_of(const Standardisation& scaling, std::span<const double> variables) {
  std::vector<double> terms;
  for (std::size_t v = 0; v < variables.size(); ++v)
    terms.push_back(std::isnan(variables[v]) ? NAN : scaling.standardised(v, variables[v]));
  for (std::size_t a = 0; a < variables.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b) terms.push_back(terms[a] * terms[b]);
  return terms;
}

TrainingTable table_of_terms(const TrainingTable& table, const Standardisation& scaling) {
  TrainingTable result;
  result.variable_count = table.variable_count + table.variable_count * (table.variable_count + 1) / 2;
  result.outcome = table.outcome;
  result.weight = table.weight;
  result.group = table.group;
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    const std::vector<double> terms = terms_of(scaling, table.row(n));
    result.variables.insert(result.variables.end(), terms.begin(), terms.end());
  }
  return result;
}

/// Sum over rows of -w log P(label), each by a model without the row's fold.
double held_out_loss(const TrainingTable& terms, std::span<const int> label, const std::vector<std::size_t>& fold,
                     std::size_t folds, double ridge) {
  const std::vector<double> p = out_of_fold(
      terms, label, fold, folds,
      [&](const TrainingTable& rows, std::span<const int> labels) { return fit_logistic(rows, labels, ridge); });
  double loss = 0;
  for (std::size_t n = 0; n < p.size(); ++n)
    loss -= terms.weight[n] * std::log(std::max(kLeast, label[n] ? p[n] : 1 - p[n]));
  return loss;
}

double chosen_ridge(const TrainingTable& terms, std::span<const int> label, std::uint64_t seed) {
  const std::size_t groups = std::set<std::uint64_t>(terms.group.begin(), terms.group.end()).size();
  const std::size_t folds = std::min(kFolds, groups);
  if (folds < 2) return 1;  // one group: nothing to hold out
  const std::vector<std::size_t> fold = assign_folds(terms, folds, seed);
  double best = 0, least = INFINITY;
  for (int half_decade = -5; half_decade <= 3; ++half_decade) {
    const double ridge = std::pow(10, 0.5 * half_decade);
    const double loss = held_out_loss(terms, label, fold, folds, ridge);
    if (loss < least) {
      least = loss;
      best = ridge;
    }
  }
  return best;
}

}  // namespace

double QuadraticModel::operator()(std::span<const double> variables) const {
  return std::clamp(of_terms(terms_of(*this, variables)), kLeast, 1 - kLeast);
}

QuadraticModel fit_quadratic(const TrainingTable& table, std::span<const int> label, std::uint64_t seed) {
  QuadraticModel model;
  static_cast<Standardisation&>(model) = standardisation_of(table);
  const TrainingTable terms = table_of_terms(table, model);
  model.ridge = chosen_ridge(terms, label, seed);
  model.of_terms = fit_logistic(terms, label, model.ridge);
  return model;
}

namespace {

struct LabelledRows {
  torch::Tensor inputs, label, weight;  // [row x variable], [row], [row]
};

LabelledRows tensors_of(const TrainingTable& table, std::span<const int> label, const Standardisation& scaling,
                        const std::vector<std::size_t>& rows) {
  LabelledRows result;
  result.inputs = torch::empty({std::int64_t(rows.size()), std::int64_t(table.variable_count)}, torch::kFloat64);
  double* cell = result.inputs.data_ptr<double>();
  std::vector<double> labels, weights;
  for (std::size_t n : rows) {
    for (std::size_t v = 0; v < table.variable_count; ++v) *cell++ = scaling.standardised(v, table.row(n)[v]);
    labels.push_back(label[n]);
    weights.push_back(table.weight[n]);
  }
  result.label = torch::tensor(labels, torch::kFloat64);
  result.weight = torch::tensor(weights, torch::kFloat64);
  return result;
}

/// Standard normal draws over the root of `inputs`, as a parameter.
torch::Tensor initial(std::vector<std::int64_t> shape, double inputs, std::uint64_t seed, std::uint64_t stream) {
  torch::Tensor result = torch::empty(shape, torch::kFloat64);
  double* value = result.data_ptr<double>();
  for (std::int64_t k = 0; k < result.numel(); ++k) value[k] = random_normal(seed, stream, std::uint64_t(k), inputs);
  return result.set_requires_grad(true);
}

struct Network {
  torch::Tensor A, B, w, c;
  Network(std::int64_t variables, const NetworkSettings& settings)
      : A(initial({std::int64_t(settings.hidden), variables}, double(variables), settings.seed, 1)),
        B(torch::zeros({std::int64_t(settings.hidden)}, torch::kFloat64).set_requires_grad(true)),
        w(initial({std::int64_t(settings.hidden)}, double(settings.hidden), settings.seed, 2)),
        c(torch::zeros({1}, torch::kFloat64).set_requires_grad(true)) {}
  torch::Tensor logit(const torch::Tensor& x) const {
    return torch::matmul(torch::tanh(torch::matmul(x, A.t()) + B), w) + c;
  }
  /// Mean of -w log P(label).
  torch::Tensor loss(const LabelledRows& rows) const {
    const torch::Tensor z = logit(rows.inputs);
    return (rows.weight * (torch::softplus(z) - rows.label * z)).mean();
  }
};

/// Trains for `epochs`; look(epoch, network) after each.
template <class Look>
Network trained(const LabelledRows& rows, const NetworkSettings& settings, std::size_t epochs, Look look) {
  Network network(rows.inputs.size(1), settings);
  torch::optim::Adam adam(std::vector<torch::Tensor>{network.A, network.B, network.w, network.c},
                          torch::optim::AdamOptions(settings.learning_rate));
  const double decay = settings.weight_decay / (2 * double(rows.inputs.size(0)));
  for (std::size_t epoch = 1; epoch <= epochs; ++epoch) {
    adam.zero_grad();
    (network.loss(rows) + decay * (network.A.square().sum() + network.w.square().sum())).backward();
    adam.step();
    look(epoch, network);
  }
  return network;
}

/// The number of epochs with the least loss on a fifth of the groups; all of them for a single group.
std::size_t best_epoch(const TrainingTable& table, std::span<const int> label, const Standardisation& scaling,
                       const NetworkSettings& settings) {
  const std::vector<std::size_t> fold = assign_folds(table, 5, settings.seed);
  std::vector<std::size_t> fit, check;
  for (std::size_t n = 0; n < fold.size(); ++n) (fold[n] == 0 ? check : fit).push_back(n);
  if (fit.empty() || check.empty()) return settings.max_epochs;
  const LabelledRows held_out = tensors_of(table, label, scaling, check);
  double lowest = INFINITY;
  std::size_t best = 1;
  trained(tensors_of(table, label, scaling, fit), settings, settings.max_epochs,
          [&](std::size_t epoch, const Network& network) {
            if (epoch % 5 != 0) return;
            const torch::NoGradGuard constants;
            const double loss = network.loss(held_out).item<double>();
            if (loss < lowest) {
              lowest = loss;
              best = epoch;
            }
          });
  return best;
}

}  // namespace

double NetworkModel::operator()(std::span<const double> variables) const {
  double sum = output_weight.back();
  for (std::size_t j = 0; j < hidden; ++j) {
    double field = input_bias[j];
    for (std::size_t v = 0; v < variables.size(); ++v)
      field += input_weight[j * variables.size() + v] * standardised(v, variables[v]);
    sum += output_weight[j] * std::tanh(field);
  }
  return 1 / (1 + std::exp(-sum));
}

NetworkModel fit_network(const TrainingTable& table, std::span<const int> label, const NetworkSettings& settings) {
  GONOGO_ASSERT(label.size() == table.row_count());
  const OneTorchThread one_thread;
  NetworkModel model;
  static_cast<Standardisation&>(model) = standardisation_of(table);
  model.hidden = settings.hidden;
  model.epochs = best_epoch(table, label, model, settings);
  const Network network = trained(tensors_of(table, label, model, permutation(table.row_count(), settings.seed, 3)),
                                  settings, model.epochs, [](std::size_t, const Network&) {});
  model.input_weight = values_of(network.A);
  model.input_bias = values_of(network.B);
  model.output_weight = values_of(network.w);
  model.output_weight.push_back(network.c.item<double>());
  return model;
}

}  // namespace gonogo::learning
