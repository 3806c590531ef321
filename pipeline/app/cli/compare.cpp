#include "pipeline/map/write/compare_maps.h"

#include <memory>

#include "pipeline/app/cli/command.h"

namespace gonogo::app {

void add_compare_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand(
      "compare", "Two maps of a region: where one passes and the other does not, and how sure that is");
  auto request = std::make_shared<map::CompareRequest>();
  command->add_option("first", request->first, "Folder of a map, uphill heading")->required();
  command->add_option("second", request->second, "Folder of another map of the same region")->required();
  command->add_option("--out", request->out, "Folder of the comparison")->required();
  command->footer(
      "Two vehicles, two moistures, or before and after more trials. Writes change.tif, difference.tif, "
      "significance.tif,\n"
      "change_significance.tif, a figure, an overlay for globes and compare.csv; docs/map.md says how significance is "
      "judged.\n\n"
      "Example:\n  gonogo compare out/dry out/wet --out out/dry_and_wet");
  command->callback([request, &globals] {
    request->threads = globals.threads;
    const Json result = map::compare_maps(*request);
    print_result(globals, result, map::compare_text(result));
  });
}

}  // namespace gonogo::app
