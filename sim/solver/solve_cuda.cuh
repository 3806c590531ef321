// The iteration on the GPU: all updates of a step in one cooperative kernel, so that nothing waits for launches or for
// the host. A block updates a tile of contacts at a time; grid-wide barriers stand where the stages of solve_host.h
// end. Records are packed for bandwidth: an arm along the normal (two spheres, a sphere on a fixed floor) is one number.
#pragma once
#include <cooperative_groups.h>

#include "sim/joint/motor.h"
#include "sim/joint/project.h"
#include "sim/solver/body_update.h"
#include "sim/solver/split.h"
#include "sim/solver/tiles.h"

namespace gonogo::sim {

struct alignas(16) FrameRecord {
  Vec3 normal;
  Real bias;
};
struct alignas(16) ConeRecord {
  Real step_n, step_t, mu, cohesion;
};
struct alignas(16) TurnRecord {
  Real rho, sigma, step_r, softness;
};
/// Arms along the normal [m]; not a number in `a` where they are not: then ArmsRecord holds them.
struct alignas(8) CentralArms {
  Real a, b;
};
struct ArmsRecord {
  Vec3 a, b;
};
struct alignas(8) PairRecord {
  BodyIndex a, b;
};
/// Contacts that a body owns and its part of the second lists.
struct alignas(16) BodyContacts {
  Index owned_begin, owned_end, second_begin, second_end;
};

template <>
struct SolverStorage<Cuda> {
  Buffer<FrameRecord, Cuda> frame;  // [contact], as are the next seven
  Buffer<ConeRecord, Cuda> cone;
  Buffer<TurnRecord, Cuda> turn;
  Buffer<CentralArms, Cuda> central;
  Buffer<ArmsRecord, Cuda> arms;
  Buffer<PairRecord, Cuda> pair;
  Buffer<Vec3, Cuda> linear[2], angular[2];  // impulses of the latest two updates, taking turns
  Buffer<BodyContacts, Cuda> of_body;
  Buffer<BodyIndex, Cuda> hub;       // bodies with so many contacts that a warp sums them
  Buffer<Index, Cuda> hub_count;     // one
  Buffer<UpdateSums, Cuda> tile_sums;
  Buffer<WorldSums, Cuda> tile_measures, body_tile_measures;
  Buffer<Index, Cuda> arrived;       // [world] tiles that have added their sums
  Buffer<Index, Cuda> worlds_at_work;  // one
  Buffer<Real, Cuda> motor_before;
};

/// On the device a step that lacks room is given up and taken again; see Progress.
inline void make_room_for_contacts(Cuda, State<Cuda>&) {}

inline constexpr Index kHubContacts = 48;

/// What the kernel works on.
struct SolveViews {
  Tiles tiles;
  Incidence incidence;
  IterationRules rules;
  Real step;
  const Index* halted;
  const Index* contact_total;
  View<const Contact> contact;
  View<const BodyMass> mass;
  View<const Quat> orientation;
  View<const SymMat3> inverse_inertia_W;
  View<const Velocity> free_velocity;
  View<const WorldIndex> world_of_body, world_of_body_tile;
  View<const Index> first_body_tile;
  Projection projection;
  MotorMoment motor_moment;
  View<Velocity> gathered;  // [mechanism body]
  View<const Motor> motor;
  View<const MotorDrive> drive;
  View<Real> motor_impulse, motor_before;
  View<Velocity> velocity, extrapolated_velocity;
  View<Momentum> momentum;
  View<Impulse> impulse;  // warm start, and the result
  View<WorldSums> world_sums;

