// A track in a world of the contact engine: shoes on pins around sprocket, road wheels and idler, with a tensioner.
//
// The belt is a mechanism of its own, held by contacts alone:
//   - plates lie on the discs of road wheels and idler;
//   - a boss around every pin sits between two teeth of the sprocket;
//   - a horn on every shoe runs in the gap between the discs and guides the belt sideways, with the play of that gap.
// Teeth are boxes on the sprocket's hub, half-way between the seats of neighbouring bosses. They leave 3 mm beside each
// boss and reach 12 mm over the chord between the pins. As in a chain drive, the teeth push some bosses and the hub
// carries others (single-pin shoes: J. Y. Wong, Theory of Ground Vehicles, 4th ed., 4.1; sprocket contact as in Project
// Chrono's ChTrackAssemblySinglePin, with boxes instead of arcs). Plates and sprockets pass through each other, because
// a real shoe has windows for the teeth.
//
// There is no friction inside a track: bosses turn about their pins like the rollers of a chain. With friction, the
// straight flank of a tooth would hold the boss that leaves it under tension and wind the belt up. Wheels therefore
// slide on plates, which matters little because their moments of inertia are small. Internal resistance comes from
// impacts and dampers alone.
#pragma once
#include "vehicle/model/track_loop.h"
#include "vehicle/world/engine_bodies.h"

namespace gonogo::vehicle {

struct EngineTrack {
  std::vector<sim::BodyIndex> shoe;  // [shoe] between pins k and k + 1 of the loop
  std::vector<Index> pin;            // joint of shoe k with the shoe before it, at pin k
  sim::BodyIndex sprocket = 0, idler = 0, carrier = 0;
  Index drive_motor = -1, brake_motor = -1;  // of the sprocket against the chassis
  Index tensioner = -1;                      // spring between chassis and carrier
  double brake_torque = 0;                   // [N m]
};

/// Throws InputError when the vehicle's file describes no belts, or when the sprocket does not fit them.
void require_belt(const Vehicle& v);

/// Adds the sprockets' teeth and the idlers of both sides, `loops` left and right. Shapes follow the order of bodies:
/// call after the chassis's shapes and before the road wheels'.
void add_sprockets_and_idlers(sim::SceneWorld& world, const Vehicle& v, const TrackLoop (&loops)[2],
                              const Assembly& assembly, const EngineBodies& bodies, int material);

/// Adds the two discs of a road wheel or idler.
void add_double_wheel(sim::SceneWorld& world, const Vehicle& v, sim::BodyIndex body, double radius, double width,
                      int material);

/// Adds spring and damper about the pivot of a station's trailing arm.
void add_torsion_spring(sim::SceneWorld& world, const Station& station, const Assembly& assembly, int wheel,
                        const EngineBodies& bodies);

/// Adds shoes, pins, shapes, tensioner and motors of one side: 1 left, -1 right. Call after add_bodies.
EngineTrack add_belt(sim::SceneWorld& world, const Vehicle& v, double side, const TrackLoop& loop,
                     const Assembly& assembly, const EngineBodies& bodies, const Vec3d& origin, int material);

}  // namespace gonogo::vehicle
