// The iteration of a part on the host: the stages of solve_host.h, with an exchange after each update.
#pragma once
#include "base/ranks/ranks.h"
#include "sim/simulation/layout/part.h"
#include "sim/simulation/parts/part_lists.h"
#include "sim/solver/host_blocks.h"
#include "sim/solver/solve_host.h"

namespace gonogo::sim {

/// Gathers the velocity of an own body; those of shared ones need the wrenches of all parts.
struct GatherOwn {
  GatherVelocity gather;
  View<const std::uint8_t> is_shared;

  void operator()(BodyIndex b) const {
    if (!is_shared[b]) gather(b);
  }
};

/// Updates a tile; of a partial one, notes the sums of each contact.
template <bool turning>
struct UpdatePart {
  UpdateTile<turning> update;
  Index head_tile, tail_tile;   // -1: there is none
  View<UpdateSums> head, tail;  // [contact]

  void operator()(Index tile) const {
    if (tile == head_tile) return note(tile, head);
    if (tile == tail_tile) return note(tile, tail);
    update(tile);
  }

  void note(Index tile, View<UpdateSums> contact) const {
    const ContactRange range = update.tiles.contacts(tile);
    update.update_blocks(tile, [&](ContactIndex first, const Pack& uphill, const Pack& residual) {
      for (Index lane = 0; lane < kPackWidth && first + lane < range.end; ++lane)
        contact[first + lane - range.begin] = {double(uphill[lane]), double(residual[lane])};
    });
  }
};

/// Sums of a tile from those of its contacts, in the order of UpdateTile.
inline UpdateSums sums_of_tile(const std::vector<UpdateSums>& contact) {
  UpdateSums sums;
  for (std::size_t first = 0; first < contact.size(); first += kPackWidth) {
    Pack uphill{}, residual{};
    for (std::size_t lane = 0; lane < kPackWidth && first + lane < contact.size(); ++lane) {
      uphill[lane] = Real(contact[first + lane].uphill);
      residual[lane] = Real(contact[first + lane].residual_square);
    }
    sums.uphill += sum_lanes(uphill);
    sums.residual_square += sum_lanes(residual);
  }
  return sums;
}

/// The same for residuals at the step's end: `residual_max` is a contact's own, in the order of MeasureTile.
inline WorldSums measures_of_tile(const std::vector<WorldSums>& contact) {
  WorldSums sums;
  for (const WorldSums& c : contact) {
    sums.residual_square += c.residual_max * c.residual_max;
    sums.residual_max = std::fmax(sums.residual_max, c.residual_max);
  }
  return sums;
}

template <class Exec>
class PartSolver;

template <>
class PartSolver<Cpu> {
 public:
  PartSolver(Ranks& ranks, const Part& part, const FlatWorld&) : ranks_(ranks), part_(part) {}

  void reserve(State<Cpu>&, const StepSettings&) {}

  /// The contract of solve.h, for the bodies and contacts of the part; every part calls it at once.
  void solve(Cpu exec, State<Cpu>& s, const PartContacts& contacts, const StepSettings& settings) {
    contacts_ = &contacts;
    const IterationRules rules = settings.rules();
    const Index tile_count = tiles(s).count();
    fetch_weights(s.contact_weight.view());
    for_each_counted(exec, contact_count(s), mass_splitting(s, settings));
    fill_blocks(exec, s, own_, tile_count);
    s.momentum.write(0, first_momentum(rules));
    own_.motor_before.upload(s.mechanisms.motor_impulse.download());
    begin_bodies(exec, s);
    given_.assign(parts(), {});
    gather(exec, s, true);
    for (Index k = 0; !s.momentum.read(0).done; ++k) {
      if (s.momentum.read(0).begins) advance_tiles(exec, s, own_, tile_count, k & 1, settings);
      s.turning ? update<true>(exec, s, tile_count, k & 1) : update<false>(exec, s, tile_count, k & 1);
      for_each_index(exec, s.mechanisms.motor.size(), motor_update(s, own_.motor_before.view(), settings));
      gather(exec, s, false);
      if (s.momentum.read(0).ends) carry_bodies(exec, s);
      decide(s, rules);
    }
    measure(exec, s, tile_count, settings);
  }

 private:
  std::size_t parts() const { return std::size_t(ranks_.count()); }
  std::size_t me() const { return std::size_t(ranks_.rank()); }
  const TileCut& own_cut() const { return contacts_->cut[me()]; }

