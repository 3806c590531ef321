// What semi-empirical formulas say of a wheel's pull on dry sand, least and most of them.
#pragma once

namespace gonogo::lab {

/// What formulas say at one slip, least and most of them; shares of the load.
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

/// Wong and Reece on the dry sands of Wong's table with this friction angle [deg] and none, their own or `cohesion`
/// [Pa], sand_net_traction and, for tyres, sand_gross_traction over the cone indices of dry sand. Slip in (0, 1).
TractionBand sand_band(const WheelOnSand& wheel, double friction_angle, double slip, double cohesion = 0);

}  // namespace gonogo::lab
