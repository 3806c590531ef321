// Pull of a wheel on dry sand by semi-empirical formulas: min and max over formulas and soils.
#pragma once

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
/// for tyres, sand_gross_traction. The sands get this friction angle [deg] and, in turn, no cohesion, their own, and
/// `cohesion` [Pa]. Slip in (0, 1).
TractionBand sand_band(const WheelOnSand& wheel, double friction_angle, double slip, double cohesion = 0);

}  // namespace gonogo::lab
