// The stages of an iteration, as one team takes them; see launch.cuh for their order. Sums have the same order, and so
// the same bits, whether contacts are resident or not.
#pragma once
#include "sim/solver/cuda/contact_records.cuh"
#include "sim/solver/cuda/mechanism.cuh"

namespace gonogo::sim {

/// Bodies with more contacts than this are summed by a warp.
inline constexpr Index kHubContacts = 48;

/// `turning`: some contact resists rolling or spinning. `resident`: see Residence. `in_substeps`: a step may have
/// several. `method`: `apgd` includes `jacobi`, whose momentum is zero.
template <bool turning, bool resident, bool in_substeps, Iteration method>
class SolveKernel {
  static constexpr bool sweeps = method == Iteration::gauss_seidel, spectral = method == Iteration::bb;
  static_assert(!resident || method == Iteration::apgd);

 public:
  GONOGO_DEVICE SolveKernel(const SolveViews& views, const Team& team, MechanismWork& work)
      : s(views), contact_(views), team_(team), work_(work) {
    if (!resident) return;
    if (team.rank == 0) {
      const bool works = team.index < s.tiles.count();
      residence().tile[team.in_block] = works ? s.tiles.tile[team.index] : Tile{{0, 0}, -1, 0};
    }
    team.sync();
  }

  /// Packs the records of contacts, with impulses from the warm start, and starts bodies, worlds and motors.
  GONOGO_DEVICE void prepare() {
    if constexpr (resident) {
      const ContactRange own = tile().contacts;
      if (const ContactIndex i = own.begin + team_.rank; i < own.end) begin_contact(i);
    } else {
      for (Index i = first_index(); i < *s.contact_total; i += stride()) begin_contact(i);
    }
    for (Index b = first_index(); b < s.mass.size; b += stride()) prepare_body(b);
    for (Index w = first_index(); w < s.momentum[0].size; w += stride()) {
      store_words(s.momentum[0][w], first_momentum(s.rules));
      if (spectral) s.length[w] = SpectralStep{};
    }
    for (Index m = first_index(); m < s.motor.size; m += stride()) s.motor_before[m] = s.motor_impulse[m];
  }

  /// Copies the resident half contacts of bodies. Call when all blocks have prepared.
  GONOGO_DEVICE void hold_bodies() {
    if constexpr (resident) {
      if (threadIdx.x == 0) residence().hub_count = *s.hub_count;
      const BodyIndex b = first_index() / kLanesPerBody, in_block = threadIdx.x / kLanesPerBody;
      Load load;
      if (b < s.mass.size) load = load_of(b);
      if (lane() == 0) {
        residence().contacts_of_body[in_block] = load.contacts;
        residence().world_of_body[in_block] = load.world;
      }
      for (Index n = 0; n < kHeldHalves; ++n)
        if (const Index k = load.contacts.begin + lane() + n * kLanesPerBody; k < load.contacts.end)
          residence().half[n][threadIdx.x] = s.half[k];
      __syncthreads();
    }
  }

  /// Colours the contacts; each waits for those before it, so all blocks must be running. Call when all blocks have
  /// prepared. See Colouring.
  GONOGO_DEVICE void colour_contacts() {
    if constexpr (sweeps) {
      const Colouring all{s.incidence, s.mass, s.tiles.world, s.contact, s.colour};
      for (bool waiting = true; waiting;) {
        waiting = false;
        for (Index i = first_index(); i < *s.contact_total; i += stride()) waiting = !all.try_colour(i) || waiting;
      }
      for (Index i = first_index(); i < *s.contact_total; i += stride()) atomicMax(s.colours, s.colour[i] + 1);
    }
  }

  /// Update number `k` of all tiles.
  GONOGO_DEVICE void update_contacts(Index k, GridBarrier& grid) {
    if constexpr (sweeps) {
      for (Index colour = 0; colour == 0 || colour < *s.colours; ++colour) {
        if (colour > 0) grid.wait();
        for (Index tile = team_.index; tile < s.tiles.count(); tile += team_.count)
          sweep_tile(s.tiles.tile[tile], tile, k, colour);
      }
    } else if constexpr (resident) {
      if (tile().world >= 0) update_tile(tile(), team_.index, k);
    } else {
      for (Index tile = team_.index; tile < s.tiles.count(); tile += team_.count)
        update_tile(s.tiles.tile[tile], tile, k);
    }
  }

