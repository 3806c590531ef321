#include "learning/score/copula.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "base/error.h"
#include "base/math/random.h"
#include "learning/score/mixing.h"

namespace gonogo::learning {
namespace {

/// Lower triangle L of L L' = matrix + a little on the diagonal, which keeps it positive where columns depend on
/// others.
std::vector<double> cholesky(const std::vector<double>& matrix, std::size_t n) {
  constexpr double kRidge = 1e-9;
  std::vector<double> root(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = matrix[i * n + j] + (i == j ? kRidge : 0);
      for (std::size_t k = 0; k < j; ++k) sum -= root[i * n + k] * root[j * n + k];
      root[i * n + j] = i == j ? std::sqrt(std::max(sum, kRidge)) : sum / root[j * n + j];
    }
  return root;
}

}  // namespace

GaussianCopula::GaussianCopula(const ScoredRows& rows, std::uint64_t seed)
    : columns_(rows.columns), value_(rows.columns), until_(rows.columns), correlation_(rows.columns * rows.columns) {
  if (rows.count() < 2) throw InputError("Gaussian copula: two rows at least are needed");
  const double total = std::accumulate(rows.weight.begin(), rows.weight.end(), 0.0);
  std::vector<std::vector<double>> score(columns_, std::vector<double>(rows.count()));
  for (std::size_t c = 0; c < columns_; ++c) {
    std::vector<std::size_t> order(rows.count());
    std::iota(order.begin(), order.end(), std::size_t(0));
    const auto key = [&](std::size_t n) { return std::pair(rows.row(n)[c], random_unit(seed, c, n)); };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
    double before = 0;
    for (std::size_t n : order) {
      score[c][n] = normal_quantile((before + rows.weight[n] / 2) / total);
      before += rows.weight[n];
      value_[c].push_back(rows.row(n)[c]);
      until_[c].push_back(before / total);
    }
    steps_.push_back(std::set<double>(value_[c].begin(), value_[c].end()).size() <= kMaxSteps);
  }
  for (std::size_t a = 0; a < columns_; ++a)
    for (std::size_t b = 0; b < columns_; ++b) {
      double ab = 0, aa = 0, bb = 0;
      for (std::size_t n = 0; n < rows.count(); ++n) {
        ab += rows.weight[n] * score[a][n] * score[b][n];
        aa += rows.weight[n] * score[a][n] * score[a][n];
        bb += rows.weight[n] * score[b][n] * score[b][n];
      }
      correlation_[a * columns_ + b] = a == b ? 1 : ab / std::sqrt(aa * bb);
    }
  root_ = cholesky(correlation_, columns_);
}

double GaussianCopula::quantile(std::size_t column, double u) const {
  const std::vector<double>&value = value_[column], &until = until_[column];
  const std::size_t k =
      std::min(std::size_t(std::lower_bound(until.begin(), until.end(), u) - until.begin()), value.size() - 1);
  if (steps_[column] || k == 0) return value[k];
  return value[k - 1] + (value[k] - value[k - 1]) * std::min(1.0, (u - until[k - 1]) / (until[k] - until[k - 1]));
}

ScoredRows GaussianCopula::draw(std::size_t count, std::uint64_t seed) const {
  ScoredRows rows;
  rows.columns = columns_;
  std::vector<double> normal(columns_), row(columns_);
  for (std::size_t n = 0; n < count; ++n) {
    for (std::size_t c = 0; c < columns_; ++c) normal[c] = random_normal(seed, n, c);
    for (std::size_t c = 0; c < columns_; ++c) {
      double z = 0;
      for (std::size_t k = 0; k <= c; ++k) z += root_[c * columns_ + k] * normal[k];
      row[c] = quantile(c, std::erfc(-z / std::sqrt(2.0)) / 2);
    }
    rows.add(row, 1);
  }
  return rows;
}

}  // namespace gonogo::learning
