// Checks of tracks on hard ground, as hard_ground.h has them for wheels. Each sets the vehicle down first and throws
// InputError for one whose file has no belt that closes.
#pragma once
#include "vehicle/hard_ground/hard_ground.h"

namespace gonogo::vehicle {

/// Tracks at rest. The ground carries the weight within 1 %; the two runs of a belt pull as much as its tensioner
/// pushes within 2 %; pins stay together within 0.1 mm.
HardGroundReport check_belts_at_rest(const Vehicle& v, const HardGroundRun& run);

/// Distance travelled in two turns of the sprockets, which turn at `sprocket_speed` [rad/s] on level ground: teeth
/// times pitch within 1 %. Pins stay together as above.
HardGroundReport check_track_speed(const Vehicle& v, double sprocket_speed, const HardGroundRun& run);

/// Steepest slope that spinning belts hold: tangent mu within 2 %.
HardGroundReport check_track_traction(const Vehicle& v, double mu, const HardGroundRun& run);

/// Slowly up a slope [rad], over whole teeth. The force of the ground is the weight's component along the slope within
/// 2 %. The torque of the sprockets over their rolling radius is that force within 3 %, the loss in impacts and
/// dampers.
HardGroundReport check_track_torque(const Vehicle& v, double slope, const HardGroundRun& run);

}  // namespace gonogo::vehicle
