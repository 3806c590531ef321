// The Gaussian process classifier beside a dense computation of Laplace's approximation that shares no formula with it:
// Newton's method on the explicit inverse of K, determinants instead of the matrix B, finite differences for gradients.
#include "learning/rbm/regression/gaussian_process.h"

#include <Eigen/Dense>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "base/hdf5/hdf5.h"
#include "base/math/random.h"
#include "base/parallel/host_loop.h"
#include "learning/rbm/regression/baselines.h"
#include "learning/rbm/regression/fit_files.h"
#include "learning/rbm/regression/symmetric.h"
#include "learning/score/score.h"
#include "tests/learning/smooth_boundary.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

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

TEMPLATE_TEST_CASE("a factor gives the matrix back, and times its inverse the identity", "", float, double) {
  using T = TestType;
  const double exact = sizeof(T) == 4 ? 1e-4 : 1e-12;
  for (const Eigen::Index rows : {1, 7, 31, 32, 33, 64, 100, 257}) {
    Matrix<T> S(rows, rows);
    for (Eigen::Index i = 0; i < rows; ++i)
      for (Eigen::Index j = 0; j < rows; ++j) S(i, j) = T(std::exp(-0.1 * std::abs(double(i - j))) + (i == j));
    Matrix<T> L = S;
    L.template triangularView<Eigen::StrictlyUpper>().setConstant(T(NAN));  // is not read
    REQUIRE(factorise(L));
    Matrix<T> inverse = L;
    invert_factored(inverse);
    const Column<T> ones = Column<T>::Ones(rows), x = factored_solution<T>(L, ones);
    double worst = 0;
    for (Eigen::Index i = 0; i < rows; ++i) {
      double of_x = 0;
      for (Eigen::Index j = 0; j < rows; ++j) {
        double of_factor = 0, of_inverse = 0;
        for (Eigen::Index k = 0; k < rows; ++k) {
          if (k <= std::min(i, j)) of_factor += double(L(i, k)) * double(L(j, k));
          of_inverse += double(S(i, k)) * double(inverse(std::max(k, j), std::min(k, j)));
        }
        of_x += double(S(i, j)) * double(x[j]);
        worst = std::max({worst, std::abs(of_factor - double(S(i, j))), std::abs(of_inverse - double(i == j))});
      }
      worst = std::max(worst, std::abs(of_x - 1));
    }
    CAPTURE(rows);
    CHECK(worst < exact);
  }
  Matrix<T> saddle(2, 2);
  saddle << 1, 2, 2, 1;
  CHECK(!factorise(saddle));
}

