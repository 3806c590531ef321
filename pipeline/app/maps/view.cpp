#include <memory>

#include "base/progress.h"
#include "pipeline/app/cli/work.h"
#include "pipeline/map/map_view.h"

namespace gonogo::app {
namespace {

struct ViewOptions {
  std::string folder, address = "127.0.0.1";
  std::uint16_t port = 8470;  // 0: any free one
};

void serve_map(const Globals& globals, const ViewOptions& options) {
  const map::MapView view(options.folder);
  map::HttpServer server(options.address, options.port);
  const std::string address = "http://" + options.address + ":" + std::to_string(server.port()) + "/";
  log_line("view", address + " until Ctrl-C");
  server.run([&](const std::string& path) { return view.answer(path); });
  Json result = Json::object();
  result["address"] = address;
  print_result(globals, result, "");
}

}  // namespace

void add_view_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("view", "Show a map to a browser on this machine, tiles read on demand");
  const auto options = std::make_shared<ViewOptions>();
  add_named(*command, "folder", options->folder, kFolder, "Folder of a map")->required();
  command->add_option("--port", options->port, "Port; 0 takes any free one")->capture_default_str();
  add_named(*command, "--address", options->address, "ADDRESS",
            "IPv4 address to listen on; other than the default it lets other machines read the map")
      ->capture_default_str();
  add_examples(*command, {"gonogo view out/demo/map"},
               "Small maps need no server: open index.html. On large ones, whose page is thinned out, zooming in shows "
               "every cell.");
  calls<serve_map>(*command, globals, options);
}

}  // namespace gonogo::app
