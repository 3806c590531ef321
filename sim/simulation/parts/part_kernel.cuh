// The iteration of a part on a GPU: the kernel of launch.cuh on each of several GPUs at once. They write into each
// other's memory, and a barrier across all of them stands where solve_part_host.h exchanges letters:
//
//     update     contacts of the part                          -> sums of tiles; those of partial tiles to all GPUs
//   ================================================ grid barrier ==========================================
//     move       own bodies; wrenches on shared bodies and sums of whole tiles to all GPUs
//   ================================================ grid barrier ==========================================
//     push       velocities of border bodies to the GPUs that hold copies of them
//   ============================================ barrier of all GPUs =======================================
//     receive    velocities of halo bodies; shared bodies and mechanisms from the wrenches of all parts
//     decide     from the sums of all tiles, on each GPU alike
//   ================================================ grid barrier ==========================================
//
// What is received alternates between two places, so that no GPU overwrites what another still reads.
#pragma once
#include "sim/simulation/parts/part_lists.h"
#include "sim/solver/cuda/kernel.cuh"

namespace gonogo::sim {

/// Memory of one GPU into which the others write; [2]: of even and odd updates.
struct PartMail {
  Velocity* halo[2] = {nullptr, nullptr};                         // in the order of `received`
  Wrench* wrench[2] = {nullptr, nullptr};                         // on shared bodies, in the world's order
  UpdateSums* tile[2] = {nullptr, nullptr};                       // [tile of the world]
  UpdateSums* partial[2] = {nullptr, nullptr};                    // [partial tile * kTileSize] of each contact
  WorldSums *tile_measure = nullptr, *partial_measure = nullptr;  // the same of the step's residuals
  WorldSums* body_measure = nullptr;                              // [body tile of the world]
  Index* weight = nullptr;                                        // of halo bodies, in the order of `received`
  std::uint8_t* wanted = nullptr;         // in the order of `sent`: a contact of the other part needs the body
  unsigned long long* arrived = nullptr;  // [rank] barriers at which it has been; own: of earlier steps
};

/// A wrench that the part gives: the half contact that it comes from, and its place among those of all parts.
struct alignas(8) PartRecord {
  Index half, to;
};

/// Which kernel stage moves a body.
enum class MovedBy : std::uint8_t { own, owner, all };  // this part alone; the part that owns it; all parts alike

struct PartViews {
  PartMail mail[kMaxGpus];  // [rank], its own included
  Index rank, count;
  View<const MovedBy> moved_by;                                // [body]
  View<const BodyIndex> sent, received;                        // in the order of the ranks
  Index sent_begin[kMaxGpus + 1], inbox_begin[kMaxGpus];       // [rank] into `sent`; into the halo of that rank
  Index received_begin[kMaxGpus + 1], outbox_begin[kMaxGpus];  // [rank] into `received`; into `sent` of that rank
  View<Index> weight;                                          // [body] sum over its contacts
  View<std::uint8_t> used;                                     // [body] a contact here has it
  View<const BodyIndex> shared;
  View<const HalfRange> shared_wrenches;  // [shared]
  View<const PartRecord> record;
  PartTiles tiles;
  Index whole, tail;  // own whole tiles; contacts behind them
  Index first_tile;   // of the own whole ones, in the world
  Index world_tiles, world_contacts;
  Index partial_count, partial_tile[kMaxGpus], partial_contacts[kMaxGpus];  // tiles of the world in several parts
  Index head_place, tail_place;                                             // into PartMail::partial
  BodyIndex own_begin, own_end;
  Index first_body_tile, world_body_tiles;

  GONOGO_DEVICE const PartMail& own_mail() const { return mail[rank]; }
};

/// All blocks of all GPUs wait for each other and then see what the others wrote before.
class WorldBarrier {
 public:
  GONOGO_DEVICE explicit WorldBarrier(const PartViews& part)
      : part_(part), passed_(part.own_mail().arrived[part.rank]) {}

