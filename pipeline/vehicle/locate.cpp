#include "pipeline/vehicle/locate.h"

#include <algorithm>
#include <system_error>
#include <vector>

#include "base/error.h"
#include "base/nearest.h"

namespace gonogo::pipeline {
namespace {

namespace fs = std::filesystem;

/// configs/vehicles here, or beside the source tree that the program was built in.
std::vector<fs::path> folders() {
  std::vector<fs::path> result{fs::path("configs") / "vehicles"};
  std::error_code none;
  fs::path at = fs::read_symlink("/proc/self/exe", none).parent_path();
  for (int up = 0; !none && up < 5 && at.has_relative_path(); ++up, at = at.parent_path())
    result.push_back(at / "configs" / "vehicles");
  result.erase(std::remove_if(result.begin(), result.end(), [](const fs::path& p) { return !fs::is_directory(p); }),
               result.end());
  return result;
}

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

fs::path vehicle_file(const std::string& name) {
  if (fs::is_regular_file(name)) return name;
  const bool plain = name.find('/') == std::string::npos && fs::path(name).extension() != ".json";
  const auto places = folders();
  if (plain)
    for (const fs::path& folder : places)
      if (fs::is_regular_file(folder / (name + ".json"))) return folder / (name + ".json");
  if (!plain || places.empty()) throw InputError(name + ": no such vehicle file");
  throw InputError(name + ": no such vehicle file; " + places[0].string() + " has: " + join_words(names_in(places[0])));
}

}  // namespace gonogo::pipeline
