// The Gaussian process classifier beside a dense computation of Laplace's approximation that shares no formula with it:
// Newton's method on the explicit inverse of K, determinants instead of the matrix B, finite differences for gradients.
#include "learning/rbm/gaussian_process.h"

#include <Eigen/Dense>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "base/math/random.h"
#include "learning/rbm/baselines.h"
#include "learning/score/score.h"
#include "tests/learning/smooth_boundary.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

/// 14 rows of two variables on a curved edge, with unequal weights.
TrainingTable small_table() {
  TrainingTable table;
  table.variable_count = 2;
  for (std::size_t n = 0; n < 14; ++n) {
    const double x = 4 * random_unit(5, 1, n) - 2, y = 4 * random_unit(5, 2, n) - 2;
    table.variables.insert(table.variables.end(), {x, y});
    table.outcome.push_back(x + y * y - 1 + random_unit(5, 3, n) > 0.5 ? 0 : 2);
    table.weight.push_back(0.5 + random_unit(5, 4, n));
    table.group.push_back(n);
  }
  return table;
}

/// Laplace's approximation by K^-1 and determinants.
struct Dense {
  Eigen::MatrixXd Z, K;
  Eigen::VectorXd y, w, f, W;
  KernelLogs logs;
  double k(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
    double square = 0;
    for (Eigen::Index v = 0; v < a.size(); ++v) square += std::pow((a[v] - b[v]) / std::exp(logs[std::size_t(v)]), 2);
    return std::exp(logs.back() - square / 2);
  }
  Dense(Eigen::MatrixXd inputs, std::span<const int> label, std::span<const double> weight, KernelLogs kernel_logs)
      : Z(std::move(inputs)), logs(std::move(kernel_logs)) {
    const Eigen::Index n = Z.rows();
    K.resize(n, n);
    y.resize(n);
    w.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      y[i] = label[std::size_t(i)] ? 1 : -1;
      w[i] = weight[std::size_t(i)];
      for (Eigen::Index j = 0; j < n; ++j) K(i, j) = k(Z.row(i), Z.row(j));
    }
    f = Eigen::VectorXd::Zero(n);
    const Eigen::MatrixXd precision = K.inverse();
    for (int step = 0; step < 200; ++step) {
      const Eigen::VectorXd slope = w.array() * y.array() / (1 + (y.array() * f.array()).exp());
      W = w.array() * f.array().exp() / (1 + f.array().exp()).square();
      f += (precision + Eigen::MatrixXd(W.asDiagonal())).fullPivLu().solve(slope - precision * f);
    }
    W = w.array() * f.array().exp() / (1 + f.array().exp()).square();
  }
  double evidence() const {
    const double likelihood = -(w.array() * (1 + (-y.array() * f.array()).exp()).log()).sum();
    const Eigen::MatrixXd curvature = K.inverse() + Eigen::MatrixXd(W.asDiagonal());
    return likelihood - f.dot(K.fullPivLu().solve(f)) / 2 - std::log(K.determinant()) / 2 -
           std::log(curvature.determinant()) / 2;
  }
  Latent latent(const Eigen::VectorXd& x) const {
    Eigen::VectorXd at(Z.rows());
    for (Eigen::Index i = 0; i < Z.rows(); ++i) at[i] = k(Z.row(i), x);
    const Eigen::MatrixXd noisy = K + Eigen::MatrixXd(W.cwiseInverse().asDiagonal());
    return {at.dot(K.fullPivLu().solve(f)), std::exp(logs.back()) - at.dot(noisy.fullPivLu().solve(at))};
  }
};

Eigen::MatrixXd matrix_of(const std::vector<double>& values, std::size_t columns) {
  return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      values.data(), Eigen::Index(values.size() / columns), Eigen::Index(columns));
}

/// Mean of sigmoid over a normal distribution by 40,001 points of the trapezoidal rule.
double mean_sigmoid(const Latent& f) {
  double sum = 0, total = 0;
  for (int k = -20000; k <= 20000; ++k) {
    const double t = 10.0 * k / 20000, weight = std::exp(-t * t / 2);
    sum += weight / (1 + std::exp(-f.mean - t * std::sqrt(f.variance)));
    total += weight;
  }
  return sum / total;
}

}  // namespace

TEST_CASE("evidence and its gradient agree with dense determinants and finite differences") {
  const TrainingTable table = small_table();
  const std::vector<int> label = labels_of(table);
  for (const KernelLogs& logs : {KernelLogs{0.2, 0.5, 1.5}, KernelLogs{-0.4, 1.0, 3.0}}) {
    const LaplaceEvidence found = laplace_evidence(table.variables, label, table.weight, logs);
    const Eigen::MatrixXd inputs = matrix_of(table.variables, 2);
    CHECK(found.value == Approx(Dense(inputs, label, table.weight, logs).evidence()).epsilon(1e-7));
    for (std::size_t k = 0; k < logs.size(); ++k) {
      const double h = 1e-4;
      KernelLogs more = logs, less = logs;
      more[k] += h;
      less[k] -= h;
      const double slope =
          (Dense(inputs, label, table.weight, more).evidence() - Dense(inputs, label, table.weight, less).evidence()) /
          (2 * h);
      CHECK(found.gradient[k] == Approx(slope).epsilon(1e-4).margin(1e-6));
    }
  }
}