  GONOGO_DEVICE void wait(GridBarrier& grid) {
    __threadfence_system();
    grid.wait();
    ++passed_;
    const Index other = threadIdx.x;
    if (other < part_.count && other != part_.rank) {
      if (blockIdx.x == 0)
        asm volatile("st.release.sys.global.u64 [%0], %1;" ::"l"(part_.mail[other].arrived + part_.rank), "l"(passed_)
                     : "memory");
      unsigned long long now;
      do
        asm volatile("ld.acquire.sys.global.u64 %0, [%1];"
                     : "=l"(now)
                     : "l"(part_.own_mail().arrived + other)
                     : "memory");
      while (now < passed_);
    }
    __syncthreads();
  }

  /// For the next step. Call when all blocks have read their first count.
  GONOGO_DEVICE void remember() const {
    if (blockIdx.x == 0 && threadIdx.x == 0) part_.own_mail().arrived[part_.rank] = passed_;
  }

 private:
  const PartViews& part_;
  unsigned long long passed_;
};

template <bool turning, bool in_substeps>
class PartKernel : public SolveKernel<turning, false, in_substeps, Iteration::apgd> {
  using Base = SolveKernel<turning, false, in_substeps, Iteration::apgd>;
  using Base::contact_;
  using Base::first_index;
  using Base::s;
  using Base::stride;
  using Base::team_;
  using Base::work_;

 public:
  GONOGO_DEVICE PartKernel(const SolveViews& views, const PartViews& part, const Team& team, MechanismWork& work)
      : Base(views, team, work), part_(part) {}

  GONOGO_DEVICE void push_weights() {
    for (Index r = 0; r < part_.count; ++r)
      for (Index n = part_.sent_begin[r] + first_index(); n < part_.sent_begin[r + 1]; n += stride())
        part_.mail[r].weight[inbox_place(r, n)] = part_.weight[part_.sent[n]];
  }

  GONOGO_DEVICE void receive_weights() {
    for (Index n = first_index(); n < part_.received.size; n += stride())
      part_.weight[part_.received[n]] = part_.own_mail().weight[n];
  }

  GONOGO_DEVICE void prepare() {
    for (Index i = first_index(); i < *s.contact_total; i += stride()) {
      this->begin_contact(i);
      const PairRecord bodies = contact_.pair(i);
      for (const BodyIndex b : {bodies.a, bodies.b})
        if (b < part_.own_begin || b >= part_.own_end) part_.used[b] = 1;
    }
    for (Index b = first_index(); b < s.mass.size; b += stride()) {
      if (part_.moved_by[b] == MovedBy::own) this->prepare_body(b);
      if (part_.moved_by[b] == MovedBy::owner) s.of_body[b] = HalfRange{0, 0};
    }
    for (Index k = first_index(); k < part_.shared.size; k += stride())
      s.of_body[part_.shared[k]] = part_.shared_wrenches[k];
    if (first_index() == 0) store_words(s.momentum[0][0], first_momentum(s.rules));
    for (Index m = first_index(); m < s.motor.size; m += stride()) s.motor_before[m] = s.motor_impulse[m];
  }

  GONOGO_DEVICE void update_contacts(Index k) {
    const Index head = part_.tiles.head > 0 ? part_.tiles.first_own() : -1;
    const Index tail = part_.tail > 0 ? part_.tiles.first_whole() + part_.whole : -1;
    for (Index tile = team_.index; tile < s.tiles.count(); tile += team_.count) {
      if (tile == head)
        update_partial(s.tiles.tile[tile], part_.head_place, k);
      else if (tile == tail)
        update_partial(s.tiles.tile[tile], part_.tail_place, k);
      else
        this->update_tile(s.tiles.tile[tile], tile, k);
    }
  }

  /// What all GPUs sum. Call when all blocks have updated.
  GONOGO_DEVICE void push_sums(Index k) {
    for (Index n = first_index(); n < part_.record.size; n += stride()) {
      Wrench w;
      this->add_contact(s.half[part_.record[n].half], (k + 1) & 1, w.linear, w.angular);
      for (Index r = 0; r < part_.count; ++r) part_.mail[r].wrench[(k + 1) & 1][part_.record[n].to] = w;
    }
    if (k < 0) return push_wants();
    for (Index t = first_index(); t < part_.whole; t += stride())
      for (Index r = 0; r < part_.count; ++r)
        part_.mail[r].tile[k & 1][part_.first_tile + t] = s.tile_sums[part_.tiles.first_whole() + t];
  }

