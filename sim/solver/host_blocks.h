// Blocks: the host updates eight contacts at once, stored field by field. Each tile starts a new block.
#pragma once
#include "sim/solver/jacobi_scan.h"
#include "sim/solver/penalty_method.h"
#include "sim/solver/solve.h"
#include "sim/solver/spectral.h"
#include "sim/solver/split.h"
#include "sim/state/contact_lists.h"

namespace gonogo::sim {

inline constexpr Index kBlocksPerTile = kTileSize / kPackWidth;

/// Eight consecutive contacts of one tile. Lanes past the tile's end have zero normal, friction and impulse; their
/// impulse stays zero and adds nothing to any sum.
struct ContactBlock {
  ContactNumbers<Pack> numbers;
  Vec3T<Pack> linear[2], angular[2];  // impulses of the latest two updates, alternating
  BodyIndex body_a[kPackWidth], body_b[kPackWidth];
  Index slot_b[kPackWidth];  // of the wrench on body b; without one, behind all bodies' slots, that of the tile
  Pack gap_bias, gap, gap_rate;

  ImpulseT<Pack> impulse(Index which) const { return {.linear = linear[which], .angular = angular[which]}; }
  void set_impulse(Index which, const ImpulseT<Pack>& p) {
    linear[which] = p.linear;
    angular[which] = p.angular;
  }
};

template <>
struct SolverStorage<Cpu> {
  Buffer<ContactBlock, Cpu> block;          // [tile * kBlocksPerTile]
  Buffer<Wrench, Cpu> wrench_a, wrench_b;   // [contact] on body a; [slot] on body b
  Buffer<UpdateSums, Cpu> tile_sums;        // [tile]
  Buffer<WorldSums, Cpu> tile_measures;     // [tile]
  Buffer<Real, Cpu> motor_before;           // [motor] impulses of the update before [N m s]
  Buffer<Index, Cpu> colour;                // [contact] for Gauss-Seidel
  Index colours = 0;                        // number of colours
  Buffer<Velocity, Cpu> velocity_before;    // [body] of the update before, for spectral gradients
  Buffer<SpectralStep, Cpu> length;         // [world]
  Buffer<Momentum, Cpu> momentum_before;    // [world]
  Buffer<SpectralSums, Cpu> spectral_sums;  // [tile]
  ScanStorage<Cpu> scan;
  PenaltyStorage<Cpu> penalty;
};

/// Loads eight records of eight numbers as one pack per number.
template <class Record, class Fields>
inline void load_fields(const Record* const (&record)[kPackWidth], Fields& fields) {
  static_assert(sizeof(Record) == sizeof(Pack) && sizeof(Fields) == kPackWidth * sizeof(Pack));
  Pack m[kPackWidth];
  for (int lane = 0; lane < kPackWidth; ++lane) m[lane] = *reinterpret_cast<const PackInMemory*>(record[lane]);
  transpose(m);
  auto* field = reinterpret_cast<PackInMemory*>(&fields);
  for (int f = 0; f < kPackWidth; ++f) field[f] = m[f];
}

inline VelocityT<Pack> load_velocities(View<const Velocity> velocity, const BodyIndex (&body)[kPackWidth]) {
  static_assert(sizeof(Velocity) == sizeof(Pack));
  Pack m[kPackWidth];
  for (int lane = 0; lane < kPackWidth; ++lane) {
    BodyIndex b = body[lane];
    asm("" : "+r"(b));  // eight addresses in vectors would have to be taken out again one by one
    m[lane] = *reinterpret_cast<const PackInMemory*>(&velocity[b]);
  }
  transpose(m);
  return {{m[0], m[1], m[2]}, m[3], {m[4], m[5], m[6]}, m[7]};
}

/// Fills the blocks of one tile from its contacts and their warm start.
struct FillTile {
  Tiles tiles;
  View<const Contact> contact;
  View<const Impulse> impulse;
  View<const Index> slot;
  View<ContactBlock> block;

  static constexpr int kNumbers = sizeof(ContactNumbers<Real>) / sizeof(Real);

  void operator()(Index tile) const {
    const ContactRange range = tiles.contacts(tile);
    for (Index first = range.begin; first < range.end; first += kPackWidth)
      fill(block[tile * kBlocksPerTile + (first - range.begin) / kPackWidth], first, range.end, slot.size + tile);
  }

