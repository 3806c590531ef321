#include "pipeline/trial/saved_run.h"

#include "base/cancel.h"
#include "base/error.h"
#include "sim/io/checkpoint.h"

namespace gonogo::pipeline {
namespace {

constexpr const char* kGroup = "trial";

bool exists(const TrialCheckpoint& checkpoint) {
  return !checkpoint.path.empty() && std::filesystem::exists(checkpoint.path);
}

}  // namespace

SavedRun::SavedRun(const TrialCheckpoint& checkpoint, const sim::SceneWorld& world, const sim::StepSettings& settings,
                   std::uint64_t attempt)
    : checkpoint_(checkpoint),
      scene_(checkpoint.path.empty() ? "" : sim::scene_hash(world, settings)),
      attempt_(attempt),
      last_(std::chrono::steady_clock::now()) {}

void SavedRun::resume(sim::Simulation& simulation) const {
  if (!exists(checkpoint_)) return;
  const Hdf5Reader in(checkpoint_.path);
  simulation.restore(0, sim::read_snapshot(in, scene_));
}

void SavedRun::save_when_due(sim::Simulation& simulation) {
  if (checkpoint_.path.empty()) return;
  const bool cancelled = cancel_requested();
  const std::chrono::duration<double> since = std::chrono::steady_clock::now() - last_;
  if (cancelled || since.count() >= checkpoint_.every) save(simulation);
  stop_if_cancelled();
}

void SavedRun::save(sim::Simulation& simulation) {
  Hdf5Writer out;
  out.group(kGroup);
  out.attribute(kGroup, "attempt", std::int64_t(attempt_));
  sim::store_snapshot(out, simulation.snapshot(0), scene_);
  out.save(checkpoint_.path);
  last_ = std::chrono::steady_clock::now();
}

std::uint64_t saved_attempt(const TrialCheckpoint& checkpoint) {
  if (!exists(checkpoint)) return 1;
  const Hdf5Reader in(checkpoint.path);
  if (!in.has(kGroup)) in.fail(kGroup, "this is no checkpoint of a trial; name another file or remove this one");
  return std::uint64_t(in.integer_attribute(kGroup, "attempt"));
}

}  // namespace gonogo::pipeline
