// How well Markov chains have mixed: rank-normalised split R-hat and effective sample size.
// Vehtari, Gelman, Simpson, Carpenter, Buerkner, Bayesian Analysis 16:667 (2021), sections 3.1 and 4; the cut of the
// autocorrelation is that of Geyer, Statistical Science 7:473 (1992), section 3.3.
#pragma once
#include <span>
#include <vector>

namespace gonogo::learning {

/// Quantile of the standard normal distribution, p in (0, 1), to full precision of a double's erfc.
double normal_quantile(double p);

struct Mixing {
  double r_hat = 0;      // 1 when chains agree; above 1.01 they have not mixed
  double effective = 0;  // number of independent draws with the same information about the mean ("bulk" ESS)
};

/// draws: [chain x draw], all chains of one length. Both numbers are NaN where a chain has fewer than four draws or all
/// draws are equal.
Mixing mixing(std::span<const double> draws, std::size_t chains);

}  // namespace gonogo::learning
