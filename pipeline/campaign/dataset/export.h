// A dataset as one table for other programs.
#pragma once
#include <string>

#include "pipeline/campaign/dataset/dataset.h"

namespace gonogo::campaign {

/// Header and one line per trial (row.h).
std::string to_csv(const Dataset& dataset);

/// The inverse of to_csv, bit for bit, with an empty provenance. Throws InputError that starts with `name` and has the
/// line.
Dataset parse_csv(const std::string& text, const std::string& name);

/// One JSON object: "provenance", "units", and "trials", an object per trial. NaN is null.
std::string to_json_text(const Dataset& dataset);

}  // namespace gonogo::campaign
