// The commands under `gonogo soil` that have a file of their own.
#pragma once
#include "pipeline/app/cli/command.h"

namespace gonogo::app {

void add_soil_export(CLI::App& soil, const Globals& globals);

}  // namespace gonogo::app
