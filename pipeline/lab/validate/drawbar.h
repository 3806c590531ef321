// Drawbar pull and rolling resistance of a whole vehicle on sand over its slip, beside the bands of semi-empirical
// formulas (vehicle/semi_empirical): min and max over formulas and soils.
#pragma once
#include <filesystem>
#include <string>

#include "base/json/json.h"
#include "base/math/statistics.h"
#include "pipeline/lab/validate/trials.h"

namespace gonogo::lab {

/// Min and max of the formulas at one slip, as shares of the load.
struct TractionBand {
  double slip = 0;
  double pull[2] = {}, resistance[2] = {};
};

/// A wheel and the load on it.
struct WheelOnSand {
  double radius = 0, width = 0;               // [m]
  double load = 0;                            // normal to the ground [N]
  double section_height = 0, deflection = 0;  // of the tyre [m]; without a height no resistance by cone index
};

/// Formulas: Wong and Reece on the dry sands of Wong's table, sand_net_traction over the cone indices of dry sand and,
/// for tyres, sand_gross_traction. The sands get this friction angle on the plane of shear [deg]
/// and, in turn, no cohesion, their own, and `cohesion` [Pa]. Slip in (0, 1).
TractionBand sand_band(const WheelOnSand& wheel, double friction_angle, double slip, double cohesion = 0);

struct DrawbarRequest {
  std::filesystem::path vehicle, calibration;
  terrain::AskedNumerics numerics;          // in the place of the table's
  double friction_angle = 30, speed = 1.5;  // of the sand by triaxial compression [deg], [m/s]
  double sweep = 12;                        // over which the load grows to the weight [s]
  int seeds = 1;
  bool folded = false;           // bed, see pipeline/campaign/setup/setup.h
  bool compliant_tyres = false;  // of the stiffness that the vehicle's file names
  double wheel_rolling = 1;      // see campaign::TrialSetup
  campaign::BatchSettings batch;
};

/// One part of a sweep, mean over the seeds.
struct DrawbarPoint {
  double slip = 0;
  MeanError pull, resistance;  // of the weight; resistance: torque over rolling radius less pull
  double sinkage = 0;          // of the axle: with what a compliant tyre is pressed in [m]
  TractionBand band;
  bool pull_inside() const { return pull.mean >= band.pull[0] && pull.mean <= band.pull[1]; }
  bool resistance_inside() const {
    return resistance.mean >= band.resistance[0] && resistance.mean <= band.resistance[1];
  }
};

struct DrawbarReport {
  std::string vehicle;
  bool compliant_tyres = false;
  double friction_angle = 0, shear_plane_angle = 0;  // triaxial, on the plane of shear [deg]
  double grains_per_tyre = 0;
  std::vector<DrawbarPoint> point;  // ascending in slip, of slips at which a formula holds
  std::vector<TractionBand> band;   // for a picture
};

/// The band of a vehicle's front tyre under the mean load of its wheels.
TractionBand sand_band(const vehicle::Vehicle& v, double friction_angle, double slip);

DrawbarReport measure_drawbar(const DrawbarRequest& request);

Json as_json(const DrawbarReport& r);
std::string as_text(const DrawbarReport& r);
/// <vehicle>_drawbar.csv and, where the build has pictures, .png.
void write_drawbar(const std::filesystem::path& folder, const DrawbarReport& r);

}  // namespace gonogo::lab
