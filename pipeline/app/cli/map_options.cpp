#include "pipeline/app/cli/map_options.h"

namespace gonogo::app {

void add_map_file_options(CLI::App& command, map::MapFiles& files) {
  command.add_option("--model", files.model, "Trained model: name of a shipped one or of its vehicle, or model.h5")
      ->type_name(kModel)
      ->required();
  command.add_option("--dem", files.dem, "Elevation raster; no region file is needed then")->type_name(kFile);
  command
      .add_option("--soil", files.soil,
                  "With --dem: USDA texture, soil of configs/soils, soil file, or raster of USDA textures; without "
                  "it the soil may be anything")
      ->type_name(kSoil);
  command.add_option("--moisture", files.moisture, "Moisture of the soil; by default the raster's or any")
      ->type_name(one_of({"dry", "moist", "wet"}));
  command
      .add_option("--set", files.set, "Value of the mission, such as payload=500; by default all that trials sampled")
      ->type_name(kSetting);
  command.add_option("--region", files.region, "Region file; by default the one that the study names")
      ->type_name(kFile);
  command
      .add_option("--height-unit", files.height_unit,
                  "Unit of the elevations; by default as the raster says, or metres")
      ->type_name(one_of({"m", "ft", "us-ft"}))
      ->check(CLI::IsMember({"m", "ft", "us-ft"}));
  command.add_flag("--flat-is-ground", files.flat_is_ground,
                   "Large areas of exactly one height are ground; by default unknown, as water and voids are such");
  command.add_option("--study", files.study, "Study file: thresholds and mission values of its section \"map\"")
      ->type_name(kStudy);
  command
      .add_option("--crossing-model", files.crossing_model,
                  "Model of trials that cross ditches, for the region's; by default the one that ships for the vehicle")
      ->type_name(kModel);
  command.add_option("--dataset", files.dataset, "Trials of the model; by default dataset.h5 beside it")
      ->type_name(kFile);
  command.add_option("--vehicle", files.vehicle, "Refuse unless the model is of this vehicle")->type_name(kVehicle);
  command
      .add_option("--whole-vehicle", files.whole_vehicle,
                  "For a quarter vehicle: the whole one, for cone index and driveline; by default the study's")
      ->type_name(kVehicle);
  command
      .add_option("--max-speed", files.max_speed_km_h,
                  "Speed that is never exceeded [km/h]; by default the driveline's")
      ->check(CLI::Range(map::kMaxSpeedRange.minimum, map::kMaxSpeedRange.maximum));
}

}  // namespace gonogo::app
