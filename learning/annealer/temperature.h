// Estimates of the inverse temperature of a machine from its rows, which follow exp(-beta E) approximately. beta is in
// the units of the given problem.
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

/// Maximum pseudo-likelihood: the beta that makes every spin most probable given all others (Besag 1975; Raymond,
/// Yarkoni, Andriyash, Front. ICT 3:23 (2016)). Each of `draws` bootstrap resamples takes one Newton step from the
/// estimate. `weight` replaces occurrences, e.g. by exact probabilities. Infinite when every row is a local minimum.
BetaEstimate pseudo_likelihood_beta(const Problem& problem, const SampleSet& rows, std::uint64_t seed = 1,
                                    std::span<const double> weight = {}, std::size_t draws = 200);

/// From energies of one problem, programmed at two scales. The log ratio of their histograms is linear in the energy
/// with slope -(scale - other_scale) times beta at scale 1, for every density of states (Benedetti et al., PRA 94,
/// 022308 (2016)). Weighted regression over `bins` bins of equally many energies.
BetaEstimate histogram_beta(std::span<const double> energies, double scale, std::span<const double> other_energies,
                            double other_scale, std::uint64_t seed = 1, std::size_t bins = 16, std::size_t draws = 200);

/// T(scale) = offset + slope / scale. Devices add a temperature that does not depend on the programmed scale
/// (arXiv:2512.03162).
struct OffsetModel {
  double offset = 0, slope = 1;
  double scale_for(double temperature) const { return slope / (temperature - offset); }
};
/// Weighted least squares. error: standard errors of the temperatures. Throws InputError unless two scales differ.
OffsetModel fit_offset_model(std::span<const double> scale, std::span<const double> temperature,
                             std::span<const double> error);

}  // namespace gonogo::learning
