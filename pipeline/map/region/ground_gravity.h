// Gravity of the ground that is mapped, and whether a model's trials had it.
#pragma once
#include "pipeline/map/region/region.h"

namespace gonogo::map {

/// "1.62 m/s2"
std::string gravity_text(double gravity);

/// Whether two are the same for trials: within 2 %. On the Earth gravity varies by 0.5 %.
bool is_same_gravity(double a, double b);

/// Gravity of the region's ground [m/s^2]: what its file says, or that of the body with this equatorial radius [m].
/// Throws InputError where neither tells it, and where they contradict each other.
double ground_gravity(const Region& region, double body_radius);

/// Throws InputError unless the ground has the gravity of the model's trials [m/s^2].
void require_gravity(const Region& region, double body_radius, double of_trials);

}  // namespace gonogo::map
