// The iteration on the host: stages over tiles of contacts and over bodies.
#pragma once
#include "sim/solver/host_methods.h"
#include "sim/solver/jacobi_scan.h"
#include "sim/solver/penalty_method.h"
#include "sim/solver/shared_stages.h"

namespace gonogo::sim {

/// Min number of tiles for which a loop uses several threads; a tile has hundreds of contacts.
inline constexpr Index kTilesInParallel = 4;
/// The same of a mechanism's bodies, each of which costs as much as some tens of contacts.
inline constexpr Index kBodiesInParallel = 64;

/// Velocity of a body from the sum of its wrenches; extrapolated, except after the warm start.
struct GatherVelocity {
  Incidence incidence;
  View<const Wrench> wrench_a, wrench_b;
  View<const BodyMass> mass;
  View<const SymMat3> inverse_inertia_W;
  MotorMoment motor_moment;
  View<const Velocity> free_velocity;
  View<const WorldIndex> world_of_body;
  View<const Momentum> momentum;
  View<Velocity> velocity, extrapolated_velocity;
  View<Velocity> gathered;  // [mechanism body]; their velocities follow from ProjectMechanism
  View<Velocity> before;    // [body], or empty for methods that do not need it
  bool first;               // after the warm start

  void operator()(BodyIndex b) const {
    if (!momentum[world_of_body[b]].done) move(b, sum_of_wrenches(b));
  }

  Pack sum_of_wrenches(BodyIndex b) const {
    Pack sum{};
    const Index owned_end = is_fixed(mass[b]) ? 0 : incidence.owned_end(b);  // nothing moves a fixed body
    for (Index i = incidence.owned_begin(b); i < owned_end; ++i)
      sum += *reinterpret_cast<const PackInMemory*>(&wrench_a[i]);
    for (Index k = incidence.first_second[b]; k < incidence.first_second[b + 1]; ++k)
      sum += *reinterpret_cast<const PackInMemory*>(&wrench_b[k]);
    return sum;
  }

  /// Moves a body by the sum of its wrenches.
  void move(BodyIndex b, const Pack& sum) const {
    const Momentum& m = momentum[world_of_body[b]];
    if (before.size > 0) before[b] = velocity[b];
    if (mass[b].isotropic && mass[b].slot < 0) return set_velocity(b, sum, m.next_beta);
    Vec3 angular{sum[4], sum[5], sum[6]};
    const Index slot = mass[b].slot;
    if (slot >= 0) angular += motor_moment(slot);
    const Velocity next =
        driven_velocity(free_velocity[b], mass[b], inverse_inertia_W[b], {sum[0], sum[1], sum[2]}, angular);
    if (slot >= 0) {
      gathered[slot] = next;
      return;
    }
    extrapolated_velocity[b] = first ? next : extrapolated(next, velocity[b], m.next_beta);
    velocity[b] = next;
  }

  /// driven_velocity() and extrapolated() of a free isotropic body, on all eight numbers of a velocity at once.
  /// Separate vectors would have to be reassembled in memory.
  void set_velocity(BodyIndex b, const Pack& wrench, Real beta) const {
    const Vec3& m = mass[b].inverse_mass;
    const Real i = mass[b].inverse_inertia_B.x;
    const Pack next = in_pack(free_velocity[b]) + Pack{m.x, m.y, m.z, 0, i, i, i, 0} * wrench;
    PackInMemory& now = *reinterpret_cast<PackInMemory*>(&velocity[b]);
    const Pack ahead = first ? next : multiply_add(next - now, constant<Pack>(beta), next);
    *reinterpret_cast<PackInMemory*>(&extrapolated_velocity[b]) = ahead;
    now = next;
  }

  static Pack in_pack(const Velocity& v) { return *reinterpret_cast<const PackInMemory*>(&v); }
};

/// Decides a world's next update from the sums of its tiles, added in order.
struct DecideNextUpdate {
  View<const Index> first_tile;
  View<const UpdateSums> tile_sums;
  Tiles tiles;
  View<Momentum> momentum;
  IterationRules rules;

