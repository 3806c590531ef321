#include "pipeline/app/cli/map_options.h"

namespace gonogo::app {

void add_map_file_options(CLI::App& command, map::MapFiles& files) {
  command.add_option("--model", files.model, "Trained model (model.h5)")->type_name(kFile)->required();
  command.add_option("--region", files.region, "Region file; by default the one that the study names")
      ->type_name(kFile);
  command.add_option("--study", files.study, "Study file: thresholds and mission values of its section \"map\"")
      ->type_name(kStudy);
  command.add_option("--dataset", files.dataset, "Trials (dataset.h5): expected speed, slip, sinkage and energy")
      ->type_name(kFile);
  command
      .add_option("--vehicle", files.vehicle,
                  "Vehicle whose cone index fine-grained soil must reach; by default the study's")
      ->type_name(kVehicle);
  command.add_option("--moisture", files.moisture, "Scenario; by default the raster's or every sample")
      ->type_name(one_of({"dry", "moist", "wet"}));
}

}  // namespace gonogo::app
