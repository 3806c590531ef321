// `gonogo vehicle feasible`: whether a vehicle can stand and creep on hard ground, what limits it, and by how much.
#pragma once
#include "pipeline/lab/vehicle/show.h"
#include "vehicle/feasible/feasible.h"

namespace gonogo::lab {

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

}  // namespace gonogo::lab
