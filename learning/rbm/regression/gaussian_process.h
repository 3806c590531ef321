// Gaussian processes: a classifier, baseline of every model and teacher of machines, and a regression.
// Rasmussen & Williams, "Gaussian Processes for Machine Learning" (2006); equations and algorithms below are theirs.
//
//   P(1 | f) = sigmoid(f),  f ~ GP(m, k),  k(x, x') = s exp(-1/2 sum_v (z_v - z'_v)^2 / l_v^2),  z as in baselines.h
//
// The mean m is 0, or given at every row and point.
//
// The posterior of f at the rows is Laplace's approximation (algorithm 3.1); a row of weight w counts as w rows. P(1 |
// x) is the mean of sigmoid over the posterior of f(x) (equation 3.25), by Gauss-Hermite quadrature. log l_v and log s
// maximise the approximate marginal likelihood (equation 3.32) plus the log of a normal prior, by its gradient
// (algorithm 5.1). The prior matters for about a hundred rows: without it lengths run away.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "learning/rbm/regression/baselines.h"
#include "learning/rbm/regression/kernel_search.h"

namespace gonogo::learning {

struct GaussianProcessSettings {
  double prior_length = 3, prior_variance = 4;  // medians of l_v [standard deviations of the variable] and s
  double prior_width = 1.5;                     // standard deviation of log l_v and log s
  std::size_t search_rows = 1000;  // max rows for l_v and s, drawn by the seed; the posterior takes all rows
  std::size_t search_steps = 40;   // max of each stage of the search, see KernelSearch
  std::uint64_t seed = 1;
  bool variances = true;  // without them a model gives most_probable() alone, and is fitted sooner
};

/// log l_v [variable], then log s.
using KernelLogs = std::vector<double>;

/// Log of the approximate marginal likelihood (equation 3.32) and its gradient with respect to `logs`. inputs: [row x
/// variable], as they are; label: [row] of {0, 1}; weight: [row].
LaplaceEvidence laplace_evidence(std::span<const double> inputs, std::span<const int> label,
                                 std::span<const double> weight, const KernelLogs& logs);

/// What most_probable() takes of a fitted process.
struct ProcessParts {
  Standardisation scaling{};
  std::vector<double> logs{};    // as GaussianProcessModel::logs()
  std::vector<double> inputs{};  // of the rows, standardised [row x variable]
  std::vector<double> slope{};   // of their log likelihood at the mode [row]
};

/// Mean and variance of the latent function at a point.
struct Latent {
  double mean = 0, variance = 0;
};

class GaussianProcessModel {
 public:
  GaussianProcessModel() = default;
  /// A process without variances. The sizes of the parts agree.
  explicit GaussianProcessModel(const ProcessParts& parts);
  ProcessParts parts() const;
  std::size_t input_count() const { return scaling_.mean.size(); }

  /// Many points at once are much faster than one by one. points: [point count x variable count]; NaN counts as the
  /// variable's mean; mean: m of every point, 0 where it is empty. Throws nothing.
  std::vector<double> probabilities(std::span<const double> points, std::span<const double> mean = {}) const;
  /// sigmoid of the mean of f: the class probability at the most probable latent function (section 3.4.2). On few
  /// trials the mean of sigmoid(f) is too unsure, because Laplace's approximation is too wide.
  std::vector<double> most_probable(std::span<const double> points, std::span<const double> mean = {}) const;
  std::vector<Latent> latent(std::span<const double> points, std::span<const double> mean = {}) const;
  double operator()(std::span<const double> variables) const;
  const KernelLogs& logs() const { return logs_; }
  /// That found the logs; null if they were given.
  const KernelSearch* search() const { return search_ ? &*search_ : nullptr; }

 private:
  friend struct ProcessMaker;
  friend GaussianProcessModel fit_gaussian_process(const TrainingTable&, std::span<const int>,
                                                   const GaussianProcessSettings&, std::span<const double>,
                                                   const KernelSearch*);
  struct Rows;  // the training rows and the posterior there
  Standardisation scaling_;
  KernelLogs logs_;
  std::optional<KernelSearch> search_;
  std::shared_ptr<const Rows> rows_;
};

/// Searches l_v and s and takes the posterior. label: [row_count()] of {0, 1}; mean: m of every row, or empty; begun: a
/// search on the same rows with another mean, whose end is a good beginning.
/// Deterministic in the seed, whatever other threads do. Takes time proportional to the cube of the rows: 100 rows less
/// than 0.1 s, 3,000 rows less than a minute.
GaussianProcessModel fit_gaussian_process(const TrainingTable& table, std::span<const int> label,
                                          const GaussianProcessSettings& settings = {},
                                          std::span<const double> mean = {}, const KernelSearch* begun = nullptr);
/// The posterior for given l_v and s.
GaussianProcessModel gaussian_process_with(const TrainingTable& table, std::span<const int> label,
                                           const KernelLogs& logs, std::span<const double> mean = {});

/// What a fitted regression answers by.
struct RegressionParts : ProcessParts {  // slope: (K + noise)^-1 t
  double mean = 0, scale = 1;            // of the targets
};

/// Regression (chapter 2) of standardised targets t:
///
///   t = f(x) + e,  f ~ GP(0, k + c (1 + sum_v z_v z'_v)),  e ~ N(0, n / w),  w the weight of the row
///
/// The linear part goes on outside of few rows. log l_v, log s, log c and log n maximise the marginal likelihood
/// (equation 2.30) plus the log of a normal prior around log(prior_length), 0, log(0.1) and log(0.1).
class GaussianRegression {
 public:
  GaussianRegression() = default;
  /// A regression without leave_one_out(). The sizes of the parts agree.
  explicit GaussianRegression(const RegressionParts& parts);
  RegressionParts parts() const;
  std::size_t input_count() const { return scaling_.mean.size(); }

  /// Expected target of many points. points: [point count x variable count]; NaN counts as the variable's mean.
  std::vector<double> operator()(std::span<const double> points) const;
  /// The same of every row by all other rows (equation 5.12).
  const std::vector<double>& leave_one_out() const { return leave_one_out_; }
  /// log l_v [variable], then log s, log c, log n.
  const std::vector<double>& logs() const { return logs_; }

 private:
  friend GaussianRegression fit_gaussian_regression(const TrainingTable&, std::span<const double>,
                                                    const GaussianProcessSettings&);
  struct Rows;  // the training rows and their weights in f
  Standardisation scaling_;
  double mean_ = 0, scale_ = 1;  // of the targets
  std::vector<double> logs_, leave_one_out_;
  std::shared_ptr<const Rows> rows_;
};

/// target: [row_count()], finite. Deterministic in the seed.
GaussianRegression fit_gaussian_regression(const TrainingTable& table, std::span<const double> target,
                                           const GaussianProcessSettings& settings = {});

}  // namespace gonogo::learning
