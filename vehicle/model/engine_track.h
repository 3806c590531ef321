// A track in a world of the contact engine: shoes on pins around sprocket, road wheels and idler, and what tensions it.
//
// The belt is a mechanism of its own. Contacts alone hold it: plates on the discs of road wheels and idler, a boss
// around every pin between the teeth of the sprocket, and on every shoe a horn in the gap between the discs, which
// guides the belt sideways with the play that the gap leaves. Teeth are boxes on the sprocket's hub, half-way between
// the seats of neighbouring bosses, with 3 mm of room beside each; they reach 12 mm over the chord between the pins. A
// driving sprocket pushes bosses with its teeth and carries others with its hub, as in a chain drive (single-pin
// shoes: J. Y. Wong, Theory of Ground Vehicles, 4th ed., 4.1; contact of sprocket and shoe pins as in Project Chrono's
// ChTrackAssemblySinglePin, with arcs instead of boxes). Plates and sprockets pass through each other: a real shoe has
// windows for the teeth.
//
// Nothing rubs inside a track: bosses turn about their pins like the rollers of a chain. With friction on its straight
// flanks a tooth would hold the boss that leaves it under tension and wind the belt up. So wheels slide on plates
// instead of rolling, which their small moments of inertia let pass, and the internal resistance is that of impacts and
// dampers alone.
#pragma once
#include "vehicle/model/engine_bodies.h"
#include "vehicle/model/track_loop.h"

namespace gonogo::vehicle {

struct EngineTrack {
  std::vector<sim::BodyIndex> shoe;  // [shoe] between pins k and k + 1 of the loop
  std::vector<Index> pin;            // joints: shoe k to the shoe before it, at pin k
  sim::BodyIndex sprocket = 0, idler = 0, carrier = 0;
  Index drive_motor = -1, brake_motor = -1;  // of the sprocket against the chassis
  Index tensioner = -1;                      // spring between chassis and carrier
  double brake_torque = 0;                   // [N m]
};

/// Throws InputError for a vehicle whose file says nothing of its belts, or whose sprocket does not fit them.
void require_belt(const Vehicle& v);

/// Teeth and idlers of both sides, `loops` left and right. Shapes come in the order of their bodies: call after the
/// chassis's and before the road wheels'.
void add_sprockets_and_idlers(sim::SceneWorld& world, const Vehicle& v, const TrackLoop (&loops)[2],
                              const Assembly& assembly, const EngineBodies& bodies, int material);

/// A road wheel's or idler's two discs.
void add_double_wheel(sim::SceneWorld& world, const Vehicle& v, sim::BodyIndex body, double radius, double width,
                      int material);

/// Spring and damper about the pivot of a station's trailing arm.
void add_torsion_spring(sim::SceneWorld& world, const Station& station, const Assembly& assembly, int wheel,
                        const EngineBodies& bodies);

/// Shoes, pins, shapes, tensioner and motors of one side, 1 left or -1 right. Call after add_bodies.
EngineTrack add_belt(sim::SceneWorld& world, const Vehicle& v, double side, const TrackLoop& loop,
                     const Assembly& assembly, const EngineBodies& bodies, const Vec3d& origin, int material);

}  // namespace gonogo::vehicle
