#include "learning/rbm/network.h"

#include <algorithm>

#include "base/error.h"
#include "base/normal.h"
#include "learning/rbm/tensors.h"

namespace gonogo::learning {
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

std::vector<double> values_of(const torch::Tensor& tensor) {
  const torch::Tensor flat = tensor.detach().contiguous();
  return std::vector<double>(flat.data_ptr<double>(), flat.data_ptr<double>() + flat.numel());
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

std::vector<double> cross_validate_network(const TrainingTable& table, std::span<const int> label,
                                           const std::vector<std::size_t>& fold, std::size_t fold_count,
                                           const NetworkSettings& settings) {
  return out_of_fold(table, label, fold, fold_count, [&](const TrainingTable& rows, std::span<const int> labels) {
    return fit_network(rows, labels, settings);
  });
}

}  // namespace gonogo::learning
