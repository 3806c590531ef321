// Trials from design point to verdict: a vehicle on a settled bed under tilted gravity. One alone, or many in a batch.
#pragma once
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "pipeline/campaign/setup/read_setup.h"
#include "pipeline/campaign/trial/watch.h"

namespace gonogo::campaign {

class TrialRun;

/// Settles and stores the packings that trials at these points need, so that workers find them. Safe to repeat.
void prepare_trials(const TrialSetup& setup, std::span<const DesignPoint> points, int threads);

/// Where a trial saves itself while it drives, and how often.
struct TrialCheckpoint {
  std::filesystem::path path;  // empty: nowhere
  double every = 30;           // [s of the wall clock]
  /// Sets a file that cannot be used aside, with a line on stderr, and starts the trial from its beginning.
  bool set_aside = false;
};

/// Where a trial runs. On one backend its bits do not depend on the number of threads.
struct TrialDevice {
  sim::Backend backend = sim::Backend::cpu;
  int threads = 1;  // of the cpu backend
  int gpus = 1;     // over which its world is divided; 0: as many as pay
};

/// Runs one trial, watched and saved. Pure: depends on setup and point alone. A simulation that fails a check is
/// repeated once with half the step; failing again it is `unknown`, never `no_go`. Where `checkpoint` finds a file, the
/// trial goes on from there to the same record. The file is removed at the end. Ctrl-C saves and throws Cancelled.
/// Throws InputError for bad input, missing packings and a file of another trial.
TrialRecord run_trial(const TrialSetup& setup, const DesignPoint& point, const TrialWatch& watch = {},
                      const TrialCheckpoint& checkpoint = {}, const TrialDevice& device = {});

/// GPUs for a trial that asks for some: where it was saved, those that are left will do.
int gpus_left(int asked, int present, const TrialCheckpoint& checkpoint);

struct BatchSettings {
  sim::Backend backend = sim::Backend::cpu;
  int places = 1;   // trials at a time
  int threads = 1;  // of the cpu backend
  int gpus = 1;     // over which the world of one place is divided; 0: as many as pay
};

/// Whether trials of both may stand in one batch: same grains, step and iterations.
bool same_steps(const TrialSetup& a, const TrialSetup& b);

/// Trials side by side in one batch of worlds. When one ends, another takes its place while the rest go on. Each record
/// has the bits that the trial has alone.
class TrialBatch {
 public:
  /// `setup` must outlive it.
  TrialBatch(const TrialSetup& setup, const BatchSettings& settings);
  ~TrialBatch();

  int running() const { return int(trial_.size()); }
  /// Trials whose first attempt failed and whose second one has not begun; they keep their places.
  int waiting() const;
  int free_places() const { return settings_.places - running(); }

  /// Needs a free place. Throws InputError for a design point or a checkpoint that cannot be used.
  void start(const DesignPoint& point, const TrialWatch& watch = {}, const TrialCheckpoint& checkpoint = {});
  /// A trial of another setup, which must outlive the batch too. Throws InputError for one with other grains or
  /// numerics: all worlds of a batch take the same steps.
  void start(const TrialSetup& setup, const DesignPoint& point, const TrialWatch& watch = {},
             const TrialCheckpoint& checkpoint = {});

  /// Takes all trials to the next look; returns the records of those that ended. On Ctrl-C Cancelled is thrown;
  /// trials with a checkpoint have been saved.
  std::vector<TrialRecord> advance();

 private:
  struct AttemptPlaces;
  AttemptPlaces& places_of(std::uint64_t attempt);
  int in_place(std::uint64_t attempt) const;
  int second_attempts() const;
  void begin_second_attempts();
  std::vector<TrialRun*> ready(std::uint64_t attempt);
  void take_steps(std::uint64_t attempt);
  void save();
  std::vector<TrialRecord> collect();

  const TrialSetup& setup_;
  BatchSettings settings_;
  std::array<std::unique_ptr<AttemptPlaces>, 2> places_;  // by attempt
  std::vector<std::unique_ptr<TrialRun>> trial_;
};

}  // namespace gonogo::campaign