  /// Velocities of border bodies before they are carried into the next substep. Call when all blocks have moved bodies.
  GONOGO_DEVICE void push_velocities(Index k) {
    const bool ends = is_ending(k), all = k < 0 || ends;
    push_halo((k + 1) & 1, all, ends ? s.substep_velocity : s.velocity);
  }

  /// Moves copies of bodies. Call when all GPUs have pushed. Bodies that no contact needs are moved where a substep
  /// begins or ends.
  GONOGO_DEVICE void receive(Index k) {
    const Momentum m = s.momentum[k < 0 ? 0 : k & 1][0];
    const bool all = k < 0 || is_ending(k);
    for (Index n = first_index(); n < part_.received.size; n += stride())
      if (const BodyIndex b = part_.received[n]; all || part_.used[b] != 0)
        set_copy(b, part_.own_mail().halo[(k + 1) & 1][n], m, k);
    for (Index h = first_index() / 32; h < part_.shared.size; h += stride() / 32)
      if (s.mass[part_.shared[h]].slot < 0) move_shared(part_.shared[h], m, k);
    move_mechanisms(k);
  }

  GONOGO_DEVICE void decide(Index k) {
    if (team_.index != team_.count - 1 - s.projection.mechanism.size % team_.count) return;
    Momentum m = s.momentum[k & 1][0];
    UpdateSums* const tile = part_.own_mail().tile[k & 1];
    for (Index p = 0; p < part_.partial_count; ++p) {
      UpdateSums sums;
      if (team_.rank < part_.partial_contacts[p]) sums = part_.own_mail().partial[k & 1][p * kTileSize + team_.rank];
      sums.uphill = team_.sum(sums.uphill);
      if (m.test) sums.residual_square = team_.sum(sums.residual_square);
      if (team_.rank == 0) tile[part_.partial_tile[p]] = sums;
      team_.sync();
    }
    UpdateSums sums;
#pragma unroll 8  // loads in flight: all other teams wait for this one
    for (Index t = team_.rank; t < part_.world_tiles; t += kTileSize) sums.uphill += tile[t].uphill;
    if (m.test) {
#pragma unroll 8
      for (Index t = team_.rank; t < part_.world_tiles; t += kTileSize) sums.residual_square += tile[t].residual_square;
    }
    sums.uphill = team_.sum(sums.uphill);
    if (m.test) sums.residual_square = team_.sum(sums.residual_square);
    if (team_.rank != 0) return;
    decide_next_update(m, sums, part_.world_contacts, s.rules);
    if (m.done) atomicAdd(s.barrier, GridBarrier::kWorldDone);
    store_words(s.momentum[(k + 1) & 1][0], m);
  }

  GONOGO_DEVICE void measure(Index k) {
    Measures<turning> measures(s, team_);
    for (Index tile = team_.index; tile < s.tiles.count(); tile += team_.count) measures.measure_tile(tile, k);
    const ContactRange own = part_.tiles.own;
    for (Index n = first_index(); n < part_.tiles.head; n += stride())
      measure_partial(own.begin + n, part_.head_place + n, k);
    for (Index n = first_index(); n < part_.tail; n += stride())
      measure_partial(own.end - part_.tail + n, part_.tail_place + n, k);
    for (Index t = team_.index; t * kTileSize < part_.own_end - part_.own_begin; t += team_.count) measure_bodies(t);
  }

  /// Velocities at the step's end, after `k` updates.
  GONOGO_DEVICE void push_last_velocities(Index k) { push_halo((k + 1) & 1, true, s.velocity); }
  GONOGO_DEVICE void receive_last_velocities(Index k) {
    for (Index n = first_index(); n < part_.received.size; n += stride())
      s.velocity[part_.received[n]] = part_.own_mail().halo[(k + 1) & 1][n];
  }

  GONOGO_DEVICE void push_measures() {
    for (Index t = first_index(); t < part_.whole; t += stride())
      for (Index r = 0; r < part_.count; ++r)
        part_.mail[r].tile_measure[part_.first_tile + t] = s.tile_measures[part_.tiles.first_whole() + t];
  }

