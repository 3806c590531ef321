// Everything a run is going to do, read and checked before any of it is done.
#pragma once
#include <filesystem>

#include "pipeline/campaign/campaign.h"
#include "pipeline/learn/settings.h"
#include "pipeline/map/region.h"
#include "pipeline/map/rules.h"
#include "pipeline/study/study.h"

namespace gonogo::pipeline {

struct RunRequest {
  std::filesystem::path study, out;
  int threads = 0;  // 0: all cores
};

struct RunPlan {
  Study study;
  std::filesystem::path out;
  int threads = 0;
  CampaignRequest campaign;
  LearningSettings learning;
  Region region;
  MapRules map;

  std::filesystem::path dataset() const { return out / "dataset.h5"; }
  std::filesystem::path model() const { return out / "model.h5"; }
  std::filesystem::path map_folder() const { return out / "map"; }
};

/// Reads the study and every file it names, and opens the rasters. Throws InputError for the first thing that cannot be
/// used; writes nothing.
RunPlan plan_run(const RunRequest& request);

}  // namespace gonogo::pipeline