  /// Starts from the last threads, which have the fewest contacts.
  GONOGO_DEVICE void update_motors(Index k) {
    const UpdateMotor update{.motor = s.motor,
                             .drive = s.drive,
                             .velocity = s.extrapolated_velocity,
                             .world_of_body = s.world_of_body,
                             .momentum = s.momentum[k & 1],
                             .now = s.motor_impulse,
                             .before = s.motor_before,
                             .step = s.settings.substep()};
    for (Index i = stride() - 1 - first_index(); i < s.motor.size; i += stride()) update(i);
  }

  /// Velocities after update number `k`; -1: after the warm start.
  GONOGO_DEVICE void move_bodies(Index k) {
    const View<Momentum> momentum = s.momentum[k < 0 ? 0 : k & 1];
    if constexpr (resident) {
      const Index in_block = threadIdx.x / kLanesPerBody;
      const Load load{residence().contacts_of_body[in_block], residence().world_of_body[in_block]};
      if (load.world >= 0) move_body(first_index() / kLanesPerBody, load, momentum, k);
    } else {
      const Index teams = team_.count - s.mechanism_teams, all = kLanesPerBody * s.mass.size;
      for (Index l = (team_.index < teams) ? first_index() : all; l < all; l += teams * kTileSize)
        if (const Load load = load_of(l / kLanesPerBody); load.world >= 0)
          move_body(l / kLanesPerBody, load, momentum, k);
    }
    const Index hubs = resident ? residence().hub_count : *s.hub_count;
    for (Index h = first_index() / 32; h < hubs; h += stride() / 32) move_hub(s.hub[h], momentum, k);
  }

  /// Velocities of the jointed bodies from those that their mechanism gathers. Starts from the last teams, which have
  /// the fewest bodies.
  GONOGO_DEVICE void move_mechanisms(Index k) {
    const auto add = [&](const HalfRange& c, Index from, Index step, Vec3& linear, Vec3& angular) {
      add_contacts({c.begin + from, c.end}, (k + 1) & 1, step, linear, angular);
    };
    MechanismMover mover(s, team_, work_, add);
    Real* held = resident ? residence().projection : nullptr;
    const bool several = s.projection.mechanism.size > team_.count;
    for (Index m = team_.count - 1 - team_.index; m < s.projection.mechanism.size; m += team_.count) {
      if (k < 0 || several) mover.load(m, held);
      mover.template move<in_substeps>(k, held);
    }
  }

  /// Plans update `k + 1` of each world from the sums of its tiles.
  GONOGO_DEVICE void decide(Index k) {
    const Index behind = s.projection.mechanism.size;  // skips the teams with a mechanism, which are busy
    for (WorldIndex w = (team_.count - 1 - team_.index + team_.count - behind % team_.count) % team_.count;
         w < s.momentum[0].size; w += team_.count)
      decide(w, k);
  }

  /// After `k` updates: impulses into the contact store; residuals and energies by tile.
  GONOGO_DEVICE void measure(Index k) {
    Measures<turning> measures(s, team_);
    for (Index tile = team_.index; tile < s.tiles.count(); tile += team_.count) measures.measure_tile(tile, k);
    for (Index tile = team_.index; tile < s.world_of_body_tile.size; tile += team_.count) measures.measure_bodies(tile);
  }

  /// Residuals and energies by world.
  GONOGO_DEVICE void add_measures(Index k) {
    Measures<turning> measures(s, team_);
    for (WorldIndex w = team_.index; w < s.world_sums.size; w += team_.count) measures.add_measures(w, k);
  }

 protected:
  GONOGO_DEVICE Index first_index() const { return team_.index * kTileSize + team_.rank; }
  GONOGO_DEVICE Index stride() const { return team_.count * kTileSize; }
  GONOGO_DEVICE Index lane() const { return team_.rank % kLanesPerBody; }
  GONOGO_DEVICE const Tile& tile() const { return residence().tile[team_.in_block]; }

  GONOGO_DEVICE void begin_contact(ContactIndex i) {
    contact_.pack(i);
    if (sweeps) s.colour[i] = kNoColour;
  }

