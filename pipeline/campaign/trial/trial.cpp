#include "pipeline/campaign/trial/trial.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <set>
#include <thread>

#include "base/cancel.h"
#include "base/error.h"
#include "base/progress.h"
#include "pipeline/campaign/trial/batch.h"

namespace gonogo::campaign {

namespace {

/// Beds that the points need and the folder lacks.
std::vector<terrain::BedSpec> missing_beds(const TrialSetup& setup, std::span<const DesignPoint> points) {
  std::vector<terrain::BedSpec> missing;
  std::set<std::string> known;
  for (const DesignPoint& point : points) {
    const terrain::BedSpec spec = bed_spec_of(setup, point);
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

}  // namespace

void prepare_trials(const TrialSetup& setup, std::span<const DesignPoint> points, int threads) {
  const std::vector<terrain::BedSpec> missing = missing_beds(setup, points);
  if (missing.empty()) return;
  if (setup.settled_on == sim::Backend::cuda)
    settle_on_device(missing, setup, threads);
  else
    settle_on_host(missing, setup, threads);
}

TrialRecord run_trial(const TrialSetup& setup, const DesignPoint& point) {
  return run_trial(setup, point, TrialWatch{});
}

TrialRecord run_trial(const TrialSetup& setup, const DesignPoint& point, const TrialWatch& watch,
                      const TrialCheckpoint& checkpoint, const TrialDevice& device) {
  TrialBatch batch(setup, {device.backend, 1, device.threads});
  batch.start(point, watch, checkpoint);
  std::vector<TrialRecord> ended;
  while (ended.empty()) ended = batch.advance();
  if (!checkpoint.path.empty()) std::filesystem::remove(checkpoint.path);
  return ended.front();
}

}  // namespace gonogo::campaign
