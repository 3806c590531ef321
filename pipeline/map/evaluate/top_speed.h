// Top speed of a vehicle on a soil, where the driveline's tractive force equals what slope and soil take:
//
//   F(v_t) = W (max(0, tan(along)) + R) + w z rho (v^2 - v_s^2)      v = (1 - slip) v_t
//
// F is the tractive force at the tread speed v_t, W the weight across the ground, R the motion resistance that trials
// measured at the cell's slip and rut depth z. The trials drove up to the speed v_s. Beyond it the last term is added:
// the soil in ruts of width w is thrown forward at the vehicle's speed. Downhill the vehicle drives as on the level.
//
// Not in it: ride, sight, brakes, bends, air. A limit for these is given as max_speed.
#pragma once
#include <limits>
#include <span>
#include <vector>

#include "base/units.h"
#include "pipeline/map/evaluate/measure_fit.h"
#include "vehicle/model/tractive_force.h"

namespace gonogo::map {

/// Density of the soil that is thrown forward [kg/m^3]: the largest in configs/soils/usda.json.
inline constexpr double kThrownDensity = 2100;

/// What a trial that drove steadily under its own power measured.
struct ResistanceTrial {
  double resistance = 0;  // motion resistance over the load on the ground [-]
  double rut = 0;         // [m]
  double slip = 0;        // [-]
  double speed = 0;       // of the treads [m/s]
};

/// Motion resistance as a linear function, by least squares. Answers are kept within what was measured.
struct ResistanceFit {
  double constant = 0, per_rut = 0, per_slip = 0, per_speed = 0;  // [-], [1/m], [-], [s/m]
  double lowest = 0, highest = 0;                                 // measured [-]
  double fastest = 0;                                             // tread speed that trials reached [m/s]
  double error = 0, spread = 0;                                   // RMSE; standard deviation [-]
  std::size_t trials = 0;

  double at(double rut, double slip, double tread_speed) const;
};

/// Fewer than 12 trials give their mean; none gives zeros.
ResistanceFit fit_resistance(std::span<const ResistanceTrial> trials);

/// A vehicle as its top speed needs it.
struct SpeedModel {
  vehicle::TractiveForce drive;
  double gravity = kGravity;  // [m/s^2]
  double mass = 0;            // without payload [kg]
  double tyre_stiffness = 0;  // of all tyres together [N/m]; 0: rigid
  double rut_width = 0;       // of all ruts together [m]
  ResistanceFit resistance;
  MeasureFit slip, sinkage;  // of trials that passed [-], [m]

  /// Depth of the rut [m] under wheels that sink so far [m] and give way under this load [N].
  double rut(double sinks, double load) const;
};

/// Top speed on one soil.
class SoilSpeed {
 public:
  /// `points`: what the soil may be; the payload and the fits are averaged over them. max_speed [m/s] limits all.
  SoilSpeed(const SpeedModel& model, const std::vector<std::vector<double>>& points,
            double max_speed = std::numeric_limits<double>::infinity());

  /// [m/s]; at least kMinSpeed.
  double at(BedSlopes slopes) const;

 private:
  SpeedModel model_;
  SlopeMeasure slip_, sinkage_;
  double payload_ = 0;  // [kg]
  double max_speed_;
};

}  // namespace gonogo::map
