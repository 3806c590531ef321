// `gonogo vehicle feasible --forces`: measured wheel forces beside the nearest ones that the vehicle can have.
#pragma once
#include <filesystem>

#include "pipeline/lab/vehicle/feasible.h"

namespace gonogo::lab {

/// Standing on brakes and creeping on. Throws InputError for what check_feasible, read_measured_forces and fit_forces
/// refuse.
Report fit_measured_forces(const vehicle::Vehicle& v, const FeasibleRequest& request,
                           const std::filesystem::path& forces);

}  // namespace gonogo::lab