  GONOGO_DEVICE void add_measures(Index k) {
    if (team_.index != 0) return;
    const PartMail& mail = part_.own_mail();
    for (Index p = 0; p < part_.partial_count; ++p) {
      WorldSums sums;
      if (team_.rank < part_.partial_contacts[p]) sums = mail.partial_measure[p * kTileSize + team_.rank];
      sums = team_.sum(sums);
      if (team_.rank == 0) mail.tile_measure[part_.partial_tile[p]] = sums;
      team_.sync();
    }
    WorldSums sum;
#pragma unroll 4
    for (Index t = team_.rank; t < part_.world_tiles; t += kTileSize) sum += mail.tile_measure[t];
#pragma unroll 4
    for (Index t = team_.rank; t < part_.world_body_tiles; t += kTileSize) sum += mail.body_measure[t];
    sum = team_.sum(sum);
    sum.contact_count = part_.world_contacts;
    sum.iterations = s.momentum[k & 1][0].updates;
    if (team_.rank == 0) s.world_sums[0] = sum;
  }

 private:
  /// Place in the halo of rank `r` of the n-th sent body.
  GONOGO_DEVICE Index inbox_place(Index r, Index n) const { return part_.inbox_begin[r] + n - part_.sent_begin[r]; }

  GONOGO_DEVICE void push_halo(Index parity, bool all, View<const Velocity> velocity) {
    for (Index r = 0; r < part_.count; ++r)
      for (Index n = part_.sent_begin[r] + first_index(); n < part_.sent_begin[r + 1]; n += stride())
        if (all || part_.own_mail().wanted[n] != 0)
          part_.mail[r].halo[parity][inbox_place(r, n)] = velocity[part_.sent[n]];
  }

  /// Tells the owners of halo bodies which of them contacts need.
  GONOGO_DEVICE void push_wants() {
    for (Index r = 0; r < part_.count; ++r)
      for (Index n = part_.received_begin[r] + first_index(); n < part_.received_begin[r + 1]; n += stride())
        part_.mail[r].wanted[part_.outbox_begin[r] + n - part_.received_begin[r]] = part_.used[part_.received[n]];
  }

  GONOGO_DEVICE bool is_ending(Index k) const { return in_substeps && k >= 0 && s.momentum[k & 1][0].ends; }

  /// As update_tile(), with the sums of each contact for all GPUs.
  GONOGO_DEVICE void update_partial(const Tile& t, Index place, Index k) {
    const Momentum m = s.momentum[k & 1][0];
    const ContactIndex i = t.contacts.begin + team_.rank;
    if (i >= t.contacts.end) return;
    const PairRecord bodies = contact_.pair(i);
    const Real gap_bias = in_substeps && m.begins ? this->advance_contact(i, bodies, m, k & 1) : Real(0);
    const Velocity a = s.extrapolated_velocity[bodies.a], b = s.extrapolated_velocity[bodies.b];
    const UpdateSums sums = this->update_contact(i, a, b, gap_bias, m, k & 1);
    for (Index r = 0; r < part_.count; ++r) part_.mail[r].partial[k & 1][place + team_.rank] = sums;
  }

  /// As set_velocity(), for a velocity that the body's owner has found.
  GONOGO_DEVICE void set_copy(BodyIndex b, const Velocity& next, const Momentum& m, Index k) {
    Velocity free = k < 0 ? begin_body(s, b) : s.free_velocity[b];
    const Velocity before = s.velocity[b];
    Velocity now = next, ahead = k < 0 ? now : extrapolated<Real>(now, before, m.next_beta);
    if (is_ending(k)) {
      const Velocity more = carry_body(s, b, now, free);
      now = sum(now, more);
      ahead = sum(ahead, more);
    }
    s.velocity[b] = now;
    s.extrapolated_velocity[b] = ahead;
  }

  /// Every `step`-th wrench on a shared body.
  GONOGO_DEVICE void add_wrenches(const HalfRange& c, Index from, Index step, Index k, Vec3& linear,
                                  Vec3& angular) const {
    const Wrench* const wrench = part_.own_mail().wrench[(k + 1) & 1];
    for (Index i = c.begin + from; i < c.end; i += step) {
      linear += wrench[i].linear;
      angular += wrench[i].angular;
    }
  }

