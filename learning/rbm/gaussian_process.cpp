#include "learning/rbm/gaussian_process.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/cancel.h"
#include "base/error.h"
#include "base/units.h"
#include "learning/rbm/laplace.h"

namespace gonogo::learning {
namespace {

constexpr std::uint64_t kSearchRows = 0x67707277;  // stream of random numbers
constexpr std::int64_t kBlock = 512;               // points whose variances are worked out together

/// Rows of a table as tensors.
struct LabelledInputs {
  torch::Tensor Z;  // [row x variable], standardised
  RowLikelihood likelihood;
};

torch::Tensor standardised_rows(const Standardisation& scaling, std::span<const double> points) {
  const std::size_t width = scaling.mean.size();
  torch::Tensor Z = torch::empty({std::int64_t(points.size() / width), std::int64_t(width)}, torch::kFloat64);
  double* cell = Z.data_ptr<double>();
  for (std::size_t k = 0; k < points.size(); ++k) cell[k] = scaling.standardised(k % width, points[k]);
  return Z;
}

RowLikelihood row_likelihood(std::span<const int> label, std::span<const double> weight) {
  std::vector<double> sign;
  for (int y : label) sign.push_back(y ? 1 : -1);
  return {torch::tensor(sign, torch::kFloat64),
          torch::tensor(std::vector<double>(weight.begin(), weight.end()), torch::kFloat64)};
}

LabelledInputs labelled(const TrainingTable& table, std::span<const int> label, const Standardisation& scaling) {
  return {standardised_rows(scaling, table.variables), row_likelihood(label, table.weight)};
}

/// At most `most` of the rows, in order.
LabelledInputs some_rows(const LabelledInputs& rows, std::size_t most, std::uint64_t seed) {
  const auto count = std::size_t(rows.Z.size(0));
  if (count <= most) return rows;
  std::vector<std::size_t> order = permutation(count, seed, kSearchRows);
  std::vector<std::int64_t> chosen(order.begin(), order.begin() + std::ptrdiff_t(most));
  std::sort(chosen.begin(), chosen.end());
  const torch::Tensor index = torch::tensor(chosen, torch::kInt64);
  return {rows.Z.index_select(0, index),
          {rows.likelihood.sign.index_select(0, index), rows.likelihood.weight.index_select(0, index)}};
}

/// Minus the log of evidence times prior, as LBFGS wants it: leaves its gradient in the parameter.
class Search {
 public:
  Search(const LabelledInputs& rows, const GaussianProcessSettings& settings)
      : rows_(rows), width_(settings.prior_width) {
    std::vector<double> centre(std::size_t(rows.Z.size(1)), std::log(settings.prior_length));
    centre.push_back(std::log(settings.prior_variance));
    centre_ = torch::tensor(centre, torch::kFloat64);
    logs_ = centre_.clone().set_requires_grad(true);
  }
  torch::Tensor& logs() { return logs_; }
  KernelLogs values() const { return KernelLogs(logs_.data_ptr<double>(), logs_.data_ptr<double>() + logs_.numel()); }
  torch::Tensor operator()() {
    stop_if_cancelled();
    const torch::NoGradGuard constants;
    const KernelLogs logs = values();
    const torch::Tensor K = kernel(rows_.Z, rows_.Z, logs);
    const Mode mode = find_mode(K, rows_.likelihood, mode_);
    mode_ = mode.f;
    const LaplaceEvidence evidence = evidence_at(rows_.Z, K, rows_.likelihood, mode, logs);
    const torch::Tensor off = (logs_.detach() - centre_) / width_;
    logs_.mutable_grad() = off / width_ - torch::tensor(evidence.gradient, torch::kFloat64);
    return torch::tensor(0.5 * off.square().sum().item<double>() - evidence.value, torch::kFloat64);
  }

