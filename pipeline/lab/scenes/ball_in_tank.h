// A large ball among the spheres of a tank.
#pragma once
#include "pipeline/lab/scenes/tank.h"

namespace gonogo::lab {

/// The tank with the ball as its first body, without the spheres that the ball overlaps. Density [kg/m^3].
sim::SceneWorld with_ball(const sim::SceneWorld& tank, const Vec3d& centre, double radius, double density);

/// Middle of the tank's floor [m].
Vec3d middle_of(const sim::SceneWorld& world);

/// Mean height of the highest centre in columns two diameters wide [m]. Columns at and beside the ball are left out.
/// `bodies`: the ball first, the tank last.
double surface_of(const std::vector<sim::BodyState>& bodies, const TankSpec& tank, const sim::SceneWorld& world,
                  double ball_radius);

}  // namespace gonogo::lab
