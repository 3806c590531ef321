#include "learning/score/mixing.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"

namespace gonogo::learning {
namespace {

using Chains = std::vector<std::vector<double>>;  // [chain][draw]

/// The halves of every chain; the middle draw of an odd number is left out.
Chains split(std::span<const double> draws, std::size_t chains) {
  const std::size_t length = draws.size() / chains, half = length / 2;
  Chains result;
  for (std::size_t c = 0; c < chains; ++c)
    for (const std::size_t first : {std::size_t(0), length - half}) {
      const auto part = draws.subspan(c * length + first, half);
      result.emplace_back(part.begin(), part.end());
    }
  return result;
}

/// Normal scores of the ranks, ties at their mean rank (equation 14).
Chains rank_normalised(const Chains& chains) {
  std::vector<std::pair<double, std::pair<std::size_t, std::size_t>>> order;
  for (std::size_t c = 0; c < chains.size(); ++c)
    for (std::size_t n = 0; n < chains[c].size(); ++n) order.push_back({chains[c][n], {c, n}});
  std::sort(order.begin(), order.end());
  Chains result = chains;
  const double count = double(order.size());
  for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
    while (last < order.size() && order[last].first == order[first].first) ++last;
    const double rank = double(first + last + 1) / 2;
    const double z = normal_quantile((rank - 0.375) / (count + 0.25));
    for (std::size_t k = first; k < last; ++k) result[order[k].second.first][order[k].second.second] = z;
  }
  return result;
}

/// Distances from the median of all draws.
Chains folded(const Chains& chains) {
  std::vector<double> all;
  for (const auto& chain : chains) all.insert(all.end(), chain.begin(), chain.end());
  std::sort(all.begin(), all.end());
  const double median = (all[(all.size() - 1) / 2] + all[all.size() / 2]) / 2;
  Chains result = chains;
  for (auto& chain : result)
    for (double& x : chain) x = std::abs(x - median);
  return result;
}

/// W, the mean variance of chains, and var+, the variance of all draws (equations 1 to 3).
struct Variances {
  double within = 0, total = 0;
  std::vector<double> mean;  // [chain]
};

Variances variances(const Chains& chains) {
  const double n = double(chains.front().size()), m = double(chains.size());
  Variances result;
  for (const auto& chain : chains) {
    const double mean = std::accumulate(chain.begin(), chain.end(), 0.0) / n;
    double square = 0;
    for (double x : chain) square += (x - mean) * (x - mean);
    result.within += square / (n - 1) / m;
    result.mean.push_back(mean);
  }
  const double grand = std::accumulate(result.mean.begin(), result.mean.end(), 0.0) / m;
  double between = 0;  // B / n
  for (double mean : result.mean) between += (mean - grand) * (mean - grand) / (m - 1);
  result.total = (n - 1) / n * result.within + between;
  return result;
}

double r_hat(const Chains& chains) {
  const Variances v = variances(chains);
  return std::sqrt(v.total / v.within);
}

/// Autocorrelation of all chains together at one lag (equation 10).
double autocorrelation(const Chains& chains, const Variances& v, std::size_t lag) {
  double covariance = 0;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    double sum = 0;
    for (std::size_t n = lag; n < chains[c].size(); ++n)
      sum += (chains[c][n] - v.mean[c]) * (chains[c][n - lag] - v.mean[c]);
    covariance += sum / double(chains[c].size()) / double(chains.size());
  }
  return 1 - (v.within - covariance) / v.total;
}

/// Sums of two neighbouring lags are added up while they are positive, none larger than the one before. Of the first
/// that is not, and of the last that a chain has, an even lag that is positive counts once (as in ArviZ).
double effective_size(const Chains& chains) {
  const Variances v = variances(chains);
  const std::size_t length = chains.front().size();
  const double draws = double(length * chains.size());
  double tau = -1, before = INFINITY;
  for (std::size_t lag = 0; lag + 1 < length; lag += 2) {
    const double even = lag == 0 ? 1 : autocorrelation(chains, v, lag);
    const double pair = even + autocorrelation(chains, v, lag + 1);
    if (lag > 0 && (pair <= 0 || lag + 4 >= length)) {
      tau += std::max(even, 0.0);
      break;
    }
    before = std::min(before, pair);
    tau += 2 * before;
  }
  return draws / std::max(tau, 1 / std::log10(draws));
}

}  // namespace

double normal_quantile(double p) {
  GONOGO_ASSERT(p > 0 && p < 1);
  double low = -40, high = 40;  // bisection to a fair start, then Newton's steps on the smaller tail
  for (int k = 0; k < 20; ++k) {
    const double middle = (low + high) / 2;
    (std::erfc(-middle / std::sqrt(2.0)) / 2 < p ? low : high) = middle;
  }
  double x = (low + high) / 2;
  for (int k = 0; k < 4; ++k) {
    const double density = std::exp(-x * x / 2) / std::sqrt(8 * std::atan(1.0));
    const double off = x < 0 ? std::erfc(-x / std::sqrt(2.0)) / 2 - p : (1 - p) - std::erfc(x / std::sqrt(2.0)) / 2;
    x -= off / density;
  }
  return x;
}

Mixing mixing(std::span<const double> draws, std::size_t chains) {
  if (chains == 0 || draws.size() % chains != 0 || draws.size() / chains < 4) return {NAN, NAN};
  const auto [least, most] = std::minmax_element(draws.begin(), draws.end());
  if (*least == *most) return {NAN, NAN};
  const Chains halves = split(draws, chains), normal = rank_normalised(halves);
  // The folded draws of a variable of two values may all be equal: they say nothing then.
  const double location = r_hat(normal), scale = r_hat(rank_normalised(folded(halves)));
  return {std::isnan(scale) ? location : std::max(location, scale), effective_size(normal)};
}

}  // namespace gonogo::learning
