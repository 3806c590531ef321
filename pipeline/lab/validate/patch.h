// A moving patch against a fixed bed that is long enough for the whole drive.
#pragma once
#include "pipeline/lab/validate/two_beds.h"

namespace gonogo::lab {

/// Both beds are of the same tiles.
BedComparison compare_patch(const BedsRequest& request);

}  // namespace gonogo::lab
