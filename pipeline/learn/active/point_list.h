// The growing table of points of an active design.
#pragma once
#include <filesystem>
#include <vector>

#include "pipeline/campaign/design/design.h"

namespace gonogo::learn {

/// Number of points in the table; 0 if the file does not exist. Throws InputError for a table that cannot be read.
std::uint64_t listed_points(const std::filesystem::path& file, const campaign::DesignSpec& spec);

/// Appends points to the table, or starts a new one. Columns: the sampled variables and proposal_density. Numbers read
/// back exactly. The file is replaced as a whole, so it is never half written.
void append_points(const std::filesystem::path& file, const campaign::DesignSpec& spec,
                   const std::vector<campaign::DesignPoint>& points);

}  // namespace gonogo::learn
