// Trials side by side in one batch of worlds. When one ends, another takes its place while the rest go on. Each record
// has the bits that the trial has alone.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/campaign/trial/trial_run.h"

namespace gonogo::campaign {

struct BatchSettings {
  sim::Backend backend = sim::Backend::cpu;
  int places = 1;   // trials at a time
  int threads = 1;  // of the cpu backend
};

/// Whether trials of both may stand in one batch: same grains, step and iterations.
bool same_steps(const TrialSetup& a, const TrialSetup& b);

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
  /// Places of one attempt: all worlds of a batch take the same steps.
  struct Lane {
    Places places;
    Index look_every;  // steps
  };
  Lane& lane(std::uint64_t attempt);
  int in_place(std::uint64_t attempt) const;
  int second_attempts() const;
  void begin_second_attempts();
  std::vector<TrialRun*> ready(std::uint64_t attempt);
  void take_steps(std::uint64_t attempt);
  void save();
  std::vector<TrialRecord> collect();

  const TrialSetup& setup_;
  BatchSettings settings_;
  std::array<std::optional<Lane>, 2> lane_;  // by attempt
  std::vector<std::unique_ptr<TrialRun>> trial_;
};

}  // namespace gonogo::campaign