TEST_CASE("processes and regressions that are fitted at the same time have the bits of one alone") {
  const TrainingTable table = boundary_table(250, 4, Boundary::curved);
  const std::vector<int> label = labels_of(table);
  std::vector<double> target;
  for (std::size_t n = 0; n < table.row_count(); ++n) target.push_back(std::tanh(table.row(n)[0]));
  const auto answers = [&] {
    std::vector<double> all = fit_gaussian_process(table, label).probabilities(table.variables);
    for (const std::vector<double>& more :
         {fit_gaussian_regression(table, target).leave_one_out(), fit_quadratic(table, label).of_terms.weight,
          fit_network(table, label, {.max_epochs = 20}).input_weight})
      all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  const std::vector<double> alone = answers();
  std::vector<std::vector<double>> together(8);
  for_each_on_host(
      together.size(), 1, [&](std::size_t k) { together[k] = answers(); }, 4);
  for (const std::vector<double>& found : together) CHECK(found == alone);
}

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

TEST_CASE("with a mean the mode of the latent function solves f = m + K d log p / df") {
  TrainingTable table = small_table();
  const KernelLogs logs = {0.2, 0.5, 1.5};
  const std::vector<int> label = labels_of(table);
  std::vector<double> mean;
  for (std::size_t n = 0; n < table.row_count(); ++n) mean.push_back(1.5 * std::sin(double(n)) - 0.5);
  const GaussianProcessModel model = gaussian_process_with(table, label, logs, mean);
  const Standardisation scaling = standardisation_of(table);
  const std::vector<Latent> f = model.latent(table.variables, mean);
  const std::vector<double> mode = model.most_probable(table.variables, mean);
  for (std::size_t i = 0; i < f.size(); ++i) {
    double expected = mean[i];
    for (std::size_t j = 0; j < f.size(); ++j) {
      double square = 0;
      for (std::size_t v = 0; v < 2; ++v) {
        const double apart =
            (scaling.standardised(v, table.row(i)[v]) - scaling.standardised(v, table.row(j)[v])) / std::exp(logs[v]);
        square += apart * apart;
      }
      expected += std::exp(logs[2] - square / 2) * table.weight[j] * (label[j] - 1 / (1 + std::exp(-f[j].mean)));
    }
    CHECK(f[i].mean == Approx(expected).margin(1e-5));
    CHECK(mode[i] == Approx(1 / (1 + std::exp(-f[i].mean))));
  }
}

namespace {

/// The regression's covariance of two standardised points, without noise.
double trend_covariance(const Eigen::VectorXd& a, const Eigen::VectorXd& b, const std::vector<double>& logs) {
  const auto variables = std::size_t(a.size());
  double square = 0;
  for (std::size_t v = 0; v < variables; ++v)
    square += std::pow((a[Eigen::Index(v)] - b[Eigen::Index(v)]) / std::exp(logs[v]), 2);
  return std::exp(logs[variables] - square / 2) + std::exp(logs[variables + 1]) * (1 + a.dot(b));
}

/// The regression by dense algebra on rows that are standardised already.
struct DenseRegression {
  Eigen::MatrixXd Z;
  Eigen::VectorXd t, weight;

  Eigen::MatrixXd covariance(const std::vector<double>& logs) const {
    Eigen::MatrixXd K(Z.rows(), Z.rows());
    for (Eigen::Index i = 0; i < Z.rows(); ++i)
      for (Eigen::Index j = 0; j < Z.rows(); ++j)
        K(i, j) = trend_covariance(Z.row(i).transpose(), Z.row(j).transpose(), logs) +
                  (i == j ? std::exp(logs.back()) / weight[i] + 1e-8 : 0);
    return K;
  }
  /// Log of the marginal likelihood, times the prior of the search.
  double evidence(const std::vector<double>& logs) const {
    const Eigen::LLT<Eigen::MatrixXd> K(covariance(logs));
    double value = -0.5 * t.dot(K.solve(t)) - Eigen::MatrixXd(K.matrixL()).diagonal().array().log().sum();
    for (std::size_t k = 0; k < logs.size(); ++k) {
      const double centre = k + 3 < logs.size() ? std::log(3.0) : k + 3 == logs.size() ? 0 : std::log(0.1);
      value -= 0.5 * std::pow((logs[k] - centre) / 1.5, 2);
    }
    return value;
  }
  double at(const Eigen::VectorXd& z, const std::vector<double>& logs) const {
    const Eigen::VectorXd a = covariance(logs).llt().solve(t);
    double sum = 0;
    for (Eigen::Index i = 0; i < Z.rows(); ++i) sum += a[i] * trend_covariance(z, Z.row(i).transpose(), logs);
    return sum;
  }
  DenseRegression without(Eigen::Index row) const {
    DenseRegression less{Eigen::MatrixXd(Z.rows() - 1, Z.cols()), Eigen::VectorXd(Z.rows() - 1),
                         Eigen::VectorXd(Z.rows() - 1)};
    for (Eigen::Index i = 0, k = 0; i < Z.rows(); ++i) {
      if (i == row) continue;
      less.Z.row(k) = Z.row(i);
      less.t[k] = t[i];
      less.weight[k++] = weight[i];
    }
    return less;
  }
};

}  // namespace

TEST_CASE("the regression agrees with dense algebra, leaves rows out by removing them, and its logs are a summit") {
  TrainingTable table = boundary_table(60, 5, Boundary::curved);
  std::vector<double> target;
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    table.weight[n] = 0.5 + 0.02 * double(n);
    target.push_back(2 + 3 * std::tanh(table.row(n)[0]) + 0.3 * std::sin(7.0 * double(n)));
  }
  const GaussianRegression model = fit_gaussian_regression(table, target);
  const Standardisation scaling = standardisation_of(table);
  DenseRegression dense{Eigen::MatrixXd(60, Eigen::Index(table.variable_count)),
                        Eigen::Map<const Eigen::VectorXd>(target.data(), 60),
                        Eigen::Map<const Eigen::VectorXd>(table.weight.data(), 60)};
  for (Eigen::Index n = 0; n < 60; ++n)
    for (std::size_t v = 0; v < table.variable_count; ++v)
      dense.Z(n, Eigen::Index(v)) = scaling.standardised(v, table.row(std::size_t(n))[v]);
  const double mean = dense.t.mean(), scale = std::sqrt((dense.t.array() - mean).square().mean());
  dense.t = (dense.t.array() - mean) / scale;
  for (const Eigen::Index n : {0, 17, 59}) {
    const Eigen::VectorXd z = dense.Z.row(n).transpose();
    CHECK(model(table.row(std::size_t(n)))[0] == Approx(mean + scale * dense.at(z, model.logs())).epsilon(1e-6));
    CHECK(model.leave_one_out()[std::size_t(n)] ==
          Approx(mean + scale * dense.without(n).at(z, model.logs())).epsilon(1e-6));
  }
  for (std::size_t k = 0; k < model.logs().size(); ++k)
    for (const double step : {-0.3, 0.3}) {
      std::vector<double> moved = model.logs();
      moved[k] += step;
      CHECK(dense.evidence(model.logs()) > dense.evidence(moved) - 0.01);
    }
}

