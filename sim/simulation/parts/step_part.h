// One step of a part of a world: the stages of step.h, with what the parts exchange between them. docs/divided.md says
// what that is and why the bits are those of a world in one piece.
#pragma once
#include "base/ranks/ranks.h"
#include "sim/simulation/layout/part.h"
#include "sim/simulation/parts/part_lists.h"
#include "sim/simulation/step.h"

namespace gonogo::sim {

/// The iteration of a part. Specialised by solve_part_host.h and solve_part.cuh.
template <class Exec>
class PartSolver;

/// Steps a part; every rank has one and calls it at the same time.
template <class Exec>
class PartStepper {
 public:
  /// `world`: as restricted() gives it.
  PartStepper(Ranks& ranks, const Part& part, const FlatWorld& world)
      : ranks_(ranks), part_(part), solver_(ranks, part, world), margin_(halo_margin(world.world)) {
    std::vector<ShapeIndex> watched;
    for (std::size_t i = 0; i < world.shape.size(); ++i)
      if (const BodyIndex b = world.shape[i].body;
          world.bin_of_shape[i] >= 0 && b >= part.own_begin && b < part.own_end)
        watched.push_back(ShapeIndex(i));
    watched_.upload(watched);
    start_.resize(watched.size());
    shared_.upload(part.moving_shared);
    found_.resize(part.moving_shared.size() + 1);
    moved_.resize(1);
    events_.resize(1);
    uncounted_.resize(2);
    unknown_.resize(1);
    contacts_.me = std::size_t(ranks.rank());
  }

  /// Makes room for the first step, so that too little memory is known before it.
  void reserve(State<Exec>& s, const StepSettings& settings) { solver_.reserve(s, settings); }

  /// One step, apart from the change of parity.
  void step(Exec exec, State<Exec>& s, const StepSettings& settings) {
    sort_into_bins(exec, s);
    if (!started_)
      for_each_index(exec, watched_.size(), PickItem<Vec3d>{watched_.view(), s.centre.view(), start_.view()});
    started_ = true;
    find_all_contacts(exec, s, settings);
    build_incidence(exec, s);
    count_contacts(exec, s);
    cut_tiles(exec, s);
    share_weights(exec, s);
    prepare_motion(exec, s, settings);
    apply_forces(exec, s, settings);
    solver_.solve(exec, s, contacts_, settings);
    integrate(exec, s, settings);
  }

  /// A shape has moved so far that the halo may be incomplete. The same in all parts.
  bool halo_is_stale() const { return stale_; }

  const PartContacts& contacts() const { return contacts_; }

 private:
  /// Again where a GPU's buffers were too small: there the host enlarges them.
  void find_all_contacts(Exec exec, State<Exec>& s, const StepSettings& settings) {
    for (;;) {
      find_contacts(exec, s, settings);
      const Progress progress = s.progress.read(0);
      contacts_.tiles.all = progress.contact_total;
      if (progress.halted == 0) return;
      reserve_contacts(s, roomier(progress.contact_total));
      s.progress.write(0, Progress{0, 0, progress.steps});
    }
  }

  void count_contacts(Exec exec, State<Exec>& s) {
    for_each_index(exec, found_.size(),
                   FindOwnContacts{incidence(s), shared_.view(), part_.own_begin, part_.own_end, found_.view()});
    std::vector<SharedContacts> found = found_.download();
    PartContacts& c = contacts_;
    c.own = found[0].owned;
    c.shared = {found.begin() + 1, found.end()};
    std::vector<Index> counts{c.own.end - c.own.begin};
    for (const SharedContacts& of : c.shared) {
      counts.push_back(of.owned.end - of.owned.begin);
      counts.push_back(of.second.end - of.second.begin);
    }
    c.count.assign(std::size_t(ranks_.count()), std::vector<Index>(counts.size()));
    share(ranks_, counts, c.count);
    c.place_own();
  }

