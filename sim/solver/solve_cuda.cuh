// The iteration on the GPU: all updates of a step in one cooperative kernel, so that nothing waits for launches or for
// the host. One block per multiprocessor keeps the grid-wide barriers cheap, which stand where the stages of
// solve_host.h end; its threads work in teams of one tile each. Records are packed for bandwidth: an arm along the
// normal (two spheres, a sphere on a fixed floor) is one number.
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
/// A contact as one of its bodies sees it; those of a body follow each other, owned ones first.
struct alignas(16) HalfContact {
  Vec3 arm;
  Index contact;  // its complement where the impulse acts backwards
};
struct alignas(8) HalfRange {
  Index begin, end;
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
  Buffer<HalfContact, Cuda> half;            // [contact * 2]
  Buffer<HalfRange, Cuda> of_body;           // into half
  Buffer<BodyIndex, Cuda> hub;               // bodies with so many contacts that a warp sums them
  Buffer<Index, Cuda> hub_count;             // one
  Buffer<UpdateSums, Cuda> tile_sums;
  Buffer<WorldSums, Cuda> tile_measures, body_tile_measures;
  Buffer<Momentum, Cuda> other_momentum;  // [world]
  Buffer<Index, Cuda> worlds_at_work;     // one
  Buffer<Real, Cuda> motor_before;
};

/// On the device a step that lacks room is given up and taken again; see Progress.
inline void make_room_for_contacts(Cuda, State<Cuda>&) {}

/// Bodies with more contacts than this are summed by a warp.
inline constexpr Index kHubContacts = 48;

inline constexpr Index kTeamsPerBlock = 4;
inline constexpr Index kBlockSize = kTeamsPerBlock * kTileSize;

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
  View<Momentum> momentum[2];  // [world] of the present update and of the next, taking turns
  View<Impulse> impulse;       // warm start, and the result
  View<WorldSums> world_sums;

  View<FrameRecord> frame;
  View<ConeRecord> cone;
  View<TurnRecord> turn;
  View<CentralArms> central;
  View<ArmsRecord> arms;
  View<PairRecord> pair;
  View<Vec3> linear[2], angular[2];
  View<const Index> second_slot;
  View<HalfContact> half;
  View<HalfRange> of_body;
  View<BodyIndex> hub;
  Index* hub_count;
  View<UpdateSums> tile_sums;
  View<WorldSums> tile_measures, body_tile_measures;
  Index* worlds_at_work;
};

/// 256 threads of a block that work on one tile.
struct Team {
  Index in_block, rank;  // rank: of the thread
  Index index, count;    // among all teams; neighbours sit on different multiprocessors
  double* scratch;       // one number per warp

  __device__ void sync() const { asm volatile("bar.sync %0, %1;" ::"r"(in_block + 1), "n"(kTileSize) : "memory"); }

  /// The same bits whatever else runs; valid in the thread of rank 0.
  template <class Combine>
  __device__ double reduce(double value, Combine combine) const {
    for (int offset = 16; offset > 0; offset /= 2) value = combine(value, __shfl_down_sync(0xFFFFFFFF, value, offset));
    sync();
    if (rank % 32 == 0) scratch[rank / 32] = value;
    sync();
    double all = scratch[0];
    if (rank == 0)
      for (int warp = 1; warp < kTileSize / 32; ++warp) all = combine(all, scratch[warp]);
    return all;
  }
  __device__ double sum(double value) const {
    return reduce(value, [](double a, double b) { return a + b; });
  }
  __device__ double most(double value) const {
    return reduce(value, [](double a, double b) { return std::fmax(a, b); });
  }
  __device__ WorldSums sum(const WorldSums& value) const {
    WorldSums total;
    total.kinetic = sum(value.kinetic);
    total.gravity_power = sum(value.gravity_power);
    total.residual_square = sum(value.residual_square);
    total.residual_max = most(value.residual_max);
    return total;
  }
};

class SolveKernel {
 public:
  __device__ SolveKernel(const SolveViews& views, const Team& team) : s(views), team_(team) {}

