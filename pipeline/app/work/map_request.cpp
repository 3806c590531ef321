#include "pipeline/app/work/map_request.h"

#include "pipeline/lab/vehicle/locate.h"

namespace gonogo::app {

map::MapRequest map_request_of(const Globals& globals, map::MapFiles files) {
  files.threads = globals.threads;
  if (!files.vehicle.empty()) files.vehicle = lab::vehicle_file(files.vehicle.string());
  if (!files.whole_vehicle.empty()) files.whole_vehicle = lab::vehicle_file(files.whole_vehicle.string());
  return map::read_map_request(files);
}

}  // namespace gonogo::app
