#include "pipeline/app/maps/map_options.h"

namespace gonogo::app {

void add_map_file_options(CLI::App& command, map::MapFiles& files) {
  add_named(command, "--model", files.model, kModel,
            "Trained model: name of a shipped one or of its vehicle, or model.h5; by default the one that ships for "
            "--vehicle");
  add_named(command, "--dem", files.dem, kFile, "Elevation raster; no region file is needed then");
  add_named(
      command, "--soil", files.soil, kSoil,
      "With --dem: USDA texture, class of the USCS (SM, CH, ...), soil of configs/soils, soil file, numbers of a test "
      "(\"direct_shear:phi=31,c=0.5\", \"cone:index=414,soil=CL\"), or raster of USDA textures; without it the soil "
      "may be anything");
  add_named(
      command, "--cone-index", files.cone_index, kFile,
      "With --dem: cone index or rating cone index of fine-grained soil, a number [psi, or 414kPa] or a raster [psi]");
  add_named(command, "--moisture", files.moisture, one_of({"dry", "moist", "wet"}),
            "Moisture of the soil; by default the raster's or any");
  add_named(command, "--set", files.set, kSetting,
            "Value of the mission, such as payload=500; by default all that trials sampled");
  add_named(command, "--region", files.region, kFile, "Region file; by default the one that the study names");
  add_named(command, "--height-unit", files.height_unit, one_of({"m", "ft", "us-ft"}),
            "Unit of the elevations; by default as the raster says, or metres")
      ->check(CLI::IsMember({"m", "ft", "us-ft"}));
  command.add_flag("--flat-is-ground", files.flat_is_ground,
                   "Large areas of exactly one height are ground; by default unknown, as water and voids are such");
  add_named(command, "--study", files.study, kStudy,
            "Study file: thresholds and mission values of its section \"map\"");
  add_named(command, "--crossing-model", files.crossing_model, kModel,
            "Model of trials that cross ditches, for the region's; by default the one that ships for the vehicle");
  add_named(command, "--dataset", files.dataset, kFile, "Trials of the model; by default dataset.h5 beside it");
  add_named(command, "--vehicle", files.vehicle, kVehicle,
            "Vehicle, whose shipped model answers; with --model: refuse unless it is of this vehicle");
  add_named(command, "--whole-vehicle", files.whole_vehicle, kVehicle,
            "For a quarter vehicle: the whole one, for cone index and driveline; by default the study's");
  command
      .add_option("--max-speed", files.max_speed_km_h,
                  "Speed that is never exceeded [km/h]; by default the driveline's")
      ->check(CLI::Range(map::kMaxSpeedRange.minimum, map::kMaxSpeedRange.maximum));
}

}  // namespace gonogo::app