  /// Contacts from the narrow phase's records, impulses from the warm start.
  template <bool turning>
  __device__ void prepare() {
    for (Index i = first_index(); i < *s.contact_total; i += stride()) pack<turning>(i);
    for (Index b = first_index(); b < s.mass.size; b += stride()) prepare_body(b);
    for (Index w = first_index(); w < s.momentum[0].size; w += stride()) s.momentum[0][w] = first_momentum(s.rules);
    for (Index m = first_index(); m < s.motor.size; m += stride()) s.motor_before[m] = s.motor_impulse[m];
    if (first_index() == 0) *s.worlds_at_work = s.momentum[0].size;
  }

  /// Update number `k` of all tiles.
  template <bool turning>
  __device__ void update_contacts(Index k) {
    for (Index tile = team_.index; tile < s.tiles.count(); tile += team_.count) update_tile<turning>(tile, k);
  }

  /// Velocities after update number `k`; -1: of the warm start.
  template <bool turning>
  __device__ void gather_bodies(Index k) {
    const View<Momentum> momentum = s.momentum[k < 0 ? 0 : k & 1];
    const Index store = (k + 1) & 1;
    for (Index b = first_index(); b < s.mass.size; b += stride()) {
      const HalfRange c = s.of_body[b];
      if (c.end - c.begin > kHubContacts) continue;
      const Momentum m = momentum[s.world_of_body[b]];
      if (m.done) continue;
      Vec3 linear, angular;
      add_contacts<turning>(c, store, 0, 1, linear, angular);
      set_velocity(b, k < 0, m.next_beta, linear, angular);
    }
    const Index lane = team_.rank % 32;
    for (Index h = first_index() / 32; h < *s.hub_count; h += stride() / 32) {
      const BodyIndex b = s.hub[h];
      const Momentum m = momentum[s.world_of_body[b]];
      if (m.done) continue;
      Vec3 linear, angular;
      add_contacts<turning>(s.of_body[b], store, lane, 32, linear, angular);
      linear = warp_sum(linear);
      angular = warp_sum(angular);
      if (lane == 0) set_velocity(b, k < 0, m.next_beta, linear, angular);
    }
  }

  __device__ bool any_mechanisms() const { return s.projection.body.size > 0; }

  /// Velocities of the jointed bodies from all that their mechanism gathered; one number per thread.
  __device__ void project_mechanisms(Index k) {
    const View<Momentum> momentum = s.momentum[k < 0 ? 0 : k & 1];
    for (Index i = first_index(); i < 6 * s.projection.body.size; i += stride()) {
      const Index body = i / 6, c = i % 6;
      if (s.projection.is_empty(body)) continue;
      const BodyIndex b = s.projection.body[body].body;
      const Momentum m = momentum[s.world_of_body[b]];
      if (m.done) continue;
      const Real next = s.projection.component(body, c);
      Real& now = component(s.velocity[b], c);
      component(s.extrapolated_velocity[b], c) = k < 0 ? next : next + (next - now) * m.next_beta;
      now = next;
    }
  }

  /// What update `k + 1` will do: a team adds a world's tiles in order. The last teams begin, which have fewest bodies.
  __device__ void decide(Index k) {
    for (WorldIndex w = team_.count - 1 - team_.index; w < s.momentum[0].size; w += team_.count) decide(w, k);
  }

  __device__ bool any_at_work() const { return *static_cast<volatile Index*>(s.worlds_at_work) > 0; }

  /// After `k` updates: impulses back into the order of the contacts, residuals and energies, by tile.
  template <bool turning>
  __device__ void measure(Index k) {
    for (Index tile = team_.index; tile < s.tiles.count(); tile += team_.count) measure_tile<turning>(tile, k);
    for (Index tile = team_.index; tile < s.world_of_body_tile.size; tile += team_.count) measure_bodies(tile);
  }

  /// And by world.
  __device__ void add_measures(Index k) {
    for (WorldIndex w = team_.index; w < s.world_sums.size; w += team_.count) add_measures(w, k);
  }

 private:
  __device__ Index first_index() const { return team_.index * kTileSize + team_.rank; }
  __device__ Index stride() const { return team_.count * kTileSize; }

