// Scores of a joint distribution: boosted trees, two-sample AUC, Gaussian copula, total variation.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/math/random.h"
#include "learning/score/copula.h"
#include "learning/score/two_sample.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

ScoredRows normal_rows(std::size_t count, std::size_t columns, double shift, std::uint64_t seed) {
  ScoredRows rows;
  rows.columns = columns;
  std::vector<double> row(columns);
  for (std::size_t n = 0; n < count; ++n) {
    for (std::size_t c = 0; c < columns; ++c) row[c] = random_normal(seed, n, c) + (c == 0 ? shift : 0);
    rows.add(row, 1);
  }
  return rows;
}

/// Boosting as its definition reads: every split is tried on every subset anew.
class Reference {
 public:
  Reference(const ScoredRows& rows, const std::vector<int>& label, const BoostSettings& settings)
      : rows_(rows), settings_(settings) {
    double ones = 0, all = 0;
    for (std::size_t n = 0; n < rows.count(); ++n) {
      ones += rows.weight[n] * label[n];
      all += rows.weight[n];
    }
    const double rest = 0.5 * all / double(rows.count());
    score.assign(rows.count(), std::log((ones + rest) / (all - ones + rest)));
    for (std::size_t t = 0; t < settings.trees; ++t) {
      gradient_.clear();
      curvature_.clear();
      std::vector<std::size_t> every;
      for (std::size_t n = 0; n < rows.count(); ++n) {
        const double p = 1 / (1 + std::exp(-score[n]));
        gradient_.push_back(rows.weight[n] * (p - label[n]));
        curvature_.push_back(rows.weight[n] * p * (1 - p));
        every.push_back(n);
      }
      grow(every, settings.depth);
    }
  }
  std::vector<double> score;  // [row] log odds

 private:
  double term(const std::vector<std::size_t>& part) const {
    double g = 0, h = 0;
    for (std::size_t n : part) {
      g += gradient_[n];
      h += curvature_[n];
    }
    return g * g / (h + settings_.l2);
  }
  void grow(const std::vector<std::size_t>& part, std::size_t depth) {
    double best = 1e-9;
    std::vector<std::size_t> best_left, best_right;
    for (std::size_t c = 0; c < rows_.columns && depth > 0; ++c)
      for (std::size_t edge : part) {
        std::vector<std::size_t> left, right;
        double left_h = 0, right_h = 0;
        for (std::size_t n : part) {
          const bool low = rows_.row(n)[c] < rows_.row(edge)[c];
          (low ? left : right).push_back(n);
          (low ? left_h : right_h) += curvature_[n];
        }
        if (std::min(left_h, right_h) < settings_.least_curvature) continue;
        const double gain = term(left) + term(right) - term(part);
        if (gain <= best + 1e-12) continue;
        best = gain;
        best_left = left;
        best_right = right;
      }
    if (!best_left.empty()) {
      grow(best_left, depth - 1);
      grow(best_right, depth - 1);
      return;
    }
    double g = 0, h = 0;
    for (std::size_t n : part) {
      g += gradient_[n];
      h += curvature_[n];
    }
    for (std::size_t n : part) score[n] -= settings_.learning_rate * g / (h + settings_.l2);
  }
  const ScoredRows& rows_;
  BoostSettings settings_;
  std::vector<double> gradient_, curvature_;
};

}  // namespace

TEST_CASE("boosted trees are those of a search through every split") {
  ScoredRows rows = normal_rows(60, 3, 0, 4);
  std::vector<int> label;
  for (std::size_t n = 0; n < rows.count(); ++n) {
    rows.weight[n] = 0.5 + random_unit(9, 0, n);
    rows.values[3 * n + 1] = std::floor(2 * rows.values[3 * n + 1]);  // ties
    label.push_back(rows.row(n)[0] * rows.row(n)[1] + 0.3 * random_normal(5, 0, n) > 0);
  }
  const BoostSettings settings{.trees = 6, .depth = 3, .learning_rate = 0.3, .row_share = 1, .least_curvature = 0.8};
  const BoostedTrees trees(rows, label, settings);
  const Reference reference(rows, label, settings);
  for (std::size_t n = 0; n < rows.count(); ++n)
    CHECK(trees(rows.row(n)) == Approx(1 / (1 + std::exp(-reference.score[n]))).epsilon(1e-10));
  CHECK_THROWS_AS(BoostedTrees(ScoredRows{3, {}, {}}, std::vector<int>{}), InputError);
}

TEST_CASE("the weighted AUC is the share of pairs, ties by half") {
  std::vector<double> score, weight;
  std::vector<int> label;
  for (std::size_t n = 0; n < 80; ++n) {
    score.push_back(std::floor(10 * random_unit(1, 0, n)));
    weight.push_back(random_unit(1, 1, n));
    label.push_back(random_unit(1, 2, n) < 0.4);
  }
  double won = 0, all = 0;
  for (std::size_t a = 0; a < 80; ++a)
    for (std::size_t b = 0; b < 80; ++b) {
      if (label[a] == 0 || label[b] == 1) continue;
      won += weight[a] * weight[b] * (score[a] > score[b] ? 1 : score[a] == score[b] ? 0.5 : 0);
      all += weight[a] * weight[b];
    }
  CHECK(weighted_auc(score, label, weight) == Approx(won / all).epsilon(1e-12));
}

