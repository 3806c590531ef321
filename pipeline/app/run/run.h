// The main job: from a study to the map of its region.
//
//   <out>/trials/<key>/  finished trials of one set of inputs (campaign.h); changed inputs get a folder of their own
//   <out>/dataset.h5     the trials of this study
//   <out>/model.h5       trained on them, and on those that the study names in learning.with; of the finest fidelity
//   <out>/map/           layers, figure, area table
//   <out>/run.json       what was made from what, and its summary
//   <out>/stamps/        what each stage read and wrote, as hashes; it is done again only when they differ
#pragma once
#include <string>
#include <vector>

#include "base/json/json.h"
#include "pipeline/app/run/plan.h"

namespace gonogo::app {

struct RunSummary {
  std::vector<std::string> done;  // stages of this call: "campaign", "train", "map"
  std::filesystem::path map_folder;
  Json record;  // content of run.json
};

/// Does the stages that are not up to date. Throws InputError before any work when something cannot be used,
/// DeviceError when a library or the system fails, Cancelled on Ctrl-C. Finished trials and stages are kept: the same
/// call continues.
RunSummary run_study(const RunRequest& request);

/// The summary for people: trials by verdict, score of the model, area by class, path of the map.
std::string to_text(const RunSummary& summary);

}  // namespace gonogo::app
