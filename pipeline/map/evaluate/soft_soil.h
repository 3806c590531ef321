// Fine-grained soil that is too weak for a vehicle. The grains of a trial hold no pore water, so trials say nothing
// reliable about soft wet clay. A point of a soil is soft if its cone index is below the vehicle's VCI50. It is also
// soft if either of the two is not known.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "pipeline/map/evaluate/outcome_model.h"
#include "pipeline/map/region/region.h"

namespace gonogo::map {

/// A soil without a texture counts as fine-grained below this friction angle. No sand in configs/soils has a
/// smaller one.
inline constexpr double kMinAngleOfSand = 20;  // [deg]

struct SoftPoints {
  std::vector<char> is_soft;         // [points] 1: soft; empty: none is
  std::vector<std::string> because;  // one sentence per cause, for the map's remarks
};

/// Which of the `points` from soil_points() are too soft. The cone index of a point is measured on its sample, or else
/// estimated from cohesion and friction angle (terrain/soil/strength.h).
SoftPoints soft_points(const Region& region, const Soil& soil, const std::vector<std::vector<double>>& points,
                       const std::optional<ConeIndexNeed>& need);

/// Whether a texture of the soil's samples, the soil or the region is. Nothing if none of them gives one.
std::optional<bool> is_fine_grained(const Region& region, const Soil& soil);

}  // namespace gonogo::map
