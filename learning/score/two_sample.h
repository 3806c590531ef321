// How much two tables differ: by boosted trees that learn to tell their rows apart, and by their shares of bins.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace gonogo::learning {

struct BoostSettings {
  std::size_t trees = 200;
  std::size_t depth = 4;
  double learning_rate = 0.06;  // factor of every leaf
  double row_share = 0.8;       // of the rows that a tree sees
  double l2 = 1;
  double least_curvature = 1;  // sum of h in a leaf
  std::uint64_t seed = 1;
};

/// Rows of numbers, none NaN, with weights.
struct ScoredRows {
  std::size_t columns = 0;
  std::vector<double> values;  // [row x column]
  std::vector<double> weight;  // [row], > 0

  std::size_t count() const { return weight.size(); }
  std::span<const double> row(std::size_t n) const { return std::span(values).subspan(n * columns, columns); }
  void add(std::span<const double> row, double row_weight);
  ScoredRows subset(const std::vector<std::size_t>& rows) const;
};

/// Gradient-boosted regression trees for the log odds of two classes: second-order boosting with exact splits, as in
/// Chen & Guestrin, KDD 2016 (arXiv:1603.02754), section 2 and algorithm 1. Small and deterministic.
///
/// A leaf of rows with gradients g and curvatures h of the log loss gets -sum g / (sum h + l2). A split is chosen by
///   gain = G_left^2 / (H_left + l2) + G_right^2 / (H_right + l2) - G^2 / (H + l2).
class BoostedTrees {
 public:
  /// label: [row] of {0, 1}. Throws InputError without rows.
  BoostedTrees(const ScoredRows& rows, std::span<const int> label, const BoostSettings& settings = {});
  /// P(1 | row). row: [column].
  double operator()(std::span<const double> row) const;

  /// A node of a tree. Rows with value < threshold go to `left`, the others to left + 1.
  struct Node {
    std::size_t column = 0;
    double threshold = 0;
    std::size_t left = 0;  // 0: a leaf
    double value = 0;      // of a leaf, in log odds
  };
  const std::vector<std::vector<Node>>& trees() const { return trees_; }

 private:
  double start_ = 0;  // log odds of the labels
  std::vector<std::vector<Node>> trees_;
};

/// P(score of a row of label 1 > score of one of label 0) + half of the ties, rows weighted.
double weighted_auc(std::span<const double> score, std::span<const int> label, std::span<const double> weight);

/// AUC of telling rows of `a` from rows of `b`, each row scored by trees that were fitted without its fold. 0.5: they
/// cannot be told apart. Both classes count alike. Folds are stratified. Throws InputError with fewer rows than folds.
double two_sample_auc(const ScoredRows& a, const ScoredRows& b, const BoostSettings& settings = {},
                      std::size_t folds = 5);

/// Total variation, half the sum of |share in a - share in b| over all cells: 0 for equal tables, at most 1.
struct TableDistance {
  double mean = 0, largest = 0;
  std::size_t largest_a = 0, largest_b = 0;  // columns of the largest one; equal for a single column
};

/// Over single columns, and over all pairs of columns. Values of the columns are bins: whole numbers from 0.
TableDistance marginal_distance(const ScoredRows& a, const ScoredRows& b);
TableDistance pair_distance(const ScoredRows& a, const ScoredRows& b);

}  // namespace gonogo::learning