  View<FrameRecord> frame;
  View<ConeRecord> cone;
  View<TurnRecord> turn;
  View<CentralArms> central;
  View<ArmsRecord> arms;
  View<PairRecord> pair;
  View<Vec3> linear[2], angular[2];
  View<BodyContacts> of_body;
  View<BodyIndex> hub;
  Index* hub_count;
  View<UpdateSums> tile_sums;
  View<WorldSums> tile_measures, body_tile_measures;
  View<Index> arrived;
  Index* worlds_at_work;
};

/// Sum over the block, the same bits whatever else runs; valid in thread 0. `scratch`: one number per warp.
__device__ inline double block_sum(double value, double* scratch) {
  for (int offset = 16; offset > 0; offset /= 2) value += __shfl_down_sync(0xFFFFFFFF, value, offset);
  __syncthreads();
  if (threadIdx.x % 32 == 0) scratch[threadIdx.x / 32] = value;
  __syncthreads();
  double sum = 0;
  if (threadIdx.x == 0)
    for (int warp = 0; warp < kTileSize / 32; ++warp) sum += scratch[warp];
  return sum;
}

__device__ inline double block_max(double value, double* scratch) {
  for (int offset = 16; offset > 0; offset /= 2)
    value = std::fmax(value, __shfl_down_sync(0xFFFFFFFF, value, offset));
  __syncthreads();
  if (threadIdx.x % 32 == 0) scratch[threadIdx.x / 32] = value;
  __syncthreads();
  double most = 0;
  if (threadIdx.x == 0)
    for (int warp = 0; warp < kTileSize / 32; ++warp) most = std::fmax(most, scratch[warp]);
  return most;
}

__device__ inline WorldSums block_sum(const WorldSums& value, double* scratch) {
  WorldSums sum;
  sum.kinetic = block_sum(value.kinetic, scratch);
  sum.gravity_power = block_sum(value.gravity_power, scratch);
  sum.residual_square = block_sum(value.residual_square, scratch);
  sum.residual_max = block_max(value.residual_max, scratch);
  return sum;
}

/// Called by all threads of a block after its thread 0 has written the block's part of a world's sum: true in all of
/// them when the other parts have been written too.
__device__ inline bool last_to_arrive(Index* arrived, Index parts) {
  __shared__ bool last;
  if (threadIdx.x == 0) {
    __threadfence();
    last = atomicAdd(arrived, 1) == parts - 1;
    if (last) {
      *arrived = 0;
      __threadfence();
    }
  }
  __syncthreads();
  return last;
}

class SolveKernel {
 public:
  __device__ SolveKernel(const SolveViews& views, double* scratch) : s(views), scratch_(scratch) {}

  /// Contacts from the narrow phase's records, impulses from the warm start.
  template <bool turning>
  __device__ void prepare() {
    for (Index i = first_index(); i < *s.contact_total; i += stride()) pack<turning>(i);
    for (Index b = first_index(); b < s.mass.size; b += stride()) prepare_body(b);
    for (Index w = first_index(); w < s.momentum.size; w += stride()) {
      s.momentum[w] = first_momentum(s.rules);
      s.arrived[w] = 0;
    }
    for (Index m = first_index(); m < s.motor.size; m += stride()) s.motor_before[m] = s.motor_impulse[m];
    if (first_index() == 0) *s.worlds_at_work = s.momentum.size;
  }

  /// Update number `k` of all tiles.
  template <bool turning>
  __device__ void update_contacts(Index k) {
    for (Index tile = blockIdx.x; tile < s.tiles.count(); tile += gridDim.x) update_tile<turning>(tile, k);
  }

  /// Velocities after `update` updates.
  template <bool turning>
  __device__ void gather_bodies(Index update) {
    for (Index b = first_index(); b < s.mass.size; b += stride()) {
      const BodyContacts c = s.of_body[b];
      if (c.owned_end - c.owned_begin + c.second_end - c.second_begin > kHubContacts) continue;
      if (s.momentum[s.world_of_body[b]].iterations != update) continue;
      Vec3 linear, angular;
      add_contacts<turning>(c, update & 1, 0, 1, linear, angular);
      set_velocity(b, update, linear, angular);
    }
    const Index lane = threadIdx.x % 32;
    for (Index h = first_index() / 32; h < *s.hub_count; h += stride() / 32) {
      const BodyIndex b = s.hub[h];
      if (s.momentum[s.world_of_body[b]].iterations != update) continue;
      Vec3 linear, angular;
      add_contacts<turning>(s.of_body[b], update & 1, lane, 32, linear, angular);
      linear = warp_sum(linear);
      angular = warp_sum(angular);
      if (lane == 0) set_velocity(b, update, linear, angular);
    }
  }

  __device__ bool any_mechanisms() const { return s.projection.body.size > 0; }

