#include "learning/rbm/regression/baselines.h"

#include <algorithm>
#include <array>
#include <set>

#include "base/error.h"
#include "base/math/random.h"
#include "learning/rbm/regression/symmetric.h"

namespace gonogo::learning {

Standardisation standardisation_of(const TrainingTable& table) {
  const std::size_t variables = table.variable_count;
  std::vector<double> square(variables, 0.0), count(variables, 0.0);
  Standardisation result{std::vector<double>(variables, 0.0), std::vector<double>(variables, 1.0)};
  const auto for_each_known = [&](const auto& visit) {
    for (std::size_t n = 0; n < table.row_count(); ++n)
      for (std::size_t v = 0; v < variables; ++v)
        if (const double x = table.row(n)[v]; !std::isnan(x)) visit(v, x);
  };
  for_each_known([&](std::size_t v, double x) {
    result.mean[v] += x;
    count[v] += 1;
  });
  for (std::size_t v = 0; v < variables; ++v)
    if (count[v] > 0) result.mean[v] /= count[v];
  for_each_known([&](std::size_t v, double x) { square[v] += (x - result.mean[v]) * (x - result.mean[v]); });
  for (std::size_t v = 0; v < variables; ++v)
    if (square[v] > 0) result.scale[v] = std::sqrt(square[v] / count[v]);
  return result;
}

double LogisticModel::log_odds(std::span<const double> variables) const {
  double sum = weight.back();
  for (std::size_t v = 0; v < variables.size(); ++v) sum += weight[v] * standardised(v, variables[v]);
  return sum;
}

double LogisticModel::operator()(std::span<const double> variables) const {
  return 1 / (1 + std::exp(-log_odds(variables)));
}

namespace {

/// Columns that are not zero throughout once they are standardised. The others have no weight, and products of many
/// variables that a table does not use would make the system large.
std::vector<std::size_t> varying_columns(const TrainingTable& table, const Standardisation& scaling) {
  std::vector<std::size_t> columns;
  for (std::size_t v = 0; v < table.variable_count; ++v)
    for (std::size_t n = 0; n < table.row_count(); ++n)
      if (scaling.standardised(v, table.row(n)[v]) != 0) {
        columns.push_back(v);
        break;
      }
  return columns;
}

Column<double> sigmoid(const Column<double>& x) { return (1 + (-x).exp()).inverse(); }

/// Newton's method on a table, for one ridge after the other.
class LogisticFit {
 public:
  LogisticFit(const TrainingTable& table, std::span<const int> label)
      : scaling_(standardisation_of(table)),
        varying_(varying_columns(table, scaling_)),
        x_(Matrix<double>::Ones(Eigen::Index(table.row_count()), Eigen::Index(varying_.size()) + 1)),
        y_(Eigen::Map<const Eigen::ArrayXi>(label.data(), Eigen::Index(label.size())).cast<double>()),
        row_weight_(Eigen::Map<const Column<double>>(table.weight.data(), Eigen::Index(table.weight.size()))) {
    GONOGO_ASSERT(label.size() == table.row_count());
    for (std::size_t n = 0; n < table.row_count(); ++n)
      for (std::size_t v = 0; v < varying_.size(); ++v)
        x_(Eigen::Index(n), Eigen::Index(v)) = scaling_.standardised(varying_[v], table.row(n)[varying_[v]]);
  }

  LogisticModel at(double ridge) const {
    constexpr double kConstant = 1e-9;  // keeps the system solvable when only one class occurs
    std::vector<double> all(scaling_.mean.size(), ridge);
    all.push_back(kConstant);
    return at(all, Column<double>::Zero(x_.rows()));
  }

