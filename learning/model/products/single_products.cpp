#include "learning/model/products/single_products.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "learning/model/products/logs.h"

namespace gonogo::learning {
namespace {

constexpr std::size_t kFloats = SingleProducts::kLanes, kAtOnce = SingleProducts::kOutcomesAtOnce;

typedef float Floats8 __attribute__((vector_size(kFloats / 2 * sizeof(float))));  // a register of AVX2

Floats8 load_floats(const float* at) {
  Floats8 floats;
  std::memcpy(&floats, at, sizeof floats);
  return floats;
}

void store_floats(const Floats8& floats, float* at) { std::memcpy(at, &floats, sizeof floats); }

/// product[outcome][lane] *= prod_j (common[j] inverse[j][lane] + factor[j][outcome]) over `units` hidden units. With
/// `base` [outcome] that times the product over them, whatever was there.
void multiply_units(const float* common, const float* inverse, const float* factor, std::size_t units,
                    const float* base, float* product) {
  Floats8 left[kAtOnce], right[kAtOnce];
#pragma GCC unroll 4
  for (std::size_t y = 0; y < kAtOnce; ++y) {
    left[y] = base ? Floats8{} + base[y] : load_floats(product + y * kFloats);
    right[y] = base ? Floats8{} + base[y] : load_floats(product + y * kFloats + kFloats / 2);
  }
  for (std::size_t j = 0; j < units; ++j, factor += kAtOnce) {
    const Floats8 a = load_floats(inverse + j * kFloats) * common[j],
                  b = load_floats(inverse + j * kFloats + kFloats / 2) * common[j];
#pragma GCC unroll 4
    for (std::size_t y = 0; y < kAtOnce; ++y) {
      left[y] *= a + factor[y];
      right[y] *= b + factor[y];
    }
  }
#pragma GCC unroll 4
  for (std::size_t y = 0; y < kAtOnce; ++y) {
    store_floats(left[y], product + y * kFloats);
    store_floats(right[y], product + y * kFloats + kFloats / 2);
  }
}

/// Shares of all lanes.
struct Shares {
  Floats8 left, right;
};

/// share / sum over the outcomes of product[outcome][lane].
Shares over_sum(const float* product, std::size_t outcomes, const Shares& share) {
  Floats8 left = load_floats(product), right = load_floats(product + kFloats / 2);
  for (std::size_t y = 1; y < outcomes; ++y) {
    left += load_floats(product + y * kFloats);
    right += load_floats(product + y * kFloats + kFloats / 2);
  }
  return {share.left / left, share.right / right};
}

/// An outcome, or several whose weights are nearly the same.
struct AlikeOutcomes {
  std::vector<std::size_t> outcome;
  std::vector<double> weight;  // middle of theirs [hidden count]
};

std::vector<AlikeOutcomes> grouped(std::span<const double> outcome_weight, std::size_t outcomes) {
  constexpr double kAlike = 0.1;  // most sum of the differences of their weights
  const std::size_t hidden = outcome_weight.size() / outcomes;
  std::vector<AlikeOutcomes> groups;
  for (std::size_t y = 0; y < outcomes; ++y) {
    const auto row = outcome_weight.subspan(y * hidden, hidden);
    const auto is_alike = [&](const AlikeOutcomes& group) {
      double sum = 0;
      for (std::size_t j = 0; j < hidden; ++j) sum += std::abs(row[j] - outcome_weight[group.outcome[0] * hidden + j]);
      return sum < kAlike;
    };
    const auto found = std::find_if(groups.begin(), groups.end(), is_alike);
    if (found == groups.end())
      groups.push_back({{y}, {}});
    else
      found->outcome.push_back(y);
  }
  for (AlikeOutcomes& group : groups)
    for (std::size_t j = 0; j < hidden; ++j) {
      double least = INFINITY, most = -INFINITY;
      for (const std::size_t y : group.outcome) {
        least = std::min(least, outcome_weight[y * hidden + j]);
        most = std::max(most, outcome_weight[y * hidden + j]);
      }
      group.weight.push_back((least + most) / 2);
    }
  return groups;
}

}  // namespace

SingleProducts::SingleProducts(std::span<const double> outcome_bias, std::span<const double> outcome_weight) {
  const std::size_t outcomes = outcome_bias.size(), hidden = outcome_weight.size() / outcomes;
  const std::vector<AlikeOutcomes> groups = grouped(outcome_weight, outcomes);
  stands_for_.resize(outcomes);
  share_.resize(outcomes);
  delta_.assign(groups.size(), 0.0);
  std::vector<double> bias;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<double> log_share;
    for (const std::size_t y : groups[g].outcome) {
      double moved = 0, delta = 0;
      for (std::size_t j = 0; j < hidden; ++j) {
        moved += (outcome_weight[y * hidden + j] - groups[g].weight[j]) / 2;
        delta += std::abs(outcome_weight[y * hidden + j] - groups[g].weight[j]) / 2;
      }
      log_share.push_back(outcome_bias[y] + moved);
      delta_[g] = std::max(delta_[g], std::expm1(delta));
    }
    bias.push_back(log_sum_exp(log_share));
    for (std::size_t k = 0; k < log_share.size(); ++k) {
      stands_for_[groups[g].outcome[k]] = g;
      share_[groups[g].outcome[k]] = std::exp(log_share[k] - bias.back());
    }
  }
  const auto [least, most] = std::minmax_element(bias.begin(), bias.end());
  bias_range_ = *most - *least;
  base_.assign((groups.size() + kAtOnce - 1) / kAtOnce * kAtOnce, 0.0f);
  factor_.assign(hidden * base_.size(), 0.0);
  least_.assign(hidden, INFINITY);
  most_.assign(hidden, -INFINITY);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    base_[g] = float(std::exp(bias[g] - *most));
    for (std::size_t j = 0; j < hidden; ++j) {
      const double weight = groups[g].weight[j];
      factor_[(g / kAtOnce * hidden + j) * kAtOnce + g % kAtOnce] = std::exp(weight);
      least_[j] = std::min(least_[j], weight);
      most_[j] = std::max(most_[j], weight);
    }
  }
}