  /// Velocities of the jointed bodies from all that their mechanism gathered; one number per thread.
  __device__ void project_mechanisms(Index update) {
    for (Index i = first_index(); i < 6 * s.projection.body.size; i += stride()) {
      const Index k = i / 6, c = i % 6;
      const Mechanism& in = s.projection.mechanism[s.projection.body[k].mechanism];
      if (k - in.first_body >= in.body_count) continue;  // an empty place in a batch
      const BodyIndex b = s.projection.body[k].body;
      const Momentum& m = s.momentum[s.world_of_body[b]];
      if (m.iterations != update) continue;
      const Real next = s.projection.component(k, c);
      Real& now = component(s.velocity[b], c);
      component(s.extrapolated_velocity[b], c) = update == 0 ? next : next + (next - now) * m.beta;
      now = next;
    }
  }

  __device__ bool any_at_work() const { return *static_cast<volatile Index*>(s.worlds_at_work) > 0; }

  /// Impulses back into the order of the contacts, residuals and energies.
  template <bool turning>
  __device__ void measure() {
    for (Index tile = blockIdx.x; tile < s.tiles.count(); tile += gridDim.x) measure_tile<turning>(tile);
    for (Index tile = blockIdx.x; tile < s.world_of_body_tile.size; tile += gridDim.x) measure_bodies(tile);
  }

 private:
  __device__ static Real& component(Velocity& v, Index c) {
    Vec3& part = c < 3 ? v.linear : v.angular;
    return c % 3 == 0 ? part.x : c % 3 == 1 ? part.y : part.z;
  }

  __device__ static Index first_index() { return blockIdx.x * blockDim.x + threadIdx.x; }
  __device__ static Index stride() { return gridDim.x * blockDim.x; }

