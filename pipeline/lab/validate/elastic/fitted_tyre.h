// A ring that stands for the measured tyre. Sizes, pressure and mass are the tyre's. Three numbers are fitted, each to
// one measured number at the nominal load and pressure: the belt's bending stiffness to the contact length, the
// tangential springs of the sidewalls to the stiffness of the belt against turning on the rim, the loss factor to the
// rolling resistance.
#pragma once
#include "sim/elastic/tyre/tyre.h"

namespace gonogo::lab {

/// Statics: no loss yet.
sim::elastic::Tyre fitted_tyre(int nodes);

struct Patch {
  double deflection = 0, length = 0;  // [m]
};
/// On flat ground. Throws DeviceError where no balance is found.
Patch pressed(const sim::elastic::Tyre& tyre, double load);

struct Rolling {
  double moment = 0;            // about the hub [N m]
  double balance = 0;           // what the hub works less what is lost, over what it works, since the start [-]
  double worked = 0, lost = 0;  // per metre, of the turns that count [N]
};
/// Without friction, at the tyre's loss factor, a pressure and a load, at the measured tyre's speed.
Rolling rolling(sim::elastic::Tyre tyre, double load, double pressure);

/// The loss factor at which the moment at the nominal load and pressure is the measured one.
double fitted_loss(const sim::elastic::Tyre& tyre);

}  // namespace gonogo::lab
