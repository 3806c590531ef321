#include "pipeline/campaign/study/study.h"

namespace gonogo::campaign {

Study read_study(const std::filesystem::path& path) {
  const Config config = Config::read(path);
  Study study{.file = path,
              .name = config.text("study"),
              .seed = 0,
              .config = config,
              .vehicle = {},
              .region = {},
              .gravity = kGravity};
  if (study.name.empty()) config.fail("study", "the name is empty; give the study a name");
  config.text_or("about", "");
  study.seed = std::uint64_t(config.integer("seed", {.minimum = 0}));
  study.gravity = config.number_or("gravity", kGravity, kGravityRange);
  if (config.has("vehicle")) study.vehicle = config.path("vehicle");
  if (config.has("region")) study.region = config.path("region");
  for (const char* section : {"soil", "trial", "design", "compute", "learning", "map"}) config.object_if(section);
  config.finish();
  return study;
}

}  // namespace gonogo::campaign
