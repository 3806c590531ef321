// How probable rows are under a machine too large to enumerate: a bracket from two sides.
//
// Both estimators walk machines between independent units (beta = 0) and the machine itself (beta = 1),
//
//   f_beta(v) = exp(((1 - beta) a0 + beta a).v) prod_j (1 + exp(beta (b + v'W)_j)),
//
// with a0 the log odds of the rows' means (Salakhutdinov & Murray, ICML 2008, section 4.1), by block-Gibbs sweeps
// v -> h -> v, which are reversible for f_beta.
//
//   AIS    walks up; the mean of its weights is Z (Neal 2001). Its log is too low in the mean, so that log P(v) comes
//          out too high.
//   RAISE  walks down from each row; the mean of its weights is the row's probability under the annealing itself,
//          whose log is too low in the mean (Burda, Grosse, Salakhutdinov, AISTATS 2015, arXiv:1412.8566).
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "learning/model/weights.h"

namespace gonogo::learning {

/// Mean of log P(v) over rows [row_count x visible_count], exact; throws InputError when the smaller side is too large
/// to enumerate.
double mean_log_likelihood(const RbmWeights& weights, std::span<const double> rows);

struct AnnealingSettings {
  std::size_t steps = 10'000;  // machines between the two ends, beta in equal steps
  std::size_t chains = 100;    // of AIS
  std::size_t row_chains = 4;  // of RAISE, for each row
  std::uint64_t seed = 1;
};

/// log Z by AIS, with the ends that three standard errors of the mean weight give (low is -infinity when the error is
/// as large as the mean), and the number of equally weighted chains that would tell as much.
struct LogZEstimate {
  double log_z = 0, low = 0, high = 0, effective_chains = 0;
};

/// base_bias: a0 [visible_count]. Same bits for any number of threads.
LogZEstimate annealed_log_z(const RbmWeights& weights, std::span<const double> base_bias,
                            const AnnealingSettings& settings = {});

/// Mean over rows [row_count x visible_count] of RAISE's log P(v), and its standard error over rows.
struct RaiseEstimate {
  double mean = 0, standard_error = 0;
};
RaiseEstimate raise_log_likelihood(const RbmWeights& weights, std::span<const double> base_bias,
                                   std::span<const double> rows, const AnnealingSettings& settings = {});

/// Log odds of the means of rows, half a row added to both sides: a0.
std::vector<double> independent_bias(std::span<const double> rows, std::size_t visible_count);

/// Mean log P(v) over rows [nat]: exact when one side has at most kMaxExact units, otherwise between RAISE and AIS.
struct LikelihoodBracket {
  bool exact = false;
  double mean = 0, low = 0, high = 0;  // exact, or with AIS's log Z and its ends
  double raise = 0, raise_error = 0;   // equal to the mean, and 0, when exact
  double effective_chains = 0;         // of AIS
};
inline constexpr std::size_t kMaxExact = 18;
LikelihoodBracket bracket_log_likelihood(const RbmWeights& weights, std::span<const double> rows,
                                         const AnnealingSettings& settings = {});

}  // namespace gonogo::learning