  /// ridge: [variable count + 1]; given: log odds of every row, to which the model adds
  LogisticModel at(std::span<const double> ridge, const Column<double>& given) const {
    Column<double> penalty(x_.cols()), w = Column<double>::Zero(x_.cols());
    for (std::size_t v = 0; v < varying_.size(); ++v) penalty[Eigen::Index(v)] = ridge[varying_[v]];
    penalty[x_.cols() - 1] = ridge.back();
    for (int iteration = 0; iteration < 50; ++iteration) {
      const Column<double> step = newton_step(w, penalty, given);
      w -= step;
      if (step.abs().maxCoeff() < 1e-10) break;
    }
    LogisticModel model;
    static_cast<Standardisation&>(model) = scaling_;
    model.weight.assign(scaling_.mean.size() + 1, 0.0);
    for (std::size_t v = 0; v < varying_.size(); ++v) model.weight[varying_[v]] = w[Eigen::Index(v)];
    model.weight.back() = w[x_.cols() - 1];
    return model;
  }

 private:
  Column<double> newton_step(const Column<double>& w, const Column<double>& penalty,
                             const Column<double>& given) const {
    const Column<double> p = sigmoid(given + (x_ * w.matrix()).array()), share = (row_weight_ * p * (1 - p)).sqrt();
    const Column<double> gradient = (x_.transpose() * (row_weight_ * (p - y_)).matrix()).array() + penalty * w;
    Matrix<double> curvature = penalty.matrix().asDiagonal();
    curvature.selfadjointView<Eigen::Lower>().rankUpdate((share.matrix().asDiagonal() * x_).transpose());
    return curvature.selfadjointView<Eigen::Lower>().ldlt().solve(gradient.matrix()).array().max(-5).min(5);
  }

  Standardisation scaling_;
  std::vector<std::size_t> varying_;
  Matrix<double> x_;  // [row x varying column], then ones
  Column<double> y_, row_weight_;
};

}  // namespace

LogisticModel fit_logistic(const TrainingTable& table, std::span<const int> label, double ridge) {
  return LogisticFit(table, label).at(ridge);
}

LogisticModel fit_logistic(const TrainingTable& table, std::span<const int> label, std::span<const double> given,
                           std::span<const double> ridge) {
  GONOGO_ASSERT(given.size() == table.row_count() && ridge.size() == table.variable_count + 1);
  return LogisticFit(table, label)
      .at(ridge, Eigen::Map<const Column<double>>(given.data(), Eigen::Index(given.size())));
}

namespace {

constexpr std::size_t kFolds = 5;
constexpr double kLeast = 1e-12;  // of a probability, so that one wrong certainty does not decide

/// z, then all products; NaN where a variable is unknown. Returns [variables + variables (variables + 1) / 2].
std::vector<double> terms_of(const Standardisation& scaling, std::span<const double> variables) {
  std::vector<double> terms;
  for (std::size_t v = 0; v < variables.size(); ++v)
    terms.push_back(std::isnan(variables[v]) ? NAN : scaling.standardised(v, variables[v]));
  for (std::size_t a = 0; a < variables.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b) terms.push_back(terms[a] * terms[b]);
  return terms;
}

TrainingTable table_of_terms(const TrainingTable& table, const Standardisation& scaling) {
  TrainingTable result;
  result.variable_count = table.variable_count + table.variable_count * (table.variable_count + 1) / 2;
  result.outcome = table.outcome;
  result.weight = table.weight;
  result.group = table.group;
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    const std::vector<double> terms = terms_of(scaling, table.row(n));
    result.variables.insert(result.variables.end(), terms.begin(), terms.end());
  }
  return result;
}

constexpr int kRidges = 9;  // 10^-2.5, 10^-2, ..., 10^1.5
double ridge_number(int k) { return std::pow(10, 0.5 * (k - 5)); }

/// Adds the sum of -w log P(label) over the rows of fold `without` for every ridge, by models without these rows.
void add_held_out_loss(const TrainingTable& terms, std::span<const int> label, const std::vector<std::size_t>& fold,
                       std::size_t without, std::array<double, kRidges>& loss) {
  const LogisticFit fit = fit_without(terms, label, fold, without,
                                      [](const TrainingTable& rows, auto labels) { return LogisticFit(rows, labels); });
  for (int k = 0; k < kRidges; ++k) {
    const LogisticModel model = fit.at(ridge_number(k));
    for (std::size_t n = 0; n < fold.size(); ++n) {
      if (fold[n] != without) continue;
      const double p = model(terms.row(n));
      loss[std::size_t(k)] -= terms.weight[n] * std::log(std::max(kLeast, label[n] ? p : 1 - p));
    }
  }
}

double chosen_ridge(const TrainingTable& terms, std::span<const int> label, std::uint64_t seed) {
  const std::size_t groups = std::set<std::uint64_t>(terms.group.begin(), terms.group.end()).size();
  const std::size_t folds = std::min(kFolds, groups);
  if (folds < 2) return 1;  // one group: nothing to hold out
  const std::vector<std::size_t> fold = assign_folds(terms, folds, seed);
  std::array<double, kRidges> loss{};
  for (std::size_t f = 0; f < folds; ++f) add_held_out_loss(terms, label, fold, f, loss);
  return ridge_number(int(std::min_element(loss.begin(), loss.end()) - loss.begin()));
}

}  // namespace

