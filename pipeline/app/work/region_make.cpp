#include "pipeline/app/work/work.h"

namespace gonogo::app {

void region_make_work(const Globals& globals, const map::RegionMakeRequest& request) {
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

}  // namespace gonogo::app
