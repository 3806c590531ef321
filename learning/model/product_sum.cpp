// The sum of Posterior::sum_logarithms in products instead of logarithms: with a_j = exp(field of hidden unit j),
//
//   P(y | known) proportional to sum over combinations of exp(bias) exp(d_y) prod_j (1 + a_j exp(U_yj)),
//
// where a_j of a combination is the product of what its bins give. No exponential and no logarithm is left inside the
// sum. Only where no product can leave the range of double; elsewhere there is no answer.
#include <algorithm>
#include <array>
#include <cmath>

#include "learning/model/posterior.h"

namespace gonogo::learning {
namespace {

constexpr double kLargestLog = 600;  // e^600 times any number of terms is finite in double; e^-600 is not 0

/// sum[y] += weight prod_j (1 + a_j factor[j][y]), `Width` outcomes at a time so that they stay in registers.
template <std::size_t Width>
void add_products(std::span<const double> a, double weight, std::span<const double> factor, std::span<double> sum) {
  for (std::size_t first = 0; first < sum.size(); first += Width) {
    std::array<double, Width> product;
    product.fill(weight);
    for (std::size_t j = 0; j < a.size(); ++j) {
      const double* of_hidden = factor.data() + j * sum.size() + first;
      for (std::size_t y = 0; y < Width; ++y) product[y] *= 1 + a[j] * of_hidden[y];
    }
    for (std::size_t y = 0; y < Width; ++y) sum[first + y] += product[y];
  }
}

}  // namespace

/// Whether every number of the sum stays in the range of double: each factor on its way, by the sizes of what is added
/// up in its exponent, and the products of all hidden units, by the largest softplus of each.
bool Posterior::products_fit(std::span<const double> field, const std::vector<std::size_t>& unknown) const {
  const std::size_t hidden = field.size();
  double log_product = 0;
  for (std::size_t j = 0; j < hidden; ++j) {
    double size = std::abs(field[j]) + largest_outcome_size_;
    for (const std::size_t v : unknown) {
      double most = 0;
      for (std::size_t bin = 0; bin < nodes_[v].bias.size(); ++bin)
        most = std::max(most, std::abs(nodes_[v].field[bin * hidden + j]));
      size += most;
    }
    if (!(size < kLargestLog)) return false;
    log_product += softplus(size);
  }
  return log_product < kLargestLog;
}

std::vector<double> Posterior::outcome_products(std::span<const double> field,
                                                const std::vector<std::size_t>& unknown) const {
  const std::size_t hidden = field.size(), depth = unknown.size();
  // Odometer over the code words; level k is what the known and the first k unknown variables give.
  std::vector<std::size_t> bin(depth, 0);
  std::vector<std::vector<double>> power(depth + 1, std::vector<double>(hidden));
  std::vector<double> weight(depth + 1, 1.0), sum(padded_outcomes(), 0.0);
  for (std::size_t j = 0; j < hidden; ++j) power[0][j] = std::exp(field[j]);
  for (std::size_t level = 0;;) {
    for (; level < depth; ++level) {
      const Nodes& nodes = nodes_[unknown[level]];
      const double* factor = nodes.factor.data() + bin[level] * hidden;
      for (std::size_t j = 0; j < hidden; ++j) power[level + 1][j] = power[level][j] * factor[j];
      weight[level + 1] = weight[level] * nodes.weight[bin[level]];
    }
    add_products<kOutcomesAtOnce>(power[depth], weight[depth], outcome_factor_by_hidden_, sum);
    while (level > 0 && ++bin[level - 1] == nodes_[unknown[level - 1]].middle.size()) bin[--level] = 0;
    if (level == 0) break;
    --level;
  }
  sum.resize(outcome_count());
  return sum;
}

std::optional<PosteriorAnswer> Posterior::sum_products(std::span<const double> field,
                                                       const std::vector<std::size_t>& unknown) const {
  if (!products_fit(field, unknown)) return std::nullopt;
  PosteriorAnswer answer;
  answer.probability = outcome_products(field, unknown);
  for (std::size_t y = 0; y < outcome_count(); ++y)
    answer.probability[y] = outcome_bias_[y] + std::log(answer.probability[y]);
  const double total = log_sum_exp(answer.probability);
  for (double& p : answer.probability) p = std::exp(p - total);
  answer.standard_error.assign(outcome_count(), 0.0);
  return answer;
}

}  // namespace gonogo::learning
