// What a campaign has computed so far, as a dataset: to learn from while the rest is still to come.
#pragma once
#include <filesystem>

#include "pipeline/campaign/dataset/dataset.h"

namespace gonogo::campaign {

/// The trials before the first one that is missing. Not those behind it, although some are finished: trials that end
/// early would be more than their share there. Touches nothing, and may be taken while the campaign runs. Throws
/// InputError when there is no campaign or no committed shard, and for files that are damaged.
Dataset campaign_snapshot(const std::filesystem::path& folder);

}  // namespace gonogo::campaign
