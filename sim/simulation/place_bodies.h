// Sets and copies states of bodies where the arrays are.
#pragma once
#include "sim/state/state.h"

namespace gonogo::sim {

struct PlaceBody {
  View<const BodyIndex> body;  // [k] in the batch
  View<const BodyState> to;    // [k]
  View<Vec3d> position;        // [body] [m]
  View<Quat> orientation;
  View<Velocity> velocity;  // [m/s], [rad/s]

  GONOGO_HD void operator()(Index k) const {
    const BodyState& state = to[k];
    position[body[k]] = state.position;
    orientation[body[k]] = state.orientation;
    velocity[body[k]] = {state.velocity, 0, state.angular_velocity, 0};
  }
};

struct GatherBody {
  View<const BodyIndex> body;  // [k] in the batch
  View<const Vec3d> position;  // [body] [m]
  View<const Quat> orientation;
  View<const Velocity> velocity;  // [m/s], [rad/s]
  View<BodyState> to;             // [k]

  GONOGO_HD void operator()(Index k) const {
    const BodyIndex b = body[k];
    to[k] = {position[b], orientation[b], velocity[b].linear, velocity[b].angular};
  }
};

/// Buffers of what is sent, kept between calls.
template <class Exec>
struct BodyPlaces {
  Buffer<BodyIndex, Exec> body;
  Buffer<BodyState, Exec> to;
};

template <class Exec>
void place_bodies(Exec exec, State<Exec>& s, BodyPlaces<Exec>& sent, const std::vector<BodyIndex>& body,
                  const std::vector<BodyState>& to) {
  sent.body.upload(body);
  sent.to.upload(to);
  for_each_index(
      exec, Index(body.size()),
      PlaceBody{sent.body.view(), sent.to.view(), s.position.view(), s.orientation.view(), s.velocity.view()});
}

template <class Exec>
void gather_bodies(Exec exec, State<Exec>& s, BodyPlaces<Exec>& sent, const std::vector<BodyIndex>& body,
                   Buffer<BodyState, Exec>& to) {
  sent.body.upload(body);
  for_each_index(exec, Index(body.size()),
                 GatherBody{sent.body.view(), s.position.view(), s.orientation.view(), s.velocity.view(), to.view()});
}

}  // namespace gonogo::sim