  __device__ static Vec3 warp_sum(Vec3 v) {
    for (int offset = 16; offset > 0; offset /= 2) {
      v.x += __shfl_down_sync(0xFFFFFFFF, v.x, offset);
      v.y += __shfl_down_sync(0xFFFFFFFF, v.y, offset);
      v.z += __shfl_down_sync(0xFFFFFFFF, v.z, offset);
    }
    return v;
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

  template <bool turning>
  __device__ void pack(ContactIndex i) {
    const Contact c = s.contact[i];
    s.frame[i] = {c.normal, c.bias};
    s.cone[i] = {c.step.n, c.step.t, c.mu, c.cohesion};
    if (turning) s.turn[i] = {c.rho, c.sigma, c.step.r, c.softness};
    s.pair[i] = {c.body_a, c.body_b};
    CentralArms along;
    const bool central_a = is_central(c.arm_a, c.normal, c.body_a, along.a);
    const bool central_b = is_central(c.arm_b, c.normal, c.body_b, along.b);
    if (!central_a || !central_b) {
      along.a = NAN;
      s.arms[i] = {c.arm_a, c.arm_b};
    }
    s.central[i] = along;
    const Impulse start = s.impulse[i];
    s.linear[0][i] = s.linear[1][i] = start.linear;
    if (turning) s.angular[0][i] = s.angular[1][i] = start.angular;
  }

  __device__ void prepare_body(BodyIndex b) {
    const BodyContacts c{s.incidence.owned_begin(b), s.incidence.owned_end(b), s.incidence.first_second[b],
                         s.incidence.first_second[b + 1]};
    s.of_body[b] = c;
    if (c.owned_end - c.owned_begin + c.second_end - c.second_begin > kHubContacts)
      s.hub[atomicAdd(s.hub_count, 1)] = b;
  }

  template <bool turning>
  __device__ ContactNumbers<Real> unpack(ContactIndex i) const {
    const FrameRecord frame = s.frame[i];
    const ConeRecord cone = s.cone[i];
    const CentralArms along = s.central[i];
    ContactNumbers<Real> c;
    c.normal = frame.normal;
    c.bias = frame.bias;
    c.arm_a = frame.normal * along.a;
    c.arm_b = frame.normal * along.b;
    if (isnan(along.a)) {
      const ArmsRecord arms = s.arms[i];
      c.arm_a = arms.a;
      c.arm_b = arms.b;
    }
    c.step = {cone.step_n, cone.step_t, Real(1)};
    c.mu = cone.mu;
    c.cohesion = cone.cohesion;
    c.rho = c.sigma = c.softness = 0;
    if (turning) {
      const TurnRecord turn = s.turn[i];
      c.rho = turn.rho, c.sigma = turn.sigma, c.step.r = turn.step_r, c.softness = turn.softness;
    }
    return c;
  }

  template <bool turning>
  __device__ Impulse load_impulse(Index store, ContactIndex i) const {
    Impulse p;
    p.linear = s.linear[store][i];
    if (turning) p.angular = s.angular[store][i];
    return p;
  }

  template <bool turning>
  __device__ void update_tile(Index tile, Index k) {
    const WorldIndex w = s.tiles.world_of_tile[tile];
    const Momentum m = s.momentum[w];
    if (m.done) return;
    const ContactRange range = s.tiles.contacts(tile);
    const ContactIndex i = range.begin + threadIdx.x;
    double uphill = 0, residual_square = 0;
    if (i < range.end) {
      const ContactUpdate<Real> u = update_contact<turning>(i, m, k & 1);
      uphill = u.uphill;
      residual_square = u.residual_square;
    }
    if (tile == s.tiles.first_tile[w]) update_motors(w);
    const UpdateSums sums{block_sum(uphill, scratch_), block_sum(residual_square, scratch_)};
    if (threadIdx.x == 0) s.tile_sums[tile] = sums;
    const Index tiles = s.tiles.first_tile[w + 1] - s.tiles.first_tile[w];
    if (last_to_arrive(&s.arrived[w], tiles)) decide(w, m);
  }

  template <bool turning>
  __device__ ContactUpdate<Real> update_contact(ContactIndex i, const Momentum& m, Index now) {
    ContactNumbers<Real> c = unpack<turning>(i);
    const PairRecord pair = s.pair[i];
    const Velocity a = s.extrapolated_velocity[pair.a], b = s.extrapolated_velocity[pair.b];
    if (m.renew_slip) {
      c.bias = s.contact[i].gap_bias + c.mu * slip_speed<Real>(c, a, b);
      s.frame[i].bias = c.bias;
    }
    const ContactUpdate<Real> u = accelerated_update<turning, Real>(c, a, b, load_impulse<turning>(now, i),
                                                                    load_impulse<turning>(1 - now, i), m.beta);
    s.linear[1 - now][i] = u.impulse.linear;
    if (turning) s.angular[1 - now][i] = u.impulse.angular;
    return u;
  }

  __device__ void update_motors(WorldIndex w) {
    const WorldParameters& p = s.tiles.world[w];
    const UpdateMotor update{s.motor,    s.drive,         s.extrapolated_velocity, s.world_of_body,
                             s.momentum, s.motor_impulse, s.motor_before,          s.step};
    for (Index m = p.first_motor + threadIdx.x; m < p.first_motor + p.motor_count; m += blockDim.x) update(m);
  }

  /// By the block that arrives last: adds the world's tiles in order.
  __device__ void decide(WorldIndex w, Momentum m) {
    double uphill = 0, residual_square = 0;
    for (Index t = s.tiles.first_tile[w] + threadIdx.x; t < s.tiles.first_tile[w + 1]; t += blockDim.x) {
      uphill += __ldcg(&s.tile_sums[t].uphill);
      residual_square += __ldcg(&s.tile_sums[t].residual_square);
    }
    const UpdateSums sums{block_sum(uphill, scratch_), block_sum(residual_square, scratch_)};
    if (threadIdx.x != 0) return;
    const ContactRange r = contacts_of_world(s.tiles.world[w], s.tiles.first_contact);
    decide_next_update(m, sums, r.end - r.begin, s.rules);
    s.momentum[w] = m;
    if (m.done) atomicSub(s.worlds_at_work, 1);
  }

  /// Adds every `step`-th contact of a body, owned ones first.
  template <bool turning>
  __device__ void add_contacts(const BodyContacts& c, Index store, Index from, Index step, Vec3& linear,
                               Vec3& angular) const {
    for (ContactIndex i = c.owned_begin + from; i < c.owned_end; i += step) {
      const Impulse p = load_impulse<turning>(store, i);
      const Real along = s.central[i].a;
      const Vec3 arm = isnan(along) ? s.arms[i].a : s.frame[i].normal * along;
      linear += p.linear;
      angular += moment(arm, p);
    }
    for (Index k = c.second_begin + from; k < c.second_end; k += step) {
      const ContactIndex i = s.incidence.second[k];
      const Impulse p = load_impulse<turning>(store, i);
      const CentralArms along = s.central[i];
      const Vec3 arm = isnan(along.a) ? s.arms[i].b : s.frame[i].normal * along.b;
      linear -= p.linear;
      angular -= moment(arm, p);
    }
  }

  __device__ void set_velocity(BodyIndex b, Index update, const Vec3& linear, Vec3 angular) {
    const BodyMass m = s.mass[b];
    if (m.slot >= 0) angular += s.motor_moment(m.slot);
    const SymMat3 inverse_inertia = m.isotropic ? SymMat3{} : s.inverse_inertia_W[b];
    const Velocity next = driven_velocity(s.free_velocity[b], m, inverse_inertia, linear, angular);
    if (m.slot >= 0) {  // project_mechanisms goes on with it
      s.gathered[m.slot] = next;
      return;
    }
    const Real beta = s.momentum[s.world_of_body[b]].beta;
    s.extrapolated_velocity[b] = update == 0 ? next : extrapolated<Real>(next, s.velocity[b], beta);
    s.velocity[b] = next;
  }

  template <bool turning>
  __device__ void measure_tile(Index tile) {
    const WorldIndex w = s.tiles.world_of_tile[tile];
    const ContactRange range = s.tiles.contacts(tile);
    const ContactIndex i = range.begin + threadIdx.x;
    WorldSums sums;
    if (i < range.end) {
      const Impulse p = load_impulse<turning>(s.momentum[w].iterations & 1, i);
      s.impulse[i] = p;
      const Contact c = s.contact[i];
      const double r = contact_residual(c, s.velocity[c.body_a], s.velocity[c.body_b], p, s.rules.target);
      sums.residual_square = r * r;
      sums.residual_max = r;
    }
    add_measures(w, &s.tile_measures[tile], sums);
  }

  __device__ void measure_bodies(Index tile) {
    const WorldIndex w = s.world_of_body_tile[tile];
    const WorldParameters& p = s.tiles.world[w];
    const Index in_world = (tile - s.first_body_tile[w]) * kTileSize + threadIdx.x;
    WorldSums sums;
    if (in_world < p.body_count) {
      const BodyIndex b = p.first_body + in_world;
      sums = energy_of_body(s.mass[b], s.orientation[b], s.velocity[b], p.gravity);
    }
    add_measures(w, &s.body_tile_measures[tile], sums);
  }

  __device__ void add_measures(WorldIndex w, WorldSums* part, const WorldSums& sums) {
    const WorldSums total = block_sum(sums, scratch_);
    if (threadIdx.x == 0) *part = total;
    const Index tiles = s.tiles.first_tile[w + 1] - s.tiles.first_tile[w];
    const Index body_tiles = s.first_body_tile[w + 1] - s.first_body_tile[w];
    if (last_to_arrive(&s.arrived[w], tiles + body_tiles)) finish_measures(w);
  }

  __device__ static void add(WorldSums& sum, const WorldSums& part) {
    WorldSums fresh;  // past this multiprocessor's first-level cache
    fresh.kinetic = __ldcg(&part.kinetic);
    fresh.gravity_power = __ldcg(&part.gravity_power);
    fresh.residual_square = __ldcg(&part.residual_square);
    fresh.residual_max = __ldcg(&part.residual_max);
    sum += fresh;
  }

  __device__ void finish_measures(WorldIndex w) {
    WorldSums sum;
    for (Index t = s.tiles.first_tile[w] + threadIdx.x; t < s.tiles.first_tile[w + 1]; t += blockDim.x)
      add(sum, s.tile_measures[t]);
    for (Index t = s.first_body_tile[w] + threadIdx.x; t < s.first_body_tile[w + 1]; t += blockDim.x)
      add(sum, s.body_tile_measures[t]);
    WorldSums total = block_sum(sum, scratch_);
    if (threadIdx.x != 0) return;
    const ContactRange r = contacts_of_world(s.tiles.world[w], s.tiles.first_contact);
    total.contact_count = r.end - r.begin;
    total.iterations = s.momentum[w].iterations;
    s.world_sums[w] = total;
  }

  const SolveViews& s;
  double* scratch_;
};

/// From the warm start in the step's contact store to the velocities and impulses at the end of the step.
template <bool turning>
__global__ void __launch_bounds__(kTileSize) solve_kernel(const __grid_constant__ SolveViews views) {
  __shared__ double scratch[kTileSize / 32];
  if (*views.halted != 0) return;
  const auto grid = cooperative_groups::this_grid();
  SolveKernel kernel(views, scratch);
  kernel.prepare<turning>();
  grid.sync();
  kernel.gather_bodies<turning>(0);
  grid.sync();
  if (kernel.any_mechanisms()) {
    kernel.project_mechanisms(0);
    grid.sync();
  }
  for (Index k = 0; k < views.rules.most_iterations; ++k) {
    kernel.update_contacts<turning>(k);
    grid.sync();
    kernel.gather_bodies<turning>(k + 1);
    if (kernel.any_mechanisms()) {
      grid.sync();
      kernel.project_mechanisms(k + 1);
    }
    const bool at_work = kernel.any_at_work();
    grid.sync();
    if (!at_work) break;
  }
  kernel.measure<turning>();
}

inline void reserve_solver(State<Cuda>& s) {
  SolverStorage<Cuda>& own = s.solver;
  own.frame.resize(s.contact_capacity);
  own.cone.resize(s.contact_capacity);
  own.central.resize(s.contact_capacity);
  own.arms.resize(s.contact_capacity);
  own.pair.resize(s.contact_capacity);
  for (auto& of_contact : own.linear) of_contact.resize(s.contact_capacity);
  if (s.turning) {
    own.turn.resize(s.contact_capacity);
    for (auto& of_contact : own.angular) of_contact.resize(s.contact_capacity);
  }
  own.of_body.resize(s.body_count);
  own.hub.resize(s.body_count);
  own.hub_count.resize(1);
  own.tile_sums.resize(tile_capacity(s));
  own.tile_measures.resize(tile_capacity(s));
  own.body_tile_measures.resize(s.world_of_body_tile.size());
  own.arrived.resize(s.world_count);
  own.worlds_at_work.resize(1);
  own.motor_before.resize(s.mechanisms.motor.size());
}

inline SolveViews solve_views(Cuda exec, State<Cuda>& s, const StepSettings& settings) {
  SolverStorage<Cuda>& own = s.solver;
  return {tiles(s),
          incidence(s),
          settings.rules(),
          settings.step,
          exec.halted,
          contact_count(s).count,
          s.contact.view(),
          s.mass.view(),
          s.orientation.view(),
          s.inverse_inertia_W.view(),
          s.free_velocity.view(),
          s.world_of_body.view(),
          s.world_of_body_tile.view(),
          s.first_body_tile.view(),
          projection(s.mechanisms),
          motor_moment(s.mechanisms),
          s.mechanisms.gathered.view(),
          s.mechanisms.motor.view(),
          s.mechanisms.drive.view(),
          s.mechanisms.motor_impulse.view(),
          own.motor_before.view(),
          s.velocity.view(),
          s.extrapolated_velocity.view(),
          s.momentum.view(),
          s.store[s.parity].impulse.view(),
          s.world_sums.view(),
          own.frame.view(),
          own.cone.view(),
          own.turn.view(),
          own.central.view(),
          own.arms.view(),
          own.pair.view(),
          {own.linear[0].view(), own.linear[1].view()},
          {own.angular[0].view(), own.angular[1].view()},
          own.of_body.view(),
          own.hub.view(),
          own.hub_count.data(),
          own.tile_sums.view(),
          own.tile_measures.view(),
          own.body_tile_measures.view(),
          own.arrived.view(),
          own.worlds_at_work.data()};
}

/// As many blocks as can be resident at once, and no more than there is work for: a barrier costs less with fewer.
template <bool turning>
Index grid_size(const State<Cuda>& s) {
  int device = 0, processors = 0, blocks = 0;
  check_cuda(cudaGetDevice(&device), "device");
  check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device), "processor count");
  check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, solve_kernel<turning>, kTileSize, 0), "occupancy");
  const Index work = std::max(tile_capacity(s), (s.body_count + kTileSize - 1) / kTileSize);
  return std::max<Index>(1, std::min<Index>(work, blocks * processors));
}

template <bool turning>
void launch_solve(Cuda exec, State<Cuda>& s, const StepSettings& settings) {
  SolveViews views = solve_views(exec, s, settings);
  void* arguments[] = {&views};
  check_cuda(cudaLaunchCooperativeKernel(solve_kernel<turning>, dim3(grid_size<turning>(s)), dim3(kTileSize), arguments,
                                         0, stream_of(exec)),
             "solver launch");
}

inline void solve(Cuda exec, State<Cuda>& s, const StepSettings& settings) {
  clear(exec, s.solver.hub_count.view());
  s.turning ? launch_solve<true>(exec, s, settings) : launch_solve<false>(exec, s, settings);
}

}  // namespace gonogo::sim
