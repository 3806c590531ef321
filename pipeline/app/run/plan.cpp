#include "pipeline/app/run/plan.h"

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "pipeline/campaign/engine/study_campaign.h"
#include "pipeline/learn/training/named_trials.h"
#include "pipeline/learn/training/other_fidelity.h"
#include "pipeline/learn/training/train_model.h"
#include "pipeline/map/evaluate/block.h"
#include "pipeline/map/region/ground_gravity.h"
#include "pipeline/map/write/map_request.h"

namespace gonogo::app {
namespace {

constexpr int kKeyLength = 12;

/// Folder name for the trials of one set of inputs.
std::string key_of(const campaign::CampaignRequest& campaign) {
  std::string text;
  for (const auto& [name, value] : campaign.depends_on) text += name + '\n' + value + '\n';
  return content_hash(text).substr(0, kKeyLength);
}

void require_file(const campaign::Study& study, const std::string& key, const std::filesystem::path& file) {
  if (file.empty()) study.config.fail(key, "missing; name the JSON file of the " + key);
}

/// Reads the first, the middle and the last row: a file cut short shows.
void check_readable(const terrain::RasterSource& source) {
  const auto& grid = source.grid();
  for (const int row : {0, grid.rows / 2, grid.rows - 1}) source.read({0, row, grid.columns, 1});
}

/// Opens the rasters and reads in them, so that what cannot be read, and ground of another gravity, is known before
/// hours of simulation.
void check_rasters(const map::Region& region, double gravity) {
  const map::MapSources sources = map::open_sources(region);
  map::require_gravity(region, sources.elevation.grid().body_radius, gravity);
  check_readable(sources.elevation);
  for (const auto* raster : {&sources.soil_class, &sources.land_cover, &sources.moisture, &sources.cone_index})
    if (*raster) check_readable(**raster);
}

/// Trials of other fidelities, checked against what this study is going to simulate.
std::vector<std::filesystem::path> trials_beside(const campaign::Study& study) {
  auto files = learn::named_trials(study.config.object_if("learning"));
  if (files.empty()) return files;
  campaign::Provenance own;
  own.study = study.config.json().dump();
  own.files = {{"vehicle", read_file(study.vehicle)},
               {"calibration", read_file(study.section("soil").path("calibration"))}};
  learn::require_together(own, study.file.string(), files);
  return files;
}

}  // namespace

RunPlan plan_run(const RunRequest& request) {
  campaign::Study study = campaign::read_study(request.study);
  require_file(study, "vehicle", study.vehicle);
  require_file(study, "region", study.region);
  campaign::ComputeRequest compute;
  compute.threads = request.threads;
  campaign::CampaignRequest campaign = campaign::plan_study_campaign(study, request.out, compute);
  campaign.folder = request.out / "trials" / key_of(campaign);
  RunPlan plan{.study = study,
               .out = request.out,
               .threads = request.threads,
               .campaign = std::move(campaign),
               .learning = learn::trainable_settings(study.config.object_if("learning")),
               .with = trials_beside(study),
               .region = map::read_region(study.region),
               .map = map::read_map_rules(study.config.object_if("map"))};
  check_rasters(plan.region, plan.study.gravity);
  if (!plan.map.cone_index_of.empty())
    map::read_cone_index_need(plan.map.cone_index_of);
  else if (plan.region.cone_index)
    study.config.fail("map.cone_index_of",
                      "missing; name the vehicle that the region's cone_index raster is held against");
  return plan;
}

}  // namespace gonogo::app
