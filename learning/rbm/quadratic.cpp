#include "learning/rbm/quadratic.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace gonogo::learning {
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

/// Sum over rows of -w log P(label), each by a model without the row's fold.
double held_out_loss(const TrainingTable& terms, std::span<const int> label, const std::vector<std::size_t>& fold,
                     std::size_t folds, double ridge) {
  const std::vector<double> p = cross_validate_logistic(terms, label, fold, folds, ridge);
  double loss = 0;
  for (std::size_t n = 0; n < p.size(); ++n)
    loss -= terms.weight[n] * std::log(std::max(kLeast, label[n] ? p[n] : 1 - p[n]));
  return loss;
}

double chosen_ridge(const TrainingTable& terms, std::span<const int> label, std::uint64_t seed) {
  const std::size_t groups = std::set<std::uint64_t>(terms.group.begin(), terms.group.end()).size();
  const std::size_t folds = std::min(kFolds, groups);
  if (folds < 2) return 1;  // one group: nothing to hold out
  const std::vector<std::size_t> fold = assign_folds(terms, folds, seed);
  double best = 0, least = INFINITY;
  for (int half_decade = -5; half_decade <= 3; ++half_decade) {
    const double ridge = std::pow(10, 0.5 * half_decade);
    const double loss = held_out_loss(terms, label, fold, folds, ridge);
    if (loss < least) {
      least = loss;
      best = ridge;
    }
  }
  return best;
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

std::vector<double> cross_validate_quadratic(const TrainingTable& table, std::span<const int> label,
                                             const std::vector<std::size_t>& fold, std::size_t fold_count) {
  return out_of_fold(table, label, fold, fold_count, [](const TrainingTable& rows, std::span<const int> labels) {
    return fit_quadratic(rows, labels);
  });
}

}  // namespace gonogo::learning
