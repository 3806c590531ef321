// Trials whose means over seeds are compared.
#pragma once
#include <vector>

#include "pipeline/campaign/trial/batch.h"

namespace gonogo::lab {

/// The same variables with the seeds 0, 1, ...: replicates of one trial.
std::vector<campaign::DesignPoint> replicates(const std::vector<double>& variables, int count);

/// Dry soil of this friction angle, medium dense, 0.3 m deep, in the contract's order [deg], [m/s].
std::vector<double> plain_variables(const campaign::TrialSetup& setup, double slope_along, double friction_angle,
                                    double speed);

/// Side by side in one batch, records in the order of the points. `watch` may be shorter than the points: the rest are
/// not watched.
std::vector<campaign::TrialRecord> run_trials(const campaign::TrialSetup& setup,
                                              const std::vector<campaign::DesignPoint>& points,
                                              const campaign::BatchSettings& batch,
                                              const std::vector<campaign::TrialWatch>& watch = {});

}  // namespace gonogo::lab
