// A campaign: every trial of a design computed once, whatever happens on the way, and put into one dataset.
//
//   <folder>/campaign.json      what the trials depend on; a campaign with other inputs is refused here
//   <folder>/campaign.lock      held while a coordinator works
//   <folder>/trials/local.csv   finished trials (journal.h); <...>.damaged holds lines that were unreadable
//   <folder>/running/           trials under way, saved by their workers; gone when the campaign is complete
//   <folder>/dataset.h5         written when all trials of the design are there
//
// The dataset's bytes depend on design, inputs and program alone: not on the number of workers, the order in which
// trials ended, interruptions or deaths.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/dataset/dataset.h"

namespace gonogo::pipeline {

struct CampaignRequest {
  std::filesystem::path folder;
  std::vector<DesignPoint> design;
  std::vector<std::pair<std::string, std::string>> depends_on;  // name -> value of all that a trial's bits depend on
  Provenance provenance;
  int workers = 1;                          // 0: one per core
  int places = 1;                           // trials that a worker computes side by side
  std::vector<std::string> worker_command;  // process that calls run_worker; "/proc/self/exe" is this very program
  /// Above zero: workers are also told "--checkpoints <folder>/running --checkpoint-every <this>" [s of the wall
  /// clock].
  double checkpoint_every = 0;
  int gpus = 0;                           // above zero: workers are also told "--gpu <k>", taking turns
  std::function<void()> prepare = [] {};  // called before workers start, when trials are missing (settles beds)
};

struct CampaignSummary {
  std::filesystem::path dataset;
  std::size_t trials = 0, computed = 0, reused = 0;  // trials = computed + reused
  std::size_t damaged = 0;                           // unreadable lines of earlier runs, set aside and computed again
  std::size_t worker_deaths = 0;
  std::map<std::string, std::size_t> by_verdict, by_reason;
};

/// Computes what is missing and writes the dataset; a dataset that is right already is left untouched. Progress with
/// rate, time left and counts goes to stderr. Throws InputError when the folder belongs to another campaign (naming
/// what differs), when another coordinator works there or when a trial refuses its input; DeviceError when the disk is
/// full or a trial crashes its workers; Cancelled on Ctrl-C. Whatever it throws, finished trials are kept and the same
/// call continues.
CampaignSummary run_campaign(const CampaignRequest& request);

struct CampaignStatus {
  std::size_t trials = 0, done = 0;
  bool running = false;  // a coordinator holds the lock
  std::size_t damaged = 0;
  std::map<std::string, std::size_t> by_verdict, by_reason;
};

/// Looks without touching anything, also while the campaign runs. Throws InputError when `folder` holds no campaign.
CampaignStatus campaign_status(const std::filesystem::path& folder);

/// "31 go, 12 no_go (7 traction, 5 sinkage)": counts for one line.
std::string counts_line(const std::map<std::string, std::size_t>& by_verdict,
                        const std::map<std::string, std::size_t>& by_reason);

}  // namespace gonogo::pipeline
