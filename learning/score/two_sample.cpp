#include "learning/score/two_sample.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/error.h"
#include "base/math/random.h"
#include "base/parallel/host_loop.h"
#include "learning/model/weights.h"
#include "learning/training.h"

namespace gonogo::learning {
namespace {

constexpr double kMinGain = 1e-9;
constexpr std::size_t kNoNode = SIZE_MAX;

struct Sums {
  double gradient = 0, curvature = 0;
  double score(double l2) const { return gradient * gradient / (curvature + l2); }
};

struct Split {
  double gain = kMinGain;
  std::size_t column = 0;
  double threshold = 0;
};

/// Grows one tree level by level. `order`: rows sorted by each column.
class Grower {
 public:
  Grower(const ScoredRows& rows, const std::vector<std::vector<std::uint32_t>>& order, const std::vector<Sums>& of_row,
         const BoostSettings& settings, std::vector<std::size_t> node_of)
      : rows_(rows), order_(order), of_row_(of_row), settings_(settings), node_of_(std::move(node_of)) {}

  std::vector<BoostedTrees::Node> grow() {
    tree_.assign(1, {});
    std::size_t first = 0;
    for (std::size_t level = 0; level < settings_.depth && first < tree_.size(); ++level) first = split_level(first);
    const std::vector<Sums> sums = sums_of_nodes();
    for (std::size_t k = 0; k < tree_.size(); ++k)
      if (tree_[k].left == 0)
        tree_[k].value = -settings_.learning_rate * sums[k].gradient / (sums[k].curvature + settings_.l2);
    return std::move(tree_);
  }

 private:
  std::vector<Sums> sums_of_nodes() const {
    std::vector<Sums> sums(tree_.size());
    for (std::size_t n = 0; n < node_of_.size(); ++n) {
      if (node_of_[n] == kNoNode) continue;
      sums[node_of_[n]].gradient += of_row_[n].gradient;
      sums[node_of_[n]].curvature += of_row_[n].curvature;
    }
    return sums;
  }

  /// The best split by one column of every node from `first` on, if it is better than the one known.
  void scan(std::size_t column, std::size_t first, const std::vector<Sums>& total, std::vector<Split>& best) const {
    std::vector<Sums> left(tree_.size());
    std::vector<double> last(tree_.size(), NAN);
    for (std::uint32_t n : order_[column]) {
      const std::size_t node = node_of_[n];
      if (node == kNoNode || node < first) continue;
      const double x = rows_.values[n * rows_.columns + column];
      if (x > last[node]) consider(column, last[node], x, left[node], total[node], best[node]);
      left[node].gradient += of_row_[n].gradient;
      left[node].curvature += of_row_[n].curvature;
      last[node] = x;
    }
  }

  void consider(std::size_t column, double below, double above, const Sums& left, const Sums& total,
                Split& best) const {
    const Sums right{total.gradient - left.gradient, total.curvature - left.curvature};
    if (std::min(left.curvature, right.curvature) < settings_.least_curvature) return;
    const double gain = left.score(settings_.l2) + right.score(settings_.l2) - total.score(settings_.l2);
    if (gain > best.gain) best = {gain, column, below + (above - below) / 2};
  }

  /// Splits the nodes from `first` on and returns the first of their children.
  std::size_t split_level(std::size_t first) {
    const std::vector<Sums> total = sums_of_nodes();
    const std::size_t end = tree_.size();
    std::vector<Split> best(end);
    for (std::size_t column = 0; column < rows_.columns; ++column) scan(column, first, total, best);
    for (std::size_t node = first; node < end; ++node) {
      if (best[node].gain <= kMinGain) continue;
      tree_[node].column = best[node].column;
      tree_[node].threshold = best[node].threshold;
      tree_[node].left = tree_.size();
      tree_.resize(tree_.size() + 2);
    }
    for (std::size_t n = 0; n < node_of_.size(); ++n) {
      if (node_of_[n] == kNoNode || tree_[node_of_[n]].left == 0) continue;
      const BoostedTrees::Node& node = tree_[node_of_[n]];
      node_of_[n] = node.left + (rows_.values[n * rows_.columns + node.column] >= node.threshold);
    }
    return end;
  }

