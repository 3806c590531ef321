// A vehicle as rigid bodies and joints in the design position, in the vehicle's frame. Both the reduced-coordinate
// model (vehicle/multibody) and the contact engine's model are built from it.
#pragma once
#include "vehicle/model/vehicle.h"

namespace gonogo::vehicle {

/// A wheel that touches the ground, and its suspension.
struct Station {
  std::string name;                        // "front left"
  int axle = 0;                            // of a track: index of the road wheel
  double side = 1;                         // 1 left, -1 right, 0 in the middle
  Vec3d mount, centre;                     // points of the suspension and the wheel [m]
  const Suspension* suspension = nullptr;  // points into the vehicle
  const Wheel* wheel = nullptr;
  bool driven = false;      // of a track: true, by the belt
  double brake_torque = 0;  // [N m]
};

/// All stations, axle by axle, left before right.
std::vector<Station> stations(const Vehicle& v);

enum class LinkType { revolute, prismatic, spherical, distance };

/// A joint of body `child` on body `parent`. Points and axes are in the vehicle's frame.
struct Link {
  LinkType type = LinkType::revolute;
  int parent = 0, child = 0;
  Vec3d point{};         // of a distance link: its end on the child [m]
  Vec3d parent_point{};  // of a distance link: its other end [m]
  Vec3d axis{};          // unit vector; of revolute and prismatic links
  bool wheel = false;    // a wheel's axle
  bool loop = false;     // closes a loop
};

/// Spring, damper or both between two bodies.
struct Strut {
  int parent = 0, child = 0;
  Vec3d parent_point{}, child_point{};  // [m]
  const Spring* spring = nullptr;
  const Damper* damper = nullptr;
};

/// Bodies of a track's sprocket, idler, and the carrier that slides in the chassis with the idler.
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

/// The vehicle must outlive the assembly, which points into it. Idlers turn in the chassis; the shoes' mass is part of
/// the chassis.
Assembly assemble(const Vehicle& v);

/// A tracked vehicle without its shoes. Idlers [left, right] stand at the given points, on carriers that slide along
/// the tensioners' travel. The carriers' mass is taken off the chassis.
Assembly assemble_without_belts(const Vehicle& v, const std::vector<Vec3d>& idler);

/// Two bodies as one rigid body.
Part joined(const Part& a, const Part& b);

}  // namespace gonogo::vehicle
