// One trial in a place of a batch. Its bed settles alone; then the vehicle is let down and drives until a stop rule
// holds. An attempt that fails a check is followed by a second one with half the step. The batch takes the steps.
// Neither the other trials nor the number of steps between two looks changes the record.
#pragma once
#include <chrono>
#include <future>
#include <memory>
#include <string>

#include "pipeline/campaign/trial/places.h"
#include "pipeline/campaign/trial/trial.h"
#include "pipeline/campaign/trial/watch.h"

namespace gonogo::campaign {

class SavedRun;

class TrialRun {
 public:
  /// Goes on from the checkpoint's file where there is one.
  TrialRun(const TrialSetup& setup, const DesignPoint& point, TrialWatch watch, TrialCheckpoint checkpoint);
  ~TrialRun();

  /// Attempt that is next or under way: the places that it enters must take the steps of attempt_settings().
  std::uint64_t attempt() const { return record_.attempts; }
  void enter(Places& places);
  bool in_place() const { return places_ != nullptr; }
  sim::WorldIndex place() const { return place_; }

  /// Puts the next phase's world into the place once the host has made it. `wait`: waits for it. May rebuild the batch.
  void arrive(bool wait);
  bool is_coming() const { return phase_ == Phase::bed_coming || phase_ == Phase::drive_coming; }

  /// After at most this many steps the batch has to look; it may do so sooner.
  Index due() const;
  /// Records the `steps` taken since the last look. `stop` is that of its place.
  void look(Index steps, const sim::WorldStop& stop);
  /// Has the world of the next phase made, or leaves the place.
  void move_on();

  /// Writes the checkpoint when its interval has passed, or at once.
  void save_when_due(bool at_once);
  bool saves() const { return !checkpoint_.path.empty(); }

  /// The record is final.
  bool over() const { return phase_ == Phase::over; }
  const TrialRecord& record() const { return record_; }

 private:
  /// Where the trial is between two calls. enter(), arrive(), look() and move_on() take the arrows.
  ///
  ///             enter              arrive       look, move_on           arrive
  ///   outside ---------> bed_coming ------> bed ------------> drive_coming ------> drive
  ///
  /// A checkpoint leads from `outside` straight to `bed` or `drive`. From these two an attempt ends: in `over`, or in
  /// `outside` when a second attempt follows.
  enum class Phase {
    outside,       // has no place: before its first attempt, or between two
    bed_coming,    // the host makes the world of the bed
    bed,           // the bed settles alone under the trial's gravity
    drive_coming,  // the bed has settled; the host makes the world with the vehicle
    drive,         // the vehicle drives until a monitor stops the world
    over           // the record is final
  };

  sim::Simulation& simulation() { return places_->simulation(); }
  RunningWorld now() { return {simulation(), place_, *world_, step_}; }
  void resume(const SavedRun& saved);
  void set_aside(const std::string& why);
  void send_for(Phase coming);
  ReadyWorld bed_world() const;
  ReadyWorld drive_world() const;
  void begin(Phase phase, ReadyWorld ready, const sim::Snapshot* from);
  void leave();

  // What a look finds; each returns the next phase.
  Phase look_at_bed();
  Phase look_at_drive(const sim::WorldStop& stop);
  Phase end_attempt(const DriveOutcome& outcome);

  void say(const std::string& what) const;  // on standard error, of this trial
  void say_what_was_slowed();
  void say_what_failed(std::uint64_t failed, const DriveOutcome& outcome);
  std::string scene_of(const sim::SceneWorld& world) const;

  Index renewal_steps() const;
  void renew_when_due();

  const TrialSetup setup_;  // of this point
  TrialWatcher watcher_;
  TrialCheckpoint checkpoint_;
  Phase phase_ = Phase::outside;
  Phase next_ = Phase::outside;  // entered by move_on()
  TrialRecord record_;
  TrialConditions conditions_;
  terrain::Packing packing_;
  std::unique_ptr<SavedRun> saved_;  // until the first attempt has entered a place
  std::chrono::steady_clock::time_point next_save_;
  bool has_parts_ = false;  // the checkpoint names files of parts

  // The attempt under way.
  double step_s_ = 0;  // length of a step [s]
  sim::StepSettings settings_;
  Places* places_ = nullptr;
  sim::WorldIndex place_ = 0;
  Index step_ = 0;  // of the phase's world
  std::shared_ptr<const sim::SceneWorld> world_;
  std::string bed_scene_, scene_;  // hashes, when they have been needed
  TiltedBed bed_;

  std::future<ReadyWorld> coming_;  // last member: destroyed, and so waited for, first
};

}  // namespace gonogo::campaign