  void fill(ContactBlock& out, ContactIndex first, ContactIndex end, Index unused) const {
    GONOGO_ASSERT(first < end && end <= contact.size);
    Pack field[kNumbers];
    for (int lane = 0; lane < kPackWidth; ++lane) {
      const ContactIndex i = first + lane < end ? first + lane : end - 1;
      Real number[kNumbers];
      std::memcpy(number, static_cast<const ContactNumbers<Real>*>(&contact[i]), sizeof number);
      for (int f = 0; f < kNumbers; ++f) field[f][lane] = number[f];
      out.gap_bias[lane] = contact[i].gap_bias;
      out.gap[lane] = contact[i].gap;
      out.gap_rate[lane] = contact[i].gap_rate;
      out.body_a[lane] = contact[i].body_a;
      out.body_b[lane] = contact[i].body_b;
      out.slot_b[lane] = slot[i] >= 0 ? slot[i] : unused;
    }
    std::memcpy(static_cast<void*>(&out.numbers), field, sizeof field);
    fill_impulses(out, first, end);
    for (int lane = end - first; lane < kPackWidth; ++lane) empty_lane(out, lane, unused);
  }

  void fill_impulses(ContactBlock& out, ContactIndex first, ContactIndex end) const {
    const Impulse* start[kPackWidth];
    for (int lane = 0; lane < kPackWidth; ++lane) start[lane] = &impulse[first + lane < end ? first + lane : end - 1];
    ImpulseT<Pack> p;
    load_fields(start, p);
    for (const Index which : {0, 1}) out.set_impulse(which, p);
  }

  void empty_lane(ContactBlock& out, int lane, Index unused) const {
    auto* field = reinterpret_cast<Real*>(&out.numbers);
    for (int f = 0; f < kNumbers; ++f) field[f * kPackWidth + lane] = 0;
    out.numbers.step.n[lane] = out.numbers.step.t[lane] = out.numbers.step.r[lane] = 1;
    for (Vec3T<Pack>& p :
         {std::ref(out.linear[0]), std::ref(out.linear[1]), std::ref(out.angular[0]), std::ref(out.angular[1])})
      p.x[lane] = p.y[lane] = p.z[lane] = 0;
    out.slot_b[lane] = unused;
  }
};

inline void store_wrenches(const Vec3T<Pack>& linear, const Vec3T<Pack>& angular, Pack (&row)[kPackWidth]) {
  const Pack zero{};
  const Pack field[kPackWidth] = {linear.x, linear.y, linear.z, zero, angular.x, angular.y, angular.z, zero};
  for (int f = 0; f < kPackWidth; ++f) row[f] = field[f];
  transpose(row);
}

/// Writes the wrenches of a block's impulses, which the bodies then sum.
inline void scatter_wrenches(const ContactBlock& b, const ImpulseT<Pack>& p, ContactIndex first, Index count,
                             View<Wrench> wrench_a, View<Wrench> wrench_b) {
  GONOGO_ASSERT(count > 0 && count <= kPackWidth && wrench_b.size > wrench_a.size);
  Pack row[kPackWidth];
  store_wrenches(p.linear, cross(b.numbers.arm_a, p.linear) + p.angular, row);
  for (Index lane = 0; lane < count; ++lane) *reinterpret_cast<PackInMemory*>(&wrench_a[first + lane]) = row[lane];
  store_wrenches(-p.linear, -(cross(b.numbers.arm_b, p.linear) + p.angular), row);
  for (Index lane = 0; lane < count; ++lane) *reinterpret_cast<PackInMemory*>(&wrench_b[b.slot_b[lane]]) = row[lane];
}

/// The same for the blocks of a tile.
inline void scatter_tile(const Tiles& tiles, View<const ContactBlock> block, Index tile, Index parity,
                         View<Wrench> wrench_a, View<Wrench> wrench_b) {
  const ContactRange range = tiles.contacts(tile);
  for (Index first = range.begin; first < range.end; first += kPackWidth) {
    const ContactBlock& b = block[tile * kBlocksPerTile + (first - range.begin) / kPackWidth];
    scatter_wrenches(b, b.impulse(parity), first, std::min(range.end - first, kPackWidth), wrench_a, wrench_b);
  }
}

/// Writes the wrenches of the warm start.
struct ScatterTile {
  Tiles tiles;
  View<const ContactBlock> block;
  View<Wrench> wrench_a, wrench_b;

  void operator()(Index tile) const { scatter_tile(tiles, block, tile, 0, wrench_a, wrench_b); }
};

inline Real sum_lanes(const Pack& p) { return ((p[0] + p[1]) + (p[2] + p[3])) + ((p[4] + p[5]) + (p[6] + p[7])); }

/// One update of all contacts of a tile; `turning` as in projected_step.
template <bool turning>
struct UpdateTile {
  Tiles tiles;
  View<ContactBlock> block;
  View<const Velocity> velocity;  // extrapolated
  View<const Momentum> momentum;  // [world]
  View<Wrench> wrench_a, wrench_b;
  View<UpdateSums> sums;  // [tile]
  Index parity;           // which of a block's impulses is the latest

  void operator()(Index tile) const {
    if (momentum[tiles.tile[tile].world].done) return;
    UpdateSums s;
    update_blocks(tile, [&](Index, const Pack& uphill, const Pack& residual) {
      s.uphill += sum_lanes(uphill);
      s.residual_square += sum_lanes(residual);
    });
    sums[tile] = s;
  }