TEST_CASE("the posterior at fresh points agrees with dense algebra, its mean probability with a fine sum") {
  const TrainingTable table = small_table();
  const KernelLogs logs = {0.2, 0.5, 1.5};
  const GaussianProcessModel model = gaussian_process_with(table, labels_of(table), logs);
  const Standardisation scaling = standardisation_of(table);
  std::vector<double> rows = table.variables, fresh = {0.3, -0.2, 1.9, 1.7, -6, 5, NAN, 0.4};
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = scaling.standardised(k % 2, rows[k]);
  const Dense dense(matrix_of(rows, 2), labels_of(table), table.weight, logs);
  const std::vector<Latent> found = model.latent(fresh);
  const std::vector<double> p = model.probabilities(fresh);
  const std::vector<double> mode = model.most_probable(fresh);
  for (std::size_t n = 0; n < found.size(); ++n) {
    const Eigen::Vector2d x(scaling.standardised(0, fresh[2 * n]), scaling.standardised(1, fresh[2 * n + 1]));
    const Latent expected = dense.latent(x);
    CHECK(found[n].mean == Approx(expected.mean).epsilon(1e-5).margin(1e-8));
    CHECK(found[n].variance == Approx(expected.variance).epsilon(1e-5));
    CHECK(mode[n] == Approx(1 / (1 + std::exp(-expected.mean))).epsilon(1e-5));
    CHECK(p[n] == Approx(mean_sigmoid(expected)).margin(2e-4));
    CHECK(p[n] == Approx(model(std::span(fresh).subspan(2 * n, 2))));
  }
}

TEST_CASE("a row of weight two counts as the row twice") {
  TrainingTable once = small_table(), twice = once;
  once.weight.assign(14, 1.0);
  once.weight[3] = 2;
  twice.weight.assign(14, 1.0);
  twice.variables.insert(twice.variables.end(), once.row(3).begin(), once.row(3).end());
  twice.outcome.push_back(once.outcome[3]);
  twice.weight.push_back(1);
  const KernelLogs logs = {0.2, 0.5, 1.5};
  const LaplaceEvidence one = laplace_evidence(once.variables, labels_of(once), once.weight, logs),
                        two = laplace_evidence(twice.variables, labels_of(twice), twice.weight, logs);
  CHECK(one.value == Approx(two.value).epsilon(1e-7));
  CHECK(one.gradient[0] == Approx(two.gradient[0]).epsilon(1e-5));
}

TEST_CASE("the search climbs the evidence, is a function of its seed, and the process learns a curved edge") {
  const TrainingTable table = boundary_table(300, 4, Boundary::curved),
                      fresh = boundary_table(2000, 99, Boundary::curved);
  const std::vector<int> label = labels_of(table);
  GaussianProcessSettings settings;
  settings.search_rows = 200;
  const auto begin = std::chrono::steady_clock::now();
  const GaussianProcessModel model = fit_gaussian_process(table, label, settings);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  CHECK(model.logs() == fit_gaussian_process(table, label, settings).logs());
  const auto evidence = [&](const KernelLogs& logs) {
    const Standardisation scaling = standardisation_of(table);
    std::vector<double> rows = table.variables;
    for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = scaling.standardised(k % table.variable_count, rows[k]);
    return laplace_evidence(rows, label, table.weight, logs).value;
  };
  KernelLogs start(table.variable_count, std::log(3.0));
  start.push_back(std::log(4.0));
  CHECK(evidence(model.logs()) > evidence(start) + 5);
  const std::vector<double> p = model.probabilities(fresh.variables);
  std::vector<double> straight;
  const LogisticModel logistic = fit_logistic(table, label);
  for (std::size_t n = 0; n < fresh.row_count(); ++n) straight.push_back(logistic(fresh.row(n)));
  const double brier = brier_score(p, labels_of(fresh));
  std::printf("curved edge, 300 rows in %.1f s: Brier of the process %.4f, of logistic regression %.4f\n", seconds,
              brier, brier_score(straight, labels_of(fresh)));
  CHECK(brier < 0.8 * brier_score(straight, labels_of(fresh)));
}

TEST_CASE("quadratic regression finds a quadratic edge that a straight one cannot follow") {
  const TrainingTable table = boundary_table(600, 4, Boundary::curved),
                      fresh = boundary_table(2000, 99, Boundary::curved);
  const std::vector<int> label = labels_of(table);
  const QuadraticModel model = fit_quadratic(table, label);
  const LogisticModel straight = fit_logistic(table, label);
  std::vector<double> p, q;
  for (std::size_t n = 0; n < fresh.row_count(); ++n) {
    p.push_back(model(fresh.row(n)));
    q.push_back(straight(fresh.row(n)));
  }
  CHECK(brier_score(p, labels_of(fresh)) < 0.8 * brier_score(q, labels_of(fresh)));
  CHECK(model.of_terms.weight.size() == table.variable_count * (table.variable_count + 3) / 2 + 1);
  // By hand at one point: the terms in their documented order.
  std::vector<double> terms;
  for (std::size_t v = 0; v < table.variable_count; ++v) terms.push_back(model.standardised(v, fresh.row(7)[v]));
  for (std::size_t a = 0; a < table.variable_count; ++a)
    for (std::size_t b = 0; b <= a; ++b) terms.push_back(terms[a] * terms[b]);
  double field = model.of_terms.weight.back();
  for (std::size_t k = 0; k < terms.size(); ++k)
    field += model.of_terms.weight[k] * (terms[k] - model.of_terms.mean[k]) / model.of_terms.scale[k];
  CHECK(p[7] == Approx(1 / (1 + std::exp(-field))));
}
