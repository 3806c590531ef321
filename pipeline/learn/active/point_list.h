// The growing table of points of an active design.
#pragma once
#include <filesystem>
#include <vector>

#include "pipeline/campaign/design/design.h"

namespace gonogo::learn {

/// Number of points in the table; 0 when it does not exist. Throws InputError for a table that cannot be read.
std::uint64_t listed_points(const std::filesystem::path& file, const campaign::DesignSpec& spec);

/// Appends points to the table (columns: the sampled variables and proposal_density), every number exact; the file is
/// replaced whole. Written anew where it does not exist.
void append_points(const std::filesystem::path& file, const campaign::DesignSpec& spec,
                   const std::vector<campaign::DesignPoint>& points);

}  // namespace gonogo::learn
