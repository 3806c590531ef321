#include "pipeline/campaign/study/study.h"

namespace gonogo::campaign {

Config Study::file_named(const std::string& name, const std::filesystem::path& path) const {
  const auto text = stored.find(name);
  return text == stored.end() ? Config::read(path) : Config::parse(text->second, name + " stored in the dataset");
}

Study read_study(const std::filesystem::path& path) { return read_study(Config::read(path)); }

Study read_study(const Config& config) {
  Study study{.file = config.file(),
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