  GONOGO_DEVICE void prepare_body(BodyIndex b) {
    HalfRange c{};  // a fixed body sums no contacts
    if (!is_fixed(s.mass[b]))
      c = {s.incidence.owned_begin(b) + s.incidence.first_second[b],
           s.incidence.owned_end(b) + s.incidence.first_second[b + 1]};
    s.of_body[b] = c;
    if (c.end - c.begin > kHubContacts && s.mass[b].slot < 0) s.hub[atomicAdd(s.hub_count, 1)] = b;
  }

  GONOGO_DEVICE void update_tile(const Tile& t, Index tile, Index k) {
    const Momentum m = s.momentum[k & 1][t.world];
    if (!resident && m.done) return;
    const ContactIndex i = t.contacts.begin + team_.rank;
    const bool mine = i < t.contacts.end;
    PairRecord bodies{0, 0};
    if (mine) bodies = contact_.pair(i);
    Velocity a = extrapolated_velocity(bodies.a), b = extrapolated_velocity(bodies.b);
    if (m.done) return;
    Real gap_bias = 0;
    if (in_substeps && m.begins && mine) {
      gap_bias = advance_contact(i, bodies, m, k & 1);
      // Loaded again, so that they need no registers meanwhile.
      a = extrapolated_velocity(bodies.a);
      b = extrapolated_velocity(bodies.b);
    }
    UpdateSums sums;
    if constexpr (spectral) {
      SpectralSums spectral_sums;
      if (mine) spectral_sums = update_spectrally(i, a, b, gap_bias, m, k & 1, sums);
      spectral_sums = team_.sum(spectral_sums);
      if (team_.rank == 0) s.spectral_sums[tile] = spectral_sums;
    } else {
      if (mine) sums = update_contact(i, a, b, gap_bias, m, k & 1);
      sums.uphill = team_.sum(sums.uphill);
    }
    if (m.test) sums.residual_square = team_.sum(sums.residual_square);
    if (team_.rank == 0) s.tile_sums[tile] = sums;
  }

  /// Updates the contacts of one colour, and their bodies at once.
  GONOGO_DEVICE void sweep_tile(const Tile& t, Index tile, Index k, Index colour) {
    const Momentum m = s.momentum[k & 1][t.world];
    if (m.done) return;
    const ContactIndex i = t.contacts.begin + team_.rank;
    const bool mine = i < t.contacts.end && s.colour[i] == colour;
    double residual = 0;
    if (mine) {
      const PairRecord bodies = contact_.pair(i);
      const Real gap_bias = in_substeps && m.begins ? advance_contact(i, bodies, m, k & 1) : Real(0);
      const Impulse before = contact_.own_impulse(k & 1, i);
      residual =
          update_contact(i, s.extrapolated_velocity[bodies.a], s.extrapolated_velocity[bodies.b], gap_bias, m, k & 1)
              .residual_square;
      const Impulse after = contact_.own_impulse(1 - (k & 1), i);
      const Impulse change{after.linear - before.linear, 0, after.angular - before.angular, 0};
      const ContactNumbers<Real> c = contact_.unpack(i);
      const SweptBodies swept{s.incidence, s.mass, s.inverse_inertia_W, s.extrapolated_velocity};
      swept.move(bodies.a, c.arm_a, change, 1);
      swept.move(bodies.b, c.arm_b, change, -1);
    }
    if (m.test) residual = team_.sum(residual);
    if (team_.rank == 0)
      s.tile_sums[tile].residual_square = residual + (colour > 0 ? s.tile_sums[tile].residual_square : 0);
    if (team_.rank == 0) s.tile_sums[tile].uphill = 0;
  }

  GONOGO_DEVICE Velocity extrapolated_velocity(BodyIndex b) const {
    return resident ? loaded_early(s.extrapolated_velocity[b]) : s.extrapolated_velocity[b];
  }

