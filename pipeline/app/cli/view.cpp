#include <memory>

#include "pipeline/app/cli/command.h"

namespace gonogo::app {

void add_view_command(CLI::App& app, const Globals& globals, const Work<ViewOptions>& work) {
  CLI::App* command = app.add_subcommand("view", "Show a map to a browser on this machine, tiles read on demand");
  const auto options = std::make_shared<ViewOptions>();
  command->add_option("folder", options->folder, "Folder of a map")->type_name(kFolder)->required();
  command->add_option("--port", options->port, "Port; 0 takes any free one")->capture_default_str();
  command
      ->add_option("--address", options->address,
                   "IPv4 address to listen on; other than the default it lets other machines read the map")
      ->type_name("ADDRESS")
      ->capture_default_str();
  add_examples(*command, {"gonogo view out/demo/map"},
               "Small maps need no server: open index.html. On large ones, whose page is thinned out, zooming in shows "
               "every cell.");
  command->callback([options, work, &globals] { work(globals, *options); });
}

}  // namespace gonogo::app
