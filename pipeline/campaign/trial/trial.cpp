#include "pipeline/campaign/trial/trial.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <set>
#include <thread>

#include "base/error.h"
#include "base/format.h"
#include "base/progress.h"
#include "pipeline/campaign/trial/trial_run.h"
#include "sim/io/part_files.h"

namespace gonogo::campaign {
namespace {

/// Beds that the points need and the folder lacks.
std::vector<terrain::BedSpec> missing_beds(const TrialSetup& setup, std::span<const DesignPoint> points) {
  std::vector<terrain::BedSpec> missing;
  std::set<std::string> known;
  for (const DesignPoint& point : points) {
    const terrain::BedSpec spec = bed_spec_of(setup, inputs_of(point));
    if (known.insert(spec.hash()).second && !std::filesystem::exists(terrain::packing_path(spec, setup.packing_folder)))
      missing.push_back(spec);
  }
  return missing;
}

/// On a GPU all at once, in one batch of worlds.
void settle_on_device(const std::vector<terrain::BedSpec>& missing, const TrialSetup& setup, int threads) {
  Progress progress("beds", "packings", missing.size());
  const auto told = [&](std::size_t at_rest) { progress.update(at_rest, "at rest, on the GPU"); };
  for (const terrain::Packing& packing : terrain::settle_packings(missing, threads, told))
    terrain::write_packing(terrain::packing_path(packing.spec, setup.packing_folder), packing);
}

/// On the host's cores side by side; each is kept as soon as it rests.
void settle_on_host(const std::vector<terrain::BedSpec>& missing, const TrialSetup& setup, int threads) {
  Progress progress("beds", "packings", missing.size());
  const std::size_t at_once = std::min<std::size_t>(missing.size(), std::size_t(std::max(1, threads)));
  const int threads_of_each = std::max(1, threads / int(at_once));
  std::atomic<std::size_t> next{0}, done{0};
  std::string failure;
  std::mutex one_at_a_time;
  const auto settle_some = [&] {
    for (std::size_t k = next++; k < missing.size() && !cancel_requested(); k = next++) try {
        const terrain::Packing packing = terrain::settle_packing(missing[k], threads_of_each);
        const std::lock_guard lock(one_at_a_time);
        terrain::write_packing(terrain::packing_path(missing[k], setup.packing_folder), packing);
        progress.update(++done);
      } catch (const std::exception& e) {
        const std::lock_guard lock(one_at_a_time);
        failure = e.what();
      }
  };
  std::vector<std::jthread> settling(at_once);
  for (std::jthread& t : settling) t = std::jthread(settle_some);
  settling.clear();
  stop_if_cancelled();
  if (!failure.empty()) throw DeviceError(failure);
}

/// Simulated time between two looks of the host at running trials [s]. Results do not depend on it.
constexpr double kLookEvery = 0.05;

constexpr std::uint64_t kAttempts[] = {1, 2};

/// Second attempts begin when so large a share of the places waits for them: a few worlds take a GPU as long as many
/// do, and twice the steps.
constexpr int kGathered = 4;

}  // namespace

void prepare_trials(const TrialSetup& setup, std::span<const DesignPoint> points, int threads) {
  const std::vector<terrain::BedSpec> missing = missing_beds(setup, points);
  if (missing.empty()) return;
  if (setup.settled_on == sim::Backend::cuda)
    settle_on_device(missing, setup, threads);
  else
    settle_on_host(missing, setup, threads);
}

TrialRecord run_trial(const TrialSetup& setup, const DesignPoint& point, const TrialWatch& watch,
                      const TrialCheckpoint& checkpoint, const TrialDevice& device) {
  TrialBatch batch(setup, {device.backend, 1, device.threads, device.gpus});
  batch.start(point, watch, checkpoint);
  std::vector<TrialRecord> ended;
  try {
    while (ended.empty()) ended = batch.advance();
  } catch (const DeviceError& error) {
    if (checkpoint.path.empty() || !std::filesystem::exists(checkpoint.path)) throw;
    throw DeviceError(std::string(error.what()) + "; the last checkpoint is " + checkpoint.path.string() +
                      ", from which the same command goes on, with fewer GPUs too");
  }
  if (!checkpoint.path.empty()) {
    std::filesystem::remove(checkpoint.path);
    sim::remove_parts_but({}, checkpoint.path);
  }
  return ended.front();
}

int gpus_left(int asked, int present, const TrialCheckpoint& checkpoint) {
  if (asked <= present || present < 1 || checkpoint.path.empty() || !std::filesystem::exists(checkpoint.path))
    return asked;
  log_line("trial", line("%d of %d GPUs are left; it goes on over those, with the same bits", present, asked));
  return present;
}

bool same_steps(const TrialSetup& a, const TrialSetup& b) {
  return a.calibration.grain_diameter == b.calibration.grain_diameter && a.numerics == b.numerics;
}

/// Places of one attempt: all worlds of a batch take the same steps.
struct TrialBatch::AttemptPlaces {
  Places places;
  Index look_every;  // steps
};

TrialBatch::TrialBatch(const TrialSetup& setup, const BatchSettings& settings) : setup_(setup), settings_(settings) {
  if (settings.places < 1) throw InputError("a batch needs at least one place");
  if (settings.gpus > 1 && settings.places > 1)
    throw InputError("several trials at a time run on one GPU each; divide one trial over GPUs, or none");
}

TrialBatch::~TrialBatch() = default;

/// How many begin together.
int TrialBatch::second_attempts() const { return std::max(1, settings_.places / kGathered); }

/// Second attempts are rare: their places are made when they are needed.
TrialBatch::AttemptPlaces& TrialBatch::places_of(std::uint64_t attempt) {
  std::unique_ptr<AttemptPlaces>& own = places_[attempt - 1];
  if (!own) {
    const Index look_every = std::max<Index>(1, Index(std::lround(kLookEvery / attempt_step(setup_, attempt))));
    const sim::StepSettings settings = attempt_settings(setup_, attempt);
    const int count = attempt == 1 ? settings_.places : second_attempts();
    own = std::make_unique<AttemptPlaces>(
        AttemptPlaces{Places(settings_.backend, settings, settings_.threads, count, settings_.gpus), look_every});
  }
  return *own;
}

void TrialBatch::start(const DesignPoint& point, const TrialWatch& watch, const TrialCheckpoint& checkpoint) {
  start(setup_, point, watch, checkpoint);
}

void TrialBatch::start(const TrialSetup& setup, const DesignPoint& point, const TrialWatch& watch,
                       const TrialCheckpoint& checkpoint) {
  if (free_places() < 1) throw InputError("the batch has no free place");
  if (!same_steps(setup, setup_)) throw InputError("trials of one batch need the same grains, step and iterations");
  auto trial = std::make_unique<TrialRun>(setup, point, watch, checkpoint);
  trial->enter(places_of(trial->attempt()).places);
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
    if (!trial->in_place()) trial->enter(places_of(trial->attempt()).places);
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
  AttemptPlaces& own = places_of(attempt);
  Index steps = own.look_every;
  for (const TrialRun* trial : trials) steps = std::min(steps, trial->due());
  own.places.simulation().advance(steps);
  const std::vector<sim::WorldStop> stops = own.places.simulation().stops();
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