  void operator()(WorldIndex w) const {
    if (momentum[w].done) return;
    UpdateSums sums;
    for (Index t = first_tile[w]; t < first_tile[w + 1]; ++t) {
      sums.uphill += tile_sums[t].uphill;
      sums.residual_square += tile_sums[t].residual_square;
    }
    const ContactRange r = contacts_of_world(tiles.world[w], tiles.first_contact);
    decide_next_update(momentum[w], sums, r.end - r.begin, rules);
  }
};

struct MeasureWorld {
  Tiles tiles;
  View<const WorldSums> tile_measures;
  View<const BodyMass> mass;
  View<const Quat> orientation;
  View<const Velocity> velocity;
  View<const Momentum> momentum;
  View<WorldSums> sums;

  void operator()(WorldIndex w) const {
    const WorldParameters& p = tiles.world[w];
    WorldSums total;
    for (Index t = tiles.first_tile[w]; t < tiles.first_tile[w + 1]; ++t) total += tile_measures[t];
    for (BodyIndex b = p.first_body; b < p.first_body + p.body_count; ++b)
      total += energy_of_body(mass[b], orientation[b], velocity[b], p.gravity);
    const ContactRange r = contacts_of_world(p, tiles.first_contact);
    total.contact_count = r.end - r.begin;
    total.iterations = momentum[w].updates;
    sums[w] = total;
  }
};

inline bool all_done(const State<Cpu>& s, View<const Momentum> momentum) {
  for (WorldIndex w = 0; w < s.world_count; ++w)
    if (!momentum[w].done) return false;
  return true;
}

inline void fill_blocks(Cpu exec, State<Cpu>& s, SolverStorage<Cpu>& own, Index tile_count) {
  own.block.resize(std::size_t(tile_count) * kBlocksPerTile);
  own.wrench_a.resize(s.contact_capacity);
  own.wrench_b.resize(s.contact_capacity + tile_count);
  own.tile_sums.fill_zero(tile_count);
  own.tile_measures.resize(tile_count);
  own.motor_before.resize(s.mechanisms.motor.size());
  const View<const Impulse> start = s.store[s.parity].impulse.view();
  for_each_index(exec, tile_count, FillTile{tiles(s), s.contact.view(), start, s.second_slot.view(), own.block.view()},
                 kTilesInParallel);
  for_each_index(exec, tile_count, ScatterTile{tiles(s), own.block.view(), own.wrench_a.view(), own.wrench_b.view()},
                 kTilesInParallel);
}

inline bool any_world(State<Cpu>& s, std::int32_t Momentum::*flag) {
  const View<const Momentum> momentum = s.momentum.view();
  for (WorldIndex w = 0; w < s.world_count; ++w)
    if (momentum[w].*flag != 0) return true;
  return false;
}

inline void project_mechanisms(Cpu exec, State<Cpu>& s, bool first, bool carried) {
  for_each_index(exec, s.mechanisms.body.size(), mechanism_projection(s, first, carried), kBodiesInParallel);
}

inline GatherVelocity velocity_gathering(State<Cpu>& s, SolverStorage<Cpu>& own, bool first) {
  return {.incidence = incidence(s),
          .wrench_a = own.wrench_a.view(),
          .wrench_b = own.wrench_b.view(),
          .mass = s.mass.view(),
          .inverse_inertia_W = s.inverse_inertia_W.view(),
          .motor_moment = motor_moment(s.mechanisms),
          .free_velocity = s.free_velocity.view(),
          .world_of_body = s.world_of_body.view(),
          .momentum = s.momentum.view(),
          .velocity = s.velocity.view(),
          .extrapolated_velocity = s.extrapolated_velocity.view(),
          .gathered = s.mechanisms.gathered.view(),
          .before = own.velocity_before.view(),
          .first = first};
}

inline void gather(Cpu exec, State<Cpu>& s, SolverStorage<Cpu>& own, bool first) {
  for_each_index(exec, s.body_count, velocity_gathering(s, own, first));
  project_mechanisms(exec, s, first, false);
}

/// Carries the bodies of worlds that begin another substep into it.
inline void carry_bodies(Cpu exec, State<Cpu>& s) {
  for_each_index(exec, s.body_count, body_carry(s));
  project_mechanisms(exec, s, false, true);
}

inline void advance_tiles(Cpu exec, State<Cpu>& s, SolverStorage<Cpu>& own, Index tile_count, Index parity,
                          const StepSettings& settings) {
  for_each_index(exec, tile_count,
                 AdvanceTile{.tiles = tiles(s),
                             .block = own.block.view(),
                             .substep_velocity = s.substep_velocity.view(),
                             .momentum = s.momentum.view(),
                             .settings = settings,
                             .parity = parity},
                 kTilesInParallel);
}

/// Decides the next update of every world.
inline void decide(Cpu exec, State<Cpu>& s, SolverStorage<Cpu>& own, const IterationRules& rules) {
  for_each_index(exec, s.world_count,
                 DecideNextUpdate{s.first_tile.view(), own.tile_sums.view(), tiles(s), s.momentum.view(), rules},
                 kTilesInParallel);
}

/// `apgd` and `jacobi`. A method prepares a step, updates all contacts, and decides the next update. `parity`: which of
/// a block's two impulses is the latest.
struct GradientMethod {
  static void prepare(Cpu, State<Cpu>&, SolverStorage<Cpu>&, Index /*tile_count*/) {}

