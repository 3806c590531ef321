#include "pipeline/trial/trial.h"

#include <algorithm>
#include <mutex>
#include <set>

#include "base/cancel.h"
#include "base/error.h"
#include "base/progress.h"
#include "pipeline/trial/batch.h"

namespace gonogo::pipeline {

void prepare_trials(const TrialSetup& setup, std::span<const DesignPoint> points, int threads) {
  std::vector<terrain::BedSpec> missing;
  std::set<std::string> known;
  for (const DesignPoint& point : points) {
    const terrain::BedSpec spec = bed_spec_of(setup, point);
    if (known.insert(spec.hash()).second && !std::filesystem::exists(terrain::packing_path(spec, setup.packing_folder)))
      missing.push_back(spec);
  }
  if (missing.empty()) return;
  Progress progress("beds", "packings", missing.size());
  std::size_t done = 0;
  std::string failure;
  std::mutex one_at_a_time;  // writing may throw, and an exception must not leave an OpenMP critical region
#pragma omp parallel for schedule(dynamic) num_threads(std::max(1, threads))
  for (std::size_t k = 0; k < missing.size(); ++k) {
    if (cancel_requested()) continue;
    try {
      const terrain::Packing packing = terrain::settle_packing(missing[k], 1);
      const std::lock_guard lock(one_at_a_time);
      terrain::write_packing(terrain::packing_path(missing[k], setup.packing_folder), packing);
      progress.update(++done);
    } catch (const std::exception& e) {
      const std::lock_guard lock(one_at_a_time);
      failure = e.what();
    }
  }
  stop_if_cancelled();
  if (!failure.empty()) throw DeviceError(failure);
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

}  // namespace gonogo::pipeline
