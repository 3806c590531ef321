#include <memory>

#include "pipeline/app/cli/command.h"

namespace gonogo::app {

void add_compare_command(CLI::App& app, const Globals& globals, const Work<map::CompareRequest>& work) {
  CLI::App* command = app.add_subcommand(
      "compare", "Two maps of a region: where one passes and the other does not, and how sure that is");
  const auto request = std::make_shared<map::CompareRequest>();
  command->add_option("first", request->first, "Folder of a map, uphill heading")->type_name(kFolder)->required();
  command->add_option("second", request->second, "Folder of another map of the same region")
      ->type_name(kFolder)
      ->required();
  command->add_option("--out", request->out, "Folder of the comparison")->type_name(kFolder)->required();
  add_examples(
      *command, {"gonogo compare out/dry out/wet --out out/dry_and_wet"},
      "Two vehicles, two moistures, or before and after more trials. Writes change.tif, difference.tif,\n"
      "significance.tif, change_significance.tif, a figure, an overlay for globes and compare.csv; docs/map.md "
      "says\nhow significance is judged.");
  command->callback([request, work, &globals] { work(globals, *request); });
}

}  // namespace gonogo::app
