// The sum of Posterior::sum_logarithms in products instead of logarithms: with a_j = exp(field of hidden unit j),
//
//   q_y = exp(d_y) prod_j (1 + a_j exp(U_yj))
//   P(y | known) proportional to sum over combinations of exp(bias) q_y             the machine's own distribution
//   P(y | known)               = sum over combinations of prior q_y / sum_y q_y     with a prior for the inputs
//
// where a_j of a combination is the product of what its bins give. No exponential and no logarithm is left inside the
// sum. Only where no product can leave the range of double; elsewhere there is no answer.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "learning/model/combinations.h"
#include "learning/model/posterior.h"

namespace gonogo::learning {
namespace {

constexpr double kMaxLog = 600;  // e^600 times any number of terms is finite in double; e^-600 is not 0

/// product[y] = base[y] prod_j (1 + a_j factor[j][y]), `Width` outcomes at a time so that they stay in registers.
template <std::size_t Width>
void multiply(std::span<const double> a, std::span<const double> base, std::span<const double> factor,
              std::span<double> product) {
  for (std::size_t first = 0; first < product.size(); first += Width) {
    std::array<double, Width> part;
    for (std::size_t y = 0; y < Width; ++y) part[y] = base[first + y];
    for (std::size_t j = 0; j < a.size(); ++j) {
      const double* of_hidden = factor.data() + j * product.size() + first;
      for (std::size_t y = 0; y < Width; ++y) part[y] *= 1 + a[j] * of_hidden[y];
    }
    for (std::size_t y = 0; y < Width; ++y) product[first + y] = part[y];
  }
}

}  // namespace

void Posterior::prepare_products() {
  const std::size_t hidden = hidden_bias_.size();
  for (Nodes& nodes : nodes_) {
    const double heaviest = *std::max_element(nodes.bias.begin(), nodes.bias.end());
    for (const double bias : nodes.bias) nodes.weight.push_back(std::exp(bias - heaviest));
  }
  const double largest = *std::max_element(outcome_bias_.begin(), outcome_bias_.end());
  outcome_base_.assign(padded_outcomes(), 0.0);
  outcome_factor_by_hidden_.assign(hidden * padded_outcomes(), 0.0);
  for (std::size_t y = 0; y < outcome_count(); ++y) {
    outcome_base_[y] = std::exp(outcome_bias_[y] - largest);
    for (std::size_t j = 0; j < hidden; ++j)
      outcome_factor_by_hidden_[j * padded_outcomes() + y] = outcome_factor_[y * hidden + j];
  }
}

/// Whether every number of the sum stays in the range of double: each factor on its way, by the sizes of what is added
/// up in its exponent, the products of all hidden units, by the largest softplus of each (no factor is below 1), and
/// exp(d).
bool Posterior::products_fit(std::span<const double> field, const std::vector<std::size_t>& unknown) const {
  const auto [smallest, largest] = std::minmax_element(outcome_bias_.begin(), outcome_bias_.end());
  if (!(*largest - *smallest < kMaxLog)) return false;
  const std::size_t hidden = field.size();
  double log_product = 0;
  for (std::size_t j = 0; j < hidden; ++j) {
    double size = std::abs(field[j]) + largest_outcome_size_, highest = field[j] + largest_outcome_weight_;
    for (const std::size_t v : unknown) {
      double largest_size = 0, largest_field = -INFINITY;
      for (std::size_t bin = 0; bin < nodes_[v].bias.size(); ++bin) {
        largest_size = std::max(largest_size, std::abs(nodes_[v].field[bin * hidden + j]));
        largest_field = std::max(largest_field, nodes_[v].field[bin * hidden + j]);
      }
      size += largest_size;
      highest += largest_field;
    }
    if (!(size < kMaxLog)) return false;
    log_product += softplus(highest);
  }
  return log_product < kMaxLog;
}

std::vector<double> Posterior::outcome_products(std::span<const double> field,
                                                const std::vector<std::size_t>& unknown) const {
  const std::size_t hidden = field.size(), depth = unknown.size();
  // Level k: what the known and the first k unknown variables give.
  std::vector<std::vector<double>> power(depth + 1, std::vector<double>(hidden));
  std::vector<double> weight(depth + 1, 1.0), product(padded_outcomes()), sum(padded_outcomes(), 0.0);
  for (std::size_t j = 0; j < hidden; ++j) power[0][j] = std::exp(field[j]);
  for_each_combination(
      bin_counts(unknown),
      [&](std::size_t k, std::size_t bin) {
        const Nodes& nodes = nodes_[unknown[k]];
        const double* factor = nodes.factor.data() + bin * hidden;
        for (std::size_t j = 0; j < hidden; ++j) power[k + 1][j] = power[k][j] * factor[j];
        weight[k + 1] = weight[k] * nodes.weight[bin];
      },
      [&] {
        multiply<kOutcomesAtOnce>(power[depth], outcome_base_, outcome_factor_by_hidden_, product);
        const double share =
            has_prior_ ? weight[depth] / std::accumulate(product.begin(), product.end(), 0.0) : weight[depth];
        for (std::size_t y = 0; y < sum.size(); ++y) sum[y] += share * product[y];
      });
  sum.resize(outcome_count());
  return sum;
}

void Posterior::shares_of_products(std::span<const double> power, std::span<double> product) const {
  multiply<kOutcomesAtOnce>(power, outcome_base_, outcome_factor_by_hidden_, product);
  const double total = std::accumulate(product.begin(), product.end(), 0.0);
  for (double& p : product) p /= total;
}

std::optional<PosteriorAnswer> Posterior::sum_products(std::span<const double> field,
                                                       const std::vector<std::size_t>& unknown) const {
  if (!products_fit(field, unknown)) return std::nullopt;
  PosteriorAnswer answer;
  answer.probability = outcome_products(field, unknown);
  const double total = std::accumulate(answer.probability.begin(), answer.probability.end(), 0.0);
  for (double& p : answer.probability) p /= total;
  answer.standard_error.assign(outcome_count(), 0.0);
  return answer;
}

}  // namespace gonogo::learning