  /// Calls add(first contact, uphill, residual square) for each block of a tile; the residual is 0 where none is
  /// tested.
  template <class Add>
  GONOGO_HD_INLINED void update_blocks(Index tile, Add&& add) const {
    const Momentum& m = momentum[tiles.tile[tile].world];
    GONOGO_ASSERT(parity == (m.updates & 1));
    const ContactRange range = tiles.contacts(tile);
    const Pack beta = constant<Pack>(m.beta);
    for (Index first = range.begin; first < range.end; first += kPackWidth) {
      ContactBlock& b = block[tile * kBlocksPerTile + (first - range.begin) / kPackWidth];
      const ContactUpdate<Pack> u = update(b, beta, m.renew_slip != 0);
      Pack residual{};
      if (m.test) residual = residual_square<turning>(b.numbers, u);
      b.set_impulse(1 - parity, u.impulse);
      scatter_wrenches(b, u.impulse, first, std::min(range.end - first, kPackWidth), wrench_a, wrench_b);
      add(first, u.uphill, residual);
    }
  }

  GONOGO_HD_INLINED ContactUpdate<Pack> update(ContactBlock& b, const Pack& beta, bool renew_slip) const {
    const VelocityT<Pack> a = load_velocities(velocity, b.body_a), c = load_velocities(velocity, b.body_b);
    if (renew_slip) b.numbers.bias = b.gap_bias + opening_speed<turning>(b.numbers, a, c);
    return accelerated_update<turning>(b.numbers, a, c, b.impulse(parity), b.impulse(1 - parity), beta);
  }
};

/// Moves the gaps of a tile on, if its world begins another substep.
struct AdvanceTile {
  Tiles tiles;
  View<ContactBlock> block;
  View<const Velocity> substep_velocity;
  View<const Momentum> momentum;
  StepSettings settings;
  Index parity;  // which of a block's impulses is the latest

  void operator()(Index tile) const {
    const Momentum& m = momentum[tiles.tile[tile].world];
    if (!m.begins) return;
    GONOGO_ASSERT(!m.done && parity == (m.updates & 1));
    const ContactRange range = tiles.contacts(tile);
    for (Index first = range.begin; first < range.end; first += kPackWidth)
      advance(block[tile * kBlocksPerTile + (first - range.begin) / kPackWidth]);
  }

  void advance(ContactBlock& b) const {
    const VelocityT<Pack> of_a = load_velocities(substep_velocity, b.body_a);
    const VelocityT<Pack> of_b = load_velocities(substep_velocity, b.body_b);
    const ContactNumbers<Pack>& c = b.numbers;
    const Pack gap = advanced_gap(b.gap, c, of_a, of_b, settings.substep());
    b.gap = counted_gap(gap, b.gap_rate, c.softness * dot(b.linear[parity], c.normal), settings);
    b.numbers.bias = b.gap_bias = bias_of_gap(b.gap, b.gap_rate, c.softness, settings);
  }
};

/// Stores impulses and gaps at the end of the step.
struct StoreTile {
  Tiles tiles;
  View<const ContactBlock> block;
  View<const Momentum> momentum;
  View<Impulse> impulse;
  View<Contact> contact;

  void operator()(Index tile) const {
    const ContactRange range = tiles.contacts(tile);
    const Index latest = momentum[tiles.tile[tile].world].updates & 1;
    for (Index first = range.begin; first < range.end; first += kPackWidth) {
      const ContactBlock& b = block[tile * kBlocksPerTile + (first - range.begin) / kPackWidth];
      const Index count = std::min(range.end - first, kPackWidth);
      Pack row[kPackWidth];
      store_wrenches(b.linear[latest], b.angular[latest], row);
      for (Index lane = 0; lane < count; ++lane) {
        *reinterpret_cast<PackInMemory*>(&impulse[first + lane]) = row[lane];
        contact[first + lane].gap = b.gap[lane];
        contact[first + lane].gap_bias = b.gap_bias[lane];
      }
    }
  }
};

/// Bytes of one update of a contact if each record is moved once: its lane of a block read, one of the block's two
/// impulses written, and both wrenches written and then read by the bodies' sums.
constexpr double host_bytes_per_contact() {
  return double(sizeof(ContactBlock) + sizeof(ImpulseT<Pack>)) / kPackWidth + 4 * sizeof(Wrench);
}
/// Bytes of one update of a body: mass, ranges of its contacts and five velocities. Read: free and present; written:
/// present and extrapolated; the contacts read the extrapolated one again.
constexpr double host_bytes_per_body() { return sizeof(BodyMass) + 4 * sizeof(Index) + 5 * sizeof(Velocity); }

}  // namespace gonogo::sim
