#include "learning/rbm/gaussian_process.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/progress.h"
#include "base/units.h"
#include "learning/rbm/tensors.h"

namespace gonogo::learning {
namespace {

constexpr std::uint64_t kSearchRows = 0x67707277;  // stream of random numbers
constexpr std::int64_t kBlock = 512;               // points whose variances are worked out together
constexpr int kNewtonSteps = 100;
constexpr auto kSearched = torch::kFloat32;  // of a classifier's matrices while its lengths are searched

// Kernels.

/// Columns of rows times the inverse lengths, each padded by zeros to whole blocks: [variable][row]. Variables that do
/// not differ between rows are left out.
template <class T>
struct Columns {
  typedef T Lanes __attribute__((vector_size(32)));  // an alias would lose the attribute
  static constexpr std::int64_t kLanes = sizeof(Lanes) / sizeof(T), kRegisters = 4, kBlock = kLanes * kRegisters;
  std::int64_t padded;
  std::vector<T> value;
  Columns(const torch::Tensor& rows, const KernelLogs& logs, const std::vector<std::int64_t>& variables)
      : padded((rows.size(0) + kBlock - 1) / kBlock * kBlock), value(std::size_t(padded) * variables.size(), T(0)) {
    const auto cell = rows.accessor<T, 2>();
    T* column = value.data();
    for (const std::int64_t v : variables) {
      const double inverse = std::exp(-logs[std::size_t(v)]);
      for (std::int64_t i = 0; i < rows.size(0); ++i) column[i] = T(cell[i][v] * inverse);
      column += padded;
    }
  }
};

/// Variables in which a row of a differs from a row of b.
template <class T>
std::vector<std::int64_t> differing(const torch::Tensor& a, const torch::Tensor& b) {
  std::vector<std::int64_t> variables;
  const auto left = a.accessor<T, 2>(), right = b.accessor<T, 2>();
  for (std::int64_t v = 0; v < a.size(1); ++v) {
    bool same = true;
    for (std::int64_t i = 0; same && i < a.size(0); ++i) same = left[i][v] == right[0][v];
    for (std::int64_t i = 0; same && i < b.size(0); ++i) same = right[i][v] == right[0][v];
    if (!same) variables.push_back(v);
  }
  return variables;
}

/// Writes log k of every row of a with every row of b: [row of a x row of b].
template <class T>
void fill_log_kernel(const torch::Tensor& a, const torch::Tensor& b, const KernelLogs& logs, torch::Tensor& result) {
  using Lanes = typename Columns<T>::Lanes;
  constexpr std::int64_t kLanes = Columns<T>::kLanes, kRegisters = Columns<T>::kRegisters, kBlock = Columns<T>::kBlock;
  const std::int64_t rows = a.size(0), columns = b.size(0);
  if (rows == 0 || columns == 0) return;
  const std::vector<std::int64_t> variables = differing<T>(a, b);
  const Columns<T> left(a, logs, variables), right(b, logs, variables);
  const T log_variance = T(logs.back());
  T* out = result.data_ptr<T>();
  for (std::int64_t i = 0; i < rows; ++i, out += columns)
    for (std::int64_t first = 0; first < columns; first += kBlock) {
      Lanes square[kRegisters] = {};
      const T *x = left.value.data() + i, *y = right.value.data() + first;
      for (std::size_t v = 0; v < variables.size(); ++v, x += left.padded, y += right.padded)
#pragma GCC unroll 4
        for (std::int64_t k = 0; k < kRegisters; ++k) {
          Lanes apart;
          std::memcpy(&apart, y + k * kLanes, sizeof apart);
          apart = *x - apart;
          square[k] += apart * apart;
        }
      for (Lanes& lanes : square) lanes = log_variance - T(0.5) * lanes;
      std::memcpy(out + first, square, std::size_t(std::min(kBlock, columns - first)) * sizeof(T));
    }
}

/// k of every row of a with every row of b. a: [n x variable], b: [m x variable]; result [n x m].
void fill_kernel(const torch::Tensor& a, const torch::Tensor& b, const KernelLogs& logs, torch::Tensor& result) {
  AT_DISPATCH_FLOATING_TYPES(a.scalar_type(), "kernel", [&] { fill_log_kernel<scalar_t>(a, b, logs, result); });
  result.exp_();
}
torch::Tensor kernel(const torch::Tensor& a, const torch::Tensor& b, const KernelLogs& logs) {
  torch::Tensor result = torch::empty({a.size(0), b.size(0)}, a.options());
  fill_kernel(a, b, logs, result);
  return result;
}

/// Matrices of a number of rows. They are written again and again, since fresh memory of megabytes costs as much as a
/// pass over them.
struct Matrices {
  torch::Tensor K;          // the kernel
  torch::Tensor lower;      // a Cholesky factor
  torch::Tensor symmetric;  // what it is the factor of, then the inverse of that
  torch::Tensor failure = torch::zeros({}, torch::kInt32);
  Matrices(std::int64_t rows, torch::Dtype type)
      : K(torch::empty({rows, rows}, type)),
        lower(torch::empty({rows, rows}, type).t()),  // in the order of LAPACK, so that nothing is reordered
        symmetric(torch::empty({rows, rows}, type)) {}

