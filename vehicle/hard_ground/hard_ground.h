// Checks a whole vehicle on a rigid plane in the contact engine against closed forms: wheel loads, gradeability,
// speeds, stopping distance, suspension frequencies. Tyres have no lugs here, because lugs on a plane roll like gear
// wheels.
#pragma once
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "vehicle/world/driving.h"

namespace gonogo::vehicle {

/// A world with the vehicle on a plane that rises along x by `slope` [rad].
struct HardGround {
  sim::SceneWorld world;
  EngineVehicle e;
  double down = 0;  // depth of the ground below the vehicle's origin [m]

  /// Starts with `speed` [m/s] and rolling wheels. `mu`: friction coefficient. `v` must outlive the object.
  HardGround(const Vehicle& v, const DriverOrders& orders, double mu, double slope = 0, double speed = 0);
};

/// The same vehicle without lugs.
Vehicle smooth(Vehicle v);

struct Trace {
  std::string label;
  std::vector<double> x, y;
  bool points = false;  // drawn as points, not as a line
  void add(double at, double value) {
    x.push_back(at);
    y.push_back(value);
  }
};

/// A measured number and its closed form.
struct HardGroundCheck {
  std::string key;    // JSON key, with unit
  std::string claim;  // quantity and closed form, in words
  double expected = 0, measured = 0;
  double tolerance = 0;  // of |measured - expected|
  bool holds() const { return std::fabs(measured - expected) <= tolerance; }
};

/// Checks and curves of one figure.
struct HardGroundReport {
  std::string name;  // of the figure's file
  std::string title, x_label, y_label;
  std::vector<HardGroundCheck> check{};
  std::vector<Trace> trace{};

  void expect(const std::string& key, const std::string& claim, double expected, double measured, double tolerance) {
    check.push_back({key, claim, expected, measured, tolerance});
  }
};

/// Device of the run.
struct HardGroundRun {
  sim::Backend backend = sim::Backend::cpu;
  int threads = 1;
};

/// Wheel loads against the balance of forces and moments, within 2 %. The vehicle must be symmetric about y = 0.
HardGroundReport check_wheel_loads(const Vehicle& v, const HardGroundRun& run);

/// Steepest slope that spinning wheels hold, within 2 %. With all differentials locked its tangent is mu; with an open
/// centre and locked axles the axle with the smaller load decides.
HardGroundReport check_gradeability(const Vehicle& v, double mu, const HardGroundRun& run);

/// Top speed in each of `gears` (1 is the lowest), where the torque at full throttle falls to zero, within 2 %.
HardGroundReport check_top_speeds(const Vehicle& v, const std::vector<int>& gears, const HardGroundRun& run);

/// Stopping distance with locked wheels: v^2 / (2 mu g) within 2 %.
HardGroundReport check_stopping(const Vehicle& v, double speed, double mu, const HardGroundRun& run);

/// Heave and pitch frequencies of a vehicle with two axles, within 5 %. The closed form takes the mass matrix over the
/// axle heights, wheels held on the ground, and the static rates of the axles.
HardGroundReport check_suspension(const Vehicle& v, const HardGroundRun& run);

// What the checks share.

std::unique_ptr<sim::Simulation> start(const HardGround& ground, const HardGroundRun& run, double step);

/// Advances by `time` [s], rounded to whole steps.
void run_for(sim::Simulation& s, double time);

/// Speed of the chassis along x [m/s].
double forward_speed(sim::Simulation& s, const HardGround& ground);

}  // namespace gonogo::vehicle