TEST_CASE("shifted normal samples have nearly the AUC of the best classifier; equal ones have 0.5") {
  const ScoredRows here = normal_rows(1000, 4, 0, 1);
  for (const double shift : {0.0, 0.5, 1.0, 2.0}) {
    const double best = std::erfc(-shift / 2) / 2;  // Phi(shift / sqrt 2)
    const double auc = two_sample_auc(here, normal_rows(1000, 4, shift, 2));
    std::printf("shift %.1f: AUC %.3f, best possible %.3f\n", shift, auc, best);
    CHECK(auc < best + 0.03);
    CHECK(auc > best - 0.04);
  }
  CHECK(two_sample_auc(here, normal_rows(1000, 4, 0, 2)) == two_sample_auc(here, normal_rows(1000, 4, 0, 2)));
  CHECK_THROWS_AS(two_sample_auc(normal_rows(4, 1, 0, 1), here), InputError);
}

TEST_CASE("a difference in the dependence alone is found") {
  ScoredRows related = normal_rows(1000, 2, 0, 3);
  for (std::size_t n = 0; n < related.count(); ++n)
    related.values[2 * n + 1] = 0.9 * related.values[2 * n] + std::sqrt(1 - 0.81) * related.values[2 * n + 1];
  CHECK(two_sample_auc(related, normal_rows(1000, 2, 0, 4)) > 0.75);
}

TEST_CASE("thinned rows with weights cannot be told from all rows; without weights they can") {
  ScoredRows thinned, plain;
  thinned.columns = plain.columns = 2;
  const ScoredRows all = normal_rows(4000, 2, 0, 5);
  for (std::size_t n = 0; n < all.count() && thinned.count() < 1000; ++n) {
    const double keep = all.row(n)[0] > 0 ? 0.9 : 0.3;
    if (random_unit(6, 0, n) > keep) continue;
    thinned.add(all.row(n), 1 / keep);
    plain.add(all.row(n), 1);
  }
  const ScoredRows fresh = normal_rows(1000, 2, 0, 6);
  CHECK(std::abs(two_sample_auc(thinned, fresh) - 0.5) < 0.04);
  CHECK(two_sample_auc(plain, fresh) > 0.57);
}

TEST_CASE("a Gaussian copula keeps marginals and correlations, steps in their order, and nothing beyond") {
  ScoredRows rows;
  rows.columns = 3;
  for (std::size_t n = 0; n < 3000; ++n) {
    const double a = random_normal(7, n, 0), b = 0.8 * a + 0.6 * random_normal(7, n, 1);
    rows.add(std::vector<double>{std::exp(a), b, b < -0.5 ? 0.0 : b < 0.7 ? 1.0 : 2.0}, 1);
  }
  const GaussianCopula copula(rows, 1);
  CHECK(copula.correlation(0, 1) == Approx(0.8).margin(0.02));
  const ScoredRows drawn = copula.draw(3000, 2);
  const auto share = [](const ScoredRows& of, auto&& holds) {
    double sum = 0;
    for (std::size_t n = 0; n < of.count(); ++n) sum += holds(of.row(n)) ? 1 : 0;
    return sum / double(of.count());
  };
  for (double y : {0.0, 1.0, 2.0})
    CHECK(share(drawn, [&](auto row) { return row[2] == y; }) ==
          Approx(share(rows, [&](auto row) { return row[2] == y; })).margin(0.03));
  CHECK(share(drawn, [](auto row) { return row[0] > std::exp(1.0) && row[1] > 1; }) ==
        Approx(share(rows, [](auto row) { return row[0] > std::exp(1.0) && row[1] > 1; })).margin(0.02));
  ScoredRows first = rows, second = drawn;
  for (ScoredRows* part : {&first, &second}) {  // without the outcome the table is a Gaussian copula
    ScoredRows inputs;
    inputs.columns = 2;
    for (std::size_t n = 0; n < 1000; ++n) inputs.add(part->row(n).first(2), 1);
    *part = inputs;
  }
  CHECK(std::abs(two_sample_auc(first, second) - 0.5) < 0.04);
  CHECK_THROWS_AS(GaussianCopula(normal_rows(1, 2, 0, 1), 1), InputError);
}

TEST_CASE("total variation of bins, single and in pairs, by hand") {
  ScoredRows a{2, {0, 0, 0, 1, 1, 0, 1, 1}, {1, 1, 1, 1}}, b{2, {0, 0, 1, 1}, {3, 1}};
  const TableDistance single = marginal_distance(a, b), pairs = pair_distance(a, b);
  CHECK(single.mean == Approx(0.25));  // shares of 0: 1/2 and 3/4 in both columns
  CHECK(single.largest == Approx(0.25));
  CHECK(pairs.mean == Approx(0.5));  // 1/4 each; 3/4 and 1/4 on the diagonal
  CHECK(pairs.largest_a == 0);
  CHECK(pairs.largest_b == 1);
  CHECK(marginal_distance(a, a).largest == 0);
}
