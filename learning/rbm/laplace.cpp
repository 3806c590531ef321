#include "learning/rbm/laplace.h"

#include <cmath>

namespace gonogo::learning {
namespace {

constexpr int kMaxSteps = 100;
constexpr double kEnough = 1e-9;  // relative change of the log posterior that ends Newton's method

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

double log_posterior(const RowLikelihood& likelihood, const torch::Tensor& a, const torch::Tensor& f) {
  return likelihood.value(f) - 0.5 * scalar_product(a, f);
}

}  // namespace

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

Mode find_mode(const torch::Tensor& K, const RowLikelihood& likelihood, const torch::Tensor& start) {
  Mode mode;
  mode.f = start.defined() ? start : torch::zeros({K.size(0)}, torch::kFloat64);
  mode.log_posterior = -INFINITY;
  for (int step = 0; step < kMaxSteps; ++step) {
    const torch::Tensor W = likelihood.curvature(mode.f);
    factorise(K, W, mode);
    const torch::Tensor b = W * mode.f + likelihood.slope(mode.f);
    torch::Tensor a = b - mode.root * solve(mode.lower, mode.root * torch::mv(K, b));
    torch::Tensor f = torch::mv(K, a);
    double now = log_posterior(likelihood, a, f);
    for (int half = 0; half < 30 && mode.a.defined() && now < mode.log_posterior; ++half) {
      a = 0.5 * (a + mode.a);
      f = 0.5 * (f + mode.f);
      now = log_posterior(likelihood, a, f);
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
  const torch::Tensor Q = M.mul_(K), both = Q.sum(0) + Q.sum(1);
  for (std::int64_t j = 0; j < Z.size(1); ++j) {  // dK / d log l = K (z - z')^2 / l^2
    const torch::Tensor z = Z.select(1, j).contiguous();
    const double apart = scalar_product(z.square(), both) - 2 * scalar_product(z, torch::mv(Q, z));
    evidence.gradient.push_back(apart * std::exp(-2 * logs[std::size_t(j)]));
  }
  evidence.gradient.push_back(Q.sum().item<double>());
  return evidence;
}

}  // namespace gonogo::learning
