// `gonogo vehicle feasible`: whether a vehicle can stand and creep on hard ground, what limits it, and by how much;
// with
// --forces, measured wheel forces beside the nearest ones that the vehicle can have.
#pragma once
#include <filesystem>

#include "pipeline/inspect/vehicle_report.h"
#include "vehicle/feasible/feasible.h"

namespace gonogo::inspect {

struct FeasibleRequest {
  double slope_along = 0, slope_across = 0;  // as the trials' variables [deg]
  double step = 0;                           // [m]
  double friction = 0.8;
  double edge_distance = 0;  // of the centre of pressure from the edge of the wheels' polygon [m]
};

/// Throws InputError for slopes beyond 80 degrees.
void check_slopes(const FeasibleRequest& request);

/// moving: it creeps on; otherwise it stands on its brakes.
vehicle::Demand demand_of(const FeasibleRequest& request, double slope_along, bool moving);

/// Throws InputError for slopes beyond 80 degrees and what vehicle::feasible refuses.
Report check_feasible(const vehicle::Vehicle& v, const FeasibleRequest& request);

/// Standing on brakes and creeping on. Throws InputError for what check_feasible, read_measured_forces and fit_forces
/// refuse.
Report fit_measured_forces(const vehicle::Vehicle& v, const FeasibleRequest& request,
                           const std::filesystem::path& forces);

}  // namespace gonogo::inspect
