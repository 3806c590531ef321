#include "pipeline/campaign/trial/batch.h"

#include <algorithm>
#include <cmath>

#include "base/cancel.h"
#include "base/error.h"

namespace gonogo::campaign {
namespace {

/// Simulated time between two looks of the host at running trials [s]. Results do not depend on it.
constexpr double kLookEvery = 0.05;

constexpr std::uint64_t kAttempts[] = {1, 2};

/// Second attempts begin when so large a share of the places waits for them: a few worlds take a GPU as long as many
/// do, and twice the steps.
constexpr int kGathered = 4;

}  // namespace

bool same_steps(const TrialSetup& a, const TrialSetup& b) {
  return a.calibration.grain_diameter == b.calibration.grain_diameter && a.numerics == b.numerics;
}

TrialBatch::TrialBatch(const TrialSetup& setup, const BatchSettings& settings) : setup_(setup), settings_(settings) {
  if (settings.places < 1) throw InputError("a batch needs at least one place");
}

TrialBatch::~TrialBatch() = default;

/// That begin together.
int TrialBatch::second_attempts() const { return std::max(1, settings_.places / kGathered); }

/// Second attempts are rare: their places are made when they are needed.
TrialBatch::Lane& TrialBatch::lane(std::uint64_t attempt) {
  std::optional<Lane>& lane = lane_[attempt - 1];
  if (!lane) {
    const double step = attempt_numerics(setup_, attempt).step;
    lane.emplace(Lane{Places(settings_.backend, attempt_settings(setup_, attempt), settings_.threads,
                             attempt == 1 ? settings_.places : second_attempts()),
                      std::max<Index>(1, Index(std::lround(kLookEvery / step)))});
  }
  return *lane;
}

void TrialBatch::start(const DesignPoint& point, const TrialWatch& watch, const TrialCheckpoint& checkpoint) {
  start(setup_, point, watch, checkpoint);
}

void TrialBatch::start(const TrialSetup& setup, const DesignPoint& point, const TrialWatch& watch,
                       const TrialCheckpoint& checkpoint) {
  if (free_places() < 1) throw InputError("the batch has no free place");
  if (!same_steps(setup, setup_)) throw InputError("trials of one batch need the same grains, step and iterations");
  auto trial = std::make_unique<TrialRun>(setup, point, watch, checkpoint);
  trial->enter(lane(trial->attempt()).places);
  trial_.push_back(std::move(trial));
}

int TrialBatch::waiting() const {
  return int(std::count_if(trial_.begin(), trial_.end(), [](const auto& trial) { return !trial->in_place(); }));
}

int TrialBatch::in_place(std::uint64_t attempt) const {
  return int(std::count_if(trial_.begin(), trial_.end(),
                           [&](const auto& trial) { return trial->in_place() && trial->attempt() == attempt; }));
}

/// Together, once enough of them wait, or as many as first attempts go on, or others are under way anyway.
void TrialBatch::begin_second_attempts() {
  const int gathered = waiting();
  if (gathered < second_attempts() && gathered < in_place(1) && in_place(2) == 0) return;
  for (auto& trial : trial_)
    if (!trial->in_place()) trial->enter(lane(trial->attempt()).places);
}

std::vector<TrialRecord> TrialBatch::advance() {
  begin_second_attempts();
  for (const std::uint64_t attempt : kAttempts) take_steps(attempt);
  save();
  return collect();
}

/// Trials whose worlds are made. Those that are being made are waited for where there is nothing to step meanwhile.
std::vector<TrialRun*> TrialBatch::ready(std::uint64_t attempt) {
  const bool wait = std::none_of(trial_.begin(), trial_.end(),
                                 [](const auto& trial) { return trial->in_place() && !trial->is_coming(); });
  std::vector<TrialRun*> trials;
  for (const auto& trial : trial_) {
    if (trial->attempt() != attempt || !trial->in_place()) continue;
    trial->arrive(wait);
    if (!trial->is_coming()) trials.push_back(trial.get());
  }
  return trials;
}

void TrialBatch::take_steps(std::uint64_t attempt) {
  const std::vector<TrialRun*> trials = ready(attempt);
  if (trials.empty()) return;
  Lane& lane = this->lane(attempt);
  Index steps = lane.look_every;
  for (const TrialRun* trial : trials) steps = std::min(steps, trial->due());
  lane.places.simulation().advance(steps);
  const std::vector<sim::WorldStop> stops = lane.places.simulation().stops();
  for (TrialRun* trial : trials) trial->look(steps, stops[std::size_t(trial->place())]);
  for (TrialRun* trial : trials) trial->move_on();
}

void TrialBatch::save() {
  const bool cancelled = cancel_requested();
  for (const auto& trial : trial_) {
    if (cancelled) trial->arrive(true);  // a world that is still being made cannot be saved
    trial->save_when_due(cancelled);
  }
  if (cancelled) throw Cancelled();
}

std::vector<TrialRecord> TrialBatch::collect() {
  std::vector<TrialRecord> records;
  for (auto& trial : trial_) {
    if (!trial->over()) continue;
    records.push_back(trial->record());
    trial.reset();
  }
  std::erase(trial_, nullptr);
  return records;
}

}  // namespace gonogo::campaign
