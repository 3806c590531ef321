// Values of a single trial's variables, for one that no design has drawn.
#pragma once
#include <string>
#include <vector>

#include "pipeline/campaign/study/study.h"
#include "pipeline/campaign/trial/setup.h"

namespace gonogo::campaign {

/// [variable] The study's fixed values and the middles of its ranges; NaN where its points come from a file.
std::vector<double> middle_values(const Study& study);

/// [variable] Level ground and soil of the middle friction angle that the calibration reaches, at 1.5 m/s.
std::vector<double> usual_values(const TrialSetup& setup);

/// Sets a variable of the contract. Throws InputError, beginning with `where`, for an unknown name and for a value
/// outside the variable's range.
void set_value(std::vector<double>& values, const std::string& name, double value, const std::string& where);

/// Throws InputError, beginning with `where`, that names the first variable without a value.
void check_all_given(const std::vector<double>& values, const std::string& where);

}  // namespace gonogo::campaign