  /// Those of halo bodies, whose contacts are not all here.
  void fetch_weights(View<Index> weight) {
    std::vector<std::vector<Index>> to(parts()), from(parts());
    std::vector<Letter> sent, received;
    for (std::size_t p = 0; p < parts(); ++p) {
      if (p == me()) continue;
      for (const BodyIndex b : part_.sent[p]) to[p].push_back(weight[b]);
      from[p].resize(part_.received[p].size());
      sent.push_back(letter(int(p), to[p]));
      received.push_back(letter(int(p), from[p]));
    }
    ranks_.exchange(sent, received);
    for (std::size_t p = 0; p < parts(); ++p)
      for (std::size_t k = 0; k < from[p].size(); ++k) weight[part_.received[p][k]] = from[p][k];
  }

  template <bool turning>
  void update(Cpu exec, State<Cpu>& s, Index tile_count, Index parity) {
    std::vector<UpdateSums> head(std::size_t(own_cut().head)), tail(std::size_t(own_cut().tail));
    const UpdateTile<turning> update{.tiles = tiles(s),
                                     .block = own_.block.view(),
                                     .velocity = s.extrapolated_velocity.view(),
                                     .momentum = s.momentum.view(),
                                     .wrench_a = own_.wrench_a.view(),
                                     .wrench_b = own_.wrench_b.view(),
                                     .sums = own_.tile_sums.view(),
                                     .parity = parity};
    const View<UpdateSums> head_view{head.data(), Index(head.size())}, tail_view{tail.data(), Index(tail.size())};
    for_each_index(exec, tile_count,
                   UpdatePart<turning>{update, contacts_->head_tile(), contacts_->tail_tile(), head_view, tail_view},
                   kTilesInParallel);
    const UpdateSums* whole = own_.tile_sums.data() + contacts_->tiles.first_whole();
    head.insert(head.end(), whole, whole + own_cut().whole);
    head.insert(head.end(), tail.begin(), tail.end());
    for (std::size_t p = 0; p < given_.size(); ++p) given_[p].resize(std::size_t(contacts_->cut[p].entries()));
    given_[me()] = std::move(head);
  }

  /// Velocities after an update, with the parts' sums under way at the same time.
  void gather(Cpu exec, State<Cpu>& s, bool first) {
    const GatherVelocity gather = velocity_gathering(s, own_, first);
    const View<const std::uint8_t> is_shared{part_.is_shared.data(), Index(part_.is_shared.size())};
    for_each_index(exec, part_.own_count(), FromIndex<GatherOwn>{{gather, is_shared}, part_.own_begin});
    exchange(s, first);
    move_shared(gather);
    project_mechanisms(exec, s, first, false);
  }

  void exchange(State<Cpu>& s, bool first) {
    wrench_.resize(parts());
    to_.resize(parts());
    from_.resize(parts());
    wrench_[me()] = own_wrenches();
    const View<Velocity> velocity = s.velocity.view(), ahead = s.extrapolated_velocity.view();
    std::vector<Letter> sent, received;
    for (std::size_t p = 0; p < parts(); ++p) {
      if (p == me()) continue;
      wrench_[p].resize(std::size_t(contacts_->wrenches_of(p)));
      to_[p].clear();
      for (const BodyIndex b : part_.sent[p]) to_[p].push_back(velocity[b]);
      from_[p].resize(part_.received[p].size());
      for (const Letter& l : {letter(int(p), given_[me()]), letter(int(p), wrench_[me()]), letter(int(p), to_[p])})
        sent.push_back(l);
      for (const Letter& l : {letter(int(p), given_[p]), letter(int(p), wrench_[p]), letter(int(p), from_[p])})
        received.push_back(l);
    }
    ranks_.exchange(sent, received);
    const Real beta = s.momentum.read(0).next_beta;
    for (std::size_t p = 0; p < parts(); ++p)
      for (std::size_t k = 0; k < part_.received[p].size(); ++k) {
        const BodyIndex b = part_.received[p][k];
        const Velocity next = from_[p][k];
        ahead[b] = first ? next : extrapolated(next, velocity[b], beta);
        velocity[b] = next;
      }
  }

  /// Of the shared bodies in turn: those of contacts that they own, then of those where they are body b.
  std::vector<Wrench> own_wrenches() {
    std::vector<Wrench> list;
    for (const SharedContacts& of : contacts_->shared) {
      const Wrench *a = own_.wrench_a.data(), *b = own_.wrench_b.data();
      list.insert(list.end(), a + of.owned.begin, a + of.owned.end);
      list.insert(list.end(), b + of.second.begin, b + of.second.end);
    }
    return list;
  }

