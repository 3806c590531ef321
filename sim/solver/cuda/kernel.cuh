// The stages of an iteration as seen by a team. Sums have the same order, and so the same bits, whether contacts are
// resident or not.
#pragma once
#include "sim/solver/cuda/mechanism.cuh"

namespace gonogo::sim {

/// Bodies with more contacts than this are summed by a warp.
inline constexpr Index kHubContacts = 48;

template <bool turning, bool resident>
class SolveKernel {
 public:
  __device__ SolveKernel(const SolveViews& views, const Team& team, MechanismWork& work)
      : s(views), team_(team), work_(work) {
    if (resident && team.index < s.tiles.count()) tile_ = s.tiles.tile[team.index];
  }

  /// Contacts from the narrow phase's records, impulses from the warm start.
  __device__ void prepare() {
    if constexpr (resident) {
      if (const ContactIndex i = tile_.contacts.begin + team_.rank; i < tile_.contacts.end) pack(i);
    } else {
      for (Index i = first_index(); i < *s.contact_total; i += stride()) pack(i);
    }
    for (Index b = first_index(); b < s.mass.size; b += stride()) prepare_body(b);
    for (Index w = first_index(); w < s.momentum[0].size; w += stride()) s.momentum[0][w] = first_momentum(s.rules);
    for (Index m = first_index(); m < s.motor.size; m += stride()) s.motor_before[m] = s.motor_impulse[m];
    if (first_index() == 0) *s.worlds_at_work = s.momentum[0].size;
  }

  /// Once all blocks have prepared.
  __device__ void hold_bodies() {
    if constexpr (resident) {
      const BodyIndex b = first_index() / kLanesPerBody;
      if (b >= s.mass.size) return;
      load_ = load_of(b);
      for (Index n = 0; n < kHeldHalves; ++n)
        if (const Index k = load_.contacts.begin + lane() + n * kLanesPerBody; k < load_.contacts.end)
          residence().half[n][threadIdx.x] = s.half[k];
    }
  }

  /// Update number `k` of all tiles.
  __device__ void update_contacts(Index k) {
    if constexpr (resident) {
      if (team_.index < s.tiles.count()) update_tile(tile_, team_.index, k);
    } else {
      for (Index tile = team_.index; tile < s.tiles.count(); tile += team_.count)
        update_tile(s.tiles.tile[tile], tile, k);
    }
  }

  /// Velocities after update number `k`; -1: of the warm start.
  __device__ void move_bodies(Index k) {
    const View<Momentum> momentum = s.momentum[k < 0 ? 0 : k & 1];
    for (Index l = first_index(); l < kLanesPerBody * s.mass.size; l += stride())
      move_body(l / kLanesPerBody, momentum, k);
    for (Index h = first_index() / 32; h < *s.hub_count; h += stride() / 32) move_hub(s.hub[h], momentum, k);
  }

  /// Motors, and velocities of the jointed bodies from all that their mechanism gathers. The last teams begin, which
  /// have fewest bodies.
  __device__ void move_mechanisms(Index k) {
    const auto add = [&](const HalfRange& c, Index from, Index step, Vec3& linear, Vec3& angular) {
      add_contacts(c, (k + 1) & 1, from, step, false, linear, angular);
    };
    MechanismMover mover(s, team_, work_, add);
    Real* held = resident ? residence().projection[team_.in_block] : nullptr;
    for (Index m = team_.count - 1 - team_.index; m < s.projection.mechanism.size; m += team_.count) {
      if (!resident || k < 0) mover.load(m, held);
      mover.move(k, held);
    }
  }

  /// What update `k + 1` will do: a team adds a world's tiles in order.
  __device__ void decide(Index k) {
    const Index behind = s.projection.mechanism.size;  // teams with a mechanism are busy
    for (WorldIndex w = (team_.count - 1 - team_.index + team_.count - behind % team_.count) % team_.count;
         w < s.momentum[0].size; w += team_.count)
      decide(w, k);
  }

  __device__ bool any_at_work() const { return *static_cast<volatile Index*>(s.worlds_at_work) > 0; }

  /// After `k` updates: impulses back into the order of the contacts, residuals and energies, by tile.
  __device__ void measure(Index k) {
    for (Index tile = team_.index; tile < s.tiles.count(); tile += team_.count) measure_tile(tile, k);
    for (Index tile = team_.index; tile < s.world_of_body_tile.size; tile += team_.count) measure_bodies(tile);
  }

