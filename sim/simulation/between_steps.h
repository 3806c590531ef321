// Work between steps where the arrays are: states of bodies set and copied, contact impulses on bodies summed, impulses
// of joints recovered.
#pragma once
#include "sim/constraint/joint_rows.h"
#include "sim/simulation/simulation.h"
#include "sim/state/contact_lists.h"
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

/// Buffers of what is sent and fetched, kept between calls.
template <class Exec>
struct BodyPlaces {
  Buffer<BodyIndex, Exec> body;
  Buffer<BodyState, Exec> to;
  Buffer<Vec3d, Exec> share;  // see SumContactImpulse
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

/// Lanes that sum the contacts of one body, which is fixed perhaps and then in no list of contacts by body.
inline constexpr Index kForceLanes = 32;

/// A lane's share of the contact impulses on a body: every kForceLanes-th contact of its world.
struct SumContactImpulse {
  View<const BodyIndex> body;  // [k] in the batch
  View<const WorldIndex> world_of_body;
  View<const WorldParameters> world;
  View<const Index> first_contact;
  View<const Contact> contact;
  View<const Impulse> impulse;
  View<Vec3d> share;  // [k * kForceLanes] [N s]

  GONOGO_HD void operator()(Index at) const {
    const BodyIndex b = body[at / kForceLanes];
    const ContactRange r = contacts_of_world(world[world_of_body[b]], first_contact);
    Vec3d sum;
    for (ContactIndex i = r.begin + at % kForceLanes; i < r.end; i += kForceLanes) {
      if (contact[i].body_a == b) sum += static_cast<Vec3d>(impulse[i].linear);
      if (contact[i].body_b == b) sum -= static_cast<Vec3d>(impulse[i].linear);
    }
    share[at] = sum;
  }
};

/// Contact impulses on bodies of the batch in the last substep [N s]; `latest`: the store of their impulses.
template <class Exec>
std::vector<Vec3d> sum_contact_impulses(Exec exec, State<Exec>& s, ContactStore<Exec>& latest, BodyPlaces<Exec>& sent,
                                        const std::vector<BodyIndex>& body) {
  sent.body.upload(body);
  sent.share.resize(body.size() * std::size_t(kForceLanes));
  for_each_index(exec, sent.share.size(),
                 SumContactImpulse{.body = sent.body.view(),
                                   .world_of_body = s.world_of_body.view(),
                                   .world = s.world.view(),
                                   .first_contact = s.first_contact.view(),
                                   .contact = s.contact.view(),
                                   .impulse = latest.impulse.view(),
                                   .share = sent.share.view()});
  const std::vector<Vec3d> shares = sent.share.download();
  std::vector<Vec3d> sums(body.size());
  for (std::size_t k = 0; k < shares.size(); ++k) sums[k / std::size_t(kForceLanes)] += shares[k];
  return sums;
}

/// p = -A^-1 (J v_gathered + b), from the system that prepare_mechanisms() solved at the step's start.
struct RecoverImpulse {
  View<const Mechanism> mechanism;
  View<const Row> row;
  View<const double> system;
  View<const Velocity> gathered;
  View<double> impulse;  // [row]

  GONOGO_HD void operator()(Index i) const {
    const Mechanism& m = mechanism[row[i].mechanism];
    const Index local = i - m.first_row;
    if (local < 0 || local >= m.row_count) return;  // an empty place in a batch
    const double* solved = system.data + m.system + std::size_t(local) * m.stride();
    const double pivot = solved[local];
    GONOGO_ASSERT(!(pivot <= 0));
    const double* of_velocity = solved + m.first_right();
    double sum = of_velocity[m.unknowns()];
    for (Index slot = 0; slot < m.body_count; ++slot) {
      const Velocity& v = gathered[m.first_body + slot];
      const double* share = of_velocity + 6 * slot;
      sum += share[0] * v.linear.x + share[1] * v.linear.y + share[2] * v.linear.z + share[3] * v.angular.x +
             share[4] * v.angular.y + share[5] * v.angular.z;
    }
    impulse[i] = -sum / pivot;
  }
};

/// Adds one row. A row is either a force at a's point, without moment about it, or a moment.
inline void add_row(JointLoad& load, const Row& row, double impulse, double step) {
  const double(&d)[6] = row.direction[0];
  const bool pushes = d[0] != 0 || d[1] != 0 || d[2] != 0;
  if (pushes) load.force += Vec3d{d[0], d[1], d[2]} * (impulse / step);
  if (!pushes) load.moment += Vec3d{d[3], d[4], d[5]} * (impulse / step);
}

template <class Exec>
void recover_impulses(Exec exec, MechanismStore<Exec>& s) {
  for_each_index(
      exec, s.row.size(),
      RecoverImpulse{s.mechanism.view(), s.row.view(), s.system.view(), s.gathered.view(), s.row_impulse.view()});
}

}  // namespace gonogo::sim
