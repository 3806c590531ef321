// A whole vehicle on a rigid plane in the contact engine, held against closed forms: wheel loads, gradeability, speeds,
// stopping distance, frequencies of the suspension. Tyres without lugs, which would roll like gear wheels on a plane.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "vehicle/model/engine_vehicle.h"

namespace gonogo::vehicle {

/// The plane's slope rises along x.
struct HardGround {
  sim::SceneWorld world;
  EngineVehicle e;
  double down = 0;  // from the design position to the ground [m]

  /// `speed`: of everything at the start, wheels rolling [m/s]. `v` must outlive it.
  HardGround(const Vehicle& v, const DriverOrders& orders, double mu, double slope = 0, double speed = 0);
};

/// The same vehicle with smooth tyres.
Vehicle smooth(Vehicle v);
/// The same vehicle with all differentials locked.
Vehicle all_locked(Vehicle v);

struct Trace {
  std::string label;
  std::vector<double> x, y;
  bool points = false;
};

/// One number against its closed form.
struct HardGroundCheck {
  std::string key;    // with its unit, for machines
  std::string claim;  // what and the closed form
  double expected = 0, measured = 0;
  double tolerance = 0;  // of |measured - expected|
  bool holds() const;
};

/// Checks that one figure shows.
struct HardGroundReport {
  std::string name;  // of the figure's file
  std::string title, x_label, y_label;
  std::vector<HardGroundCheck> check;
  std::vector<Trace> trace;
};

/// Where it runs.
struct HardGroundRun {
  sim::Backend backend = sim::Backend::cpu;
  int threads = 1;
};

/// Against the balance of forces and moments, within 2 %. The vehicle is symmetric, so that its axles determine the
/// loads.
HardGroundReport check_wheel_loads(const Vehicle& v, const HardGroundRun& run);

/// Slope that spinning wheels would just hold, within 2 %: mu with all differentials locked; with an open centre and
/// locked axles what the axle with the lesser load allows.
HardGroundReport check_gradeability(const Vehicle& v, double mu, const HardGroundRun& run);

/// Top speed in each gear of `gears` (1 the lowest): that at which full throttle gives no torque any more, within 2 %.
HardGroundReport check_top_speeds(const Vehicle& v, const std::vector<int>& gears, const HardGroundRun& run);

/// With locked wheels: v^2 / (2 mu g) within 2 %.
HardGroundReport check_stopping(const Vehicle& v, double speed, double mu, const HardGroundRun& run);

/// Tracks at rest: the ground carries the weight within 1 %, the two runs of a belt pull what its tensioner pushes
/// within 2 %, pins stay together within 0.1 mm.
HardGroundReport check_belts_at_rest(const Vehicle& v, const HardGroundRun& run);

/// Way of two turns of the sprockets [rad/s] on level ground: teeth times pitch within 1 %, pins together as above.
HardGroundReport check_track_speed(const Vehicle& v, double sprocket_speed, const HardGroundRun& run);

/// Slope that spinning belts would just hold: tan = mu within 2 %.
HardGroundReport check_track_traction(const Vehicle& v, double mu, const HardGroundRun& run);

/// Slowly up a slope [rad], over whole teeth: the force of the ground is the weight's share within 2 %, and the torque
/// of the sprockets over their rolling radius is that force within 3 %: what impacts and dampers take.
HardGroundReport check_track_torque(const Vehicle& v, double slope, const HardGroundRun& run);

/// Heave and pitch of a vehicle with two axles, within 5 %: eigenvalues of its mass over the axles (reduced
/// coordinates, wheels held on the ground) on the static rates of its axles.
HardGroundReport check_suspension(const Vehicle& v, const HardGroundRun& run);

}  // namespace gonogo::vehicle
