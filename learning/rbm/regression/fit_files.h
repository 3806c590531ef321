// Fitted processes and regressions as groups of an HDF5 file, with what they need to answer and no more.
#pragma once
#include <string>

#include "base/hdf5/hdf5.h"
#include "learning/rbm/regression/baselines.h"
#include "learning/rbm/regression/gaussian_process.h"

namespace gonogo::learning {

/// Writes a new group.
void write_fit(Hdf5Writer& out, const std::string& group, const GaussianProcessModel& fit);
void write_fit(Hdf5Writer& out, const std::string& group, const GaussianRegression& fit);
void write_fit(Hdf5Writer& out, const std::string& group, const LogisticModel& fit);

/// The fits of these groups, which answer as the written ones to the last bit; a process has no variances, and a
/// regression no leave_one_out(). Throw InputError for a group that is missing, damaged or of other sizes.
GaussianProcessModel read_process(const Hdf5Reader& in, const std::string& group);
GaussianRegression read_regression(const Hdf5Reader& in, const std::string& group);
LogisticModel read_logistic(const Hdf5Reader& in, const std::string& group);

}  // namespace gonogo::learning
