// The records of a contact: where they are, how they are packed from the narrow phase's Contact, and what a step
// reports of them.
#pragma once
#include "sim/solver/cuda/records.cuh"
#include "sim/solver/cuda/views.cuh"

namespace gonogo::sim {

/// `turning`, `resident`, `in_substeps`: see SolveKernel. A resident contact's records are those of the calling thread.
template <bool turning, bool resident, bool in_substeps>
class ContactRecords {
 public:
  GONOGO_DEVICE explicit ContactRecords(const SolveViews& views) : s(views) {}

  GONOGO_DEVICE void pack(ContactIndex i) {
    Contact c = s.contact[i];
    const Impulse start = s.impulse[i];
    s.split.split(c, start);
    s.contact[i].step = c.step;
    s.contact[i].unsplit = c.unsplit;
    s.contact[i].bias = c.bias;
    frame(i) = {c.normal, c.bias};
    cone(i) = {c.step.n, c.step.t, c.mu, c.cohesion};
    if (turning) turn(i) = {c.rho, c.sigma, c.step.r, c.softness};
    pair(i) = {c.body_a, c.body_b};
    if (in_substeps) s.gap[i] = {c.gap, c.gap_rate};
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
    store_impulse(0, i, start);
    store_impulse(1, i, start);
  }

  GONOGO_DEVICE ContactNumbers<Real> unpack(ContactIndex i) {
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
      c.rho = t.rho;
      c.sigma = t.sigma;
      c.step.r = t.step_r;
      c.softness = t.softness;
    }
    return c;
  }

  // Where a contact's records are.
  GONOGO_DEVICE FrameRecord& frame(ContactIndex i) { return resident ? residence().frame[threadIdx.x] : s.frame[i]; }
  GONOGO_DEVICE ConeRecord& cone(ContactIndex i) { return resident ? residence().cone[threadIdx.x] : s.cone[i]; }
  GONOGO_DEVICE TurnRecord& turn(ContactIndex i) { return resident ? residence().turn[threadIdx.x] : s.turn[i]; }
  GONOGO_DEVICE CentralArms& central(ContactIndex i) {
    return resident ? residence().central[threadIdx.x] : s.central[i];
  }
  GONOGO_DEVICE ArmsRecord& arms(ContactIndex i) { return resident ? residence().arms[threadIdx.x] : s.arms[i]; }
  GONOGO_DEVICE PairRecord& pair(ContactIndex i) { return resident ? residence().pair[threadIdx.x] : s.pair[i]; }

  /// The impulse that the contact's own thread has stored.
  GONOGO_DEVICE Impulse own_impulse(Index store, ContactIndex i) const {
    Impulse p;
    p.linear = resident ? residence().linear[store][threadIdx.x] : s.linear[store][i];
    if (turning) p.angular = resident ? residence().angular[store][threadIdx.x] : s.angular[store][i];
    return p;
  }
  /// The impulse of any contact.
  GONOGO_DEVICE Impulse load_impulse(Index store, ContactIndex i) const {
    Impulse p;
    p.linear = s.linear[store][i];
    if (turning) p.angular = s.angular[store][i];
    return p;
  }
  GONOGO_DEVICE void store_impulse(Index store, ContactIndex i, const Impulse& p) {
    s.linear[store][i] = p.linear;
    if (turning) s.angular[store][i] = p.angular;
    if (!resident) return;
    residence().linear[store][threadIdx.x] = p.linear;
    if (turning) residence().angular[store][threadIdx.x] = p.angular;
  }

 private:
  /// Whether only the arm along the normal counts: the rest is rounding, or the body is fixed and at rest.
  GONOGO_DEVICE bool is_central(const Vec3& arm, const Vec3& normal, BodyIndex b, Real& along) const {
    const Velocity& v = s.velocity[b];
    along = dot(arm, normal);
    const Vec3 aside = cross(arm, normal);
    if (dot(aside, aside) <= Real(1e-12) * dot(arm, arm)) return true;
    along = 0;
    return is_fixed(s.mass[b]) && dot(v.linear, v.linear) + dot(v.angular, v.angular) == 0;
  }

  const SolveViews& s;
};

/// Sums that a step reports, by tile and then by world: residuals of contacts and energies of bodies.
template <bool turning>
class Measures {
 public:
  GONOGO_DEVICE Measures(const SolveViews& views, const Team& team) : s(views), team_(team) {}

  /// Stores the impulses after `k` updates and sums the residuals.
  GONOGO_DEVICE void measure_tile(Index tile, Index k) {
    const Tile t = s.tiles.tile[tile];
    const ContactIndex i = t.contacts.begin + team_.rank;
    WorldSums sums;
    if (i < t.contacts.end) {
      const Impulse p =
          ContactRecords<turning, false, false>(s).load_impulse(s.momentum[k & 1][t.world].updates & 1, i);
      s.impulse[i] = p;
      const Contact c = s.contact[i];
      const double r = contact_residual(c, s.velocity[c.body_a], s.velocity[c.body_b], p, s.rules.target);
      sums.residual_square = r * r;
      sums.residual_max = r;
    }
    sums = team_.sum(sums);
    if (team_.rank == 0) s.tile_measures[tile] = sums;
  }

  GONOGO_DEVICE void measure_bodies(Index tile) {
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

  GONOGO_DEVICE void add_measures(WorldIndex w, Index k) {
    WorldSums sum;
    for (Index t = s.tiles.first_tile[w] + team_.rank; t < s.tiles.first_tile[w + 1]; t += kTileSize)
      sum += s.tile_measures[t];
    for (Index t = s.first_body_tile[w] + team_.rank; t < s.first_body_tile[w + 1]; t += kTileSize)
      sum += s.body_tile_measures[t];
    sum = team_.sum(sum);
    const ContactRange r = contacts_of_world(s.tiles.world[w], s.tiles.first_contact);
    sum.contact_count = r.end - r.begin;
    sum.iterations = s.momentum[k & 1][w].updates;
    if (team_.rank == 0) s.world_sums[w] = sum;
  }

 private:
  const SolveViews& s;
  const Team& team_;
};

}  // namespace gonogo::sim
