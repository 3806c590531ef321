// Datasets of campaigns that are under way: folders with shards and journals made by hand.
#include "pipeline/campaign/engine/campaign.h"

#include "base/error.h"
#include "pipeline/campaign/engine/folder.h"
#include "pipeline/campaign/engine/ledger.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/trials.h"

namespace gonogo::campaign {

namespace fs = std::filesystem;
namespace {

TrialRecord trial(std::uint64_t index) {
  DesignPoint point;
  point.index = index;
  point.seed = 100 + index;
  point.variables.assign(contract().variables.size(), 0.5);
  return closed_form_trial(point);
}

std::vector<TrialRecord> trials(std::uint64_t first, std::uint64_t count) {
  std::vector<TrialRecord> records;
  for (std::uint64_t i = first; i < first + count; ++i) records.push_back(trial(i));
  return records;
}

Provenance provenance() {
  Provenance p;
  p.study = "{}";
  p.program_version = "test";
  p.backend = "cpu";
  return p;
}

/// 20 trials in shards of 4.
void claim(const fs::path& folder) { hold_folder(folder, {20, 4}, {}); }

void write_rows(const fs::path& folder, const std::vector<TrialRecord>& records) {
  fs::create_directories(journal_path(folder).parent_path());
  write_journal(journal_path(folder), records);
}

}  // namespace

TEST_CASE("a snapshot has committed shards and journals up to the first trial that is missing, and changes nothing") {
  const TemporaryFolder folder;
  claim(folder.path());
  commit_shard(folder.path(), 0, trials(0, 4), provenance(), "c");
  commit_shard(folder.path(), 2, trials(8, 4), provenance(), "c");
  std::vector<TrialRecord> rows = trials(2, 8);  // of shards 0 and 2, too
  rows.push_back(trial(12));
  rows.push_back(trial(14));  // 13 is under way
  write_rows(folder.path(), rows);
  const Dataset snapshot = campaign_snapshot(folder.path());
  CHECK(dataset_image(snapshot) == dataset_image({trials(0, 13), provenance()}));
  CHECK(read_journal(journal_path(folder.path())).records.size() == rows.size());
  CHECK(dataset_image(campaign_snapshot(folder.path())) == dataset_image(snapshot));
}

TEST_CASE("a snapshot of nothing is refused, saying what to wait for") {
  const TemporaryFolder folder;
  CHECK_THROWS_AS(campaign_snapshot(folder.path()), InputError);  // no campaign
  claim(folder.path());
  write_rows(folder.path(), trials(0, 3));
  CHECK(contains(input_error([&] { campaign_snapshot(folder.path()); }), "the first 4 trials are done"));
  write_dataset(origin_path(folder.path()), {.records = {}, .provenance = provenance()});
  CHECK(dataset_image(campaign_snapshot(folder.path())) == dataset_image({trials(0, 3), provenance()}));
  commit_shard(folder.path(), 1, trials(4, 4), provenance(), "c");
  write_rows(folder.path(), trials(1, 3));
  CHECK(contains(input_error([&] { campaign_snapshot(folder.path()); }), "trial 0 is still missing"));
}

}  // namespace gonogo::campaign