  /// A body without joints, by one warp, in the order of move_body() or move_hub().
  GONOGO_DEVICE void move_shared(BodyIndex b, const Momentum& m, Index k) {
    const HalfRange c = s.of_body[b];
    const Index lane = team_.rank % 32;
    const bool many = c.end - c.begin > kHubContacts;
    if (!many && lane >= kLanesPerBody) return;
    Vec3 linear, angular;
    add_wrenches(c, lane, many ? 32 : kLanesPerBody, k, linear, angular);
    linear = many ? sum_of_lanes<32>(linear) : sum_of_lanes<kLanesPerBody>(linear);
    angular = many ? sum_of_lanes<32>(angular) : sum_of_lanes<kLanesPerBody>(angular);
    if (lane != 0) return;
    Velocity free = s.free_velocity[b], now = s.velocity[b];
    this->set_velocity(b, s.mass[b], linear, angular, m, k, free, now);
  }

  GONOGO_DEVICE void move_mechanisms(Index k) {
    const auto add = [&](const HalfRange& c, Index from, Index step, Vec3& linear, Vec3& angular) {
      add_wrenches(c, from, step, k, linear, angular);
    };
    MechanismMover mover(s, team_, work_, add);
    const bool several = s.projection.mechanism.size > team_.count;
    for (Index m = team_.count - 1 - team_.index; m < s.projection.mechanism.size; m += team_.count) {
      if (k < 0 || several) mover.load(m, nullptr);
      mover.template move<in_substeps>(k, nullptr);
    }
  }

  GONOGO_DEVICE void measure_partial(ContactIndex i, Index place, Index k) {
    const Impulse p = contact_.load_impulse(s.momentum[k & 1][0].updates & 1, i);
    const Contact c = s.contact[i];
    const double r = contact_residual(c, s.velocity[c.body_a], s.velocity[c.body_b], p, s.rules.target);
    WorldSums sums;
    sums.residual_square = r * r;
    sums.residual_max = r;
    for (Index to = 0; to < part_.count; ++to) part_.mail[to].partial_measure[place] = sums;
  }

  GONOGO_DEVICE void measure_bodies(Index tile) {
    const BodyIndex b = part_.own_begin + tile * kTileSize + team_.rank;
    WorldSums sums;
    if (b < part_.own_end) sums = energy_of_body(s.mass[b], s.orientation[b], s.velocity[b], s.tiles.world[0].gravity);
    sums = team_.sum(sums);
    if (team_.rank != 0) return;
    for (Index r = 0; r < part_.count; ++r) part_.mail[r].body_measure[part_.first_body_tile + tile] = sums;
  }

  const PartViews& part_;
};

/// All iterations of a step of a part; as iterate() in launch.cuh.
template <bool turning, bool in_substeps>
__global__ void __launch_bounds__(kBlockSize)
    solve_part_kernel(const __grid_constant__ SolveViews views, const __grid_constant__ PartViews part) {
  __shared__ double scratch[kTeamsPerBlock][kTileSize / 32];
  __shared__ __align__(16) std::uint8_t work_bytes[kTeamsPerBlock][sizeof(MechanismWork)];
  const Index in_block = threadIdx.x / kTileSize;
  const Team team{in_block, Index(threadIdx.x % kTileSize), Index(in_block * gridDim.x + blockIdx.x),
                  Index(kTeamsPerBlock * gridDim.x), scratch[in_block]};
  MechanismWork& work = *reinterpret_cast<MechanismWork*>(work_bytes[in_block]);
  GridBarrier grid(views.barrier);
  WorldBarrier all(part);
  PartKernel<turning, in_substeps> kernel(views, part, team, work);
  const auto move = [&](Index k) {
    kernel.move_bodies(k);
    kernel.push_sums(k);
    grid.wait();
    kernel.push_velocities(k);
    all.wait(grid);
    kernel.receive(k);
  };
  kernel.push_weights();
  all.wait(grid);
  kernel.receive_weights();
  grid.wait();
  kernel.prepare();
  grid.wait();
  move(-1);
  grid.wait();
  Index k = 0;
  for (bool ended = false; !ended; ++k) {
    kernel.update_contacts(k);
    kernel.update_motors(k);
    grid.wait();
    move(k);
    kernel.decide(k);
    ended = grid.wait(1);
  }
  kernel.measure(k);
  grid.wait();
  kernel.push_measures();
  kernel.push_last_velocities(k);
  all.wait(grid);
  kernel.add_measures(k);
  kernel.receive_last_velocities(k);
  all.remember();
}

}  // namespace gonogo::sim
