// The plan of a run. All files are read and checked before any work starts.
#pragma once
#include <filesystem>
#include <vector>

#include "pipeline/campaign/engine/campaign.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/learn/training/settings.h"
#include "pipeline/map/region/region.h"
#include "pipeline/map/region/rules.h"

namespace gonogo::app {

struct RunRequest {
  std::filesystem::path study, out;
  int threads = 0;  // 0: all cores
};

struct RunPlan {
  campaign::Study study;
  std::filesystem::path out;
  int threads = 0;
  campaign::CampaignRequest campaign;
  learn::LearningSettings learning;
  std::vector<std::filesystem::path> with;  // datasets of other fidelities that the model learns too
  map::Region region;
  map::MapRules map;

  std::filesystem::path dataset() const { return out / "dataset.h5"; }
  std::filesystem::path model() const { return out / "model.h5"; }
  std::filesystem::path map_folder() const { return out / "map"; }
};

/// Reads the study and every file it names, and opens the rasters. Throws InputError for the first that cannot be used.
/// Writes nothing.
RunPlan plan_run(const RunRequest& request);

}  // namespace gonogo::app
