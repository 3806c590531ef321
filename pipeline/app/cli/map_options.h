// Options of what a map is made from, for the commands map and route.
#pragma once
#include "pipeline/app/cli/command.h"
#include "pipeline/map/write/map_request.h"

namespace gonogo::app {

/// --model, --region, --study, --dataset, --vehicle, --moisture. `files` must outlive the parsing.
void add_map_file_options(CLI::App& command, map::MapFiles& files);

/// Reads what the options name; a vehicle may be given by its name.
map::MapRequest map_request_of(map::MapFiles files, const Globals& globals);

}  // namespace gonogo::app
