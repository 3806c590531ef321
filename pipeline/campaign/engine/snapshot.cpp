#include "pipeline/campaign/engine/snapshot.h"

#include <optional>

#include "base/error.h"
#include "pipeline/campaign/engine/folder.h"
#include "pipeline/campaign/engine/journal.h"
#include "pipeline/campaign/engine/shard.h"

namespace gonogo::campaign {
namespace fs = std::filesystem;
namespace {

struct Finished {
  RecordsByIndex records;
  std::optional<Provenance> provenance;  // of a committed shard
};

Finished committed(const fs::path& folder) {
  Finished finished;
  const Claim claim = read_claim(folder);
  const ShardPlan plan{claim.trials, claim.trials_per_shard};
  for (std::uint64_t shard = 0; shard < plan.count(); ++shard) {
    const std::optional<ShardManifest> manifest = read_manifest(folder, shard);
    if (!manifest) continue;
    std::vector<TrialRecord> records = read_shard(folder, shard, manifest->campaign).value();
    for (TrialRecord& record : records) finished.records.emplace(record.point.index, std::move(record));
    if (!finished.provenance) finished.provenance = read_dataset(shard_folder(folder) / manifest->file).provenance;
  }
  return finished;
}

}  // namespace

Dataset campaign_snapshot(const fs::path& folder) {
  Finished finished = committed(folder);
  if (!finished.provenance)
    throw InputError(folder.string() + ": no shard is committed yet; wait until the first " +
                     std::to_string(read_claim(folder).trials_per_shard) + " trials are done");
  for (const fs::path& journal : journals_of(folder)) finished.records.merge(read_journal(journal).records);
  Dataset dataset{.records = {}, .provenance = *finished.provenance};
  for (auto& [index, record] : finished.records) {
    if (index != dataset.records.size()) break;
    dataset.records.push_back(std::move(record));
  }
  if (dataset.records.empty()) throw InputError(folder.string() + ": trial 0 is still missing; wait for it");
  return dataset;
}

}  // namespace gonogo::campaign