double SingleProducts::alike_error(std::span<const double> sum) const {
  double error = 0;
  for (std::size_t g = 0; g < delta_.size(); ++g) error += delta_[g] * sum[g];
  return error;
}

std::vector<double> SingleProducts::all_outcomes(std::span<const double> sum) const {
  std::vector<double> all;
  for (std::size_t y = 0; y < share_.size(); ++y) all.push_back(share_[y] * sum[stands_for_[y]]);
  return all;
}

double SingleProducts::error_bound() const { return (2.5 * double(least_.size()) + 32) * std::exp2(-24); }

std::optional<SingleProducts::Scaled> SingleProducts::scaled(std::span<const double> lowest,
                                                             std::span<const double> highest,
                                                             std::span<const double> part) const {
  // Where the sum over the outcomes is above e^-x, an outcome vanishes when it is below e^(x - kRange) of it. All units
  // together part two outcomes by e^apart at most, so that it ends below e^(apart - 2 (kRange - x)): less than kTiny.
  constexpr double kRange = 87, kTiny = -21;  // e^-87 is a normal float
  const std::size_t hidden = least_.size();
  const auto log_sum = [](double a, double b) { return a + softplus(b - a); };
  Scaled result;
  std::vector<double> half;
  double apart = bias_range_;
  for (std::size_t j = 0; j < hidden; ++j) {
    const double low = log_sum(-highest[j], least_[j]), high = log_sum(-lowest[j], most_[j]);
    half.push_back((high - low) / 2);
    result.over_middle.push_back(std::exp(-(low + high) / 2));
    apart += log_sum(-highest[j], most_[j]) - low;
    if (!(half[j] + part[j] < kRange)) return std::nullopt;
  }
  const double most = kRange - (apart - kTiny) / 2;  // x, which is how far the sum may move before it is 1 again
  double moved = 0;
  for (std::size_t j = 0; j < hidden; ++j) {
    if (half[j] > most) return std::nullopt;
    if (moved + half[j] > most) {
      result.until.push_back(j);
      moved = 0;
    }
    moved += half[j];
  }
  result.until.push_back(hidden);
  for (std::size_t i = 0; i < factor_.size(); ++i)
    result.factor.push_back(float(factor_[i] * result.over_middle[i / kAtOnce % hidden]));
  return result;
}

void SingleProducts::add(const Scaled& scaled, std::span<const float> common, std::span<const float> inverse,
                         std::span<const float> weight, double scale, std::span<double> sum) const {
  constexpr std::size_t kHalf = kFloats / 2, kMostOutcomes = 64;
  const std::size_t hidden = least_.size(), outcomes = base_.size(), blocks = weight.size() / kFloats;
  GONOGO_ASSERT(outcomes <= kMostOutcomes && blocks <= kMostBlocks);
  alignas(32) std::array<float, kMostOutcomes * kFloats> product, weighted;
  std::fill_n(weighted.begin(), outcomes * kFloats, 0.0f);
  for (std::size_t block = 0; block < blocks; ++block) {
    const float *own = inverse.data() + block * hidden * kFloats, *of_block = weight.data() + block * kFloats;
    std::size_t from = 0;
    for (const std::size_t until : scaled.until) {
      if (from > 0) {
        const Shares share = over_sum(product.data(), outcomes, {Floats8{} + 1.0f, Floats8{} + 1.0f});
        for (float* at = product.data(); at < product.data() + outcomes * kFloats; at += kFloats) {
          store_floats(load_floats(at) * share.left, at);
          store_floats(load_floats(at + kHalf) * share.right, at + kHalf);
        }
      }
      for (std::size_t first = 0; first < outcomes; first += kAtOnce)
        multiply_units(common.data() + from, own + from * kFloats,
                       scaled.factor.data() + first * hidden + from * kAtOnce, until - from,
                       from > 0 ? nullptr : base_.data() + first, product.data() + first * kFloats);
      from = until;
    }
    const Shares share = over_sum(product.data(), outcomes, {load_floats(of_block), load_floats(of_block + kHalf)});
    for (std::size_t at = 0; at < outcomes * kFloats; at += kFloats) {
      store_floats(load_floats(&weighted[at]) + load_floats(&product[at]) * share.left, &weighted[at]);
      store_floats(load_floats(&weighted[at + kHalf]) + load_floats(&product[at + kHalf]) * share.right,
                   &weighted[at + kHalf]);
    }
  }
  for (std::size_t y = 0; y < sum.size(); ++y) {
    double even = 0, odd = 0;
    for (std::size_t lane = 0; lane < kFloats; lane += 2) {
      even += double(weighted[y * kFloats + lane]);
      odd += double(weighted[y * kFloats + lane + 1]);
    }
    sum[y] += scale * (even + odd);
  }
}

}  // namespace gonogo::learning
