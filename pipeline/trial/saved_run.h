// A driving trial on disk while it runs: its world, what its monitor has seen, and which attempt it is. A trial that
// was killed goes on from there and ends with the bits of one that was not.
#pragma once
#include <chrono>

#include "pipeline/trial/trial.h"

namespace gonogo::pipeline {

class SavedRun {
 public:
  /// `world` and `settings` as the simulation starts with them; `attempt` as in TrialRecord.
  SavedRun(const TrialCheckpoint& checkpoint, const sim::SceneWorld& world, const sim::StepSettings& settings,
           std::uint64_t attempt);

  /// Takes the simulation to where the file left it; does nothing without a file. Throws InputError for a file of
  /// another trial and for a damaged one.
  void resume(sim::Simulation& simulation) const;

  /// Writes the file when the interval has passed. On Ctrl-C writes it at once and throws Cancelled.
  void save_when_due(sim::Simulation& simulation);

 private:
  void save(sim::Simulation& simulation);

  const TrialCheckpoint& checkpoint_;
  std::string scene_;
  std::uint64_t attempt_;
  std::chrono::steady_clock::time_point last_;
};

/// Attempt that the file was written in, 1 without a file.
std::uint64_t saved_attempt(const TrialCheckpoint& checkpoint);

}  // namespace gonogo::pipeline
