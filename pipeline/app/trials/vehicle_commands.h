// Subcommands of gonogo vehicle that have files of their own.
#pragma once
#include "pipeline/app/cli/command.h"

namespace gonogo::app {

void add_vehicle_numbers(CLI::App& vehicle, const Globals& globals);
void add_vehicle_model(CLI::App& vehicle, const Globals& globals);
void add_vehicle_study(CLI::App& vehicle, const Globals& globals);
void add_vehicle_new(CLI::App& vehicle, const Globals& globals);

}  // namespace gonogo::app