  template <bool turning>
  static void update(Cpu exec, State<Cpu>& s, SolverStorage<Cpu>& own, Index tile_count, Index parity) {
    for_each_index(exec, tile_count,
                   UpdateTile<turning>{.tiles = tiles(s),
                                       .block = own.block.view(),
                                       .velocity = s.extrapolated_velocity.view(),
                                       .momentum = s.momentum.view(),
                                       .wrench_a = own.wrench_a.view(),
                                       .wrench_b = own.wrench_b.view(),
                                       .sums = own.tile_sums.view(),
                                       .parity = parity},
                   kTilesInParallel);
  }

  static void decide_next(Cpu exec, State<Cpu>& s, SolverStorage<Cpu>& own, const IterationRules& rules) {
    decide(exec, s, own, rules);
  }
};

/// `gauss_seidel`
struct SweepMethod : GradientMethod {
  /// Colours the contacts. Each waits for those before it; see Colouring.
  static void prepare(Cpu exec, State<Cpu>& s, SolverStorage<Cpu>& own, Index /*tile_count*/) {
    const Index contacts = *contact_count(s).count;
    own.colour.resize(s.contact_capacity);
    Index* const begin = own.colour.view().begin();
    std::fill_n(begin, contacts, kNoColour);
    const Colouring all = colouring(s, own.colour.view());
    while (std::find(begin, begin + contacts, kNoColour) != begin + contacts)
      for_each_index(exec, contacts, [&](ContactIndex i) { all.try_colour(i); });
    own.colours = contacts > 0 ? 1 + *std::max_element(begin, begin + contacts) : 0;
  }

  template <bool turning>
  static void update(Cpu exec, State<Cpu>& s, SolverStorage<Cpu>& own, Index tile_count, Index parity) {
    const SweptBodies bodies{incidence(s), s.mass.view(), s.inverse_inertia_W.view(), s.extrapolated_velocity.view()};
    for (Index colour = 0; colour < std::max<Index>(1, own.colours); ++colour)
      for_each_index(exec, tile_count,
                     SweepTile<turning>{.tiles = tiles(s),
                                        .block = own.block.view(),
                                        .colour = own.colour.view(),
                                        .bodies = bodies,
                                        .momentum = s.momentum.view(),
                                        .sums = own.tile_sums.view(),
                                        .parity = parity,
                                        .present = colour},
                     kTilesInParallel);
    for_each_index(exec, tile_count,
                   ScatterSweep{tiles(s), own.block.view(), s.momentum.view(), own.wrench_a.view(), own.wrench_b.view(),
                                1 - parity},
                   kTilesInParallel);
  }
};

/// `bb`
struct SpectralMethod : GradientMethod {
  static void prepare(Cpu, State<Cpu>& s, SolverStorage<Cpu>& own, Index tile_count) {
    own.velocity_before.resize(s.body_count);
    own.spectral_sums.resize(tile_count);
    own.length.upload(std::vector<SpectralStep>(std::size_t(s.world_count)));
  }

  template <bool turning>
  static void update(Cpu exec, State<Cpu>& s, SolverStorage<Cpu>& own, Index tile_count, Index parity) {
    for_each_index(exec, tile_count,
                   SpectralTile<turning>{.tiles = tiles(s),
                                         .block = own.block.view(),
                                         .velocity = s.velocity.view(),
                                         .velocity_before = own.velocity_before.view(),
                                         .momentum = s.momentum.view(),
                                         .length = own.length.view(),
                                         .wrench_a = own.wrench_a.view(),
                                         .wrench_b = own.wrench_b.view(),
                                         .sums = own.tile_sums.view(),
                                         .spectral_sums = own.spectral_sums.view(),
                                         .parity = parity},
                   kTilesInParallel);
  }

