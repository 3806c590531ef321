// One step of a part of a world on the host: the stages of step.h and solve_host.h, with what the parts exchange
// between them. docs/divided.md says what that is and why the bits are those of a world in one piece.
#pragma once
#include "base/ranks/ranks.h"
#include "sim/simulation/parts/part.h"
#include "sim/simulation/parts/tile_cut.h"
#include "sim/simulation/step.h"
#include "sim/solver/host_blocks.h"
#include "sim/solver/solve_host.h"

namespace gonogo::sim {

/// Runs a body of a loop for the indices from `first` on.
template <class Body>
struct FromIndex {
  Body body;
  Index first;
  void operator()(Index k) const { body(first + k); }
};

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

/// Steps a part. Holds what it exchanges, and the lists of the present step.
class PartStepper {
 public:
  PartStepper(Ranks& ranks, const Part& part, const FlatWorld& world) : ranks_(ranks), part_(part) {
    for (BodyIndex b = part_.own_begin; b < part_.own_end; ++b)
      for (ShapeIndex i = world.first_shape[b];
           i < (std::size_t(b) + 1 < world.first_shape.size() ? world.first_shape[b + 1] : Index(world.shape.size()));
           ++i)
        if (world.bin_of_shape[i] >= 0) watched_.push_back(i);
    margin_ = halo_margin(world.world);
  }

  /// One step, apart from the change of parity.
  void step(Cpu exec, State<Cpu>& s, const StepSettings& settings) {
    sort_into_bins(exec, s);
    if (start_.empty()) start_ = watched_centres(s);
    find_contacts(exec, s, settings);
    build_incidence(exec, s);
    count_contacts(s);
    cut_tiles(s);
    share_weights(s);
    prepare_motion(exec, s, settings);
    apply_forces(exec, s, settings);
    solve(exec, s, settings);
    integrate(exec, s, settings);
  }

  /// A shape has moved so far that the halo may be incomplete. The same in all parts.
  bool halo_is_stale() const { return stale_; }

  /// Contacts that shapes of own bodies found; number of the world's contacts before them, and of all.
  ContactRange own_contacts() const { return own_; }
  std::int64_t contacts_before() const { return before_; }
  std::int64_t contacts_of_world() const { return total_; }

 private:
  std::size_t me() const { return std::size_t(ranks_.rank()); }

  std::vector<Vec3d> watched_centres(State<Cpu>& s) const {
    std::vector<Vec3d> centre;
    for (const ShapeIndex i : watched_) centre.push_back(s.centre.read(i));
    return centre;
  }

  /// Counts the contacts of all parts, and the wrenches that each gives for the shared bodies.
  void count_contacts(State<Cpu>& s) {
    const Incidence in = incidence(s);
    own_ = {in.first_contact[first_shape(s, part_.own_begin)], in.first_contact[first_shape(s, part_.own_end)]};
    owned_.clear();
    second_.clear();
    std::vector<Index> counts{own_.end - own_.begin};
    for (const BodyIndex b : part_.moving_shared) {
      owned_.push_back(within_own(in.owned_begin(b), in.owned_end(b)));
      const auto* second = in.second.begin();
      const auto place = [&](ContactIndex i) {
        return Index(std::lower_bound(second + in.first_second[b], second + in.first_second[b + 1], i) - second);
      };
      second_.push_back({place(own_.begin), place(own_.end)});
      counts.push_back(owned_.back().end - owned_.back().begin);
      counts.push_back(second_.back().end - second_.back().begin);
    }
    count_.assign(std::size_t(ranks_.count()), std::vector<Index>(counts.size()));
    share(ranks_, counts, count_);
    cut_.clear();
    before_ = total_ = 0;
    for (std::size_t p = 0; p < count_.size(); ++p) {
      if (p == me()) before_ = total_;
      cut_.push_back(tile_cut(total_, count_[p][0]));
      total_ += count_[p][0];
    }
  }

  static ShapeIndex first_shape(State<Cpu>& s, BodyIndex b) { return s.first_shape.view()[b]; }

  ContactRange within_own(ContactIndex begin, ContactIndex end) const {
    begin = std::clamp(begin, own_.begin, own_.end);
    return {begin, std::clamp(end, begin, own_.end)};
  }

  /// Tiles of the contacts that earlier bodies found, of the own ones as the world cuts them, and of later ones.
  void cut_tiles(State<Cpu>& s) {
    const Index all = *contact_count(s).count;
    std::vector<Tile> tile;
    const auto cut = [&](ContactIndex begin, ContactIndex end) {
      for (; begin < end; begin += kTileSize) tile.push_back({{begin, std::min(begin + kTileSize, end)}, 0, 0});
    };
    cut(0, own_.begin);
    const TileCut& own = cut_[me()];
    first_tile_ = Index(tile.size());
    cut(own_.begin, own_.begin + own.head);
    cut(own_.begin + own.head, own_.end);
    cut(own_.end, all);
    GONOGO_ASSERT(Index(tile.size()) <= tile_capacity(s));
    s.tile.write(0, tile);
    s.first_tile.write(0, std::vector<Index>{0, Index(tile.size())});
  }