  void cut_tiles(Exec exec, State<Exec>& s) {
    PartTiles& tiles = contacts_.tiles;
    tiles.own = contacts_.own;
    tiles.head = contacts_.cut[contacts_.me].head;
    tiles.tile = s.tile.view();
    GONOGO_ASSERT(tiles.count() <= tile_capacity(s));
    for_each_index(exec, tiles.count(), tiles);
    s.first_tile.write(0, std::vector<Index>{0, tiles.count()});
  }

  /// Weights of shared bodies count the contacts of all parts. The solver fetches those of halo bodies.
  void share_weights(Exec exec, State<Exec>& s) {
    const auto count = std::size_t(shared_.size());
    if (count == 0) return;
    weight_.fill_zero(count);
    for_each_index(exec, shared_.size() * kWeightLanes,
                   WeighShared{found_.view(), s.contact.view(), s.store[s.parity].impulse.view(),
                               s.second_contact.view(), weight_.view()});
    std::vector<std::vector<Index>> all(std::size_t(ranks_.count()), std::vector<Index>(count));
    share(ranks_, weight_.download(), all);
    std::vector<Index> sum(count);
    for (const std::vector<Index>& part : all)
      for (std::size_t k = 0; k < count; ++k) sum[k] += part[k];
    weight_.upload(sum);
    for_each_index(exec, shared_.size(), PutItem<Index>{shared_.view(), weight_.view(), s.contact_weight.view()});
  }

  /// What happens to a halo or shared body is counted by the part that owns it.
  void integrate(Exec exec, State<Exec>& s, const StepSettings& settings) {
    Integrate move = integration(s, settings);
    for_each_index(exec, part_.own_count(), FromIndex<Integrate>{move, part_.own_begin});
    move.slowed_now = {uncounted_.data(), 1};
    move.flags = {uncounted_.data() + 1, 1};
    move.fault = unknown_.view();
    for_each_index(exec, part_.own_begin, move);
    for_each_index(exec, s.body_count - part_.own_end, FromIndex<Integrate>{move, part_.own_end});
    share_events(exec, s);
    finish_step(exec, s, settings);
  }

  void share_events(Exec exec, State<Exec>& s) {
    moved_.fill_zero(1);
    for_each_index(exec, watched_.size(),
                   NoteMoved{.watched = watched_.view(),
                             .start = start_.view(),
                             .shape = s.shape.view(),
                             .position = s.position.view(),
                             .orientation = s.orientation.view(),
                             .world = s.world.view(),
                             .moved = moved_.view(),
                             .margin = margin_});
    for_each_index(exec, 1, CollectEvents{s.flags.view(), s.slowed_now.view(), moved_.view(), events_.view()});
    StepEvents sum;
    std::vector<std::vector<StepEvents>> all(std::size_t(ranks_.count()), std::vector<StepEvents>(1));
    share(ranks_, events_.download(), all);
    for (const std::vector<StepEvents>& part : all) {
      sum.flags |= part[0].flags;
      sum.slowed += part[0].slowed;
      sum.moved |= part[0].moved;
    }
    s.flags.write(0, sum.flags);
    s.slowed_now.write(0, sum.slowed);
    stale_ = stale_ || sum.moved != 0;
  }

  Ranks& ranks_;
  const Part& part_;
  PartSolver<Exec> solver_;
  double margin_;                       // [m]
  Buffer<ShapeIndex, Exec> watched_;    // binned shapes of own bodies
  Buffer<Vec3d, Exec> start_;           // [watched] where they were when the halo was found
  Buffer<BodyIndex, Exec> shared_;      // moving ones
  Buffer<SharedContacts, Exec> found_;  // see FindOwnContacts
  Buffer<Index, Exec> weight_;
  Buffer<Index, Exec> moved_, uncounted_;  // of copies: events that their owners count
  Buffer<PackedFault, Exec> unknown_;
  Buffer<StepEvents, Exec> events_;
  PartContacts contacts_;  // of the latest step
  bool started_ = false, stale_ = false;
};

}  // namespace gonogo::sim
