// A campaign: every trial of a design is computed once and put into one dataset, through interruptions and dead
// workers.
//
//   <folder>/campaign.json    what the trials depend on; a campaign with other inputs is refused here
//   <folder>/campaign.lock    held while a coordinator, or tasks of a batch system, work
//   <folder>/trials/*.csv     finished trials of shards that are not whole yet (ledger.h); gone when all are committed
//   <folder>/shards/          committed trials (ledger.h)
//   <folder>/running/         trials under way, saved by their workers; gone when the campaign is complete
//   <folder>/progress/        speed of each writer, for status; no result depends on it
//   <folder>/dataset.h5       merged from the shards when all trials of the design are there
//
// The dataset's bytes depend on design, inputs and program alone. Engine, number of workers, size of shards, order of
// trials, interruptions and deaths do not change them.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/campaign/dataset/summary.h"
#include "pipeline/campaign/engine/folder.h"
#include "pipeline/campaign/engine/worker.h"
#include "pipeline/campaign/setup/record.h"

namespace gonogo::campaign {

struct CampaignRequest {
  std::filesystem::path folder;
  std::vector<DesignPoint> design;
  Dependencies depends_on;  // name -> value of all that a trial's bits depend on
  Provenance provenance;
  int workers = 1;                          // 0: one per core
  int places = 1;                           // trials that a worker computes side by side
  std::vector<std::string> worker_command;  // process that calls run_worker; "/proc/self/exe" is this very program
  /// Above zero: workers also get "--checkpoints <folder>/running --checkpoint-every <this>" [s of the wall clock].
  double checkpoint_every = 0;
  int gpus = 0;                           // above zero: workers also get "--gpu <k>", in turn
  std::function<void()> prepare = [] {};  // called before workers start, when trials are missing (settles beds)
  std::size_t trials_per_shard = 256;     // of a new campaign
  CrewMaker crew;                         // empty: worker processes of this machine
};

struct CampaignSummary {
  std::filesystem::path dataset;
  std::size_t trials = 0, computed = 0, reused = 0;  // trials = computed + reused
  std::size_t damaged = 0;                           // lines and shards that were set aside and computed again
  std::size_t worker_deaths = 0;
  Counts by_verdict, by_reason;
};

/// Computes what is missing and writes the dataset. A dataset that is already right is left untouched. Progress with
/// rate, time left and counts goes to stderr. Finished trials are kept whatever it throws, and the same call continues.
///
/// Throws InputError when the folder belongs to another campaign (with what differs), when another coordinator works
/// there or when a trial refuses its input. Throws DeviceError when the disk is full or a trial crashes its workers,
/// Cancelled on Ctrl-C.
CampaignSummary run_campaign(const CampaignRequest& request);

/// One of `tasks` tasks of a batch system: computes the uncommitted shards k with k % tasks == task. A shard that
/// another task works on is left to it, with a line on stderr. Returns counts over its own shards; `dataset` is empty.
/// Throws as run_campaign, and InputError when the folder was not claimed for this study.
CampaignSummary run_campaign_task(const CampaignRequest& request, std::uint64_t task, std::uint64_t tasks);

/// Prepares the folder for tasks: claims it and settles beds when trials are missing. Returns the shards that are not
/// committed.
std::vector<std::uint64_t> open_campaign(const CampaignRequest& request);

/// Merges what tasks committed and computes nothing. Throws InputError with the numbers of missing trials and shards.
CampaignSummary collect_campaign(const CampaignRequest& request);

struct CampaignStatus {
  std::size_t trials = 0, done = 0, shards = 0, committed_shards = 0;
  FolderUse use = FolderUse::none;  // who works there now
  std::size_t damaged = 0;
  double rate = 0, seconds_left = 0;  // [1/s], [s]; 0 when unknown
  Counts by_verdict, by_reason;
};

/// Changes nothing; may be called while the campaign runs. Throws InputError when `folder` holds no campaign.
CampaignStatus campaign_status(const std::filesystem::path& folder);

/// The trials before the first missing one. Finished trials behind it are left out: trials that end early would be
/// overrepresented. Changes nothing; may be called while the campaign runs. Throws InputError without a campaign, for
/// one of an older program without a committed shard, and for damaged files.
Dataset campaign_snapshot(const std::filesystem::path& folder);

}  // namespace gonogo::campaign