  Index head_tile() const { return cut_[me()].head > 0 ? first_tile_ : -1; }
  Index first_whole() const { return first_tile_ + (cut_[me()].head > 0 ? 1 : 0); }
  Index tail_tile() const { return cut_[me()].tail > 0 ? first_whole() + cut_[me()].whole : -1; }

  /// Sums over the contacts of a body count those of all parts.
  void share_weights(State<Cpu>& s) {
    const View<Index> weight = s.contact_weight.view();
    std::vector<Index> of_shared;
    for (std::size_t k = 0; k < part_.moving_shared.size(); ++k) of_shared.push_back(own_weight(s, k));
    std::vector<std::vector<Index>> all(count_.size(), std::vector<Index>(of_shared.size()));
    share(ranks_, of_shared, all);
    for (std::size_t k = 0; k < of_shared.size(); ++k) {
      weight[part_.moving_shared[k]] = 0;
      for (const std::vector<Index>& part : all) weight[part_.moving_shared[k]] += part[k];
    }
    exchange_halo<Index>(
        {}, {}, [&](BodyIndex b) { return weight[b]; }, [&](BodyIndex b, Index now) { weight[b] = now; });
  }

  Index own_weight(State<Cpu>& s, std::size_t k) const {
    const View<const Contact> contact = s.contact.view();
    const View<const Impulse> start = s.store[s.parity].impulse.view();
    const View<const Index> second = s.second_contact.view();
    Index sum = 0;
    for (ContactIndex i = owned_[k].begin; i < owned_[k].end; ++i) sum += contact_weight(contact[i], start[i]);
    for (Index n = second_[k].begin; n < second_[k].end; ++n)
      sum += contact_weight(contact[second[n]], start[second[n]]);
    return sum;
  }

  /// Sends a number of each own body to the parts that hold copies of it, after the given letters.
  template <class T, class Get, class Set>
  void exchange_halo(std::vector<Letter> sent, std::vector<Letter> received, const Get& get, const Set& set) {
    std::vector<std::vector<T>> to(count_.size()), from(count_.size());
    for (std::size_t q = 0; q < count_.size(); ++q) {
      for (const BodyIndex b : part_.sent[q]) to[q].push_back(get(b));
      from[q].resize(part_.received[q].size());
      if (!to[q].empty()) sent.push_back(letter(int(q), to[q]));
      if (!from[q].empty()) received.push_back(letter(int(q), from[q]));
    }
    ranks_.exchange(sent, received);
    for (std::size_t q = 0; q < count_.size(); ++q)
      for (std::size_t k = 0; k < from[q].size(); ++k) set(part_.received[q][k], from[q][k]);
  }

  void solve(Cpu exec, State<Cpu>& s, const StepSettings& settings) {
    const IterationRules rules = settings.rules();
    const Index tile_count = tiles(s).count();
    for_each_counted(exec, contact_count(s), mass_splitting(s, settings));
    fill_blocks(exec, s, own_storage_, tile_count);
    s.momentum.write(0, first_momentum(rules));
    own_storage_.motor_before.upload(s.mechanisms.motor_impulse.download());
    begin_bodies(exec, s);
    given_.assign(count_.size(), {});
    gather(exec, s, true);
    for (Index k = 0; !s.momentum.read(0).done; ++k) {
      if (s.momentum.read(0).begins) advance_tiles(exec, s, own_storage_, tile_count, k & 1, settings);
      s.turning ? update<true>(exec, s, tile_count, k & 1) : update<false>(exec, s, tile_count, k & 1);
      for_each_index(exec, s.mechanisms.motor.size(), motor_update(s, own_storage_.motor_before.view(), settings));
      gather(exec, s, false);
      if (s.momentum.read(0).ends) carry_bodies(exec, s);
      decide(s, rules);
    }
    measure(exec, s, tile_count, settings);
  }