  /// Moves the gap on to this substep and returns its bias. In the last substep the contact itself is updated, for the
  /// residual. `now`: the store of the latest impulses.
  GONOGO_DEVICE Real advance_contact(ContactIndex i, const PairRecord& bodies, const Momentum& m, Index now) {
    const ContactNumbers<Real> c = contact_.unpack(i);
    GapRecord own = s.gap[i];
    own.gap = advanced_gap<Real>(own.gap, c, s.substep_velocity[bodies.a], s.substep_velocity[bodies.b],
                                 s.settings.substep());
    if (c.softness > 0)
      own.gap =
          counted_gap(own.gap, own.rate, c.softness * dot(contact_.own_impulse(now, i).linear, c.normal), s.settings);
    const Real bias = bias_of_gap(own.gap, own.rate, c.softness, s.settings);
    s.gap[i].gap = own.gap;
    if (!m.renew_slip) contact_.frame(i).bias = bias;
    if (is_last_substep(m, s.rules)) {
      s.contact[i].gap = own.gap;
      s.contact[i].gap_bias = bias;
    }
    return bias;
  }

  /// Renews the bias as target_bias does. `gap_bias`: from advance_contact, where this update has called it.
  GONOGO_DEVICE void renew_slip(ContactIndex i, const Velocity& a, const Velocity& b, Real gap_bias, const Momentum& m,
                                ContactNumbers<Real>& c) {
    if (!(in_substeps && m.begins)) gap_bias = standing_gap_bias(i, c);
    c.bias = gap_bias + opening_speed<turning, Real>(c, a, b);
    contact_.frame(i).bias = c.bias;
  }

  GONOGO_DEVICE Real standing_gap_bias(ContactIndex i, const ContactNumbers<Real>& c) const {
    if constexpr (!in_substeps) return s.contact[i].gap_bias;
    const GapRecord own = s.gap[i];
    return bias_of_gap(own.gap, own.rate, c.softness, s.settings);
  }

  /// `gap_bias`: see renew_slip.
  GONOGO_DEVICE UpdateSums update_contact(ContactIndex i, const Velocity& a, const Velocity& b, Real gap_bias,
                                          const Momentum& m, Index now) {
    ContactNumbers<Real> c = contact_.unpack(i);
    if (m.renew_slip) renew_slip(i, a, b, gap_bias, m, c);
    // A sweep has no momentum: its velocities change within the update.
    const ContactUpdate<Real> u = accelerated_update<turning, Real>(
        c, a, b, contact_.own_impulse(now, i), contact_.own_impulse(1 - now, i), sweeps ? Real(0) : m.beta);
    contact_.store_impulse(1 - now, i, u.impulse);
    return {u.uphill, m.test ? residual_square<turning, Real>(c, u) : Real(0)};
  }

  GONOGO_DEVICE SpectralSums update_spectrally(ContactIndex i, const Velocity& a, const Velocity& b, Real gap_bias,
                                               const Momentum& m, Index now, UpdateSums& sums) {
    ContactNumbers<Real> c = contact_.unpack(i);
    if (m.renew_slip) renew_slip(i, a, b, gap_bias, m, c);
    const PairRecord bodies = contact_.pair(i);
    const Real length = Real(s.length[s.contact[i].world].length);
    const SpectralUpdate<Real> u =
        spectral_update<turning, Real>(c, a, b, s.velocity_before[bodies.a], s.velocity_before[bodies.b],
                                       contact_.own_impulse(now, i), contact_.own_impulse(1 - now, i), length);
    contact_.store_impulse(1 - now, i, u.update.impulse);
    if (m.test) sums.residual_square = residual_square<turning, Real>(c, u.update);
    return {u.sums.change_square, u.sums.curvature, u.sums.rise};
  }

  GONOGO_DEVICE void add_contact(const HalfContact& half, Index store, Vec3& linear, Vec3& angular) const {
    const bool backwards = half.contact < 0;
    const Impulse p = contact_.load_impulse(store, backwards ? ~half.contact : half.contact);
    const Vec3 turn = moment(half.arm, p);
    linear += backwards ? -p.linear : p.linear;
    angular += backwards ? -turn : turn;
  }

  /// Every `step`-th contact of a range.
  GONOGO_DEVICE void add_contacts(const HalfRange& c, Index store, Index step, Vec3& linear, Vec3& angular) const {
#pragma unroll 4
    for (Index k = c.begin; k < c.end; k += step) add_contact(s.half[k], store, linear, angular);
  }

