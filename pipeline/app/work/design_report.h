// What `gonogo design` prints.
#pragma once
#include <optional>

#include "pipeline/app/work/result.h"
#include "pipeline/campaign/design/design.h"

namespace gonogo::app {

/// The points, and how well they fill the box. `region_share`: of the study's region, that lies inside of the box [0,
/// 1].
void print_design(const Globals& globals, const campaign::DesignSpec& spec, bool csv,
                  const std::optional<double>& region_share);

}  // namespace gonogo::app
