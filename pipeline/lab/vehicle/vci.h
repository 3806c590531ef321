// `gonogo vehicle vci`: mobility index, vehicle cone index, and semi-empirical traction over soil strength.
#pragma once
#include "pipeline/lab/vehicle/show.h"

namespace gonogo::lab {

/// Throws InputError for vehicles without an index, see vehicle::vehicle_index.
Report vehicle_cone_index(const vehicle::Vehicle& v);

}  // namespace gonogo::lab
