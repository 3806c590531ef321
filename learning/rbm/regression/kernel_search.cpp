#include "learning/rbm/regression/kernel_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/progress.h"

namespace gonogo::learning {
namespace {

double product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

}  // namespace

KernelSearch::KernelSearch(std::vector<double> centre, double width)
    : centre_(std::move(centre)), width_(width), logs_(centre_), inverse_(logs_.size() * logs_.size(), 0.0) {}

void KernelSearch::run(const EvidenceOf& evidence_of, std::size_t rows, std::size_t steps) {
  constexpr double kLeastGain = 0.002, kLittle = 0.02;  // [nat]
  At here = at(logs_, evidence_of);
  begin(here, rows);
  double gained = INFINITY;
  for (std::size_t step = 0; step < steps; ++step) {
    const std::vector<double> towards = direction(here.gradient);
    const double slope = product(towards, here.gradient), before = here.value;
    if (!(-slope / 2 > kLeastGain) && (gained < kLittle || !(slope < 0))) break;
    if (!advance(here, towards, slope, evidence_of)) break;
    gained = before - here.value;
  }
}

KernelSearch::At KernelSearch::at(const std::vector<double>& logs, const EvidenceOf& evidence_of) const {
  stop_if_cancelled();
  LaplaceEvidence evidence = evidence_of(logs);
  At result{-evidence.value, std::move(evidence.gradient)};
  for (std::size_t k = 0; k < logs.size(); ++k) {
    const double off = (logs[k] - centre_[k]) / width_;
    result.value += 0.5 * off * off;
    result.gradient[k] = off / width_ - result.gradient[k];
  }
  return result;
}

/// The first stage begins with a step of length 1 or less; the next with what the one before found of the curvature,
/// which grows with the rows.
void KernelSearch::begin(const At& here, std::size_t rows) {
  if (rows_ > 0) {
    for (double& x : inverse_) x *= double(rows_) / double(rows);
  } else {
    const double scale = std::min(width_ * width_, 1 / std::sqrt(product(here.gradient, here.gradient)));
    for (std::size_t k = 0; k < logs_.size(); ++k) inverse_[k * logs_.size() + k] = scale;
  }
  rows_ = rows;
}

std::vector<double> KernelSearch::direction(const std::vector<double>& gradient) const {
  constexpr double kLongest = 2;  // change of a log in a step
  std::vector<double> result(gradient.size(), 0.0);
  double longest = 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    for (std::size_t j = 0; j < result.size(); ++j) result[i] -= inverse_[i * result.size() + j] * gradient[j];
    longest = std::max(longest, std::abs(result[i]));
  }
  if (longest > kLongest)
    for (double& x : result) x *= kLongest / longest;
  return result;
}

/// Whether a step along `towards` lowered the value.
bool KernelSearch::advance(At& here, const std::vector<double>& towards, double slope, const EvidenceOf& evidence_of) {
  constexpr double kEnough = 1e-4;  // of the descent that the slope promises
  double share = 1;
  for (int trial = 0; trial < 10; ++trial, share /= 2) {
    std::vector<double> logs = logs_;
    for (std::size_t k = 0; k < logs.size(); ++k) logs[k] += share * towards[k];
    At there = at(logs, evidence_of);
    if (!(there.value <= here.value + kEnough * share * slope)) continue;
    take_curvature(logs, here.gradient, there.gradient);
    logs_ = std::move(logs);
    here = std::move(there);
    return true;
  }
  return false;
}

void KernelSearch::take_curvature(const std::vector<double>& logs, const std::vector<double>& before,
                                  const std::vector<double>& after) {
  const std::size_t n = logs.size();
  std::vector<double> s(n), y(n), Hy(n, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    s[k] = logs[k] - logs_[k];
    y[k] = after[k] - before[k];
  }
  const double curvature = product(s, y);
  if (!(curvature > 1e-12)) return;
  if (!scaled_)
    for (std::size_t k = 0; k < n; ++k) inverse_[k * n + k] = curvature / product(y, y);
  scaled_ = true;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) Hy[i] += inverse_[i * n + j] * y[j];
  const double grown = (1 + product(y, Hy) / curvature) / curvature;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      inverse_[i * n + j] += grown * s[i] * s[j] - (Hy[i] * s[j] + s[i] * Hy[j]) / curvature;
}

}  // namespace gonogo::learning