  /// And by world.
  __device__ void add_measures(Index k) {
    for (WorldIndex w = team_.index; w < s.world_sums.size; w += team_.count) add_measures(w, k);
  }

 private:
  __device__ Index first_index() const { return team_.index * kTileSize + team_.rank; }
  __device__ Index stride() const { return team_.count * kTileSize; }
  __device__ Index lane() const { return team_.rank % kLanesPerBody; }

  // Where a contact's records are.
  __device__ FrameRecord& frame(ContactIndex i) { return resident ? residence().frame[threadIdx.x] : s.frame[i]; }
  __device__ ConeRecord& cone(ContactIndex i) { return resident ? residence().cone[threadIdx.x] : s.cone[i]; }
  __device__ TurnRecord& turn(ContactIndex i) { return resident ? residence().turn[threadIdx.x] : s.turn[i]; }
  __device__ CentralArms& central(ContactIndex i) { return resident ? residence().central[threadIdx.x] : s.central[i]; }
  __device__ ArmsRecord& arms(ContactIndex i) { return resident ? residence().arms[threadIdx.x] : s.arms[i]; }
  __device__ PairRecord& pair(ContactIndex i) { return resident ? residence().pair[threadIdx.x] : s.pair[i]; }

  /// The impulse that the contact's own thread has stored.
  __device__ Impulse own_impulse(Index store, ContactIndex i) const {
    Impulse p;
    p.linear = resident ? residence().linear[store][threadIdx.x] : s.linear[store][i];
    if (turning) p.angular = resident ? residence().angular[store][threadIdx.x] : s.angular[store][i];
    return p;
  }
  /// The impulse of any contact.
  __device__ Impulse load_impulse(Index store, ContactIndex i) const {
    Impulse p;
    p.linear = s.linear[store][i];
    if (turning) p.angular = s.angular[store][i];
    return p;
  }
  __device__ void store_impulse(Index store, ContactIndex i, const Impulse& p) {
    s.linear[store][i] = p.linear;
    if (turning) s.angular[store][i] = p.angular;
    if (!resident) return;
    residence().linear[store][threadIdx.x] = p.linear;
    if (turning) residence().angular[store][threadIdx.x] = p.angular;
  }

  /// Whether only the part along the normal matters: the rest is rounding, or the body is fixed and at rest.
  __device__ bool is_central(const Vec3& arm, const Vec3& normal, BodyIndex b, Real& along) const {
    const Velocity& v = s.velocity[b];
    along = dot(arm, normal);
    const Vec3 aside = cross(arm, normal);
    if (dot(aside, aside) <= Real(1e-12) * dot(arm, arm)) return true;
    along = 0;
    return is_fixed(s.mass[b]) && dot(v.linear, v.linear) + dot(v.angular, v.angular) == 0;
  }

  __device__ void pack(ContactIndex i) {
    const Contact c = s.contact[i];
    frame(i) = {c.normal, c.bias};
    cone(i) = {c.step.n, c.step.t, c.mu, c.cohesion};
    if (turning) turn(i) = {c.rho, c.sigma, c.step.r, c.softness};
    pair(i) = {c.body_a, c.body_b};
    CentralArms along;
    const bool central_a = is_central(c.arm_a, c.normal, c.body_a, along.a);
    const bool central_b = is_central(c.arm_b, c.normal, c.body_b, along.b);
    if (!central_a || !central_b) {
      along.a = NAN;
      arms(i) = {c.arm_a, c.arm_b};
    }
    central(i) = along;
    s.half[i + s.incidence.first_second[c.body_a]] = {c.arm_a, i};
    if (s.second_slot[i] >= 0) s.half[s.incidence.owned_end(c.body_b) + s.second_slot[i]] = {c.arm_b, ~i};
    const Impulse start = s.impulse[i];
    store_impulse(0, i, start);
    store_impulse(1, i, start);
  }

  __device__ void prepare_body(BodyIndex b) {
    HalfRange c{};  // nothing moves a fixed body
    if (!is_fixed(s.mass[b]))
      c = {s.incidence.owned_begin(b) + s.incidence.first_second[b],
           s.incidence.owned_end(b) + s.incidence.first_second[b + 1]};
    s.of_body[b] = c;
    if (c.end - c.begin > kHubContacts && s.mass[b].slot < 0) s.hub[atomicAdd(s.hub_count, 1)] = b;
  }