double QuadraticModel::operator()(std::span<const double> variables) const {
  return std::clamp(of_terms(terms_of(*this, variables)), kLeast, 1 - kLeast);
}

QuadraticModel fit_quadratic(const TrainingTable& table, std::span<const int> label, std::uint64_t seed) {
  QuadraticModel model;
  static_cast<Standardisation&>(model) = standardisation_of(table);
  const TrainingTable terms = table_of_terms(table, model);
  model.ridge = chosen_ridge(terms, label, seed);
  model.of_terms = fit_logistic(terms, label, model.ridge);
  return model;
}

namespace {

struct LabelledRows {
  Matrix<double> inputs;         // [row x variable]
  Column<double> label, weight;  // [row]
};

LabelledRows labelled_rows(const TrainingTable& table, std::span<const int> label, const Standardisation& scaling,
                           const std::vector<std::size_t>& rows) {
  const auto count = Eigen::Index(rows.size());
  LabelledRows result{Matrix<double>(count, Eigen::Index(table.variable_count)), Column<double>(count),
                      Column<double>(count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const std::size_t n = rows[std::size_t(k)];
    for (std::size_t v = 0; v < table.variable_count; ++v)
      result.inputs(k, Eigen::Index(v)) = scaling.standardised(v, table.row(n)[v]);
    result.label[k] = label[n];
    result.weight[k] = table.weight[n];
  }
  return result;
}

/// A, B, w and c of a network, one after the other in one array.
struct Network {
  Eigen::Index hidden, variables;
  Column<double> numbers;

  /// Standard normal weights over the root of the number of inputs; no biases.
  Network(Eigen::Index inputs, const NetworkSettings& settings)
      : hidden(Eigen::Index(settings.hidden)),
        variables(inputs),
        numbers(Column<double>::Zero(hidden * (variables + 2) + 1)) {
    for (Eigen::Index k = 0; k < hidden * variables; ++k)  // row by row
      numbers[k % variables * hidden + k / variables] =
          random_normal(settings.seed, 1, std::uint64_t(k), double(variables));
    for (Eigen::Index j = 0; j < hidden; ++j)
      numbers[hidden * (variables + 1) + j] = random_normal(settings.seed, 2, std::uint64_t(j), double(hidden));
  }
  Eigen::Map<const Matrix<double>> A() const { return {numbers.data(), hidden, variables}; }
  auto B() const { return numbers.segment(hidden * variables, hidden); }
  auto w() const { return numbers.segment(hidden * (variables + 1), hidden); }
  double c() const { return numbers[numbers.size() - 1]; }

  /// tanh(B + A z): [row x hidden].
  Matrix<double> units(const Matrix<double>& inputs) const {
    const Matrix<double> field = (inputs * A().transpose()).rowwise() + B().matrix().transpose();
    return 1 - 2 / (1 + (2 * field.array()).exp());
  }
  Column<double> logit(const Matrix<double>& units) const { return (units * w().matrix()).array() + c(); }

  /// Mean of -w log P(label).
  double loss(const LabelledRows& rows) const {
    const Column<double> z = logit(units(rows.inputs));
    return (rows.weight * (z.max(0) + (-z.abs()).exp().log1p() - rows.label * z)).mean();
  }
  /// Of the loss plus decay (|A|^2 + |w|^2), in the order of `numbers`.
  Column<double> gradient(const LabelledRows& rows, double decay) const {
    const Matrix<double> h = units(rows.inputs);
    const Column<double> of_logit = rows.weight * (sigmoid(logit(h)) - rows.label) / double(rows.label.size());
    const Matrix<double> of_field = (of_logit.matrix() * w().matrix().transpose()).array() * (1 - h.array().square());
    Column<double> result(numbers.size());
    Eigen::Map<Matrix<double>>(result.data(), hidden, variables) = of_field.transpose() * rows.inputs + 2 * decay * A();
    result.segment(hidden * variables, hidden) = of_field.colwise().sum().transpose().array();
    result.segment(hidden * (variables + 1), hidden) = (h.transpose() * of_logit.matrix()).array() + 2 * decay * w();
    result[numbers.size() - 1] = of_logit.sum();
    return result;
  }
};

/// Trains for `epochs` by Adam (Kingma & Ba 2015, algorithm 1); look(epoch, network) after each.
template <class Look>
Network trained(const LabelledRows& rows, const NetworkSettings& settings, std::size_t epochs, Look look) {
  constexpr double kFirst = 0.9, kSecond = 0.999, kLeastRoot = 1e-8;
  Network network(rows.inputs.cols(), settings);
  const double decay = settings.weight_decay / (2 * double(rows.inputs.rows()));
  Column<double> mean = Column<double>::Zero(network.numbers.size()), square = mean;
  for (std::size_t epoch = 1; epoch <= epochs; ++epoch) {
    const Column<double> gradient = network.gradient(rows, decay);
    mean = kFirst * mean + (1 - kFirst) * gradient;
    square = kSecond * square + (1 - kSecond) * gradient.square();
    const double of_mean = 1 - std::pow(kFirst, double(epoch)), of_square = 1 - std::pow(kSecond, double(epoch));
    network.numbers -= settings.learning_rate / of_mean * mean / ((square / of_square).sqrt() + kLeastRoot);
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
  const LabelledRows held_out = labelled_rows(table, label, scaling, check);
  double lowest = INFINITY;
  std::size_t best = 1;
  trained(labelled_rows(table, label, scaling, fit), settings, settings.max_epochs,
          [&](std::size_t epoch, const Network& network) {
            if (epoch % 5 != 0) return;
            const double loss = network.loss(held_out);
            if (loss < lowest) {
              lowest = loss;
              best = epoch;
            }
          });
  return best;
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
  NetworkModel model;
  static_cast<Standardisation&>(model) = standardisation_of(table);
  model.hidden = settings.hidden;
  model.epochs = best_epoch(table, label, model, settings);
  const Network network = trained(labelled_rows(table, label, model, permutation(table.row_count(), settings.seed, 3)),
                                  settings, model.epochs, [](std::size_t, const Network&) {});
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> by_unit = network.A();
  model.input_weight.assign(by_unit.data(), by_unit.data() + by_unit.size());
  model.input_bias.assign(network.B().begin(), network.B().end());
  model.output_weight.assign(network.w().begin(), network.w().end());
  model.output_weight.push_back(network.c());
  return model;
}

}  // namespace gonogo::learning
