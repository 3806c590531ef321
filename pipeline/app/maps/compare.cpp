#include <memory>

#include "pipeline/app/cli/work.h"
#include "pipeline/map/write/compare_maps.h"

namespace gonogo::app {
namespace {

void compare(const Globals& globals, const map::CompareRequest& request) {
  map::CompareRequest asked = request;
  asked.threads = globals.threads;
  const map::MapComparison result = map::compare_maps(asked);
  print_result(globals, map::compare_json(result), map::compare_text(result));
}

}  // namespace

void add_compare_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand(
      "compare", "Two maps of a region: where one passes and the other does not, and how sure that is");
  const auto request = std::make_shared<map::CompareRequest>();
  add_named(*command, "first", request->first, kFolder, "Folder of a map, uphill heading")->required();
  add_named(*command, "second", request->second, kFolder, "Folder of another map of the same region")->required();
  add_named(*command, "--out", request->out, kFolder, "Folder of the comparison")->required();
  add_examples(
      *command, {"gonogo compare out/dry out/wet --out out/dry_and_wet"},
      "Two vehicles, two moistures, or before and after more trials. Writes change.tif, difference.tif,\n"
      "significance.tif, change_significance.tif, a figure, an overlay for globes and compare.csv; docs/map.md "
      "says\nhow significance is judged.");
  calls<compare>(*command, globals, request);
}

}  // namespace gonogo::app
