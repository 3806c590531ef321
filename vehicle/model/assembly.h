// A vehicle as rigid bodies and joints in the design position, in the vehicle's frame: what both the reduced-coordinate
// model (vehicle/multibody) and the contact engine (sim/joint) are built from.
#pragma once
#include "vehicle/model/vehicle.h"

namespace gonogo::vehicle {

/// Where a wheel is.
struct Station {
  std::string name;                        // "front left"
  int axle = 0;                            // of a track: its road wheel
  double side = 1;                         // 1 left, -1 right, 0 in the middle
  Vec3d mount, centre;                     // of the suspension, of the wheel [m]
  const Suspension* suspension = nullptr;  // of the vehicle that was asked
  const Wheel* wheel = nullptr;
  bool driven = false;      // of a track: by the belt
  double brake_torque = 0;  // [N m]
};

/// Wheels that touch the ground, axle by axle, left before right.
std::vector<Station> stations(const Vehicle& v);

enum class LinkType { revolute, prismatic, spherical, distance };

/// Holds body `child` to body `parent`; points and axes in the vehicle's frame.
struct Link {
  LinkType type = LinkType::revolute;
  int parent = 0, child = 0;
  Vec3d point;         // [m]; of a distance link: on the child
  Vec3d parent_point;  // of a distance link [m]
  Vec3d axis;          // unit; of revolute and prismatic links
  bool wheel = false;  // a wheel's axle
  bool loop = false;   // closes a loop
};

/// Spring, damper or both between two bodies.
struct Strut {
  int parent = 0, child = 0;
  Vec3d parent_point, child_point;  // [m]
  const Spring* spring = nullptr;
  const Damper* damper = nullptr;
};

/// Bodies of a track's sprocket and idler, and of what slides in the chassis with the idler.
struct TrackBodies {
  int sprocket = 0, idler = 0, carrier = 0;
};

struct Assembly {
  std::vector<Part> body;  // 0 is the chassis; of positive mass
  std::vector<Link> link;  // a tree rooted in the chassis, and loops
  std::vector<Strut> strut;
  std::vector<int> wheel;          // body of each station's wheel
  std::vector<TrackBodies> track;  // left, right; only of tracks without belts
};

/// Takes pointers into the vehicle, which must outlive the assembly. Idlers turn in the chassis, and the shoes' mass
/// rides with it.
Assembly assemble(const Vehicle& v);

/// A tracked vehicle without its shoes, idlers [left, right] where they are given, on carriers that slide along the
/// tensioners' travel; their mass is taken off the chassis.
Assembly assemble_without_belts(const Vehicle& v, const std::vector<Vec3d>& idler);

/// One rigid body from two.
Part joined(const Part& a, const Part& b);

}  // namespace gonogo::vehicle