  const ScoredRows& rows_;
  const std::vector<std::vector<std::uint32_t>>& order_;
  const std::vector<Sums>& of_row_;
  const BoostSettings& settings_;
  std::vector<std::size_t> node_of_;  // [row]; kNoNode: not seen by this tree
  std::vector<BoostedTrees::Node> tree_;
};

double leaf_value(const std::vector<BoostedTrees::Node>& tree, std::span<const double> row) {
  std::size_t k = 0;
  while (tree[k].left != 0) k = tree[k].left + (row[tree[k].column] >= tree[k].threshold);
  return tree[k].value;
}

std::vector<std::vector<std::uint32_t>> sorted_rows(const ScoredRows& rows) {
  std::vector<std::vector<std::uint32_t>> order(rows.columns, std::vector<std::uint32_t>(rows.count()));
  for (std::size_t column = 0; column < rows.columns; ++column) {
    std::iota(order[column].begin(), order[column].end(), 0u);
    std::stable_sort(order[column].begin(), order[column].end(), [&](std::uint32_t a, std::uint32_t b) {
      return rows.values[a * rows.columns + column] < rows.values[b * rows.columns + column];
    });
  }
  return order;
}

}  // namespace

void ScoredRows::add(std::span<const double> row, double row_weight) {
  values.insert(values.end(), row.begin(), row.end());
  weight.push_back(row_weight);
}

ScoredRows ScoredRows::subset(const std::vector<std::size_t>& rows) const {
  ScoredRows result;
  result.columns = columns;
  for (std::size_t n : rows) result.add(row(n), weight[n]);
  return result;
}

BoostedTrees::BoostedTrees(const ScoredRows& rows, std::span<const int> label, const BoostSettings& settings) {
  if (rows.count() == 0) throw InputError("boosted trees: no row to fit");
  GONOGO_ASSERT(label.size() == rows.count());
  double ones = 0, all = 0;
  for (std::size_t n = 0; n < rows.count(); ++n) {
    ones += rows.weight[n] * label[n];
    all += rows.weight[n];
  }
  const double rest = 0.5 * all / double(rows.count());  // half a row of each class: the odds stay finite
  start_ = std::log((ones + rest) / (all - ones + rest));
  const auto order = sorted_rows(rows);
  std::vector<double> score(rows.count(), start_);
  std::vector<Sums> of_row(rows.count());
  for (std::size_t t = 0; t < settings.trees; ++t) {
    std::vector<std::size_t> node_of(rows.count());
    for (std::size_t n = 0; n < rows.count(); ++n) {
      const double p = sigmoid(score[n]);
      of_row[n] = {rows.weight[n] * (p - label[n]), rows.weight[n] * p * (1 - p)};
      node_of[n] = random_unit(settings.seed, t, n) < settings.row_share ? 0 : kNoNode;
    }
    trees_.push_back(Grower(rows, order, of_row, settings, std::move(node_of)).grow());
    for (std::size_t n = 0; n < rows.count(); ++n) score[n] += leaf_value(trees_.back(), rows.row(n));
  }
}

double BoostedTrees::operator()(std::span<const double> row) const {
  double sum = start_;
  for (const auto& tree : trees_) sum += leaf_value(tree, row);
  return sigmoid(sum);
}

double weighted_auc(std::span<const double> score, std::span<const int> label, std::span<const double> weight) {
  std::vector<std::size_t> order(score.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return score[a] < score[b]; });
  double zeros = 0, ones = 0, won = 0;
  for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
    double zeros_here = 0, ones_here = 0;
    for (; last < order.size() && score[order[last]] == score[order[first]]; ++last)
      (label[order[last]] ? ones_here : zeros_here) += weight[order[last]];
    won += ones_here * (zeros + zeros_here / 2);
    zeros += zeros_here;
    ones += ones_here;
  }
  return won / (zeros * ones);
}

double two_sample_auc(const ScoredRows& a, const ScoredRows& b, const BoostSettings& settings, std::size_t folds) {
  if (a.count() < folds || b.count() < folds)
    throw InputError("two-sample score: " + std::to_string(std::min(a.count(), b.count())) + " rows in " +
                     std::to_string(folds) + " folds");
  GONOGO_ASSERT(a.columns == b.columns);
  ScoredRows rows;
  rows.columns = a.columns;
  std::vector<int> label;
  std::vector<std::size_t> fold;
  for (const ScoredRows* part : {&a, &b}) {
    const double total = std::accumulate(part->weight.begin(), part->weight.end(), 0.0);
    const std::vector<std::size_t> place = permutation(part->count(), settings.seed, part == &b);
    for (std::size_t n = 0; n < part->count(); ++n) {
      rows.add(part->row(n), part->weight[n] * double(a.count() + b.count()) / (2 * total));
      label.push_back(part == &b);
      fold.push_back(place[n] % folds);
    }
  }
  std::vector<double> score(rows.count());
  for_each_on_host(folds, 1, [&](std::size_t f) {
    std::vector<std::size_t> fitted;
    std::vector<int> fitted_label;
    for (std::size_t n = 0; n < rows.count(); ++n) {
      if (fold[n] == f) continue;
      fitted.push_back(n);
      fitted_label.push_back(label[n]);
    }
    const BoostedTrees trees(rows.subset(fitted), fitted_label, settings);
    for (std::size_t n = 0; n < rows.count(); ++n)
      if (fold[n] == f) score[n] = trees(rows.row(n));
  });
  return weighted_auc(score, label, rows.weight);
}

namespace {

double total_variation(const ScoredRows& a, const ScoredRows& b, std::size_t first, std::size_t second) {
  std::map<std::pair<double, double>, double> cell;  // share in a less share in b
  const auto count = [&](const ScoredRows& rows, double sign) {
    const double total = std::accumulate(rows.weight.begin(), rows.weight.end(), 0.0);
    for (std::size_t n = 0; n < rows.count(); ++n)
      cell[{rows.row(n)[first], rows.row(n)[second]}] += sign * rows.weight[n] / total;
  };
  count(a, 1);
  count(b, -1);
  double sum = 0;
  for (const auto& [place, difference] : cell) sum += std::abs(difference) / 2;
  return sum;
}

void add(TableDistance& result, double distance, std::size_t first, std::size_t second, double share) {
  result.mean += distance * share;
  if (distance <= result.largest) return;
  result.largest = distance;
  result.largest_a = first;
  result.largest_b = second;
}

}  // namespace

TableDistance marginal_distance(const ScoredRows& a, const ScoredRows& b) {
  GONOGO_ASSERT(a.columns == b.columns);
  TableDistance result;
  for (std::size_t c = 0; c < a.columns; ++c) add(result, total_variation(a, b, c, c), c, c, 1 / double(a.columns));
  return result;
}

TableDistance pair_distance(const ScoredRows& a, const ScoredRows& b) {
  GONOGO_ASSERT(a.columns == b.columns);
  TableDistance result;
  const double pairs = double(a.columns) * double(a.columns - 1) / 2;
  for (std::size_t c = 0; c < a.columns; ++c)
    for (std::size_t d = c + 1; d < a.columns; ++d) add(result, total_variation(a, b, c, d), c, d, 1 / pairs);
  return result;
}

}  // namespace gonogo::learning
