#include <memory>

#include "pipeline/app/cli/work.h"
#include "pipeline/map/soil_grids/make_region.h"

namespace gonogo::app {
namespace {

void make_region_file(const Globals& globals, const map::RegionMakeRequest& request) {
  const map::RegionMade made = map::make_region(request);
  Json result = Json::object(), files = Json::array();
  std::string text = std::to_string(made.soils) + " mixtures of textures\n";
  for (const std::string& remark : made.remarks) text += "  " + remark + "\n";
  for (const auto& file : made.files) {
    files.push_back(Json(file.string()));
    text += file.string() + "\n";
  }
  result["soils"] = made.soils;
  result["remarks"] = Json(made.remarks);
  result["files"] = files;
  print_result(globals, result, text);
}

}  // namespace

void add_region_command(CLI::App& app, const Globals& globals) {
  CLI::App* region = app.add_subcommand("region", "Region files, which say what the ground of a map is made of");
  region->require_subcommand(1);
  add_examples(*region, {"gonogo region make my_valley"});
  CLI::App* command = region->add_subcommand(
      "make", "Region file of a folder with an elevation model and soil layers of SoilGrids, SSURGO or gNATSGO");
  const auto request = std::make_shared<map::RegionMakeRequest>();
  add_named(*command, "folder", request->folder, kFolder, "Folder of the rasters; the region file is written into it")
      ->required();
  command->add_option("--name", request->name, "Name of the region; default: the folder's");
  command
      ->add_option("--suction", request->suction,
                   "Which layer of water the ground holds: at a suction of 10, 33 or 1500 kPa; default: 33")
      ->check(CLI::IsMember({10, 33, 1500}));
  add_number(*command, "--texture-error", request->texture_error, {0.0, 50.0},
             "Standard error of sand and clay where no layers of low and high values are given [%]");
  add_examples(
      *command,
      {"gonogo region make my_valley", "gonogo map --model hmmwv --region my_valley/region.json --out out/my_valley"},
      "Names and units of the layers, and where to get them: docs/regions.md.");
  calls<make_region_file>(*command, globals, request);
}

}  // namespace gonogo::app
