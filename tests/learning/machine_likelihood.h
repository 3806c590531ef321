// Log-likelihood of rows under a machine too large to enumerate, as a bracket from two sides.
//
// Both estimators pass through machines between independent units (beta = 0) and the machine itself (beta = 1),
//
//   f_beta(v) = exp(((1 - beta) a0 + beta a).v) prod_j (1 + exp(beta (b + v'W)_j)),
//
// with a0 the log odds of the rows' means (Salakhutdinov & Murray, ICML 2008, section 4.1), by block-Gibbs sweeps
// v -> h -> v, which are reversible for f_beta.
//
//   AIS    goes up. The mean of its weights is Z (Neal 2001). The mean of log Z is too low, so log P(v) is too high.
//   RAISE  goes down from each row. The mean of its weights is the row's probability under the annealing process. The
//          mean of its log is too low (Burda, Grosse, Salakhutdinov, AISTATS 2015, arXiv:1412.8566).
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "learning/encoding/encoder.h"
#include "learning/model/weights.h"
#include "learning/sampler/chains/chain_random.h"

namespace gonogo::learning {

/// Exact mean of log P(v) over rows [row_count x visible_count]. Throws InputError when the smaller side is too large
/// to enumerate.
double mean_log_likelihood(const RbmWeights& weights, std::span<const double> rows);

struct AnnealingSettings {
  std::size_t steps = 10'000;  // intermediate machines, equal steps of beta
  std::size_t chains = 100;    // of AIS
  std::size_t row_chains = 4;  // of RAISE, for each row
  std::uint64_t seed = 1;
};

/// log Z by AIS. [low, high] spans three standard errors of the mean weight; low is -infinity when the error reaches
/// the mean. effective_chains: number of equally weighted chains with the same information.
struct LogZEstimate {
  double log_z = 0, low = 0, high = 0, effective_chains = 0;
};

/// base_bias: a0 [visible_count]. The bits do not depend on threads.
LogZEstimate annealed_log_z(const RbmWeights& weights, std::span<const double> base_bias,
                            const AnnealingSettings& settings = {});

/// RAISE's mean log P(v) over rows [row_count x visible_count], with its standard error over rows.
struct RaiseEstimate {
  double mean = 0, standard_error = 0;
};
RaiseEstimate raise_log_likelihood(const RbmWeights& weights, std::span<const double> base_bias,
                                   std::span<const double> rows, const AnnealingSettings& settings = {});

/// a0: log odds of the rows' means, with half a row added to both sides.
std::vector<double> independent_bias(std::span<const double> rows, std::size_t visible_count);

/// Mean log P(v) over rows [nat]. Exact when one side has at most kMaxExact units; otherwise between RAISE and AIS.
struct LikelihoodBracket {
  bool exact = false;
  double mean = 0, low = 0, high = 0;  // exact, or by AIS's log Z and its interval
  double raise = 0, raise_error = 0;   // when exact: the mean and 0
  double effective_chains = 0;         // of AIS
};
inline constexpr std::size_t kMaxExact = 18;
LikelihoodBracket bracket_log_likelihood(const RbmWeights& weights, std::span<const double> rows,
                                         const AnnealingSettings& settings = {});

/// The machines f_beta between independent units and a given machine.
struct AnnealedMachine {
  AnnealedMachine(const RbmWeights& weights, std::span<const double> base_bias);
  double log_z_independent() const;  // log of the sum over v of f_0(v)

  RbmWeights machine;
  std::vector<double> weight_transpose;  // [hidden x visible]
  std::vector<double> base_bias;         // a0
};

/// One chain on them: a visible row and its hidden fields. Draws depend on (seed, chain, step) alone.
class AnnealedChain {
 public:
  AnnealedChain(const AnnealedMachine& machine, std::uint64_t seed, std::uint64_t chain);
  void start_independent();                        // v ~ f_0
  void start_at(std::span<const double> row);      // of {0, 1}
  double log_ratio(double from, double to) const;  // log f_to(v) - log f_from(v)
  void sweep(double beta, std::uint64_t step);     // step >= 1, each used once

 private:
  void refresh();
  const AnnealedMachine& machine_;
  ChainRandom random_;
  std::vector<Bit> visible_, hidden_;
  std::vector<double> field_, scaled_, visible_field_;  // field_: b + v'W
};

}  // namespace gonogo::learning