  __device__ ContactNumbers<Real> unpack(ContactIndex i) {
    const FrameRecord f = frame(i);
    const ConeRecord k = cone(i);
    const CentralArms along = central(i);
    ContactNumbers<Real> c;
    c.normal = f.normal;
    c.bias = f.bias;
    c.arm_a = f.normal * along.a;
    c.arm_b = f.normal * along.b;
    if (isnan(along.a)) {
      const ArmsRecord both = arms(i);
      c.arm_a = both.a;
      c.arm_b = both.b;
    }
    c.step = {k.step_n, k.step_t, Real(1)};
    c.mu = k.mu;
    c.cohesion = k.cohesion;
    c.rho = c.sigma = c.softness = 0;
    if (turning) {
      const TurnRecord t = turn(i);
      c.rho = t.rho, c.sigma = t.sigma, c.step.r = t.step_r, c.softness = t.softness;
    }
    return c;
  }

  __device__ void update_tile(const Tile& t, Index tile, Index k) {
    const Momentum m = s.momentum[k & 1][t.world];
    if (m.done) return;
    const ContactIndex i = t.contacts.begin + team_.rank;
    UpdateSums sums;
    if (i < t.contacts.end) sums = update_contact(i, m, k & 1);
    sums.uphill = team_.sum(sums.uphill);
    if (m.test) sums.residual_square = team_.sum(sums.residual_square);
    if (team_.rank == 0) s.tile_sums[tile] = sums;
  }

  __device__ UpdateSums update_contact(ContactIndex i, const Momentum& m, Index now) {
    const PairRecord bodies = pair(i);
    const Velocity a = s.extrapolated_velocity[bodies.a], b = s.extrapolated_velocity[bodies.b];
    ContactNumbers<Real> c = unpack(i);
    if (m.renew_slip) {
      c.bias = s.contact[i].gap_bias + c.mu * slip_speed<Real>(c, a, b);
      frame(i).bias = c.bias;
    }
    const ContactUpdate<Real> u =
        accelerated_update<turning, Real>(c, a, b, own_impulse(now, i), own_impulse(1 - now, i), m.beta);
    store_impulse(1 - now, i, u.impulse);
    return {u.uphill, m.test ? residual_square<turning, Real>(c, u) : Real(0)};
  }

  /// Adds every `step`-th contact of a body. `held`: from the first on, they are resident.
  __device__ void add_contacts(const HalfRange& c, Index store, Index from, Index step, bool held, Vec3& linear,
                               Vec3& angular) const {
    Index n = 0;
#pragma unroll 4
    for (Index k = c.begin + from; k < c.end; k += step, ++n) {
      const HalfContact half = held && n < kHeldHalves ? residence().half[n][threadIdx.x] : s.half[k];
      const bool backwards = half.contact < 0;
      const Impulse p = load_impulse(store, backwards ? ~half.contact : half.contact);
      const Vec3 turn = moment(half.arm, p);
      linear += backwards ? -p.linear : p.linear;
      angular += backwards ? -turn : turn;
    }
  }

  /// What a body's few threads need to know. Hubs and jointed bodies are left to others.
  struct Load {
    HalfRange contacts;
    WorldIndex world;
    bool light;
  };

  __device__ Load load_of(BodyIndex b) const {
    const HalfRange c = s.of_body[b];
    return {c, s.world_of_body[b], c.end - c.begin <= kHubContacts && s.mass[b].slot < 0};
  }

  __device__ void move_body(BodyIndex b, View<const Momentum> momentum, Index k) {
    const Load load = resident ? load_ : load_of(b);
    if (!load.light) return;
    const Momentum m = momentum[load.world];
    if (m.done) return;
    const BodyMass mass = s.mass[b];
    const Velocity free = s.free_velocity[b], before = s.velocity[b];
    Vec3 linear, angular;
    add_contacts(load.contacts, (k + 1) & 1, lane(), kLanesPerBody, resident, linear, angular);
    linear = sum_of_lanes<kLanesPerBody>(linear);
    angular = sum_of_lanes<kLanesPerBody>(angular);
    if (lane() != 0) return;
    set_velocity(b, driven(s, b, free, mass, linear, angular), before, m, k);
  }

