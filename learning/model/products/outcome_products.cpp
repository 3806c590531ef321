#include "learning/model/products/outcome_products.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "learning/model/products/logs.h"

namespace gonogo::learning {
namespace {

typedef double Half __attribute__((vector_size(OutcomeProducts::kLanes / 2 * sizeof(double))));  // a register of AVX2

Half load(const double* at) {
  Half half;
  std::memcpy(&half, at, sizeof half);
  return half;
}

void store(const Half& half, double* at) { std::memcpy(at, &half, sizeof half); }

}  // namespace

OutcomeProducts::OutcomeProducts(std::span<const double> outcome_bias, std::span<const double> outcome_weight) {
  const std::size_t outcomes = outcome_bias.size(), hidden = outcome_weight.size() / outcomes;
  const auto [least, most] = std::minmax_element(outcome_bias.begin(), outcome_bias.end());
  bias_range_ = *most - *least;
  base_.assign((outcomes + kOutcomesAtOnce - 1) / kOutcomesAtOnce * kOutcomesAtOnce, 0.0);
  factor_.assign(hidden * base_.size(), 0.0);
  least_.assign(hidden, INFINITY);
  most_.assign(hidden, -INFINITY);
  for (std::size_t y = 0; y < outcomes; ++y) {
    base_[y] = std::exp(outcome_bias[y] - *most);
    const std::size_t group = y / kOutcomesAtOnce;
    for (std::size_t j = 0; j < hidden; ++j) {
      const double weight = outcome_weight[y * hidden + j];
      factor_[(group * hidden + j) * kOutcomesAtOnce + y % kOutcomesAtOnce] = std::exp(weight);
      least_[j] = std::min(least_[j], weight);
      most_[j] = std::max(most_[j], weight);
    }
  }
}

template <bool kShared>
void OutcomeProducts::multiply(const double* common, std::span<const double> inverse, std::span<double> product) const {
  const std::size_t hidden = least_.size();
  for (std::size_t first = 0; first < base_.size(); first += kOutcomesAtOnce) {
    Half left[kOutcomesAtOnce], right[kOutcomesAtOnce];
#pragma GCC unroll 5
    for (std::size_t y = 0; y < kOutcomesAtOnce; ++y) left[y] = right[y] = Half{} + base_[first + y];
    const double* factor = factor_.data() + first * hidden;
    for (std::size_t j = 0; j < hidden; ++j, factor += kOutcomesAtOnce) {
      Half a = load(inverse.data() + j * kLanes), b = load(inverse.data() + j * kLanes + kLanes / 2);
      if constexpr (kShared) a *= common[j], b *= common[j];
#pragma GCC unroll 5
      for (std::size_t y = 0; y < kOutcomesAtOnce; ++y) {
        left[y] *= a + factor[y];
        right[y] *= b + factor[y];
      }
    }
#pragma GCC unroll 5
    for (std::size_t y = 0; y < kOutcomesAtOnce; ++y) {
      store(left[y], product.data() + (first + y) * kLanes);
      store(right[y], product.data() + (first + y) * kLanes + kLanes / 2);
    }
  }
}

void OutcomeProducts::operator()(std::span<const double> inverse, std::span<double> product) const {
  multiply<false>(nullptr, inverse, product);
}

void OutcomeProducts::operator()(std::span<const double> common, std::span<const double> inverse,
                                 std::span<double> product) const {
  multiply<true>(common.data(), inverse, product);
}

void OutcomeProducts::add(std::span<const double> common, std::span<const double> inverse,
                          std::span<const double> weight, bool normalised, Sum& sum) const {
  constexpr std::size_t kHalf = kLanes / 2;
  (*this)(common, inverse, sum.product);
  for (std::size_t lane = 0; lane < kLanes; lane += kHalf) {
    Half total = Half{} + double(!normalised);
    for (std::size_t at = lane; at < sum.product.size() && normalised; at += kLanes) total += load(&sum.product[at]);
    const Half share = load(&weight[lane]) / total;
    for (std::size_t at = lane; at < sum.product.size(); at += kLanes)
      store(load(&sum.weighted[at]) + share * load(&sum.product[at]), &sum.weighted[at]);
  }
}

bool OutcomeProducts::fit(std::span<const double> lowest, std::span<const double> highest, double range) const {
  double below = bias_range_, above = 0;
  for (std::size_t j = 0; j < least_.size(); ++j) {
    below += std::max(0.0, -std::max(-highest[j], least_[j]));
    above += std::max(0.0, most_[j] + softplus(-lowest[j] - most_[j]));
  }
  return below < range && above < range;
}

}  // namespace gonogo::learning
