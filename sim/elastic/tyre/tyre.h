// An inflated tyre in the middle plane of its wheel: a belt that bends, sidewalls to a rigid rim, air, a tread.
//   belt       closed ring of co-rotated beams, EI and EA
//   sidewalls  two arcs that do not stretch, blown out by the air (membrane), and springs of their rubber
//   air        constant pressure, which follows the belt
//   tread      normal compliance on the outer surface of the belt, by ContactLaw
// x points forward, y up. Angles count counter-clockwise: a wheel that rolls forward turns by negative angles.
#pragma once
#include <vector>

#include "sim/elastic/model.h"

namespace gonogo::sim::elastic {

struct Tyre {
  double radius = 0;                  // of the tread's surface before the air widens the belt [m]
  double tread = 0;                   // from the middle of the belt to the tread's surface [m]
  double rim_radius = 0;              // where the sidewalls begin [m]
  double width = 0;                   // of rim, belt and contact [m]
  double bulge = 0;                   // of a sidewall beyond the rim's edge, unloaded [m]; 0: no membrane
  double pressure = 0;                // of the air above the atmosphere's [Pa]
  double bending = 0;                 // EI of the belt [N m^2]
  double stretching = 0;              // EA of the belt [N]
  double radial = 0, tangential = 0;  // springs of the sidewalls' rubber, per length of the belt [N/m^2]
  double belt_mass = 0;               // [kg]; statics do not need it
  double loss = 0;                    // loss factor of belt and springs, 0 to 0.3 [-]
  int nodes = 240;                    // of the ring
  ContactLaw law{};                   // c_n: modulus of the tread over its thickness [Pa/m^m_n]

  double belt_radius() const { return radius - tread; }
};

/// Throws InputError for numbers out of range, naming number and range.
void check_tyre(const Tyre& tyre);

/// Place and motion of the rim.
struct Rim {
  double x = 0, y = 0, turn = 0;    // of the hub [m]; [rad]
  double vx = 0, vy = 0, spin = 0;  // [m/s], [rad/s]
};

/// On the rim, at the hub.
struct RimLoad {
  double x = 0, y = 0;  // [N]
  double moment = 0;    // counter-clockwise [N m]
};

// Small motions of an inflated, unloaded tyre about a rim that is held. Public; free of Eigen.

/// Stiffness of the belt as a rigid ring on its sidewalls.
struct SidewallStiffness {
  double shift = 0;  // [N/m]
  double turn = 0;   // about the hub [N m/rad]
};
SidewallStiffness sidewall_stiffness(const Tyre& tyre);

/// Frequencies of the ring, ascending [Hz], with the mass matrix of RollingTyre. Throws InputError for a belt without
/// mass. Solved densely: (3 nodes)^3.
std::vector<double> frequencies(const Tyre& tyre);

}  // namespace gonogo::sim::elastic
