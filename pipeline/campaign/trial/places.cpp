#include "pipeline/campaign/trial/places.h"

#include <algorithm>

#include "sim/simulation/parts/divided.h"

namespace gonogo::campaign {
namespace {

/// What is in a place that nobody has. Its law resists rolling, so that every batch solves with rolling, whether or not
/// one of its worlds needs it: GPUs have a kernel of their own for batches without.
std::shared_ptr<const sim::SceneWorld> nobody() {
  static const auto world = [] {
    sim::SceneWorld w = sim::vacant_world();
    w.set_law(0, 0, {0, 1, 0});
    return std::make_shared<const sim::SceneWorld>(w);
  }();
  return world;
}

/// Somewhat more than asked for, so that a batch whose worlds vary is not rebuilt for each that is slightly larger.
sim::WorldSize with_margin(sim::WorldSize size) {
  for (Index* count : {&size.bodies, &size.shapes, &size.bins}) *count += *count / 8;
  return size;
}

}  // namespace

Places::Places(sim::Backend backend, const sim::StepSettings& settings, int threads, int count, int gpus)
    : backend_(backend), settings_(settings), threads_(threads), gpus_(gpus) {
  GONOGO_ASSERT(gpus <= 1 || count == 1);
  rebuild(std::size_t(count));
}

sim::WorldIndex Places::take() {
  auto free = std::find(taken_.begin(), taken_.end(), false);
  const auto place = free - taken_.begin();
  if (free == taken_.end()) rebuild(2 * taken_.size());
  taken_[std::size_t(place)] = true;
  return sim::WorldIndex(place);
}

void Places::release(sim::WorldIndex place) {
  taken_[std::size_t(place)] = false;
  world_[std::size_t(place)] = nobody();
  simulation_->replace(place, *nobody());
}

ReadyWorld Places::ready(sim::WorldIndex place, sim::SceneWorld world) const {
  sim::FlatWorld flat = sim::flatten(world, place, settings_);
  return {std::make_shared<const sim::SceneWorld>(std::move(world)), std::move(flat)};
}

void Places::put(sim::WorldIndex place, ReadyWorld ready, const sim::Snapshot* from) {
  const sim::WorldSize size = ready.flat.size();
  if (sim::larger(room_, size) != room_) {
    room_ = sim::larger(room_, with_margin(size));
    world_[std::size_t(place)] = nobody();  // what was there is not needed any more
    simulation_->replace(place, *nobody());
    rebuild(world_.size());
  }
  world_[std::size_t(place)] = std::move(ready.world);
  simulation_->replace(place, std::move(ready.flat));
  if (from) simulation_->restore(place, *from);
}

int Places::gpus_for_rooms() const {
  if (gpus_ > 0 || backend_ != sim::Backend::cuda || world_.size() > 1) return std::max(1, gpus_);
  return sim::gpus_that_pay(room_.bodies, settings_, sim::linked_gpus());
}

void Places::rebuild(std::size_t count) {
  std::vector<std::optional<sim::Snapshot>> snapshot(count);
  for (std::size_t p = 0; p < world_.size(); ++p)
    if (world_[p] != nobody()) snapshot[p] = simulation_->snapshot(sim::WorldIndex(p));
  world_.resize(count, nobody());
  taken_.resize(count, false);
  simulation_.reset();  // before the new one asks for memory
  sim::Scene scene;
  for (const auto& world : world_) scene.push_back(*world);
  const int gpus = gpus_for_rooms();
  simulation_ = gpus > 1 ? sim::make_team_simulation(backend_, scene.at(0), settings_, gpus)
                         : sim::make_simulation(backend_, scene, settings_, threads_, room_);
  for (std::size_t p = 0; p < count; ++p)
    if (snapshot[p]) simulation_->restore(sim::WorldIndex(p), *snapshot[p]);
}

}  // namespace gonogo::campaign
