// From options to the request of a map, for the commands map and route.
#pragma once
#include "pipeline/app/work/result.h"
#include "pipeline/map/write/map_request.h"

namespace gonogo::app {

/// Reads the files; a vehicle may be given by its name.
map::MapRequest map_request_of(const Globals& globals, map::MapFiles files);

}  // namespace gonogo::app