  __device__ static Real& component(Velocity& v, Index c) {
    Vec3& part = c < 3 ? v.linear : v.angular;
    return c % 3 == 0 ? part.x : c % 3 == 1 ? part.y : part.z;
  }

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
    s.half[i + s.incidence.first_second[c.body_a]] = {c.arm_a, i};
    if (s.second_slot[i] >= 0) s.half[s.incidence.owned_end(c.body_b) + s.second_slot[i]] = {c.arm_b, ~i};
    const Impulse start = s.impulse[i];
    s.linear[0][i] = s.linear[1][i] = start.linear;
    if (turning) s.angular[0][i] = s.angular[1][i] = start.angular;
  }

  __device__ void prepare_body(BodyIndex b) {
    HalfRange c{};  // nothing moves a fixed body
    if (!is_fixed(s.mass[b]))
      c = {s.incidence.owned_begin(b) + s.incidence.first_second[b],
           s.incidence.owned_end(b) + s.incidence.first_second[b + 1]};
    s.of_body[b] = c;
    if (c.end - c.begin > kHubContacts) s.hub[atomicAdd(s.hub_count, 1)] = b;
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
    const Tile t = s.tiles.tile[tile];
    const Momentum m = s.momentum[k & 1][t.world];
    if (m.done) return;
    const ContactIndex i = t.contacts.begin + team_.rank;
    UpdateSums sums;
    if (i < t.contacts.end) sums = update_contact<turning>(i, m, k & 1);
    if (t.first) update_motors(t.world, s.momentum[k & 1]);
    sums.uphill = team_.sum(sums.uphill);
    if (m.test) sums.residual_square = team_.sum(sums.residual_square);
    if (team_.rank == 0) s.tile_sums[tile] = sums;
  }

  template <bool turning>
  __device__ UpdateSums update_contact(ContactIndex i, const Momentum& m, Index now) {
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
    return {u.uphill, m.test ? residual_square<turning, Real>(c, u) : Real(0)};
  }

  __device__ void update_motors(WorldIndex w, View<const Momentum> momentum) {
    const WorldParameters& p = s.tiles.world[w];
    const UpdateMotor update{s.motor,  s.drive,         s.extrapolated_velocity, s.world_of_body,
                             momentum, s.motor_impulse, s.motor_before,          s.step};
    for (Index m = p.first_motor + team_.rank; m < p.first_motor + p.motor_count; m += kTileSize) update(m);
  }

  __device__ void decide(WorldIndex w, Index k) {
    Momentum m = s.momentum[k & 1][w];
    if (!m.done) {
      UpdateSums sums;
      for (Index t = s.tiles.first_tile[w] + team_.rank; t < s.tiles.first_tile[w + 1]; t += kTileSize) {
        sums.uphill += s.tile_sums[t].uphill;
        sums.residual_square += s.tile_sums[t].residual_square;
      }
      sums = {team_.sum(sums.uphill), team_.sum(sums.residual_square)};
      const ContactRange r = contacts_of_world(s.tiles.world[w], s.tiles.first_contact);
      decide_next_update(m, sums, r.end - r.begin, s.rules);
      if (m.done && team_.rank == 0) atomicSub(s.worlds_at_work, 1);
    }
    if (team_.rank == 0) s.momentum[(k + 1) & 1][w] = m;
  }

  /// Adds every `step`-th contact of a body.
  template <bool turning>
  __device__ void add_contacts(const HalfRange& c, Index store, Index from, Index step, Vec3& linear,
                               Vec3& angular) const {
#pragma unroll 4
    for (Index k = c.begin + from; k < c.end; k += step) {
      const HalfContact half = s.half[k];
      const bool backwards = half.contact < 0;
      const Impulse p = load_impulse<turning>(store, backwards ? ~half.contact : half.contact);
      const Vec3 turn = moment(half.arm, p);
      linear += backwards ? -p.linear : p.linear;
      angular += backwards ? -turn : turn;
    }
  }

  __device__ void set_velocity(BodyIndex b, bool first, Real beta, const Vec3& linear, Vec3 angular) {
    const BodyMass m = s.mass[b];
    if (m.slot >= 0) angular += s.motor_moment(m.slot);
    const SymMat3 inverse_inertia = m.isotropic ? SymMat3{} : s.inverse_inertia_W[b];
    const Velocity next = driven_velocity(s.free_velocity[b], m, inverse_inertia, linear, angular);
    if (m.slot >= 0) {  // project_mechanisms goes on with it
      s.gathered[m.slot] = next;
      return;
    }
    s.extrapolated_velocity[b] = first ? next : extrapolated<Real>(next, s.velocity[b], beta);
    s.velocity[b] = next;
  }

  template <bool turning>
  __device__ void measure_tile(Index tile, Index k) {
    const Tile t = s.tiles.tile[tile];
    const ContactIndex i = t.contacts.begin + team_.rank;
    WorldSums sums;
    if (i < t.contacts.end) {
      const Impulse p = load_impulse<turning>(s.momentum[k & 1][t.world].iterations & 1, i);
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
};

/// From the warm start in the step's contact store to the velocities and impulses at the end of the step.
template <bool turning>
__global__ void __launch_bounds__(kBlockSize) solve_kernel(const __grid_constant__ SolveViews views) {
  __shared__ double scratch[kTeamsPerBlock][kTileSize / 32];
  if (*views.halted != 0) return;
  const auto grid = cooperative_groups::this_grid();
  const Index in_block = threadIdx.x / kTileSize;
  const Team team{in_block, Index(threadIdx.x % kTileSize), Index(in_block * gridDim.x + blockIdx.x),
                  Index(kTeamsPerBlock * gridDim.x), scratch[in_block]};
  SolveKernel kernel(views, team);
  kernel.prepare<turning>();
  grid.sync();
  kernel.gather_bodies<turning>(-1);
  grid.sync();
  if (kernel.any_mechanisms()) {
    kernel.project_mechanisms(-1);
    grid.sync();
  }
  Index k = 0;
  do {
    kernel.update_contacts<turning>(k);
    grid.sync();
    kernel.gather_bodies<turning>(k);
    kernel.decide(k);
    grid.sync();
    if (kernel.any_mechanisms()) {
      kernel.project_mechanisms(k);
      grid.sync();
    }
    ++k;
  } while (kernel.any_at_work());
  kernel.measure<turning>(k);
  grid.sync();
  kernel.add_measures(k);
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
  own.half.resize(2 * std::size_t(s.contact_capacity));
  own.of_body.resize(s.body_count);
  own.hub.resize(s.body_count);
  own.hub_count.resize(1);
  own.tile_sums.resize(tile_capacity(s));
  own.tile_measures.resize(tile_capacity(s));
  own.body_tile_measures.resize(s.world_of_body_tile.size());
  own.other_momentum.resize(s.world_count);
  own.worlds_at_work.resize(1);
  own.motor_before.resize(s.mechanisms.motor.size());
}

inline SolveViews solve_views(Cuda exec, State<Cuda>& s, const StepSettings& settings) {
  SolverStorage<Cuda>& own = s.solver;
  return {tiles(s),
          incidence(s),
          settings.rules(),
          settings.substep(),
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
          {s.momentum.view(), own.other_momentum.view()},
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
          s.second_slot.view(),
          own.half.view(),
          own.of_body.view(),
          own.hub.view(),
          own.hub_count.data(),
          own.tile_sums.view(),
          own.tile_measures.view(),
          own.body_tile_measures.view(),
          own.worlds_at_work.data()};
}

/// One block per multiprocessor, and no more than there is work for: a barrier costs less with fewer.
inline Index grid_size(const State<Cuda>& s) {
  int device = 0, processors = 0;
  check_cuda(cudaGetDevice(&device), "device");
  check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device), "processor count");
  const Index work = std::max(tile_capacity(s), (s.body_count + kTileSize - 1) / kTileSize);
  return std::min<Index>(work, processors);
}

template <bool turning>
void launch_solve(Cuda exec, State<Cuda>& s, const StepSettings& settings) {
  SolveViews views = solve_views(exec, s, settings);
  void* arguments[] = {&views};
  check_cuda(cudaLaunchCooperativeKernel(solve_kernel<turning>, dim3(grid_size(s)), dim3(kBlockSize), arguments, 0,
                                         stream_of(exec)),
             "solver launch");
}

inline void solve(Cuda exec, State<Cuda>& s, const StepSettings& settings) {
  clear(exec, s.solver.hub_count.view());
  s.turning ? launch_solve<true>(exec, s, settings) : launch_solve<false>(exec, s, settings);
}

}  // namespace gonogo::sim