  template <bool turning>
  void update(Cpu exec, State<Cpu>& s, Index tile_count, Index parity) {
    std::vector<UpdateSums> head(std::size_t(cut_[me()].head)), tail(std::size_t(cut_[me()].tail));
    const UpdateTile<turning> update{.tiles = tiles(s),
                                     .block = own_storage_.block.view(),
                                     .velocity = s.extrapolated_velocity.view(),
                                     .momentum = s.momentum.view(),
                                     .wrench_a = own_storage_.wrench_a.view(),
                                     .wrench_b = own_storage_.wrench_b.view(),
                                     .sums = own_storage_.tile_sums.view(),
                                     .parity = parity};
    for_each_index(
        exec, tile_count,
        UpdatePart<turning>{
            update, head_tile(), tail_tile(), {head.data(), Index(head.size())}, {tail.data(), Index(tail.size())}},
        kTilesInParallel);
    const UpdateSums* whole = own_storage_.tile_sums.data() + first_whole();
    head.insert(head.end(), whole, whole + cut_[me()].whole);
    head.insert(head.end(), tail.begin(), tail.end());
    for (std::size_t p = 0; p < given_.size(); ++p) given_[p].resize(std::size_t(cut_[p].entries()));
    given_[me()] = std::move(head);
  }

  /// Velocities after an update, with the parts' sums under way at the same time.
  void gather(Cpu exec, State<Cpu>& s, bool first) {
    const GatherVelocity gather = velocity_gathering(s, own_storage_, first);
    const View<const std::uint8_t> is_shared{part_.is_shared.data(), Index(part_.is_shared.size())};
    for_each_index(exec, part_.own_count(), FromIndex<GatherOwn>{{gather, is_shared}, part_.own_begin});
    wrench_.resize(count_.size());
    for (std::size_t p = 0; p < count_.size(); ++p) wrench_[p].resize(wrenches_of(p));
    wrench_[me()] = own_wrenches();
    std::vector<Letter> sent, received;
    for (std::size_t p = 0; p < count_.size(); ++p) {
      if (p == me()) continue;
      for (Letter part : {letter(int(p), given_[me()]), letter(int(p), wrench_[me()])}) sent.push_back(part);
      for (Letter part : {letter(int(p), given_[p]), letter(int(p), wrench_[p])}) received.push_back(part);
    }
    const View<Velocity> velocity = s.velocity.view(), ahead = s.extrapolated_velocity.view();
    const Real beta = s.momentum.read(0).next_beta;
    exchange_halo<Velocity>(
        std::move(sent), std::move(received), [&](BodyIndex b) { return velocity[b]; },
        [&](BodyIndex b, const Velocity& next) {
          ahead[b] = first ? next : extrapolated(next, velocity[b], beta);
          velocity[b] = next;
        });
    move_shared(gather);
    project_mechanisms(exec, s, first, false);
  }

  std::size_t wrenches_of(std::size_t p) const {
    Index sum = 0;
    for (std::size_t n = 1; n < count_[p].size(); ++n) sum += count_[p][n];
    return std::size_t(sum);
  }

  /// Of the shared bodies in turn: those of contacts that they own, then of those where they are body b.
  std::vector<Wrench> own_wrenches() {
    std::vector<Wrench> list;
    for (std::size_t k = 0; k < owned_.size(); ++k) {
      const Wrench *a = own_storage_.wrench_a.data(), *b = own_storage_.wrench_b.data();
      list.insert(list.end(), a + owned_[k].begin, a + owned_[k].end);
      list.insert(list.end(), b + second_[k].begin, b + second_[k].end);
    }
    return list;
  }

  /// Adds the wrenches in the order of the world's contacts: part by part, the owned ones first.
  void move_shared(const GatherVelocity& gather) const {
    std::vector<std::size_t> next(count_.size());
    for (std::size_t k = 0; k < part_.moving_shared.size(); ++k) {
      Pack sum{};
      for (const std::size_t side : {2 * k + 1, 2 * k + 2})
        for (std::size_t p = 0; p < count_.size(); ++p) {
          const std::size_t from = next[p] + (side == 2 * k + 2 ? std::size_t(count_[p][2 * k + 1]) : 0);
          for (Index n = 0; n < count_[p][side]; ++n)
            sum += *reinterpret_cast<const PackInMemory*>(&wrench_[p][from + std::size_t(n)]);
        }
      for (std::size_t p = 0; p < count_.size(); ++p)
        next[p] += std::size_t(count_[p][2 * k + 1] + count_[p][2 * k + 2]);
      gather.move(part_.moving_shared[k], sum);
    }
  }

  void decide(State<Cpu>& s, const IterationRules& rules) {
    const UpdateSums sums = sum_of_parts(cut_, given_, sums_of_tile, [](UpdateSums& total, const UpdateSums& tile) {
      total.uphill += tile.uphill;
      total.residual_square += tile.residual_square;
    });
    Momentum m = s.momentum.read(0);
    decide_next_update(m, sums, Index(total_), rules);
    s.momentum.write(0, m);
  }

