// At which temperature a machine really sampled: estimates from its rows. Rows follow exp(-beta E) more or less; beta
// is in the units of the problem that is passed here.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "learning/qubo/problem.h"
#include "learning/qubo/sample_set.h"

namespace gonogo::learning {

struct BetaEstimate {
  double beta = 0, low = 0, high = 0;  // 95 % bootstrap interval over reads
};

/// Maximum pseudo-likelihood: the beta under which every spin, given all others, is most probable (Besag 1975; Raymond,
/// Yarkoni, Andriyash, Front. ICT 3:23 (2016)). The bootstrap draws as many reads as there are and takes one Newton
/// step from the estimate for each. `weight` replaces occurrences, e.g. by exact probabilities. Infinite when every row
/// is a local minimum.
BetaEstimate pseudo_likelihood_beta(const Problem& problem, const SampleSet& rows, std::uint64_t seed = 1,
                                    std::span<const double> weight = {}, std::size_t draws = 200);

/// Two sets of energies of one problem that was programmed at two scales: log of the ratio of their histograms is
/// linear in the energy with slope -(scale - other_scale) times beta at scale 1, whatever the density of states
/// (Benedetti et al., PRA 94, 022308 (2016)). Weighted regression over `bins` bins of equally many energies.
BetaEstimate histogram_beta(std::span<const double> energies, double scale, std::span<const double> other_energies,
                            double other_scale, std::uint64_t seed = 1, std::size_t bins = 16, std::size_t draws = 200);

/// T(scale) = offset + slope / scale by weighted least squares: devices add a temperature that does not depend on the
/// programmed scale (arXiv:2512.03162); offset 0 is the naive model.
struct OffsetModel {
  double offset = 0, slope = 1;
  double scale_for(double temperature) const { return slope / (temperature - offset); }
};
/// error: standard errors of the temperatures. At least two different scales; throws InputError otherwise.
OffsetModel fit_offset_model(std::span<const double> scale, std::span<const double> temperature,
                             std::span<const double> error);

}  // namespace gonogo::learning
