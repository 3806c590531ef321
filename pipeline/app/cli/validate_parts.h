// The commands under `gonogo validate`.
#pragma once
#include "pipeline/app/cli/command.h"

namespace gonogo::app {

void add_elastic_check(CLI::App& validate, const Globals& globals);
void add_fclib_check(CLI::App& validate, const Globals& globals);
void add_soils_check(CLI::App& validate, const Globals& globals);
void add_wheels_check(CLI::App& validate, const Globals& globals);
/// patch, folded, drawbar, grade
void add_trial_checks(CLI::App& validate, const Globals& globals);

}  // namespace gonogo::app