TEST_CASE("fits that were written answer as before, and damaged ones are refused by their place") {
  const TrainingTable table = boundary_table(60, 5, Boundary::curved), asked = boundary_table(40, 6, Boundary::curved);
  const std::vector<int> label = labels_of(table);
  std::vector<double> target;
  for (std::size_t n = 0; n < table.row_count(); ++n) target.push_back(2 + std::tanh(table.row(n)[0]));
  const GaussianProcessModel process = fit_gaussian_process(table, label, {.variances = false});
  const GaussianRegression regression = fit_gaussian_regression(table, target);
  const LogisticModel logistic = fit_logistic(table, label);
  const TemporaryFolder folder;
  {
    Hdf5Writer out;
    write_fit(out, "fits/process", process);
    write_fit(out, "fits/regression", regression);
    write_fit(out, "fits/logistic", logistic);
    out.save(folder / "fits.h5");
  }
  const Hdf5Reader in(folder / "fits.h5");
  CHECK(read_process(in, "fits/process").most_probable(asked.variables) == process.most_probable(asked.variables));
  CHECK(read_regression(in, "fits/regression")(asked.variables) == regression(asked.variables));
  CHECK(read_logistic(in, "fits/logistic").log_odds(asked.row(3)) == logistic.log_odds(asked.row(3)));

  ProcessParts parts = process.parts();
  parts.logs[0] = NAN;
  {
    Hdf5Writer damaged;
    write_fit(damaged, "process", GaussianProcessModel(parts));
    damaged.save(folder / "damaged.h5");
  }
  CHECK(contains(input_error([&] { read_process(Hdf5Reader(folder / "damaged.h5"), "process"); }),
                 "process/logs: holds a value that is not a finite number; train the model again"));
  CHECK(contains(input_error([&] { read_regression(in, "fits/process"); }), "fits/process/target"));
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
