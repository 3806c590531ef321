#include <memory>

#include "pipeline/app/cli/map_options.h"

namespace gonogo::app {

void add_map_command(CLI::App& app, const Globals& globals, const Work<map::MapFiles>& work) {
  CLI::App* command =
      app.add_subcommand("map", "Go/NoGo map of a region: a page, GeoTIFF layers, QGIS styles, figure, area table");
  const auto files = std::make_shared<map::MapFiles>();
  add_map_file_options(*command, *files);
  command
      ->add_option("--members", files->members,
                   "Members of the model (gonogo train --members): their spread widens the interval on P(go)")
      ->type_name(kFile);
  command
      ->add_option("--heading", files->heading,
                   "Of class, P(go) and reason: one of these, or degrees clockwise from grid north")
      ->type_name(one_of({"uphill", "worst", "best"}));
  command->add_option("--out", files->out, "Folder of the map")->type_name(kFolder)->required();
  command->add_flag("--colour-blind-safe", files->colour_blind_safe, "Class colours that do not rely on red and green");
  add_examples(*command,
               {"gonogo map --model hmmwv --dem elevation.tif --soil sand --moisture wet --out out/map",
                "gonogo map --model out/demo/model.h5 --region configs/regions/sagehen.json --out out/map"},
               "Writes index.html, a page that opens from disk; go.tif (class), p_go.tif, reason.tif and more layers, "
               "each\nwith a QGIS style; map.png, area.csv and map.json. gonogo models lists the models that ship; "
               "docs/map.md\nsays what the numbers mean.");
  command->callback([files, work, &globals] { work(globals, *files); });
}

}  // namespace gonogo::app
