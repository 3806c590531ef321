#include <cstdio>
#include <memory>

#include "base/progress.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/map/view/map_view.h"

namespace gonogo::app {
namespace {

struct Options {
  std::string folder, address = "127.0.0.1";
  std::uint16_t port = 8470;
};

}  // namespace

void add_view_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("view", "Show a map to a browser on this machine, tiles read on demand");
  auto options = std::make_shared<Options>();
  command->add_option("folder", options->folder, "Folder of a map")->required();
  command->add_option("--port", options->port, "Port; 0 takes any free one")->capture_default_str();
  command
      ->add_option("--address", options->address,
                   "IPv4 address to listen on; other than the default it lets other machines read the map")
      ->capture_default_str();
  command->footer(
      "Small maps need no server: open index.html. On large ones, whose page is thinned out, zooming in shows every "
      "cell.\n\n"
      "Example:\n  gonogo view out/demo/map");
  command->callback([options, &globals] {
    const map::MapView view(options->folder);
    map::HttpServer server(options->address, options->port);
    const std::string address = "http://" + options->address + ":" + std::to_string(server.port()) + "/";
    log_line("view", address + " until Ctrl-C");
    server.run([&](const std::string& path) { return view.answer(path); });
    Json result = Json::object();
    result["address"] = address;
    print_result(globals, result, "");
  });
}

}  // namespace gonogo::app
