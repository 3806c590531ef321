// UpdateContact for the host: the same formula on eight consecutive contacts at once. Same bits as one by one.
#pragma once
#include "sim/world/state.h"

namespace gonogo::sim {

#ifndef __CUDACC__
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

struct FillBlock {
  View<const Contact> contact;
  View<const Impulse> impulse;
  View<ContactBlock> block;

  void operator()(Index k) const {
    ContactBlock& out = block[k];
    const Impulse* old[kPackWidth];
    Pack field[16];
    for (int lane = 0; lane < kPackWidth; ++lane) {
      const Index i = std::min(k * kPackWidth + lane, contact.size - 1);
      const Contact& c = contact[i];
      Real number[16];
      std::memcpy(number, static_cast<const ContactNumbers<Real>*>(&c), sizeof number);
      for (int f = 0; f < 16; ++f) field[f][lane] = number[f];
      out.body_a[lane] = c.body_a;
      out.body_b[lane] = c.body_b;
      old[lane] = &impulse[i];
    }
    std::memcpy(static_cast<void*>(&out.numbers), field, sizeof field);
    load_fields(old, out.impulse);
    out.first_world = contact[k * kPackWidth].world;
    out.last_world = contact[std::min((k + 1) * kPackWidth, contact.size) - 1].world;
  }
};

struct UpdateBlock {
  View<ContactBlock> block;
  View<const Contact> contact;
  View<const Velocity> velocity;
  View<const Momentum> momentum;
  View<Impulse> extrapolated;
  View<Real> progress, residual_square;

  void operator()(Index k) const {
    ContactBlock& b = block[k];
    const Index first = k * kPackWidth, count = std::min<Index>(kPackWidth, contact.size - first);
    Pack beta{};
    PackMask active{};
    if (!read_momentum(b, first, beta, active)) return;
    const Velocity *of_a[kPackWidth], *of_b[kPackWidth];
    const Impulse* from[kPackWidth];
    for (int lane = 0; lane < kPackWidth; ++lane) {
      of_a[lane] = &velocity[b.body_a[lane]];
      of_b[lane] = &velocity[b.body_b[lane]];
      from[lane] = &extrapolated[first + std::min<Index>(lane, count - 1)];
    }
    VelocityT<Pack> velocity_a, velocity_b;
    ImpulseT<Pack> start;
    load_fields(of_a, velocity_a);
    load_fields(of_b, velocity_b);
    load_fields(from, start);
    const ContactUpdate<Pack> u = accelerated_update(b.numbers, velocity_a, velocity_b, b.impulse, start, beta);
    b.impulse = u.impulse;
    store(u, first, count, active);
  }

  /// Extrapolation factor per lane; false when all worlds of the block are done.
  bool read_momentum(const ContactBlock& b, Index first, Pack& beta, PackMask& active) const {
    if (b.first_world == b.last_world) {
      const Momentum& m = momentum[b.first_world];
      beta = constant<Pack>(m.beta);
      active = PackMask{} - 1;
      return m.phase != Phase::done;
    }
    bool any = false;
    for (int lane = 0; lane < kPackWidth; ++lane) {
      const Momentum& m = momentum[contact[std::min(first + lane, contact.size - 1)].world];
      beta[lane] = m.beta;
      active[lane] = m.phase != Phase::done ? -1 : 0;
      any = any || m.phase != Phase::done;
    }
    return any;
  }

  void store(const ContactUpdate<Pack>& u, Index first, Index count, const PackMask& active) const {
    const Vec3T<Pack>&linear = u.extrapolated.linear, &angular = u.extrapolated.angular;
    Pack row[kPackWidth] = {linear.x, linear.y, linear.z, Pack{}, angular.x, angular.y, angular.z, Pack{}};
    transpose(row);
    for (Index lane = 0; lane < count; ++lane) {
      if (!active[lane]) continue;
      *reinterpret_cast<PackInMemory*>(&extrapolated[first + lane]) = row[lane];
      progress[first + lane] = u.progress[lane];
      residual_square[first + lane] = u.residual_square[lane];
    }
  }
};
#endif

}  // namespace gonogo::sim
