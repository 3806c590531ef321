// Fine-grained soil that is too weak for a vehicle: the trials' grains have no water that could be squeezed out of the
// way, so that what they say of soft wet clay is not trusted. A point of a soil counts as soft where its cone index is
// below the vehicle's VCI50, or where either is not known.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "pipeline/map/evaluate/outcome_model.h"
#include "pipeline/map/region/region.h"

namespace gonogo::map {

/// A soil whose texture is not given counts as fine-grained below this friction angle: no sand of configs/soils has
/// less.
inline constexpr double kLeastAngleOfSand = 20;  // [deg]

struct SoftPoints {
  std::vector<char> is_soft;         // [points]; empty: none
  std::vector<std::string> because;  // one sentence for each cause
};

/// `points` are those of soil_points() for this soil. The index is the sample's own measurement, otherwise that of
/// cohesion and friction angle (terrain/soil/strength.h).
SoftPoints soft_points(const Region& region, const Soil& soil, const std::vector<std::vector<double>>& points,
                       const std::optional<ConeIndexNeed>& need);

/// True, false, or nothing where neither the soil nor the region says.
std::optional<bool> is_fine_grained(const Region& region, const Soil& soil);

}  // namespace gonogo::map