  /// Factorises `symmetric`. Whether it is positive definite.
  bool factorise() {
    torch::Tensor transposed = symmetric.t();
    at::linalg_cholesky_ex_out(lower, failure, transposed);
    return failure.item<int>() == 0;
  }
  /// Overwrites `symmetric` with its inverse.
  void invert() {
    torch::Tensor transposed = symmetric.t();
    at::cholesky_inverse_out(transposed, lower);
  }
};

// Laplace's approximation of the posterior. Equations: Rasmussen & Williams (2006), chapters 3 and 5.

/// The rows' log likelihood sum_n w_n log sigmoid(y_n f_n) at f, with its derivatives, y of {-1, 1}.
struct RowLikelihood {
  torch::Tensor sign, weight;  // y, w [row]
  double value(const torch::Tensor& f) const;
  torch::Tensor slope(const torch::Tensor& f) const;      // d / df
  torch::Tensor curvature(const torch::Tensor& f) const;  // W = -d2 / df2, > 0
  torch::Tensor third(const torch::Tensor& f) const;      // d3 / df3
};

/// The mode of the posterior: f = m + K a, with root = W^1/2. Matrices::lower is then the Cholesky factor of
/// B = I + W^1/2 K W^1/2.
struct Mode {
  torch::Tensor f{}, a{}, root{};
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
constexpr Precision kRough = {1e-7, false};

double scalar_product(const torch::Tensor& a, const torch::Tensor& b) { return torch::dot(a, b).item<double>(); }

/// B^-1 of a vector, by the Cholesky factor of B.
torch::Tensor solve(const torch::Tensor& lower, const torch::Tensor& b) {
  return torch::cholesky_solve(b.unsqueeze(1), lower).squeeze(1);
}

void factorise(Matrices& matrices, const torch::Tensor& curvature, Mode& mode) {
  mode.root = curvature.sqrt();
  AT_DISPATCH_FLOATING_TYPES(curvature.scalar_type(), "factorise", [&] {
    const scalar_t *root = mode.root.data_ptr<scalar_t>(), *from = matrices.K.data_ptr<scalar_t>();
    scalar_t* to = matrices.symmetric.data_ptr<scalar_t>();
    const std::int64_t rows = curvature.size(0);
    for (std::int64_t i = 0; i < rows; ++i, from += rows, to += rows)
      for (std::int64_t j = 0; j < rows; ++j) to[j] = from[j] * (root[i] * root[j]);
  });
  matrices.symmetric.diagonal().add_(1);
  mode.found = matrices.factorise();
}

/// m: the mean of f.
double log_posterior(const RowLikelihood& likelihood, const torch::Tensor& a, const torch::Tensor& f,
                     const torch::Tensor& m) {
  return likelihood.value(f) - 0.5 * scalar_product(a, f - m);
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
/// lowers the posterior is halved. matrices: of the kernel.
Mode find_mode(Matrices& matrices, const RowLikelihood& likelihood, const torch::Tensor& m, const torch::Tensor& start,
               const Precision& precision) {
  const torch::Tensor& K = matrices.K;
  Mode mode{.f = start.defined() ? start : m, .log_posterior = -INFINITY};
  for (int step = 0; step < kNewtonSteps; ++step) {
    const torch::Tensor W = likelihood.curvature(mode.f);
    factorise(matrices, W, mode);
    if (!mode.found) return mode;
    const torch::Tensor b = W * (mode.f - m) + likelihood.slope(mode.f);
    torch::Tensor a = b - mode.root * solve(matrices.lower, mode.root * torch::mv(K, b));
    torch::Tensor f = m + torch::mv(K, a);
    double now = log_posterior(likelihood, a, f, m);
    for (int half = 0; half < 30 && mode.a.defined() && now < mode.log_posterior; ++half) {
      a = 0.5 * (a + mode.a);
      f = 0.5 * (f + mode.f);
      now = log_posterior(likelihood, a, f, m);
    }
    const bool done = std::abs(now - mode.log_posterior) <= precision.gain * (1 + std::abs(now));
    mode.a = a;
    mode.f = f;
    mode.log_posterior = now;
    mode.found = std::isfinite(now);
    if (done || !mode.found) break;
  }
  if (precision.factor_at_mode) factorise(matrices, likelihood.curvature(mode.f), mode);
  return mode;
}

/// sum_ab Q_ab (z_a - z_b)^2 / l^2 of every variable, which are the derivatives by log l_v where Q = M K by elements;
/// then sum_ab Q_ab.
std::vector<double> kernel_slopes(const torch::Tensor& Z, const torch::Tensor& Q, const std::vector<double>& logs) {
  const std::int64_t variables = Z.size(1);
  const torch::Tensor ones = torch::ones({Z.size(0), 1}, Z.options()), squares = Z.square();
  // Columns: Q Z, Q Z^2 and Q 1.
  const torch::Tensor sums = torch::matmul(Q, torch::cat({Z, squares, ones}, 1));
  const torch::Tensor row_sums = sums.slice(1, 2 * variables);
  const std::vector<double> apart =
      values_of((squares * row_sums + sums.slice(1, variables, 2 * variables) - 2 * Z * sums.slice(1, 0, variables))
                    .sum(0)
                    .to(torch::kFloat64));
  std::vector<double> slopes;
  for (std::size_t v = 0; v < apart.size(); ++v) slopes.push_back(apart[v] * std::exp(-2 * logs[v]));
  slopes.push_back(row_sums.sum().item<double>());
  return slopes;
}

/// Overwrites R = W^1/2 B^-1 W^1/2, of which B^-1 is given, with Q = M K by elements for
/// M = v t' + 1/2 a a' - 1/2 R.
template <class T>
void weigh_kernel(const T* K, const T* root, const T* v, const T* t, const T* a, std::int64_t rows, T* inverse) {
  for (std::int64_t i = 0; i < rows; ++i, K += rows, inverse += rows)
    for (std::int64_t j = 0; j < rows; ++j)
      inverse[j] = K[j] * (v[i] * t[j] + T(0.5) * (a[i] * a[j] - inverse[j] * (root[i] * root[j])));
}

/// Evidence and gradient at a mode (equation 3.32 and algorithm 5.1). Z: [row x variable]. Overwrites the matrices but
/// for the kernel.
LaplaceEvidence evidence_at(const torch::Tensor& Z, Matrices& matrices, const RowLikelihood& likelihood,
                            const Mode& mode, const KernelLogs& logs) {
  if (!mode.found) return {.value = -INFINITY, .gradient = std::vector<double>(logs.size(), 0.0)};
  LaplaceEvidence evidence;
  evidence.value = mode.log_posterior - matrices.lower.diagonal().log().sum().item<double>();
  matrices.invert();
  const torch::Tensor &K = matrices.K, &inverse = matrices.symmetric;  // of B
  // (K^-1 + W)^-1 = W^-1/2 (I - B^-1) W^-1/2: its diagonal without another system of equations.
  const torch::Tensor variance = (1 - inverse.diagonal()) / mode.root.square().clamp_min(1e-12);
  const torch::Tensor s2 = 0.5 * variance * likelihood.third(mode.f);
  // Every derivative is sum_ab M_ab dK_ab: s1 and s2' s3 of algorithm 5.1 are linear in dK.
  const torch::Tensor v = s2 - mode.root * torch::mv(inverse, mode.root * torch::mv(K, s2));
  const torch::Tensor slope = likelihood.slope(mode.f);
  AT_DISPATCH_FLOATING_TYPES(K.scalar_type(), "evidence", [&] {
    weigh_kernel(K.data_ptr<scalar_t>(), mode.root.data_ptr<scalar_t>(), v.data_ptr<scalar_t>(),
                 slope.data_ptr<scalar_t>(), mode.a.data_ptr<scalar_t>(), K.size(0), inverse.data_ptr<scalar_t>());
  });
  evidence.gradient = kernel_slopes(Z, inverse, logs);
  return evidence;
}

// The process on a table.

/// Rows of a table as tensors.
struct LabelledInputs {
  torch::Tensor Z;  // [row x variable], standardised
  RowLikelihood likelihood;
  torch::Tensor mean;  // of f [row]
  LabelledInputs to(torch::Dtype type) const {
    return {Z.to(type), {likelihood.sign.to(type), likelihood.weight.to(type)}, mean.to(type)};
  }
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

// Search of lengths and variances.

/// Numbers of rows of the stages of a search. Each begins where the one before ended: most steps are then taken on few
/// rows, whose matrices cost an eighth.
std::vector<std::size_t> stages(std::size_t rows, const GaussianProcessSettings& settings) {
  constexpr std::size_t kFewest = 200;
  std::vector<std::size_t> result{std::min(rows, settings.search_rows)};
  while (result.front() / 2 >= kFewest) result.insert(result.begin(), result.front() / 2);
  return result;
}

/// The logs of a search, and the rows and a of the mode found last.
struct FoundKernel {
  KernelLogs logs;
  torch::Tensor Z{}, a{};
  /// The latent function that it expects of rows. Z: [row x variable]
  torch::Tensor expected(const LabelledInputs& rows) const {
    if (!a.defined()) return {};
    const auto type = rows.Z.scalar_type();
    return rows.mean + torch::mv(kernel(rows.Z, this->Z.to(type), logs), a.to(type));
  }
};

FoundKernel searched(const LabelledInputs& all, const GaussianProcessSettings& settings) {
  KernelLogs centre(std::size_t(all.Z.size(1)), std::log(settings.prior_length));
  centre.push_back(std::log(settings.prior_variance));
  KernelSearch search(std::move(centre), settings.prior_width);
  FoundKernel found;
  for (const std::size_t count : stages(std::size_t(all.Z.size(0)), settings)) {
    const LabelledInputs rows = some_rows(all, count, settings.seed).to(kSearched);
    Matrices matrices(rows.Z.size(0), kSearched);
    torch::Tensor start = found.expected(rows), a;
    search.run(
        [&](const KernelLogs& logs) {
          fill_kernel(rows.Z, rows.Z, logs, matrices.K);
          if (a.defined()) start = rows.mean + torch::mv(matrices.K, a);
          const Mode mode = find_mode(matrices, rows.likelihood, rows.mean, start, kRough);
          if (mode.found) a = mode.a;
          return evidence_at(rows.Z, matrices, rows.likelihood, mode, logs);
        },
        count, settings.search_steps);
    found = {search.logs(), rows.Z, a};
  }
  return found;
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

/// Makes models, which only these functions may fill.
struct ProcessMaker {
  static GaussianProcessModel make(const TrainingTable& table, const LabelledInputs& rows, const FoundKernel& found) {
    GaussianProcessModel model;
    model.scaling_ = standardisation_of(table);
    model.logs_ = found.logs;
    Matrices matrices(rows.Z.size(0), torch::kFloat64);
    fill_kernel(rows.Z, rows.Z, found.logs, matrices.K);
    const Mode mode = find_mode(matrices, rows.likelihood, rows.mean, found.expected(rows), kExact);
    model.rows_ = std::make_shared<const GaussianProcessModel::Rows>(
        GaussianProcessModel::Rows{rows.Z, rows.likelihood.slope(mode.f), mode.root, matrices.lower});
    return model;
  }
};

LaplaceEvidence laplace_evidence(std::span<const double> inputs, std::span<const int> label,
                                 std::span<const double> weight, const KernelLogs& logs) {
  GONOGO_ASSERT(inputs.size() == label.size() * (logs.size() - 1) && weight.size() == label.size());
  const OneTorchThread one_thread;
  const torch::Tensor Z = torch::tensor(std::vector<double>(inputs.begin(), inputs.end()), torch::kFloat64)
                              .reshape({std::int64_t(label.size()), std::int64_t(logs.size()) - 1});
  const RowLikelihood likelihood = row_likelihood(label, weight);
  Matrices matrices(Z.size(0), torch::kFloat64);
  fill_kernel(Z, Z, logs, matrices.K);
  return evidence_at(Z, matrices, likelihood,
                     find_mode(matrices, likelihood, mean_or_zero({}, label.size()), {}, kExact), logs);
}

GaussianProcessModel gaussian_process_with(const TrainingTable& table, std::span<const int> label,
                                           const KernelLogs& logs, std::span<const double> mean) {
  GONOGO_ASSERT(label.size() == table.row_count() && logs.size() == table.variable_count + 1);
  const OneTorchThread one_thread;
  return ProcessMaker::make(table, labelled(table, label, standardisation_of(table), mean), {logs});
}

GaussianProcessModel fit_gaussian_process(const TrainingTable& table, std::span<const int> label,
                                          const GaussianProcessSettings& settings, std::span<const double> mean) {
  GONOGO_ASSERT(label.size() == table.row_count());
  const OneTorchThread one_thread;
  const LabelledInputs rows = labelled(table, label, standardisation_of(table), mean);
  return ProcessMaker::make(table, rows, searched(rows, settings));
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

/// Overwrites C^-1 with M = 1/2 (a a' - C^-1).
void to_slopes(const torch::Tensor& a, torch::Tensor& inverse) {
  const std::int64_t rows = a.size(0);
  const double* at = a.data_ptr<double>();
  double* out = inverse.data_ptr<double>();
  for (std::int64_t i = 0; i < rows; ++i, out += rows)
    for (std::int64_t j = 0; j < rows; ++j) out[j] = 0.5 * (at[i] * at[j] - out[j]);
}

/// Equation 2.30 and its gradient (5.9). t: standardised targets.
LaplaceEvidence regression_evidence(const torch::Tensor& Z, const torch::Tensor& t, const torch::Tensor& inverse_weight,
                                    const std::vector<double>& logs, Matrices& matrices) {
  const KernelLogs smooth(logs.begin(), logs.end() - 2);
  const double trend = std::exp(logs[logs.size() - 2]), level = std::exp(logs.back());
  fill_kernel(Z, Z, smooth, matrices.K);
  torch::addmm_out(matrices.symmetric, matrices.K, Z, Z.t(), 1, trend);
  matrices.symmetric.add_(trend).diagonal().add_(noise(inverse_weight, logs));
  if (!matrices.factorise()) return {.value = -INFINITY, .gradient = std::vector<double>(logs.size(), 0.0)};
  matrices.invert();
  torch::Tensor& M = matrices.symmetric;
  const torch::Tensor a = torch::mv(M, t);
  LaplaceEvidence evidence;
  evidence.value = -0.5 * scalar_product(t, a) - matrices.lower.diagonal().log().sum().item<double>();
  to_slopes(a, M);
  const torch::Tensor of_noise = (M.diagonal() * inverse_weight).sum();
  const torch::Tensor with_ones = torch::cat({Z, torch::ones({Z.size(0), 1}, Z.options())}, 1);
  const torch::Tensor of_trend = (torch::matmul(M, with_ones) * with_ones).sum();  // sum_ab M_ab (1 + z_a z_b)
  evidence.gradient = kernel_slopes(Z, M.mul_(matrices.K), logs);
  evidence.gradient.push_back(of_trend.item<double>() * trend);
  evidence.gradient.push_back(of_noise.item<double>() * level);
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
  std::vector<double> centre(table.variable_count, std::log(settings.prior_length));
  centre.insert(centre.end(), {0, std::log(0.1), std::log(0.1)});
  KernelSearch search(std::move(centre), settings.prior_width);
  for (const std::size_t count : stages(table.row_count(), settings)) {
    const torch::Tensor some = some_of(table.row_count(), count, settings.seed);
    const torch::Tensor some_Z = Z.index_select(0, some), some_t = t.index_select(0, some);
    const torch::Tensor some_weight = inverse_weight.index_select(0, some);
    Matrices matrices(some_Z.size(0), torch::kFloat64);
    search.run(
        [&](const std::vector<double>& logs) {
          return regression_evidence(some_Z, some_t, some_weight, logs, matrices);
        },
        count, settings.search_steps);
  }
  model.logs_ = search.logs();
  torch::Tensor K = trend_kernel(Z, Z, model.logs_);
  K.diagonal().add_(noise(inverse_weight, model.logs_));
  const torch::Tensor inverse = torch::cholesky_inverse(torch::linalg_cholesky(K.t())), a = torch::mv(inverse, t);
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
