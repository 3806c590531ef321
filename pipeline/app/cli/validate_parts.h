// The commands under `gonogo validate`.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "pipeline/app/cli/command.h"
#include "pipeline/lab/validate/soil_figure.h"

namespace gonogo::app {

/// Makes the figures, writes each to `folder` unless that is empty, and prints their checks. Throws DeviceError with
/// the number of checks of `what` ("soils") that do not hold, if any.
void report_figures(const Globals& globals, const std::vector<std::string>& names, const std::string& folder,
                    const std::string& what, const std::function<lab::SoilFigure(const std::string&)>& make);

void add_elastic_check(CLI::App& validate, const Globals& globals);
void add_fclib_check(CLI::App& validate, const Globals& globals);
void add_soils_check(CLI::App& validate, const Globals& globals);
void add_wheels_check(CLI::App& validate, const Globals& globals);
/// patch, folded, drawbar, grade
void add_trial_checks(CLI::App& validate, const Globals& globals);

}  // namespace gonogo::app
