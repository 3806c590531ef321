// Updates of the host's tiles by the methods that are not accelerated: Gauss-Seidel and spectral gradients.
#pragma once
#include "sim/solver/host_blocks.h"
#include "sim/solver/shared_stages.h"

namespace gonogo::sim {

inline ContactNumbers<Real> lane_of(const ContactNumbers<Pack>& numbers, Index lane) {
  constexpr int count = sizeof(ContactNumbers<Real>) / sizeof(Real);
  Real field[count];
  const auto* packed = reinterpret_cast<const Real*>(&numbers);
  for (int f = 0; f < count; ++f) field[f] = packed[f * kPackWidth + lane];
  ContactNumbers<Real> result;
  std::memcpy(static_cast<void*>(&result), field, sizeof field);
  return result;
}

inline Vec3 lane_of(const Vec3T<Pack>& v, Index lane) { return {v.x[lane], v.y[lane], v.z[lane]}; }

inline void set_lane(Vec3T<Pack>& v, Index lane, const Vec3& to) {
  v.x[lane] = to.x;
  v.y[lane] = to.y;
  v.z[lane] = to.z;
}

/// Updates the contacts of one colour in a tile, and their bodies at once.
template <bool turning>
struct SweepTile {
  Tiles tiles;
  View<ContactBlock> block;
  View<const Index> colour;  // [contact]
  SweptBodies bodies;
  View<const Momentum> momentum;
  View<UpdateSums> sums;  // [tile] over all colours
  Index parity, present;  // present: the colour

  void operator()(Index tile) const {
    const Momentum& m = momentum[tiles.tile[tile].world];
    if (m.done) return;
    GONOGO_ASSERT(parity == (m.updates & 1) && present >= 0);
    const ContactRange range = tiles.contacts(tile);
    if (present == 0) sums[tile] = {};
    for (ContactIndex i = range.begin; i < range.end; ++i)
      if (colour[i] == present) update(tile, i - range.begin, m);
  }

  void update(Index tile, Index in_tile, const Momentum& m) const {
    const Index lane = in_tile % kPackWidth;
    ContactBlock& block_of = block[tile * kBlocksPerTile + in_tile / kPackWidth];
    const BodyIndex body_a = block_of.body_a[lane], body_b = block_of.body_b[lane];
    const Velocity a = bodies.velocity[body_a], b = bodies.velocity[body_b];
    ContactNumbers<Real> c = lane_of(block_of.numbers, lane);
    if (m.renew_slip)
      block_of.numbers.bias[lane] = c.bias = block_of.gap_bias[lane] + opening_speed<turning, Real>(c, a, b);
    const Impulse now{lane_of(block_of.linear[parity], lane), 0, lane_of(block_of.angular[parity], lane), 0};
    const ContactUpdate<Real> u = accelerated_update<turning, Real>(c, a, b, now, now, Real(0));
    if (m.test) sums[tile].residual_square += residual_square<turning, Real>(c, u);
    set_lane(block_of.linear[1 - parity], lane, u.impulse.linear);
    set_lane(block_of.angular[1 - parity], lane, u.impulse.angular);
    const Impulse change{u.impulse.linear - now.linear, 0, u.impulse.angular - now.angular, 0};
    bodies.move(body_a, c.arm_a, change, 1);
    bodies.move(body_b, c.arm_b, change, -1);
  }
};

/// Writes the wrenches of the latest impulses.
struct ScatterSweep {
  Tiles tiles;
  View<const ContactBlock> block;
  View<const Momentum> momentum;
  View<Wrench> wrench_a, wrench_b;
  Index latest;

  void operator()(Index tile) const {
    if (!momentum[tiles.tile[tile].world].done) scatter_tile(tiles, block, tile, latest, wrench_a, wrench_b);
  }
};

/// One spectral update of all contacts of a tile.
template <bool turning>
struct SpectralTile {
  Tiles tiles;
  View<ContactBlock> block;
  View<const Velocity> velocity, velocity_before;
  View<const Momentum> momentum;
  View<const SpectralStep> length;  // [world]
  View<Wrench> wrench_a, wrench_b;
  View<UpdateSums> sums;
  View<SpectralSums> spectral_sums;  // [tile]
  Index parity;

  void operator()(Index tile) const {
    const WorldIndex w = tiles.tile[tile].world;
    const Momentum& m = momentum[w];
    if (m.done) return;
    const ContactRange range = tiles.contacts(tile);
    GONOGO_ASSERT(length[w].length >= 1 && length[w].length <= kMaxStep);
    const Pack step = constant<Pack>(Real(length[w].length));
    UpdateSums s;
    SpectralSums spectral;
    for (Index first = range.begin; first < range.end; first += kPackWidth) {
      ContactBlock& b = block[tile * kBlocksPerTile + (first - range.begin) / kPackWidth];
      const SpectralUpdate<Pack> u = update(b, step, m.renew_slip != 0);
      if (m.test) s.residual_square += sum_lanes(residual_square<turning>(b.numbers, u.update));
      b.set_impulse(1 - parity, u.update.impulse);
      scatter_wrenches(b, u.update.impulse, first, std::min(range.end - first, kPackWidth), wrench_a, wrench_b);
      spectral += SpectralSums{sum_lanes(u.sums.change_square), sum_lanes(u.sums.curvature), sum_lanes(u.sums.rise)};
    }
    sums[tile] = s;
    spectral_sums[tile] = spectral;
  }

  SpectralUpdate<Pack> update(ContactBlock& b, const Pack& step, bool renew_slip) const {
    const VelocityT<Pack> a = load_velocities(velocity, b.body_a), c = load_velocities(velocity, b.body_b);
    const VelocityT<Pack> a0 = load_velocities(velocity_before, b.body_a);
    const VelocityT<Pack> c0 = load_velocities(velocity_before, b.body_b);
    if (renew_slip) b.numbers.bias = b.gap_bias + opening_speed<turning>(b.numbers, a, c);
    return spectral_update<turning, Pack>(b.numbers, a, c, a0, c0, b.impulse(parity), b.impulse(1 - parity), step);
  }
};

/// Decides the length of a world's next step from the sums of its tiles. Call after DecideNextUpdate.
struct DecideNextLength {
  View<const Index> first_tile;
  View<const SpectralSums> sums;
  View<const Momentum> before, next;
  View<SpectralStep> length;
  IterationRules rules;

  void operator()(WorldIndex w) const {
    if (before[w].done) return;
    SpectralSums total;
    for (Index t = first_tile[w]; t < first_tile[w + 1]; ++t) total += sums[t];
    decide_next_length(length[w], total, before[w], next[w], rules);
  }
};

}  // namespace gonogo::sim
