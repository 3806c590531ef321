#include "learning/rbm/regression/gaussian_process.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "base/error.h"
#include "base/math/random.h"
#include "base/progress.h"
#include "base/units.h"
#include "learning/rbm/regression/symmetric.h"

namespace gonogo::learning {
namespace {

constexpr std::uint64_t kSearchRows = 0x67707277;  // stream of random numbers
constexpr Eigen::Index kBlock = 512;               // points whose variances are worked out together
constexpr int kNewtonSteps = 100;
using Searched = float;  // of a classifier's matrices while its lengths are searched

// Kernels.

/// Rows divided by the lengths, and half the square of each: log k = log s + x.y - |x|^2 / 2 - |y|^2 / 2.
template <class T>
struct ScaledRows {
  Matrix<T> x;  // [row x variable]
  Column<T> half_square;
  ScaledRows(const Matrix<T>& rows, const KernelLogs& logs) : x(rows) {
    for (Eigen::Index v = 0; v < x.cols(); ++v) x.col(v) *= T(std::exp(-logs[std::size_t(v)]));
    half_square = T(0.5) * x.rowwise().squaredNorm().array();
  }
};

/// Writes the lower triangle of the kernel of all pairs of rows, where |x - y|^2 is no less than 0 in spite of
/// rounding.
template <class T>
void fill_kernel(const Matrix<T>& rows, const KernelLogs& logs, Matrix<T>& K) {
  const ScaledRows<T> scaled(rows, logs);
  const T log_variance = T(logs.back());
  const Eigen::Index count = rows.rows();
  K.template triangularView<Eigen::Lower>().setZero();
  K.template selfadjointView<Eigen::Lower>().rankUpdate(scaled.x);
  for (Eigen::Index j = 0; j < count; ++j) {
    auto column = K.col(j).tail(count - j).array();
    column = (log_variance + (column - scaled.half_square.tail(count - j) - scaled.half_square[j]).min(T(0))).exp();
    column[0] = std::exp(log_variance);
  }
}

/// k of every row of a with every row of b: [row of a x row of b].
template <class T>
Matrix<T> kernel(const Matrix<T>& a, const Matrix<T>& b, const KernelLogs& logs) {
  const ScaledRows<T> left(a, logs), right(b, logs);
  const T log_variance = T(logs.back());
  Matrix<T> K = left.x * right.x.transpose();
  for (Eigen::Index j = 0; j < K.cols(); ++j) {
    auto column = K.col(j).array();
    column = (log_variance + (column - left.half_square - right.half_square[j]).min(T(0))).exp();
  }
  return K;
}

/// Eigen::Lower triangles of matrices of a number of rows. They are written again and again, since fresh memory of
/// megabytes costs as much as a pass over them.
template <class T>
struct Matrices {
  Matrix<T> K;       // the kernel
  Matrix<T> factor;  // a Cholesky factor, then the inverse of what it is the factor of
  explicit Matrices(Eigen::Index rows) : K(rows, rows), factor(rows, rows) {}
};

/// Sum of the logs of a factor's diagonal.
template <class T>
double half_log_determinant(const Matrix<T>& factor) {
  double sum = 0;
  for (Eigen::Index k = 0; k < factor.rows(); ++k) sum += std::log(double(factor(k, k)));
  return sum;
}

// Laplace's approximation of the posterior. Equations: Rasmussen & Williams (2006), chapters 3 and 5.

template <class T>
Column<T> sigmoid(const Column<T>& f) {
  return (1 + (-f).exp()).inverse();
}

/// The rows' log likelihood sum_n w_n log sigmoid(y_n f_n) at f, with its derivatives, y of {-1, 1}.
template <class T>
struct RowLikelihood {
  Column<T> sign, weight;  // y, w [row]
  double value(const Column<T>& f) const {
    const Column<T> margin = sign * f;  // log(1 + exp(-x)) = max(-x, 0) + log(1 + exp(-|x|))
    return -double((weight * ((-margin).max(T(0)) + (-margin.abs()).exp().log1p())).sum());
  }
  /// d / df.
  Column<T> slope(const Column<T>& f) const { return weight * sign * sigmoid<T>(-sign * f); }
  /// W = -d2 / df2, > 0.
  Column<T> curvature(const Column<T>& f) const { return weight * sigmoid<T>(f) * sigmoid<T>(-f); }
  /// d3 / df3.
  Column<T> third(const Column<T>& f) const { return curvature(f) * (sigmoid<T>(f) - sigmoid<T>(-f)); }
};

/// The mode of the posterior: f = m + K a, with root = W^1/2. Matrices::factor is then the Cholesky factor of
/// B = I + W^1/2 K W^1/2.
template <class T>
struct Mode {
  Column<T> f{}, a{}, root{};
  double log_posterior = 0;  // -1/2 a.(f - m) + log likelihood
  bool found = true;         // or a factorisation failed
};

/// When Newton's method ends.
struct Precision {
  double gain;          // of the log posterior in a step, over 1 + its size
  bool factor_at_mode;  // or where the last step began
};
constexpr Precision kExact = {1e-9, true};
/// The evidence is then known to some 0.001 nat, a tenth of what ends a search.
constexpr Precision kRough = {1e-6, false};

template <class T>
double scalar_product(const Column<T>& a, const Column<T>& b) {
  return double(a.matrix().dot(b.matrix()));
}

template <class T>
void factorise_curved(Matrices<T>& matrices, const Column<T>& curvature, Mode<T>& mode) {
  mode.root = curvature.sqrt();
  const Eigen::Index rows = curvature.size();
  for (Eigen::Index j = 0; j < rows; ++j) {
    auto column = matrices.factor.col(j).tail(rows - j).array();
    column = matrices.K.col(j).tail(rows - j).array() * (mode.root.tail(rows - j) * mode.root[j]);
    column[0] += 1;
  }
  mode.found = factorise(matrices.factor);
}

/// m: the mean of f.
template <class T>
double log_posterior(const RowLikelihood<T>& likelihood, const Column<T>& a, const Column<T>& f, const Column<T>& m) {
  return likelihood.value(f) - 0.5 * scalar_product<T>(a, f - m);
}

/// Where Newton's method may begin, not yet a mode: f, or m where f is empty.
template <class T>
Mode<T> start_at(const Column<T>& f, const Column<T>& m) {
  return {.f = f.size() > 0 ? f : m, .log_posterior = -INFINITY};
}
/// The same at m + K a, or at m where a is empty.
template <class T>
Mode<T> start_with(const Matrix<T>& K, const RowLikelihood<T>& likelihood, const Column<T>& m, const Column<T>& a) {
  if (a.size() == 0) return start_at<T>({}, m);
  Mode<T> mode{.f = m + symmetric_product<T>(K, a), .a = a};
  mode.log_posterior = log_posterior(likelihood, a, mode.f, m);
  return mode;
}

/// Newton's method (algorithm 3.1) from a start. A step that lowers the posterior is halved. matrices: of the kernel;
/// m: the mean of f [row].
template <class T>
Mode<T> find_mode(Matrices<T>& matrices, const RowLikelihood<T>& likelihood, const Column<T>& m, Mode<T> mode,
                  const Precision& precision) {
  const Matrix<T>& K = matrices.K;
  for (int step = 0; step < kNewtonSteps; ++step) {
    const Column<T> W = likelihood.curvature(mode.f);
    factorise_curved(matrices, W, mode);
    if (!mode.found) return mode;
    const Column<T> b = W * (mode.f - m) + likelihood.slope(mode.f);
    Column<T> a = b - mode.root * factored_solution<T>(matrices.factor, mode.root * symmetric_product<T>(K, b));
    Column<T> f = m + symmetric_product<T>(K, a);
    double now = log_posterior(likelihood, a, f, m);
    for (int half = 0; half < 30 && mode.a.size() > 0 && now < mode.log_posterior; ++half) {
      a = T(0.5) * (a + mode.a);
      f = T(0.5) * (f + mode.f);
      now = log_posterior(likelihood, a, f, m);
    }
    const bool done = std::abs(now - mode.log_posterior) <= precision.gain * (1 + std::abs(now));
    mode.a = a;
    mode.f = f;
    mode.log_posterior = now;
    mode.found = std::isfinite(now);
    if (done || !mode.found) break;
  }
  if (precision.factor_at_mode) factorise_curved(matrices, likelihood.curvature(mode.f), mode);
  return mode;
}

/// sum_ab Q_ab (z_a - z_b)^2 / l^2 of every variable, which are the derivatives by log l_v where Q = M K by elements;
/// then sum_ab Q_ab. Q: symmetric, its lower triangle.
template <class T>
std::vector<double> kernel_slopes(const Matrix<T>& Z, const Matrix<T>& Q, const std::vector<double>& logs) {
  const Eigen::Index variables = Z.cols();
  Matrix<T> with_ones(Z.rows(), variables + 1);
  with_ones << Z, Column<T>::Ones(Z.rows()).matrix();
  const Matrix<T> sums = Q.template selfadjointView<Eigen::Lower>() * with_ones;
  const Column<T> row_sums = sums.col(variables).array();
  std::vector<double> slopes;
  for (Eigen::Index v = 0; v < variables; ++v) {
    const Column<T> z = Z.col(v).array(), Qz = sums.col(v).array();
    slopes.push_back(2 * double((z * (z * row_sums - Qz)).sum()) * std::exp(-2 * logs[std::size_t(v)]));
  }
  slopes.push_back(double(row_sums.sum()));
  return slopes;
}

/// Overwrites B^-1 with Q = M K by elements for the symmetric part of M = v t' + 1/2 a a' - 1/2 R, where
/// R = W^1/2 B^-1 W^1/2.
template <class T>
void weigh_kernel(const Matrix<T>& K, const Column<T>& root, const Column<T>& v, const Column<T>& t, const Column<T>& a,
                  Matrix<T>& inverse) {
  const Eigen::Index rows = K.rows();
  for (Eigen::Index j = 0; j < rows; ++j) {
    const Eigen::Index left = rows - j;
    auto column = inverse.col(j).tail(left).array();
    column = T(0.5) * K.col(j).tail(left).array() *
             (v.tail(left) * t[j] + t.tail(left) * v[j] + a.tail(left) * a[j] - column * (root.tail(left) * root[j]));
  }
}

/// Evidence and gradient at a mode (equation 3.32 and algorithm 5.1). Z: [row x variable]. Overwrites the factor.
template <class T>
LaplaceEvidence evidence_at(const Matrix<T>& Z, Matrices<T>& matrices, const RowLikelihood<T>& likelihood,
                            const Mode<T>& mode, const KernelLogs& logs) {
  if (!mode.found) return {.value = -INFINITY, .gradient = std::vector<double>(logs.size(), 0.0)};
  LaplaceEvidence evidence;
  evidence.value = mode.log_posterior - half_log_determinant(matrices.factor);
  invert_factored(matrices.factor);
  const Matrix<T>&K = matrices.K, &inverse = matrices.factor;  // of B
  // (K^-1 + W)^-1 = W^-1/2 (I - B^-1) W^-1/2: its diagonal without another system of equations.
  const Column<T> variance = (1 - inverse.diagonal().array()) / mode.root.square().max(T(1e-12));
  const Column<T> s2 = T(0.5) * variance * likelihood.third(mode.f);
  // Every derivative is sum_ab M_ab dK_ab: s1 and s2' s3 of algorithm 5.1 are linear in dK.
  const Column<T> v = s2 - mode.root * symmetric_product<T>(inverse, mode.root * symmetric_product<T>(K, s2));
  weigh_kernel<T>(K, mode.root, v, likelihood.slope(mode.f), mode.a, matrices.factor);
  evidence.gradient = kernel_slopes(Z, matrices.factor, logs);
  return evidence;
}

// The process on a table.

/// Rows of a table.
template <class T>
struct LabelledInputs {
  Matrix<T> Z;  // [row x variable], standardised
  RowLikelihood<T> likelihood;
  Column<T> mean;  // of f [row]
  template <class To>
  LabelledInputs<To> to() const {
    return {Z.template cast<To>(),
            {likelihood.sign.template cast<To>(), likelihood.weight.template cast<To>()},
            mean.template cast<To>()};
  }
};

Column<double> column(std::span<const double> values) {
  return Eigen::Map<const Column<double>>(values.data(), Eigen::Index(values.size()));
}

/// values: [row x variable].
Matrix<double> matrix_of(std::span<const double> values, std::size_t rows, std::size_t variables) {
  using ByRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const ByRows>(values.data(), Eigen::Index(rows), Eigen::Index(variables));
}

/// `mean`, or 0 of every row.
Column<double> mean_or_zero(std::span<const double> mean, std::size_t rows) {
  GONOGO_ASSERT(mean.empty() || mean.size() == rows);
  return mean.empty() ? Column<double>(Column<double>::Zero(Eigen::Index(rows))) : column(mean);
}

Matrix<double> standardised_rows(const Standardisation& scaling, std::span<const double> points) {
  const std::size_t width = scaling.mean.size();
  Matrix<double> Z(Eigen::Index(points.size() / width), Eigen::Index(width));
  for (std::size_t k = 0; k < points.size(); ++k)
    Z(Eigen::Index(k / width), Eigen::Index(k % width)) = scaling.standardised(k % width, points[k]);
  return Z;
}

RowLikelihood<double> row_likelihood(std::span<const int> label, std::span<const double> weight) {
  std::vector<double> sign;
  for (int y : label) sign.push_back(y ? 1 : -1);
  return {column(sign), column(weight)};
}

LabelledInputs<double> labelled(const TrainingTable& table, std::span<const int> label, const Standardisation& scaling,
                                std::span<const double> mean) {
  return {standardised_rows(scaling, table.variables), row_likelihood(label, table.weight),
          mean_or_zero(mean, table.row_count())};
}

/// At most `most` of `count` rows, ascending.
std::vector<Eigen::Index> some_of(std::size_t count, std::size_t most, std::uint64_t seed) {
  std::vector<std::size_t> order = permutation(count, seed, kSearchRows);
  std::vector<Eigen::Index> chosen(order.begin(), order.begin() + std::ptrdiff_t(std::min(count, most)));
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

LabelledInputs<double> some_rows(const LabelledInputs<double>& rows, std::size_t most, std::uint64_t seed) {
  const std::vector<Eigen::Index> index = some_of(std::size_t(rows.Z.rows()), most, seed);
  return {rows.Z(index, Eigen::all), {rows.likelihood.sign(index), rows.likelihood.weight(index)}, rows.mean(index)};
}

// Search of lengths and variances.

/// Numbers of rows of the stages of a search. Each begins where the one before ended: most steps are then taken on few
/// rows, whose matrices cost an eighth. Of half as many, an input that acts to both sides alike may look as if it did
/// nothing. The search then ends at its long length, a lower summit, also on all rows. No stage has fewer rows than the
/// search has seen.
std::vector<std::size_t> stages(std::size_t rows, const GaussianProcessSettings& settings, std::size_t seen = 0) {
  constexpr std::size_t kFewest = 400;
  std::vector<std::size_t> result{std::min(rows, settings.search_rows)};
  while (result.front() / 2 >= std::max(kFewest, seen)) result.insert(result.begin(), result.front() / 2);
  return result;
}

/// The logs of a search, and the rows and a of the mode with them.
struct FoundKernel {
  KernelLogs logs;
  Matrix<double> Z{};
  Column<double> a{};
  /// A beginning for Newton's method on other rows: the latent function that it expects, but 0 where the label says
  /// the opposite, from where a step would be far too long. None before a mode was found.
  template <class T>
  Column<T> expected(const LabelledInputs<T>& rows) const {
    if (a.size() == 0) return {};
    const Matrix<T> from = Z.template cast<T>();
    const Column<T> f = rows.mean + (kernel<T>(rows.Z, from, logs) * a.template cast<T>().matrix()).array();
    return rows.likelihood.sign * (rows.likelihood.sign * f).max(T(0));
  }
};

KernelSearch new_search(std::size_t variables, const GaussianProcessSettings& settings) {
  KernelLogs centre(variables, std::log(settings.prior_length));
  centre.push_back(std::log(settings.prior_variance));
  return KernelSearch(std::move(centre), settings.prior_width);
}

/// Goes on with a search.
FoundKernel searched(const LabelledInputs<double>& all, const GaussianProcessSettings& settings, KernelSearch& search) {
  using T = Searched;
  FoundKernel found;
  for (const std::size_t count : stages(std::size_t(all.Z.rows()), settings, search.rows())) {
    const LabelledInputs<double> exact = some_rows(all, count, settings.seed);
    const LabelledInputs<T> rows = exact.to<T>();
    Matrices<T> matrices(rows.Z.rows());
    std::map<KernelLogs, Column<T>> a;  // of the modes found
    Column<T> f = found.expected(rows);
    search.run(
        [&](const KernelLogs& logs) {
          fill_kernel(rows.Z, logs, matrices.K);
          const Mode<T> mode = find_mode(matrices, rows.likelihood, rows.mean, start_at(f, rows.mean), kRough);
          if (mode.found) {
            a[logs] = mode.a;
            f = mode.f;
          }
          return evidence_at(rows.Z, matrices, rows.likelihood, mode, logs);
        },
        count, settings.search_steps);
    found = {search.logs(), exact.Z, a[search.logs()].template cast<double>()};
  }
  return found;
}

/// The mode of all rows: Newton's method in single precision, and on from there in double precision. Near the mode a
/// step leaves little more than the square of its gain to be gained.
Mode<double> posterior_mode(Matrices<double>& matrices, const LabelledInputs<double>& rows, const FoundKernel& found,
                            bool with_factor) {
  using T = Searched;
  constexpr double kLastGain = 1e-6;
  Column<double> a;
  {
    const LabelledInputs<T> rough = rows.to<T>();
    Matrices<T> single(rough.Z.rows());
    fill_kernel(rough.Z, found.logs, single.K);
    const Mode<T> near =
        find_mode(single, rough.likelihood, rough.mean, start_at(found.expected(rough), rough.mean), kRough);
    if (near.found) a = near.a.cast<double>();
  }
  fill_kernel(rows.Z, found.logs, matrices.K);
  return find_mode(matrices, rows.likelihood, rows.mean, start_with(matrices.K, rows.likelihood, rows.mean, a),
                   {kLastGain, with_factor});
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
  Matrix<double> Z;
  Column<double> slope, root;  // the slope of the log likelihood at the mode, and that of Mode
  Matrix<double> factor;       // of Matrices at the mode; empty without variances
};

/// Makes models, which only these functions may fill.
struct ProcessMaker {
  static GaussianProcessModel make(const TrainingTable& table, const LabelledInputs<double>& rows,
                                   const FoundKernel& found, bool variances) {
    GaussianProcessModel model;
    model.scaling_ = standardisation_of(table);
    model.logs_ = found.logs;
    Matrices<double> matrices(rows.Z.rows());
    const Mode<double> mode = posterior_mode(matrices, rows, found, variances);
    if (!variances) matrices.factor.resize(0, 0);
    model.rows_ = std::make_shared<const GaussianProcessModel::Rows>(
        GaussianProcessModel::Rows{rows.Z, rows.likelihood.slope(mode.f), mode.root, std::move(matrices.factor)});
    return model;
  }
};

namespace {

/// Row by row.
std::vector<double> listed(const Matrix<double>& Z) {
  std::vector<double> values;
  values.reserve(std::size_t(Z.size()));
  for (Eigen::Index i = 0; i < Z.rows(); ++i)
    for (Eigen::Index v = 0; v < Z.cols(); ++v) values.push_back(Z(i, v));
  return values;
}

Matrix<double> rows_of(const ProcessParts& parts) {
  const std::size_t width = parts.scaling.mean.size();
  GONOGO_ASSERT(parts.inputs.size() == parts.slope.size() * width);
  return matrix_of(parts.inputs, parts.slope.size(), width);
}

}  // namespace

GaussianProcessModel::GaussianProcessModel(const ProcessParts& parts)
    : scaling_(parts.scaling),
      logs_(parts.logs),
      rows_(std::make_shared<const Rows>(Rows{rows_of(parts), column(parts.slope), {}, {}})) {
  GONOGO_ASSERT(logs_.size() == scaling_.mean.size() + 1);
}

ProcessParts GaussianProcessModel::parts() const {
  return {scaling_, logs_, listed(rows_->Z), {rows_->slope.begin(), rows_->slope.end()}};
}

LaplaceEvidence laplace_evidence(std::span<const double> inputs, std::span<const int> label,
                                 std::span<const double> weight, const KernelLogs& logs) {
  GONOGO_ASSERT(inputs.size() == label.size() * (logs.size() - 1) && weight.size() == label.size());
  const Matrix<double> Z = matrix_of(inputs, label.size(), logs.size() - 1);
  const RowLikelihood<double> likelihood = row_likelihood(label, weight);
  Matrices<double> matrices(Z.rows());
  fill_kernel(Z, logs, matrices.K);
  const Column<double> m = mean_or_zero({}, label.size());
  const Mode<double> mode = find_mode(matrices, likelihood, m, start_at<double>({}, m), kExact);
  return evidence_at(Z, matrices, likelihood, mode, logs);
}

GaussianProcessModel gaussian_process_with(const TrainingTable& table, std::span<const int> label,
                                           const KernelLogs& logs, std::span<const double> mean) {
  GONOGO_ASSERT(label.size() == table.row_count() && logs.size() == table.variable_count + 1);
  return ProcessMaker::make(table, labelled(table, label, standardisation_of(table), mean), {logs}, true);
}

GaussianProcessModel fit_gaussian_process(const TrainingTable& table, std::span<const int> label,
                                          const GaussianProcessSettings& settings, std::span<const double> mean,
                                          const KernelSearch* begun) {
  GONOGO_ASSERT(label.size() == table.row_count());
  const LabelledInputs<double> rows = labelled(table, label, standardisation_of(table), mean);
  KernelSearch search = begun ? *begun : new_search(table.variable_count, settings);
  const FoundKernel found = searched(rows, settings, search);
  GaussianProcessModel model = ProcessMaker::make(table, rows, found, settings.variances);
  model.search_ = std::move(search);
  return model;
}

namespace {

/// Calls visit(first, points) for the next kBlock standardised points, [point x variable], again and again.
template <class Visit>
void for_each_block(const Standardisation& scaling, std::span<const double> points, const Visit& visit) {
  const std::size_t width = scaling.mean.size(), block = std::size_t(kBlock) * width;
  for (std::size_t first = 0; first < points.size(); first += block) {
    stop_if_cancelled();
    visit(Eigen::Index(first / width),
          standardised_rows(scaling, points.subspan(first, std::min(block, points.size() - first))));
  }
}

}  // namespace

std::vector<Latent> GaussianProcessModel::latent(std::span<const double> points, std::span<const double> mean) const {
  GONOGO_ASSERT(rows_->factor.size() > 0);
  const Column<double> m = mean_or_zero(mean, points.size() / scaling_.mean.size());
  const double prior = std::exp(logs_.back());
  std::vector<Latent> result;
  for_each_block(scaling_, points, [&](Eigen::Index first, const Matrix<double>& block) {
    Matrix<double> k = kernel(rows_->Z, block, logs_);
    const Column<double> f =
        m.segment(first, block.rows()) + (k.transpose() * rows_->slope.matrix()).array();  // equation 3.21
    k = rows_->root.matrix().asDiagonal() * k;
    rows_->factor.triangularView<Eigen::Lower>().solveInPlace(k);
    const Column<double> less = k.colwise().squaredNorm().transpose().array();
    for (Eigen::Index i = 0; i < f.size(); ++i)
      result.push_back({f[i], std::max(0.0, prior - less[i])});  // equation 3.24
  });
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
  const Column<double> m = mean_or_zero(mean, points.size() / scaling_.mean.size());
  std::vector<double> p;
  for_each_block(scaling_, points, [&](Eigen::Index first, const Matrix<double>& block) {
    const Column<double> f = (kernel(block, rows_->Z, logs_) * rows_->slope.matrix()).array();
    const Column<double> at = sigmoid<double>(m.segment(first, block.rows()) + f);
    p.insert(p.end(), at.begin(), at.end());
  });
  return p;
}

double GaussianProcessModel::operator()(std::span<const double> variables) const { return probabilities(variables)[0]; }

// Regression.

struct GaussianRegression::Rows {
  Matrix<double> Z;
  Column<double> slope;  // (K + noise)^-1 t [row]
};

namespace {

constexpr double kJitter = 1e-8;  // least share of noise in a standardised target

/// Variance of every row's noise, for unit weights 1 / w.
Column<double> noise(const Column<double>& inverse_weight, const std::vector<double>& logs) {
  return inverse_weight * std::exp(logs.back()) + kJitter;
}

/// Writes the smooth kernel and the factor of k + c (1 + z z') + noise. Whether that is positive definite. logs: as
/// GaussianRegression::logs().
bool factorise_trend(const Matrix<double>& Z, const Column<double>& inverse_weight, const std::vector<double>& logs,
                     Matrices<double>& matrices) {
  const double trend = std::exp(logs[logs.size() - 2]);
  fill_kernel(Z, KernelLogs(logs.begin(), logs.end() - 2), matrices.K);
  Matrix<double>& C = matrices.factor;
  for (Eigen::Index j = 0; j < C.cols(); ++j)
    C.col(j).tail(C.rows() - j).array() = matrices.K.col(j).tail(C.rows() - j).array() + trend;
  C.selfadjointView<Eigen::Lower>().rankUpdate(Z, trend);
  C.diagonal().array() += noise(inverse_weight, logs);
  return factorise(C);
}

/// Equation 2.30 and its gradient (5.9). t: standardised targets.
LaplaceEvidence regression_evidence(const Matrix<double>& Z, const Column<double>& t,
                                    const Column<double>& inverse_weight, const std::vector<double>& logs,
                                    Matrices<double>& matrices) {
  if (!factorise_trend(Z, inverse_weight, logs, matrices))
    return {.value = -INFINITY, .gradient = std::vector<double>(logs.size(), 0.0)};
  LaplaceEvidence evidence;
  evidence.value = -half_log_determinant(matrices.factor);
  invert_factored(matrices.factor);
  Matrix<double>& M = matrices.factor;  // 1/2 (a a' - C^-1)
  const Column<double> a = symmetric_product<double>(M, t);
  evidence.value -= 0.5 * scalar_product<double>(t, a);
  const Eigen::Index rows = Z.rows();
  for (Eigen::Index j = 0; j < rows; ++j) {
    auto column = M.col(j).tail(rows - j).array();
    column = 0.5 * (a.tail(rows - j) * a[j] - column);
  }
  const double of_noise = (M.diagonal().array() * inverse_weight).sum();
  Matrix<double> with_ones(rows, Z.cols() + 1);
  with_ones << Z, Column<double>::Ones(rows).matrix();
  const Matrix<double> products = M.selfadjointView<Eigen::Lower>() * with_ones;
  const double of_trend = products.cwiseProduct(with_ones).sum();  // sum_ab M_ab (1 + z_a z_b)
  for (Eigen::Index j = 0; j < rows; ++j) M.col(j).tail(rows - j).array() *= matrices.K.col(j).tail(rows - j).array();
  evidence.gradient = kernel_slopes(Z, M, logs);
  evidence.gradient.push_back(of_trend * std::exp(logs[logs.size() - 2]));
  evidence.gradient.push_back(of_noise * std::exp(logs.back()));
  return evidence;
}

}  // namespace

GaussianRegression fit_gaussian_regression(const TrainingTable& table, std::span<const double> target,
                                           const GaussianProcessSettings& settings) {
  GONOGO_ASSERT(target.size() == table.row_count());
  GaussianRegression model;
  model.scaling_ = standardisation_of(table);
  const Matrix<double> Z = standardised_rows(model.scaling_, table.variables);
  Column<double> t = column(target);
  model.mean_ = t.mean();
  t -= model.mean_;
  model.scale_ = std::max(std::sqrt(t.square().mean()), kJitter);
  t /= model.scale_;
  const Column<double> inverse_weight = 1 / column(table.weight);
  std::vector<double> centre(table.variable_count, std::log(settings.prior_length));
  centre.insert(centre.end(), {0, std::log(0.1), std::log(0.1)});
  KernelSearch search(std::move(centre), settings.prior_width);
  for (const std::size_t count : stages(table.row_count(), settings)) {
    const std::vector<Eigen::Index> some = some_of(table.row_count(), count, settings.seed);
    const Matrix<double> some_Z = Z(some, Eigen::all);
    const Column<double> some_t = t(some), some_weight = inverse_weight(some);
    Matrices<double> matrices(some_Z.rows());
    search.run(
        [&](const std::vector<double>& logs) {
          return regression_evidence(some_Z, some_t, some_weight, logs, matrices);
        },
        count, settings.search_steps);
  }
  model.logs_ = search.logs();
  Matrices<double> matrices(Z.rows());
  if (!factorise_trend(Z, inverse_weight, model.logs_, matrices))
    throw InputError(
        "Gaussian regression: its covariance is not positive definite; are there trials with the same "
        "variables and a very large weight?");
  invert_factored(matrices.factor);
  const Column<double> a = symmetric_product<double>(matrices.factor, t);
  const Column<double> left = (t - a / matrices.factor.diagonal().array()) * model.scale_ + model.mean_;
  model.leave_one_out_.assign(left.begin(), left.end());
  model.rows_ = std::make_shared<const GaussianRegression::Rows>(GaussianRegression::Rows{Z, a});
  return model;
}

GaussianRegression::GaussianRegression(const RegressionParts& parts)
    : scaling_(parts.scaling),
      mean_(parts.mean),
      scale_(parts.scale),
      logs_(parts.logs),
      rows_(std::make_shared<const Rows>(Rows{rows_of(parts), column(parts.slope)})) {
  GONOGO_ASSERT(logs_.size() == scaling_.mean.size() + 3);
}

RegressionParts GaussianRegression::parts() const {
  return {{scaling_, logs_, listed(rows_->Z), {rows_->slope.begin(), rows_->slope.end()}}, mean_, scale_};
}

std::vector<double> GaussianRegression::operator()(std::span<const double> points) const {
  const KernelLogs smooth(logs_.begin(), logs_.end() - 2);
  const double trend = std::exp(logs_[logs_.size() - 2]);
  // c (1 + z z') a of all rows at once.
  const Column<double>& a = rows_->slope;
  const Eigen::VectorXd tilt = trend * (rows_->Z.transpose() * a.matrix());
  const double level = trend * a.sum();
  std::vector<double> result;
  for_each_block(scaling_, points, [&](Eigen::Index, const Matrix<double>& block) {
    const Column<double> f = (kernel(block, rows_->Z, smooth) * a.matrix() + block * tilt).array() + level;
    for (const double x : f) result.push_back(x * scale_ + mean_);
  });
  return result;
}

}  // namespace gonogo::learning
