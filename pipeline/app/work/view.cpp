#include "base/progress.h"
#include "pipeline/app/work/work.h"
#include "pipeline/map/view/map_view.h"

namespace gonogo::app {

void view_work(const Globals& globals, const ViewOptions& options) {
  const map::MapView view(options.folder);
  map::HttpServer server(options.address, options.port);
  const std::string address = "http://" + options.address + ":" + std::to_string(server.port()) + "/";
  log_line("view", address + " until Ctrl-C");
  server.run([&](const std::string& path) { return view.answer(path); });
  Json result = Json::object();
  result["address"] = address;
  print_result(globals, result, "");
}

}  // namespace gonogo::app
