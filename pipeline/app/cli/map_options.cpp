#include "pipeline/app/cli/map_options.h"

#include "pipeline/lab/vehicle/locate.h"

namespace gonogo::app {

void add_map_file_options(CLI::App& command, map::MapFiles& files) {
  command.add_option("--model", files.model, "Trained model (model.h5)")->required();
  command.add_option("--region", files.region, "Region file; by default the one that the study names");
  command.add_option("--study", files.study, "Study file: thresholds and mission values of its section \"map\"");
  command.add_option("--dataset", files.dataset, "Trials (dataset.h5): expected speed, slip, sinkage and energy");
  command.add_option("--vehicle", files.vehicle,
                     "Vehicle (file or name) whose cone index fine-grained soil must reach; by default the study's");
  command.add_option("--moisture", files.moisture,
                     "Scenario: dry, moist or wet; by default the raster's or every sample");
}

map::MapRequest map_request_of(map::MapFiles files, const Globals& globals) {
  files.threads = globals.threads;
  if (!files.vehicle.empty()) files.vehicle = lab::vehicle_file(files.vehicle.string());
  return map::read_map_request(files);
}

}  // namespace gonogo::app