  /// Adds the wrenches in the order of the world's contacts: part by part, the owned ones first.
  void move_shared(const GatherVelocity& gather) const {
    std::vector<std::size_t> next(parts());
    const auto add = [&](std::size_t p, std::size_t from, Index count, Pack& sum) {
      for (Index n = 0; n < count; ++n)
        sum += *reinterpret_cast<const PackInMemory*>(&wrench_[p][from + std::size_t(n)]);
    };
    for (std::size_t k = 0; k < part_.moving_shared.size(); ++k) {
      Pack sum{};
      for (std::size_t p = 0; p < parts(); ++p) add(p, next[p], contacts_->owned_of(p, k), sum);
      for (std::size_t p = 0; p < parts(); ++p) {
        add(p, next[p] + std::size_t(contacts_->owned_of(p, k)), contacts_->second_of(p, k), sum);
        next[p] += std::size_t(contacts_->owned_of(p, k) + contacts_->second_of(p, k));
      }
      gather.move(part_.moving_shared[k], sum);
    }
  }

  void decide(State<Cpu>& s, const IterationRules& rules) {
    const UpdateSums sums =
        sum_of_parts(contacts_->cut, given_, sums_of_tile, [](UpdateSums& total, const UpdateSums& tile) {
          total.uphill += tile.uphill;
          total.residual_square += tile.residual_square;
        });
    Momentum m = s.momentum.read(0);
    decide_next_update(m, sums, Index(contacts_->total), rules);
    s.momentum.write(0, m);
  }

  void measure(Cpu exec, State<Cpu>& s, Index tile_count, const StepSettings& settings) {
    const View<Impulse> impulse = s.store[s.parity].impulse.view();
    for_each_index(exec, tile_count,
                   StoreTile{tiles(s), own_.block.view(), s.momentum.view(), impulse, s.contact.view()},
                   kTilesInParallel);
    const MeasureTile measure{tiles(s), s.contact.view(),          s.velocity.view(),
                              impulse,  own_.tile_measures.view(), settings.target};
    for_each_index(exec, tile_count, measure, kTilesInParallel);
    std::vector<WorldSums> list;
    const auto add_contacts = [&](ContactIndex begin, ContactIndex end) {
      for (ContactIndex i = begin; i < end; ++i) list.emplace_back().residual_max = measure.residual(i);
    };
    const ContactRange own = contacts_->own;
    add_contacts(own.begin, own.begin + own_cut().head);
    const WorldSums* whole = own_.tile_measures.data() + contacts_->tiles.first_whole();
    list.insert(list.end(), whole, whole + own_cut().whole);
    add_contacts(own.end - own_cut().tail, own.end);
    std::vector<std::vector<WorldSums>> all(parts());
    for (std::size_t p = 0; p < all.size(); ++p) all[p].resize(std::size_t(contacts_->cut[p].entries()));
    share(ranks_, std::move(list), all);
    WorldSums total =
        sum_of_parts(contacts_->cut, all, measures_of_tile, [](WorldSums& a, const WorldSums& b) { a += b; });
    add_energies(s, total);
    total.contact_count = Index(contacts_->total);
    total.iterations = s.momentum.read(0).updates;
    s.world_sums.write(0, total);
  }

  /// Adds the energies of all bodies in their order: each part adds its own to the sum of those before.
  void add_energies(State<Cpu>& s, WorldSums& total) {
    std::vector<WorldSums> sum{total};
    const int last = ranks_.count() - 1, rank = ranks_.rank();
    if (rank > 0) ranks_.exchange({}, std::vector<Letter>{letter(rank - 1, sum)});
    const View<const BodyMass> mass = s.mass.view();
    const View<const Quat> orientation = s.orientation.view();
    const View<const Velocity> velocity = s.velocity.view();
    const Vec3 gravity = s.world.view()[0].gravity;
    for (BodyIndex b = part_.own_begin; b < part_.own_end; ++b)
      sum[0] += energy_of_body(mass[b], orientation[b], velocity[b], gravity);
    if (rank < last) {
      ranks_.exchange(std::vector<Letter>{letter(rank + 1, sum)}, {});
      ranks_.exchange({}, std::vector<Letter>{letter(last, sum)});
    } else {
      std::vector<Letter> to_all;
      for (int r = 0; r < last; ++r) to_all.push_back(letter(r, sum));
      ranks_.exchange(to_all, {});
    }
    total = sum[0];
  }

  Ranks& ranks_;
  const Part& part_;
  const PartContacts* contacts_ = nullptr;      // of the present step
  std::vector<std::vector<UpdateSums>> given_;  // [part] of the present update
  std::vector<std::vector<Wrench>> wrench_;     // [part] on shared bodies
  std::vector<std::vector<Velocity>> to_, from_;
  SolverStorage<Cpu> own_;
};

}  // namespace gonogo::sim
