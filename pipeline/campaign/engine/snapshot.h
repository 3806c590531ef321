// Finished trials of a running campaign as a dataset, to learn from before the campaign ends.
#pragma once
#include <filesystem>

#include "pipeline/campaign/dataset/dataset.h"

namespace gonogo::campaign {

/// The trials before the first missing one. Finished trials behind it are left out: trials that end early would be
/// overrepresented. Changes nothing; may be called while the campaign runs. Throws InputError without a campaign or a
/// committed shard, and for damaged files.
Dataset campaign_snapshot(const std::filesystem::path& folder);

}  // namespace gonogo::campaign
