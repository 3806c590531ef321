#include "base/files/shipped.h"

#include <algorithm>
#include <cstdlib>
#include <system_error>

#include "base/error.h"
#include "base/format.h"

namespace gonogo {

namespace fs = std::filesystem;

namespace {

/// A folder of the source tree, here, in $GONOGO_SHARE and above the running program; those that exist.
std::vector<fs::path> places_of(const fs::path& folder) {
  std::vector<fs::path> result{folder};
  if (const char* share = std::getenv("GONOGO_SHARE")) result.push_back(share / folder);
  std::error_code none;
  fs::path at = fs::read_symlink("/proc/self/exe", none).parent_path();
  for (int up = 0; !none && up < 5 && at.has_relative_path(); ++up, at = at.parent_path())
    for (const char* place : {"", "share/gonogo"}) result.push_back(at / place / folder);
  result.erase(std::remove_if(result.begin(), result.end(), [](const fs::path& p) { return !fs::is_directory(p); }),
               result.end());
  return result;
}

}  // namespace

std::vector<fs::path> shipped_folders(const std::string& kind) { return places_of(fs::path("configs") / kind); }

std::vector<fs::path> shipped_data_folders(const std::string& file) {
  std::vector<fs::path> result;
  for (const fs::path& place : places_of("data"))
    for (const auto& entry : fs::directory_iterator(place)) {
      const auto same = [&](const fs::path& known) { return known.filename() == entry.path().filename(); };
      if (fs::is_regular_file(entry.path() / file) && std::none_of(result.begin(), result.end(), same))
        result.push_back(entry.path());
    }
  std::sort(result.begin(), result.end(),
            [](const fs::path& a, const fs::path& b) { return a.filename() < b.filename(); });
  return result;
}

std::vector<std::string> shipped_names(const fs::path& folder, const std::string& left_out) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().stem().string();
    const bool out = !left_out.empty() && name.rfind(left_out, 0) == 0;
    if (entry.path().extension() == ".json" && !out) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

fs::path shipped_file(const std::string& kind, const std::string& what, const std::string& name,
                      const std::string& left_out) {
  if (fs::is_regular_file(name)) return name;
  const bool plain = name.find('/') == std::string::npos && fs::path(name).extension() != ".json";
  const auto places = shipped_folders(kind);
  if (plain)
    for (const fs::path& folder : places)
      if (fs::is_regular_file(folder / (name + ".json"))) return folder / (name + ".json");
  if (!plain || places.empty()) throw InputError(name + ": no such " + what + " file");
  throw InputError(name + ": no such " + what + " file; " + places[0].string() +
                   " has: " + join_words(shipped_names(places[0], left_out)));
}

}  // namespace gonogo