  /// One warp.
  __device__ void move_hub(BodyIndex b, View<const Momentum> momentum, Index k) {
    const Momentum m = momentum[s.world_of_body[b]];
    if (m.done) return;
    Vec3 linear, angular;
    add_contacts(s.of_body[b], (k + 1) & 1, team_.rank % 32, 32, false, linear, angular);
    linear = sum_of_lanes<32>(linear);
    angular = sum_of_lanes<32>(angular);
    if (team_.rank % 32 != 0) return;
    set_velocity(b, driven(s, b, s.free_velocity[b], s.mass[b], linear, angular), s.velocity[b], m, k);
  }

  __device__ void set_velocity(BodyIndex b, const Velocity& next, const Velocity& before, const Momentum& m, Index k) {
    s.extrapolated_velocity[b] = k < 0 ? next : extrapolated<Real>(next, before, m.next_beta);
    s.velocity[b] = next;
  }

  __device__ void decide(WorldIndex w, Index k) {
    Momentum m = s.momentum[k & 1][w];
    if (!m.done) {
      UpdateSums sums;
      for (Index t = s.tiles.first_tile[w] + team_.rank; t < s.tiles.first_tile[w + 1]; t += kTileSize) {
        sums.uphill += s.tile_sums[t].uphill;
        if (m.test) sums.residual_square += s.tile_sums[t].residual_square;
      }
      sums.uphill = team_.sum(sums.uphill);
      if (m.test) sums.residual_square = team_.sum(sums.residual_square);
      const ContactRange r = contacts_of_world(s.tiles.world[w], s.tiles.first_contact);
      decide_next_update(m, sums, r.end - r.begin, s.rules);
      if (m.done && team_.rank == 0) atomicSub(s.worlds_at_work, 1);
    }
    if (team_.rank == 0) s.momentum[(k + 1) & 1][w] = m;
  }

  __device__ void measure_tile(Index tile, Index k) {
    const Tile t = s.tiles.tile[tile];
    const ContactIndex i = t.contacts.begin + team_.rank;
    WorldSums sums;
    if (i < t.contacts.end) {
      const Impulse p = load_impulse(s.momentum[k & 1][t.world].iterations & 1, i);
      s.impulse[i] = p;
      const Contact c = s.contact[i];
      const double r = contact_residual(c, s.velocity[c.body_a], s.velocity[c.body_b], p, s.rules.target);
      sums.residual_square = r * r;
      sums.residual_max = r;
    }
    sums = team_.sum(sums);
    if (team_.rank == 0) s.tile_measures[tile] = sums;
  }

  __device__ void measure_bodies(Index tile) {
    const WorldIndex w = s.world_of_body_tile[tile];
    const WorldParameters& p = s.tiles.world[w];
    const Index in_world = (tile - s.first_body_tile[w]) * kTileSize + team_.rank;
    WorldSums sums;
    if (in_world < p.body_count) {
      const BodyIndex b = p.first_body + in_world;
      sums = energy_of_body(s.mass[b], s.orientation[b], s.velocity[b], p.gravity);
    }
    sums = team_.sum(sums);
    if (team_.rank == 0) s.body_tile_measures[tile] = sums;
  }

  __device__ void add_measures(WorldIndex w, Index k) {
    WorldSums sum;
    for (Index t = s.tiles.first_tile[w] + team_.rank; t < s.tiles.first_tile[w + 1]; t += kTileSize)
      sum += s.tile_measures[t];
    for (Index t = s.first_body_tile[w] + team_.rank; t < s.first_body_tile[w + 1]; t += kTileSize)
      sum += s.body_tile_measures[t];
    sum = team_.sum(sum);
    const ContactRange r = contacts_of_world(s.tiles.world[w], s.tiles.first_contact);
    sum.contact_count = r.end - r.begin;
    sum.iterations = s.momentum[k & 1][w].iterations;
    if (team_.rank == 0) s.world_sums[w] = sum;
  }

  const SolveViews& s;
  const Team& team_;
  MechanismWork& work_;
  Tile tile_{};  // resident: the team's own
  Load load_{};  // resident: of the thread's body
};

}  // namespace gonogo::sim