  /// Every kLanesPerBody-th contact of a body, from the calling lane on.
  GONOGO_DEVICE void add_own_contacts(const HalfRange& c, Index store, Vec3& linear, Vec3& angular) const {
    HalfRange rest{c.begin + lane(), c.end};
    if constexpr (resident) {
      for (Index n = 0; n < kHeldHalves; ++n, rest.begin += kLanesPerBody)
        if (rest.begin < c.end) add_contact(residence().half[n][threadIdx.x], store, linear, angular);
    }
    add_contacts(rest, store, kLanesPerBody, linear, angular);
  }

  /// What the lanes of a body need. Hubs and jointed bodies have no contacts here and world -1.
  struct Load {
    HalfRange contacts{0, 0};
    WorldIndex world = -1;
  };

  GONOGO_DEVICE Load load_of(BodyIndex b) const {
    const HalfRange c = s.of_body[b];
    if (c.end - c.begin > kHubContacts || s.mass[b].slot >= 0) return {};
    return {c, s.world_of_body[b]};
  }

  GONOGO_DEVICE void move_body(BodyIndex b, const Load& load, View<const Momentum> momentum, Index k) {
    const Momentum m = momentum[load.world];
    if (!resident && m.done) return;
    const BodyMass mass = s.mass[b];
    Velocity free = s.free_velocity[b], now = s.velocity[b];
    Vec3 linear, angular;
    add_own_contacts(load.contacts, (k + 1) & 1, linear, angular);
    linear = sum_of_lanes<kLanesPerBody>(linear);
    angular = sum_of_lanes<kLanesPerBody>(angular);
    if (lane() == 0 && !m.done) set_velocity(b, mass, linear, angular, m, k, free, now);
  }

  /// By one warp.
  GONOGO_DEVICE void move_hub(BodyIndex b, View<const Momentum> momentum, Index k) {
    const Momentum m = momentum[s.world_of_body[b]];
    if (m.done) return;
    Vec3 linear, angular;
    const HalfRange c = s.of_body[b];
    add_contacts({c.begin + team_.rank % 32, c.end}, (k + 1) & 1, 32, linear, angular);
    linear = sum_of_lanes<32>(linear);
    angular = sum_of_lanes<32>(angular);
    if (team_.rank % 32 != 0) return;
    Velocity free = s.free_velocity[b], now = s.velocity[b];
    set_velocity(b, s.mass[b], linear, angular, m, k, free, now);
  }

  /// `free`, `now`: in: velocities without impulses and of the update before; out: the new ones.
  GONOGO_DEVICE void set_velocity(BodyIndex b, const BodyMass& mass, const Vec3& linear, const Vec3& angular,
                                  const Momentum& m, Index k, Velocity& free, Velocity& now) {
    if (k < 0) free = begin_body(s, b);
    const Velocity before = now;
    if (spectral) s.velocity_before[b] = before;
    now = driven(s, b, free, mass, linear, angular);
    Velocity ahead = k < 0 ? now : extrapolated<Real>(now, before, m.next_beta);
    if (in_substeps && k >= 0 && m.ends) {
      const Velocity more = carry_body(s, b, now, free);
      now = sum(now, more);
      ahead = sum(ahead, more);
    }
    s.velocity[b] = now;
    s.extrapolated_velocity[b] = ahead;
  }

  GONOGO_DEVICE void decide(WorldIndex w, Index k) {
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
      const Momentum present = m;
      decide_next_update(m, sums, r.end - r.begin, s.rules);
      if constexpr (spectral) decide_length(w, present, m);
      if (m.done && team_.rank == 0) atomicAdd(s.barrier, GridBarrier::kWorldDone);
    }
    if (team_.rank == 0) store_words(s.momentum[(k + 1) & 1][w], m);
  }

  GONOGO_DEVICE void decide_length(WorldIndex w, const Momentum& present, const Momentum& next) {
    SpectralSums sums;
    for (Index t = s.tiles.first_tile[w] + team_.rank; t < s.tiles.first_tile[w + 1]; t += kTileSize)
      sums += s.spectral_sums[t];
    sums = team_.sum(sums);
    if (team_.rank == 0) decide_next_length(s.length[w], sums, present, next, s.rules);
  }

  const SolveViews& s;
  ContactRecords<turning, resident, in_substeps> contact_;
  const Team& team_;
  MechanismWork& work_;
};

}  // namespace gonogo::sim