  void measure(Cpu exec, State<Cpu>& s, Index tile_count, const StepSettings& settings) {
    const View<Impulse> impulse = s.store[s.parity].impulse.view();
    for_each_index(exec, tile_count, StoreImpulses{tiles(s), own_storage_.block.view(), s.momentum.view(), impulse},
                   kTilesInParallel);
    const MeasureTile measure{
        tiles(s), s.contact.view(), s.velocity.view(), impulse, own_storage_.tile_measures.view(), settings.target};
    for_each_index(exec, tile_count, measure, kTilesInParallel);
    const TileCut& own = cut_[me()];
    std::vector<WorldSums> list;
    const auto add_contacts = [&](ContactIndex begin, ContactIndex end) {
      for (ContactIndex i = begin; i < end; ++i) list.emplace_back().residual_max = measure.residual(i);
    };
    add_contacts(own_.begin, own_.begin + own.head);
    const WorldSums* whole = own_storage_.tile_measures.data() + first_whole();
    list.insert(list.end(), whole, whole + own.whole);
    add_contacts(own_.end - own.tail, own_.end);
    std::vector<std::vector<WorldSums>> all(count_.size());
    for (std::size_t p = 0; p < all.size(); ++p) all[p].resize(std::size_t(cut_[p].entries()));
    share(ranks_, std::move(list), all);
    WorldSums total = sum_of_parts(cut_, all, measures_of_tile, [](WorldSums& a, const WorldSums& b) { a += b; });
    add_energies(s, total);
    total.contact_count = Index(total_);
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

  /// What happens to a halo or shared body is counted by the part that owns it.
  void integrate(Cpu exec, State<Cpu>& s, const StepSettings& settings) {
    Integrate move{.world = s.world.view(),
                   .world_of_body = s.world_of_body.view(),
                   .mass = s.mass.view(),
                   .velocity = s.velocity.view(),
                   .earlier_velocity = s.earlier_velocity.view(),
                   .position = s.position.view(),
                   .orientation = s.orientation.view(),
                   .steps = s.steps.view(),
                   .slowed = s.slowed.view(),
                   .slowed_now = s.slowed_now.view(),
                   .flags = s.flags.view(),
                   .fault = s.fault.view(),
                   .settings = settings};
    for_each_index(exec, part_.own_count(), FromIndex<Integrate>{move, part_.own_begin});
    Index uncounted[2] = {0, 0};
    PackedFault unknown = kNoFault;
    move.slowed_now = {&uncounted[0], 1};
    move.flags = {&uncounted[1], 1};
    move.fault = {&unknown, 1};
    for_each_index(exec, part_.own_begin, move);
    for_each_index(exec, s.body_count - part_.own_end, FromIndex<Integrate>{move, part_.own_end});
    share_events(s);
    finish_step(exec, s, settings);
  }

  void share_events(State<Cpu>& s) {
    std::vector<std::vector<Index>> all(count_.size(), std::vector<Index>(3));
    share(ranks_, {s.flags.read(0), s.slowed_now.read(0), has_moved_far(s) ? 1 : 0}, all);
    Index flags = 0, slowed = 0;
    for (const std::vector<Index>& part : all) {
      flags |= part[0];
      slowed += part[1];
      stale_ = stale_ || part[2] != 0;
    }
    s.flags.write(0, flags);
    s.slowed_now.write(0, slowed);
  }

  bool has_moved_far(State<Cpu>& s) const {
    const View<const Shape> shape = s.shape.view();
    const Vec3d period = s.world.view()[0].period;
    for (std::size_t k = 0; k < watched_.size(); ++k) {
      const Shape& own = shape[watched_[k]];
      const Vec3d centre =
          s.position.view()[own.body] + static_cast<Vec3d>(rotate(s.orientation.view()[own.body], own.offset_B));
      const Vec3d moved = nearest_image(centre - start_[k], period);
      if (!(dot(moved, moved) <= margin_ * margin_)) return true;
    }
    return false;
  }

  Ranks& ranks_;
  const Part& part_;
  std::vector<ShapeIndex> watched_;  // binned shapes of own bodies
  std::vector<Vec3d> start_;         // [watched] where they were when the halo was found
  double margin_ = 0;
  bool stale_ = false;

  ContactRange own_{0, 0};
  std::int64_t before_ = 0, total_ = 0;
  std::vector<ContactRange> owned_, second_;    // [moving shared] own contacts; places in the list of second contacts
  std::vector<std::vector<Index>> count_;       // [part] own contacts, then both lists of each moving shared body
  std::vector<TileCut> cut_;                    // [part]
  Index first_tile_ = 0;                        // of the own contacts
  std::vector<std::vector<UpdateSums>> given_;  // [part] of the present update
  std::vector<std::vector<Wrench>> wrench_;     // [part] on shared bodies
  SolverStorage<Cpu> own_storage_;
};

}  // namespace gonogo::sim
