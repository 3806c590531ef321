#include <gonogo/common.h>

#include "base/files/shipped.h"
#include "base/progress.h"
#include "base/version.h"
#include "pipeline/face/inside.h"

namespace gonogo::api {

std::string version() { return program_version(); }
std::string revision() { return program_revision(); }
void cancel_on_interrupt() { install_cancel_handler(); }

std::vector<std::string> shipped(const std::string& kind) {
  return guarded([&] {
    std::vector<std::string> names;
    if (kind == "models") {
      for (const auto& folder : shipped_data_folders("model.h5")) names.push_back(folder.filename().string());
      return names;
    }
    if (kind != "vehicles" && kind != "soils" && kind != "studies" && kind != "regions")
      throw gonogo::InputError("shipped: \"" + kind + "\": there are models, vehicles, soils, studies and regions");
    const auto folders = shipped_folders(kind);
    return folders.empty() ? names : shipped_names(folders.front());
  });
}

}  // namespace gonogo::api
