// The places of a batch of worlds; the batch grows as larger worlds come. The bits of a world depend neither on its
// place, nor on the other worlds, nor on when the batch grew.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "sim/simulation/simulation.h"

namespace gonogo::campaign {

/// A world ready for its place, with its flat form.
struct ReadyWorld {
  std::shared_ptr<const sim::SceneWorld> world;
  sim::FlatWorld flat;
};

class Places {
 public:
  /// Starts with `count` places, all free, too small for any world: the first world that enters sets their size. The
  /// world of a single place may be divided over `gpus`; 0: as many as pay.
  Places(sim::Backend backend, const sim::StepSettings& settings, int threads, int count, int gpus = 1);

  /// A free place; there are more of them afterwards where none was left.
  sim::WorldIndex take();
  /// Frees the place and drops its world.
  void release(sim::WorldIndex place);

  /// Flattens a world on the host. Touches no place, so that any thread may call it. Throws InputError for a world that
  /// cannot run.
  ReadyWorld ready(sim::WorldIndex place, sim::SceneWorld world) const;

  /// Puts a world into a place that was taken; with `from`, as it was when that snapshot was made. May rebuild the
  /// batch: reports, contacts and forces of the other worlds are then zero until their next step. Throws DeviceError
  /// when the device's memory does not suffice.
  void put(sim::WorldIndex place, ReadyWorld ready, const sim::Snapshot* from = nullptr);

  /// Not to be kept over take() and put().
  sim::Simulation& simulation() { return *simulation_; }

 private:
  void rebuild(std::size_t count);
  int gpus_for_rooms() const;

  sim::Backend backend_;
  sim::StepSettings settings_;
  int threads_, gpus_;
  sim::WorldSize room_;
  std::vector<std::shared_ptr<const sim::SceneWorld>> world_;  // [place]; free places share an empty one
  std::vector<bool> taken_;                                    // [place]
  std::unique_ptr<sim::Simulation> simulation_;
};

}  // namespace gonogo::campaign