  static void decide_next(Cpu exec, State<Cpu>& s, SolverStorage<Cpu>& own, const IterationRules& rules) {
    own.momentum_before.upload(s.momentum.download());
    decide(exec, s, own, rules);
    for_each_index(exec, s.world_count,
                   DecideNextLength{s.first_tile.view(), own.spectral_sums.view(), own.momentum_before.view(),
                                    s.momentum.view(), own.length.view(), rules},
                   kTilesInParallel);
  }
};

inline void measure(Cpu exec, State<Cpu>& s, SolverStorage<Cpu>& own, Index tile_count, const StepSettings& settings) {
  View<Impulse> impulse = s.store[s.parity].impulse.view();
  for_each_index(exec, tile_count, StoreTile{tiles(s), own.block.view(), s.momentum.view(), impulse, s.contact.view()},
                 kTilesInParallel);
  for_each_index(
      exec, tile_count,
      MeasureTile{tiles(s), s.contact.view(), s.velocity.view(), impulse, own.tile_measures.view(), settings.target},
      kTilesInParallel);
  for_each_index(exec, s.world_count,
                 MeasureWorld{.tiles = tiles(s),
                              .tile_measures = own.tile_measures.view(),
                              .mass = s.mass.view(),
                              .orientation = s.orientation.view(),
                              .velocity = s.velocity.view(),
                              .momentum = s.momentum.view(),
                              .sums = s.world_sums.view()},
                 kTilesInParallel);
}

template <class Method>
void iterate(Cpu exec, State<Cpu>& s, SolverStorage<Cpu>& own, const StepSettings& settings) {
  const IterationRules rules = settings.rules();
  const Index tile_count = tiles(s).count();
  for_each_counted(exec, contact_count(s), mass_splitting(s, settings));
  fill_blocks(exec, s, own, tile_count);
  for (WorldIndex w = 0; w < s.world_count; ++w) s.momentum.write(w, first_momentum(rules));
  Method::prepare(exec, s, own, tile_count);
  own.motor_before.upload(s.mechanisms.motor_impulse.download());
  begin_bodies(exec, s);
  gather(exec, s, own, true);
  for (Index k = 0; !all_done(s, s.momentum.view()); ++k) {
    GONOGO_ASSERT(k < std::int64_t(rules.substeps) * rules.max_iterations + rules.substeps);
    if (any_world(s, &Momentum::begins)) advance_tiles(exec, s, own, tile_count, k & 1, settings);
    s.turning ? Method::template update<true>(exec, s, own, tile_count, k & 1)
              : Method::template update<false>(exec, s, own, tile_count, k & 1);
    for_each_index(exec, s.mechanisms.motor.size(), motor_update(s, own.motor_before.view(), settings));
    gather(exec, s, own, false);
    if (any_world(s, &Momentum::ends)) carry_bodies(exec, s);
    Method::decide_next(exec, s, own, rules);
  }
  measure(exec, s, own, tile_count, settings);
}

inline void solve(Cpu exec, State<Cpu>& s, SolverStorage<Cpu>& own, const StepSettings& settings) {
  GONOGO_ASSERT(settings.step > 0 && settings.iterations >= 1 && settings.substeps >= 1 && settings.tolerance >= 0);
  GONOGO_ASSERT((s.parity == 0 || s.parity == 1) && s.store[s.parity].impulse.size() == s.contact_capacity);
  GONOGO_ASSERT(*contact_count(s).count >= 0 && *contact_count(s).count <= s.contact_capacity);
  GONOGO_ASSERT(s.velocity.size() == s.body_count && s.momentum.size() == s.world_count);
  if (is_penalty(settings.contact)) {
    reserve_penalty(s, own.penalty);
    return solve_by_penalty(exec, s, own.penalty, settings);
  }
  switch (settings.iteration) {
    case Iteration::apgd:
    case Iteration::jacobi:
      return iterate<GradientMethod>(exec, s, own, settings);
    case Iteration::gauss_seidel:
      return iterate<SweepMethod>(exec, s, own, settings);
    case Iteration::bb:
      return iterate<SpectralMethod>(exec, s, own, settings);
    case Iteration::jacobi_scan:
      reserve_scan(s, own.scan, settings);
      return solve_by_scan(exec, s, own.scan, settings);
  }
}

}  // namespace gonogo::sim
