#include "learning/rbm/gaussian_process.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "base/progress.h"
#include "base/units.h"
#include "learning/rbm/tensors.h"

namespace gonogo::learning {
namespace {

constexpr std::uint64_t kSearchRows = 0x67707277;  // stream of random numbers
constexpr std::int64_t kBlock = 512;               // points whose variances are worked out together
constexpr int kNewtonSteps = 100;
constexpr double kEnough = 1e-9;  // relative change of the log posterior that ends Newton's method

// Laplace's approximation of the posterior. Equations: Rasmussen & Williams (2006), chapters 3 and 5.

/// The rows' log likelihood sum_n w_n log sigmoid(y_n f_n) at f, with its derivatives, y of {-1, 1}.
struct RowLikelihood {
  torch::Tensor sign, weight;  // y, w [row]
  double value(const torch::Tensor& f) const;
  torch::Tensor slope(const torch::Tensor& f) const;      // d / df
  torch::Tensor curvature(const torch::Tensor& f) const;  // W = -d2 / df2, > 0
  torch::Tensor third(const torch::Tensor& f) const;      // d3 / df3
};

/// The mode of the posterior: f = m + K a, with root = W^1/2 and lower = the Cholesky factor of B = I + W^1/2 K W^1/2.
struct Mode {
  torch::Tensor f{}, a{}, root{}, lower{};
  double log_posterior = 0;  // -1/2 a.(f - m) + log likelihood
};

/// A number per variable from the first numbers of `logs`: 1 / l_v.
torch::Tensor inverse_lengths(const KernelLogs& logs) {
  std::vector<double> inverse;
  for (std::size_t v = 0; v + 1 < logs.size(); ++v) inverse.push_back(std::exp(-logs[v]));
  return torch::tensor(inverse, torch::kFloat64);
}

double scalar_product(const torch::Tensor& a, const torch::Tensor& b) { return torch::dot(a, b).item<double>(); }

/// B^-1 of a vector, by the Cholesky factor of B.
torch::Tensor solve(const torch::Tensor& lower, const torch::Tensor& b) {
  return torch::cholesky_solve(b.unsqueeze(1), lower).squeeze(1);
}

void factorise(const torch::Tensor& K, const torch::Tensor& curvature, Mode& mode) {
  mode.root = curvature.sqrt();
  torch::Tensor B = K * mode.root.unsqueeze(0);
  B.mul_(mode.root.unsqueeze(1)).diagonal().add_(1);
  mode.lower = torch::linalg_cholesky(B);
}

/// m: the mean of f.
double log_posterior(const RowLikelihood& likelihood, const torch::Tensor& a, const torch::Tensor& f,
                     const torch::Tensor& m) {
  return likelihood.value(f) - 0.5 * scalar_product(a, f - m);
}

/// k of every row of a with every row of b. a: [n x variable], b: [m x variable]; result [n x m].
torch::Tensor kernel(const torch::Tensor& a, const torch::Tensor& b, const KernelLogs& logs) {
  const torch::Tensor inverse = inverse_lengths(logs);
  torch::Tensor square = torch::zeros({a.size(0), b.size(0)}, torch::kFloat64);
  for (std::int64_t v = 0; v < a.size(1); ++v) {
    const torch::Tensor difference =
        a.select(1, v).mul(inverse[v]).unsqueeze(1) - b.select(1, v).mul(inverse[v]).unsqueeze(0);
    square.addcmul_(difference, difference);
  }
  return square.mul_(-0.5).add_(logs.back()).exp_();
}

double RowLikelihood::value(const torch::Tensor& f) const {
  return -scalar_product(weight, torch::softplus(-sign * f));
}
torch::Tensor RowLikelihood::slope(const torch::Tensor& f) const { return weight * sign * torch::sigmoid(-sign * f); }
torch::Tensor RowLikelihood::curvature(const torch::Tensor& f) const {
  return weight * torch::sigmoid(f) * torch::sigmoid(-f);
}
torch::Tensor RowLikelihood::third(const torch::Tensor& f) const {
  return curvature(f) * (torch::sigmoid(f) - torch::sigmoid(-f));
}

/// Newton's method (algorithm 3.1) from `start` [row], or from the mean m [row] if that is undefined. A step that
/// lowers the posterior is halved.
Mode find_mode(const torch::Tensor& K, const RowLikelihood& likelihood, const torch::Tensor& m,
               const torch::Tensor& start) {
  Mode mode{.f = start.defined() ? start : m, .log_posterior = -INFINITY};
  for (int step = 0; step < kNewtonSteps; ++step) {
    const torch::Tensor W = likelihood.curvature(mode.f);
    factorise(K, W, mode);
    const torch::Tensor b = W * (mode.f - m) + likelihood.slope(mode.f);
    torch::Tensor a = b - mode.root * solve(mode.lower, mode.root * torch::mv(K, b));
    torch::Tensor f = m + torch::mv(K, a);
    double now = log_posterior(likelihood, a, f, m);
    for (int half = 0; half < 30 && mode.a.defined() && now < mode.log_posterior; ++half) {
      a = 0.5 * (a + mode.a);
      f = 0.5 * (f + mode.f);
      now = log_posterior(likelihood, a, f, m);
    }
    const bool done = std::abs(now - mode.log_posterior) <= kEnough * (1 + std::abs(now));
    mode.a = a;
    mode.f = f;
    mode.log_posterior = now;
    if (done) break;
  }
  factorise(K, likelihood.curvature(mode.f), mode);
  return mode;
}

/// sum_ab M_ab dK_ab / d log l_v of every variable, for Q = M K by elements: dK / d log l = K (z - z')^2 / l^2.
std::vector<double> length_slopes(const torch::Tensor& Z, const torch::Tensor& Q, const std::vector<double>& logs) {
  const torch::Tensor both = Q.sum(0) + Q.sum(1);
  std::vector<double> slopes;
  for (std::int64_t j = 0; j < Z.size(1); ++j) {
    const torch::Tensor z = Z.select(1, j).contiguous();
    const double apart = scalar_product(z.square(), both) - 2 * scalar_product(z, torch::mv(Q, z));
    slopes.push_back(apart * std::exp(-2 * logs[std::size_t(j)]));
  }
  return slopes;
}

/// Evidence and gradient at a mode (equation 3.32 and algorithm 5.1). Z: [row x variable].
LaplaceEvidence evidence_at(const torch::Tensor& Z, const torch::Tensor& K, const RowLikelihood& likelihood,
                            const Mode& mode, const KernelLogs& logs) {
  LaplaceEvidence evidence;
  evidence.value = mode.log_posterior - mode.lower.diagonal().log().sum().item<double>();
  const torch::Tensor inverse = torch::cholesky_inverse(mode.lower);  // of B
  // (K^-1 + W)^-1 = W^-1/2 (I - B^-1) W^-1/2: its diagonal without another system of equations.
  const torch::Tensor variance = (1 - inverse.diagonal()) / mode.root.square().clamp_min(1e-12);
  const torch::Tensor R = inverse.mul_(mode.root.unsqueeze(0)).mul_(mode.root.unsqueeze(1));
  const torch::Tensor s2 = 0.5 * variance * likelihood.third(mode.f);
  // Every derivative is sum_ab M_ab dK_ab: s1 and s2' s3 of algorithm 5.1 are linear in dK.
  const torch::Tensor v = s2 - torch::mv(R, torch::mv(K, s2));
  torch::Tensor M = torch::outer(v, likelihood.slope(mode.f));
  M.add_(torch::outer(mode.a, mode.a), 0.5).sub_(R, 0.5);
  const torch::Tensor Q = M.mul_(K);
  evidence.gradient = length_slopes(Z, Q, logs);
  evidence.gradient.push_back(Q.sum().item<double>());
  return evidence;
}

// The process on a table.

/// Rows of a table as tensors.
struct LabelledInputs {
  torch::Tensor Z;  // [row x variable], standardised
  RowLikelihood likelihood;
  torch::Tensor mean;  // of f [row]
};

torch::Tensor column(std::span<const double> values) {
  return torch::tensor(std::vector<double>(values.begin(), values.end()), torch::kFloat64);
}

/// `mean`, or 0 of every row.
torch::Tensor mean_or_zero(std::span<const double> mean, std::size_t rows) {
  GONOGO_ASSERT(mean.empty() || mean.size() == rows);
  return mean.empty() ? torch::zeros({std::int64_t(rows)}, torch::kFloat64) : column(mean);
}

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
  return {torch::tensor(sign, torch::kFloat64), column(weight)};
}

LabelledInputs labelled(const TrainingTable& table, std::span<const int> label, const Standardisation& scaling,
                        std::span<const double> mean) {
  return {standardised_rows(scaling, table.variables), row_likelihood(label, table.weight),
          mean_or_zero(mean, table.row_count())};
}

/// At most `most` of `count` rows, ascending.
torch::Tensor some_of(std::size_t count, std::size_t most, std::uint64_t seed) {
  if (count <= most) return torch::arange(std::int64_t(count), torch::kInt64);
  std::vector<std::size_t> order = permutation(count, seed, kSearchRows);
  std::vector<std::int64_t> chosen(order.begin(), order.begin() + std::ptrdiff_t(most));
  std::sort(chosen.begin(), chosen.end());
  return torch::tensor(chosen, torch::kInt64);
}

LabelledInputs some_rows(const LabelledInputs& rows, std::size_t most, std::uint64_t seed) {
  const torch::Tensor index = some_of(std::size_t(rows.Z.size(0)), most, seed);
  return {rows.Z.index_select(0, index),
          {rows.likelihood.sign.index_select(0, index), rows.likelihood.weight.index_select(0, index)},
          rows.mean.index_select(0, index)};
}

/// Evidence and its gradient at the logs of a kernel.
using EvidenceOf = std::function<LaplaceEvidence(const std::vector<double>& logs)>;

/// The logs that maximise evidence times a normal prior of this width around `centre`.
std::vector<double> searched(const std::vector<double>& centre, double width, std::size_t steps,
                             const EvidenceOf& evidence_of) {
  const torch::Tensor middle = torch::tensor(centre, torch::kFloat64);
  torch::Tensor logs = middle.clone().set_requires_grad(true);
  const auto values = [&] {
    return std::vector<double>(logs.data_ptr<double>(), logs.data_ptr<double>() + logs.numel());
  };
  torch::optim::LBFGS optimizer(std::vector<torch::Tensor>{logs}, torch::optim::LBFGSOptions(1)
                                                                      .max_iter(std::int64_t(steps))
                                                                      .tolerance_grad(1e-2)
                                                                      .tolerance_change(1e-2)
                                                                      .line_search_fn("strong_wolfe"));
  optimizer.step([&] {
    stop_if_cancelled();
    const torch::NoGradGuard constants;
    const LaplaceEvidence evidence = evidence_of(values());
    const torch::Tensor off = (logs.detach() - middle) / width;
    logs.mutable_grad() = off / width - torch::tensor(evidence.gradient, torch::kFloat64);
    return torch::tensor(0.5 * off.square().sum().item<double>() - evidence.value, torch::kFloat64);
  });
  return values();
}

KernelLogs searched(const LabelledInputs& rows, const GaussianProcessSettings& settings) {
  KernelLogs centre(std::size_t(rows.Z.size(1)), std::log(settings.prior_length));
  centre.push_back(std::log(settings.prior_variance));
  torch::Tensor start;
  return searched(centre, settings.prior_width, settings.search_steps, [&](const KernelLogs& logs) {
    const torch::Tensor K = kernel(rows.Z, rows.Z, logs);
    const Mode mode = find_mode(K, rows.likelihood, rows.mean, start);
    start = mode.f;
    return evidence_at(rows.Z, K, rows.likelihood, mode, logs);
  });
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
  return evidence_at(Z, K, likelihood, find_mode(K, likelihood, mean_or_zero({}, label.size()), {}), logs);
}

GaussianProcessModel gaussian_process_with(const TrainingTable& table, std::span<const int> label,
                                           const KernelLogs& logs, std::span<const double> mean) {
  GONOGO_ASSERT(label.size() == table.row_count() && logs.size() == table.variable_count + 1);
  const OneTorchThread one_thread;
  GaussianProcessModel model;
  model.scaling_ = standardisation_of(table);
  model.logs_ = logs;
  const LabelledInputs rows = labelled(table, label, model.scaling_, mean);
  const Mode mode = find_mode(kernel(rows.Z, rows.Z, logs), rows.likelihood, rows.mean, {});
  model.rows_ = std::make_shared<const GaussianProcessModel::Rows>(
      GaussianProcessModel::Rows{rows.Z, rows.likelihood.slope(mode.f), mode.root, mode.lower});
  return model;
}

GaussianProcessModel fit_gaussian_process(const TrainingTable& table, std::span<const int> label,
                                          const GaussianProcessSettings& settings, std::span<const double> mean) {
  GONOGO_ASSERT(label.size() == table.row_count());
  const OneTorchThread one_thread;
  const LabelledInputs rows =
      some_rows(labelled(table, label, standardisation_of(table), mean), settings.search_rows, settings.seed);
  return gaussian_process_with(table, label, searched(rows, settings), mean);
}

std::vector<Latent> GaussianProcessModel::latent(std::span<const double> points, std::span<const double> mean) const {
  const OneTorchThread one_thread;
  const torch::Tensor all = standardised_rows(scaling_, points), m = mean_or_zero(mean, std::size_t(all.size(0)));
  const double prior = std::exp(logs_.back());
  std::vector<Latent> result;
  for (std::int64_t first = 0; first < all.size(0); first += kBlock) {
    stop_if_cancelled();
    const std::int64_t last = std::min(first + kBlock, all.size(0));
    const torch::Tensor k = kernel(rows_->Z, all.slice(0, first, last), logs_);
    const torch::Tensor f = m.slice(0, first, last) + torch::mv(k.t(), rows_->slope);  // equation 3.21
    const torch::Tensor v = torch::linalg_solve_triangular(rows_->lower, k * rows_->root.unsqueeze(1), false);
    const torch::Tensor less = v.square().sum(0);
    for (std::int64_t i = 0; i < f.size(0); ++i)
      result.push_back({f[i].item<double>(), std::max(0.0, prior - less[i].item<double>())});  // equation 3.24
  }
  return result;
}

std::vector<double> GaussianProcessModel::probabilities(std::span<const double> points,
                                                        std::span<const double> mean) const {
  std::vector<double> p;
  for (const Latent& f : latent(points, mean)) p.push_back(mean_sigmoid(f));
  return p;
}

std::vector<double> GaussianProcessModel::most_probable(std::span<const double> points,
                                                        std::span<const double> mean) const {
  const OneTorchThread one_thread;
  const torch::Tensor all = standardised_rows(scaling_, points), m = mean_or_zero(mean, std::size_t(all.size(0)));
  std::vector<double> p;
  for (std::int64_t first = 0; first < all.size(0); first += kBlock) {
    stop_if_cancelled();
    const std::int64_t last = std::min(first + kBlock, all.size(0));
    const torch::Tensor k = kernel(rows_->Z, all.slice(0, first, last), logs_);
    const torch::Tensor block = torch::sigmoid(m.slice(0, first, last) + torch::mv(k.t(), rows_->slope)).contiguous();
    p.insert(p.end(), block.data_ptr<double>(), block.data_ptr<double>() + block.numel());
  }
  return p;
}

double GaussianProcessModel::operator()(std::span<const double> variables) const { return probabilities(variables)[0]; }

// Regression.

struct GaussianRegression::Rows {
  torch::Tensor Z, slope;  // [row x variable]; (K + noise)^-1 t [row]
};

namespace {

constexpr double kJitter = 1e-8;  // least share of noise in a standardised target

/// k + c (1 + z z'). logs: as GaussianRegression::logs().
torch::Tensor trend_kernel(const torch::Tensor& a, const torch::Tensor& b, const std::vector<double>& logs) {
  const KernelLogs smooth(logs.begin(), logs.end() - 2);
  return kernel(a, b, smooth).add_(torch::matmul(a, b.t()).add_(1), std::exp(logs[logs.size() - 2]));
}

/// Variance of every row's noise, for unit weights 1 / w.
torch::Tensor noise(const torch::Tensor& inverse_weight, const std::vector<double>& logs) {
  return inverse_weight * std::exp(logs.back()) + kJitter;
}

/// Equation 2.30 and its gradient (5.9). t: standardised targets.
LaplaceEvidence regression_evidence(const torch::Tensor& Z, const torch::Tensor& t, const torch::Tensor& inverse_weight,
                                    const std::vector<double>& logs) {
  const KernelLogs smooth(logs.begin(), logs.end() - 2);
  const torch::Tensor K = kernel(Z, Z, smooth), linear = torch::matmul(Z, Z.t()).add_(1);
  torch::Tensor all = torch::add(K, linear, std::exp(logs[logs.size() - 2]));
  all.diagonal().add_(noise(inverse_weight, logs));
  const torch::Tensor lower = torch::linalg_cholesky(all), inverse = torch::cholesky_inverse(lower);
  const torch::Tensor a = torch::mv(inverse, t);
  LaplaceEvidence evidence;
  evidence.value = -0.5 * scalar_product(t, a) - lower.diagonal().log().sum().item<double>();
  const torch::Tensor M = 0.5 * (torch::outer(a, a) - inverse);
  const torch::Tensor Q = M * K;
  evidence.gradient = length_slopes(Z, Q, logs);
  evidence.gradient.push_back(Q.sum().item<double>());
  evidence.gradient.push_back((M * linear).sum().item<double>() * std::exp(logs[logs.size() - 2]));
  evidence.gradient.push_back((M.diagonal() * inverse_weight).sum().item<double>() * std::exp(logs.back()));
  return evidence;
}

}  // namespace

GaussianRegression fit_gaussian_regression(const TrainingTable& table, std::span<const double> target,
                                           const GaussianProcessSettings& settings) {
  GONOGO_ASSERT(target.size() == table.row_count());
  const OneTorchThread one_thread;
  GaussianRegression model;
  model.scaling_ = standardisation_of(table);
  const torch::Tensor Z = standardised_rows(model.scaling_, table.variables);
  torch::Tensor t = column(target);
  model.mean_ = t.mean().item<double>();
  t -= model.mean_;
  model.scale_ = std::max(std::sqrt(t.square().mean().item<double>()), kJitter);
  t /= model.scale_;
  const torch::Tensor inverse_weight = 1 / column(table.weight);
  const torch::Tensor some = some_of(table.row_count(), settings.search_rows, settings.seed);
  const torch::Tensor some_Z = Z.index_select(0, some), some_t = t.index_select(0, some);
  const torch::Tensor some_weight = inverse_weight.index_select(0, some);
  std::vector<double> centre(table.variable_count, std::log(settings.prior_length));
  centre.insert(centre.end(), {0, std::log(0.1), std::log(0.1)});
  model.logs_ = searched(centre, settings.prior_width, settings.search_steps, [&](const std::vector<double>& logs) {
    return regression_evidence(some_Z, some_t, some_weight, logs);
  });
  torch::Tensor K = trend_kernel(Z, Z, model.logs_);
  K.diagonal().add_(noise(inverse_weight, model.logs_));
  const torch::Tensor inverse = torch::cholesky_inverse(torch::linalg_cholesky(K)), a = torch::mv(inverse, t);
  const torch::Tensor left = ((t - a / inverse.diagonal()) * model.scale_ + model.mean_).contiguous();
  model.leave_one_out_.assign(left.data_ptr<double>(), left.data_ptr<double>() + left.numel());
  model.rows_ = std::make_shared<const GaussianRegression::Rows>(GaussianRegression::Rows{Z, a});
  return model;
}

std::vector<double> GaussianRegression::operator()(std::span<const double> points) const {
  const OneTorchThread one_thread;
  const torch::Tensor all = standardised_rows(scaling_, points);
  std::vector<double> result;
  for (std::int64_t first = 0; first < all.size(0); first += kBlock) {
    stop_if_cancelled();
    const torch::Tensor k = trend_kernel(all.slice(0, first, std::min(first + kBlock, all.size(0))), rows_->Z, logs_);
    const torch::Tensor t = (torch::mv(k, rows_->slope) * scale_ + mean_).contiguous();
    result.insert(result.end(), t.data_ptr<double>(), t.data_ptr<double>() + t.numel());
  }
  return result;
}

}  // namespace gonogo::learning
