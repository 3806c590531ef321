// Sums that a step reports, by tile and then by world: residuals of contacts and energies of bodies.
#pragma once
#include "sim/solver/cuda/contact_records.cuh"

namespace gonogo::sim {

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
