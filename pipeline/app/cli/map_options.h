// Options of what a map is made from, for the commands map and route.
#pragma once
#include "pipeline/app/cli/command.h"

namespace gonogo::app {

/// --model, --dem, --soil, --region, --study and what else says of which ground and mission. `files` must outlive the
/// parsing.
void add_map_file_options(CLI::App& command, map::MapFiles& files);

}  // namespace gonogo::app
