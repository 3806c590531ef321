#include <memory>

#include "pipeline/app/cli/map_options.h"

namespace gonogo::app {

void add_route_command(CLI::App& app, const Globals& globals, const Work<RouteOptions>& work) {
  CLI::App* command = app.add_subcommand(
      "route", "Ways over a region: fastest, safest, of least energy, shortest; what can be reached");
  const auto options = std::make_shared<RouteOptions>();
  add_map_file_options(*command, options->files);
  command->add_option("--from", options->from, "Start: easting,northing in the region's coordinate system")
      ->type_name("E,N");
  command->add_option("--to", options->to, "End, likewise")->type_name("E,N");
  command->add_option("--via", options->via, "Places to pass between, in this order")->type_name("E,N");
  command
      ->add_option("--avoid", options->avoid,
                   "Polygons that no way may touch: GeoJSON, GeoPackage or another format of GDAL")
      ->type_name(kFile);
  command->add_flag("--eight-directions", options->eight_directions,
                    "Steps to the eight neighbours only, as the page takes; quicker, up to 8 % longer");
  command
      ->add_option("--turning", options->turning,
                   "A turn by 90 degrees costs as much as driving so many metres there; 0: turns cost nothing [m]")
      ->type_name("NUMBER")
      ->capture_default_str();
  command->add_option("--cost", options->costs, "What a way has least of; several give several lines")
      ->type_name(one_of({"fastest", "safest", "least-energy", "shortest"}))
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--out", options->out, "Lines: .gpkg, .geojson, or .gpx with elevation and time")
      ->type_name(kFile);
  command
      ->add_option("--departure", options->departure,
                   "When the track of a .gpx starts, such as 2026-05-01T06:00:00Z; by default the first second of 2000")
      ->type_name("TIME");
  command->add_option("--reach", options->reach, "GeoTIFF of the least cost from the start to every cell")
      ->type_name(kFile);
  command
      ->add_option("--isochrones", options->isochrones,
                   "GeoPackage: polygons of what is reached from the start within bands of the first cost")
      ->type_name(kFile);
  command->add_option("--interval", options->interval,
                      "Width of these bands: s, m, J, or for the safest -ln of the chance; by default a round one");
  command
      ->add_option("--regions", options->regions,
                   "GeoPackage: connected regions, inside of which every place can be reached from every other")
      ->type_name(kFile);
  command
      ->add_option("--costmap", options->costmap,
                   "Costmap for Nav2 by the first cost: .yaml, and a .pgm beside it; docs/map.md says what values mean")
      ->type_name(kFile);
  command
      ->add_option("--grid-map", options->grid_map,
                   "Layers for grid_map, .nc or .tif: elevation, and by heading the first cost and what passes")
      ->type_name(kFile);
  add_examples(*command,
               {"gonogo route --model out/demo/model.h5 \\\n"
                "      --region configs/regions/sagehen.json --from 216000,4368000 --to 221000,4372500 \\\n"
                "      --cost fastest,safest --out routes.gpkg --isochrones minutes.gpkg"},
               "Costs and what a route may cross: docs/map.md.");
  command->callback([options, work, &globals] { work(globals, *options); });
}

}  // namespace gonogo::app
