// Options of what a map is made from, for the commands map and route.
#pragma once
#include "pipeline/app/cli/command.h"
#include "pipeline/inspect/vehicle_report.h"
#include "pipeline/map/map_request.h"

namespace gonogo::app {

/// --model, --dem, --soil, --region, --study and what else says of which ground and mission. `files` must outlive the
/// parsing.
void add_map_file_options(CLI::App& command, map::MapFiles& files);

/// The request of a map from its options: reads the files. A vehicle may be given by its name.
inline map::MapRequest map_request_of(const Globals& globals, map::MapFiles files) {
  files.threads = globals.threads;
  if (!files.vehicle.empty()) files.vehicle = inspect::vehicle_file(files.vehicle.string());
  if (!files.whole_vehicle.empty()) files.whole_vehicle = inspect::vehicle_file(files.whole_vehicle.string());
  return map::read_map_request(files);
}

}  // namespace gonogo::app
