#include <memory>

#include "pipeline/app/cli/command.h"

namespace gonogo::app {

void add_region_command(CLI::App& app, const Globals& globals, const Work<map::RegionMakeRequest>& make) {
  CLI::App* region = app.add_subcommand("region", "Region files, which say what the ground of a map is made of");
  region->require_subcommand(1);
  add_examples(*region, {"gonogo region make my_valley"});
  CLI::App* command = region->add_subcommand(
      "make", "Region file of a folder with an elevation model and soil layers of SoilGrids, SSURGO or gNATSGO");
  const auto request = std::make_shared<map::RegionMakeRequest>();
  command->add_option("folder", request->folder, "Folder of the rasters; the region file is written into it")
      ->type_name(kFolder)
      ->required();
  command->add_option("--name", request->name, "Name of the region; default: the folder's");
  command
      ->add_option("--suction", request->suction,
                   "Which layer of water the ground holds: at a suction of 10, 33 or 1500 kPa; default: 33")
      ->check(CLI::IsMember({10, 33, 1500}));
  command
      ->add_option("--texture-error", request->texture_error,
                   "Standard error of sand and clay where no layers of low and high values are given [%]")
      ->check(CLI::Range(0.0, 50.0))
      ->capture_default_str();
  add_examples(
      *command,
      {"gonogo region make my_valley", "gonogo map --model hmmwv --region my_valley/region.json --out out/my_valley"},
      "Names and units of the layers, and where to get them: docs/regions.md.");
  command->callback([request, make, &globals] { make(globals, *request); });
}

}  // namespace gonogo::app