 private:
  const LabelledInputs& rows_;
  double width_;
  torch::Tensor centre_, logs_, mode_;
};

KernelLogs searched(const LabelledInputs& rows, const GaussianProcessSettings& settings) {
  Search search(rows, settings);
  torch::optim::LBFGS optimizer(std::vector<torch::Tensor>{search.logs()},
                                torch::optim::LBFGSOptions(1)
                                    .max_iter(std::int64_t(settings.search_steps))
                                    .tolerance_grad(1e-2)
                                    .tolerance_change(1e-2)
                                    .line_search_fn("strong_wolfe"));
  optimizer.step([&] { return search(); });
  return search.values();
}

/// Mean of sigmoid(f) for a normal f: 20-point Gauss-Hermite quadrature on the nodes of exp(-t^2).
double mean_sigmoid(const Latent& f) {
  constexpr std::array<double, 10> kNode = {
      0.24534070830090124, 0.7374737285453944, 1.2340762153953231, 1.7385377121165861, 2.2549740020892757,
      2.7888060584281305,  3.3478545673832163, 3.9447640401156252, 4.6036824495507442, 5.3874808900112328};
  constexpr std::array<double, 10> kWeight = {0.4622436696006101,    0.28667550536283415,   0.10901720602002329,
                                              0.024810520887463643,  0.0032437733422378566, 0.00022833863601635308,
                                              7.8025564785320636e-6, 1.0860693707692822e-7, 4.3993409922731809e-10,
                                              2.2293936455341515e-13};
  const double scale = std::sqrt(2 * f.variance);
  double sum = 0;
  for (std::size_t k = 0; k < kNode.size(); ++k)
    sum +=
        kWeight[k] * (1 / (1 + std::exp(-f.mean - scale * kNode[k])) + 1 / (1 + std::exp(-f.mean + scale * kNode[k])));
  return sum / std::sqrt(kPi);
}

}  // namespace

struct GaussianProcessModel::Rows {
  torch::Tensor Z, slope, root, lower;  // Mode, and the slope of the log likelihood there
};

LaplaceEvidence laplace_evidence(std::span<const double> inputs, std::span<const int> label,
                                 std::span<const double> weight, const KernelLogs& logs) {
  GONOGO_ASSERT(inputs.size() == label.size() * (logs.size() - 1) && weight.size() == label.size());
  const OneTorchThread one_thread;
  const torch::Tensor Z = torch::tensor(std::vector<double>(inputs.begin(), inputs.end()), torch::kFloat64)
                              .reshape({std::int64_t(label.size()), std::int64_t(logs.size()) - 1});
  const RowLikelihood likelihood = row_likelihood(label, weight);
  const torch::Tensor K = kernel(Z, Z, logs);
  return evidence_at(Z, K, likelihood, find_mode(K, likelihood, {}), logs);
}

GaussianProcessModel gaussian_process_with(const TrainingTable& table, std::span<const int> label,
                                           const KernelLogs& logs) {
  GONOGO_ASSERT(label.size() == table.row_count() && logs.size() == table.variable_count + 1);
  const OneTorchThread one_thread;
  GaussianProcessModel model;
  model.scaling_ = standardisation_of(table);
  model.logs_ = logs;
  const LabelledInputs rows = labelled(table, label, model.scaling_);
  const Mode mode = find_mode(kernel(rows.Z, rows.Z, logs), rows.likelihood, {});
  model.rows_ = std::make_shared<const GaussianProcessModel::Rows>(
      GaussianProcessModel::Rows{rows.Z, rows.likelihood.slope(mode.f), mode.root, mode.lower});
  return model;
}

GaussianProcessModel fit_gaussian_process(const TrainingTable& table, std::span<const int> label,
                                          const GaussianProcessSettings& settings) {
  GONOGO_ASSERT(label.size() == table.row_count());
  const OneTorchThread one_thread;
  const LabelledInputs rows =
      some_rows(labelled(table, label, standardisation_of(table)), settings.search_rows, settings.seed);
  return gaussian_process_with(table, label, searched(rows, settings));
}

std::vector<Latent> GaussianProcessModel::latent(std::span<const double> points) const {
  const OneTorchThread one_thread;
  const torch::Tensor all = standardised_rows(scaling_, points);
  const double prior = std::exp(logs_.back());
  std::vector<Latent> result;
  for (std::int64_t first = 0; first < all.size(0); first += kBlock) {
    stop_if_cancelled();
    const torch::Tensor k = kernel(rows_->Z, all.slice(0, first, std::min(first + kBlock, all.size(0))), logs_);
    const torch::Tensor mean = torch::mv(k.t(), rows_->slope);  // equation 3.21
    const torch::Tensor v = torch::linalg_solve_triangular(rows_->lower, k * rows_->root.unsqueeze(1), false);
    const torch::Tensor less = v.square().sum(0);
    for (std::int64_t i = 0; i < mean.size(0); ++i)
      result.push_back({mean[i].item<double>(), std::max(0.0, prior - less[i].item<double>())});  // equation 3.24
  }
  return result;
}

std::vector<double> GaussianProcessModel::probabilities(std::span<const double> points) const {
  std::vector<double> p;
  for (const Latent& f : latent(points)) p.push_back(mean_sigmoid(f));
  return p;
}

std::vector<double> GaussianProcessModel::most_probable(std::span<const double> points) const {
  const OneTorchThread one_thread;
  const torch::Tensor all = standardised_rows(scaling_, points);
  std::vector<double> p;
  for (std::int64_t first = 0; first < all.size(0); first += kBlock) {
    stop_if_cancelled();
    const torch::Tensor k = kernel(rows_->Z, all.slice(0, first, std::min(first + kBlock, all.size(0))), logs_);
    const torch::Tensor block = torch::sigmoid(torch::mv(k.t(), rows_->slope)).contiguous();
    p.insert(p.end(), block.data_ptr<double>(), block.data_ptr<double>() + block.numel());
  }
  return p;
}

double GaussianProcessModel::operator()(std::span<const double> variables) const { return probabilities(variables)[0]; }

}  // namespace gonogo::learning
