// One trial in a place of a batch. Its bed settles alone; then the vehicle is let down and drives until a stop rule
// holds. An attempt that fails a check is followed by a second one with half the step. The batch takes the steps.
// Neither the other trials nor the number of steps between two looks changes the record.
#pragma once
#include <chrono>
#include <future>
#include <memory>
#include <optional>

#include "pipeline/campaign/trial/drive.h"
#include "pipeline/campaign/trial/places.h"
#include "pipeline/campaign/trial/saved_run.h"
#include "pipeline/campaign/trial/trial.h"

namespace gonogo::campaign {

class TrialRun {
 public:
  /// Goes on from the checkpoint's file where there is one.
  TrialRun(const TrialSetup& setup, const DesignPoint& point, TrialWatch watch, TrialCheckpoint checkpoint);

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
  ///             enter              arrive       look, move_on           arrive        look
  ///   outside ---------> bed_coming ------> bed ------------> drive_coming ------> drive ---> replay
  ///
  /// A checkpoint leads from `outside` straight to `bed` or `drive`. From `bed`, `drive` and `replay` an attempt ends:
  /// in `over`, or in `outside` when a second attempt follows.
  enum class Phase {
    outside,       // has no place: before its first attempt, or between two
    bed_coming,    // the host makes the world of the bed
    bed,           // the bed settles alone under the trial's gravity
    drive_coming,  // the bed has settled; the host makes the world with the vehicle
    drive,         // the vehicle drives until a monitor stops the world
    replay,        // the stop lay between two looks: the steps from the look before to the stop are taken again
    over           // the record is final
  };

  sim::Simulation& simulation() { return places_->simulation(); }
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
  Phase look_at_replay(const sim::WorldStop& stop);
  Phase follow_drive(const sim::WorldStop& stop);
  Phase end_attempt(const DriveOutcome& outcome);

  void say(const std::string& what) const;  // on standard error, of this trial
  void say_what_was_slowed();
  void say_what_failed(std::uint64_t failed, const DriveOutcome& outcome);
  std::string scene_of(const sim::SceneWorld& world) const;

  Index renewal_steps() const;
  void renew_when_due();

  Index next_frame() const;
  void pass_due_frames();
  void remember_for_replay();
  /// Slip of the latest 0.25 s, of which `x` and `rolled` [m] are the end, the `count`-th recorded sample. Wheels that
  /// hardly roll, as while the vehicle is let down with its brakes on, have none.
  double recent_slip(Index count, double x, double rolled);
  /// Of a whole vehicle, slip, sinkage and torque are those of `wheels`.
  TrialSample seen(const sim::MonitorSample& s, const SeenWheels& wheels, Index count);
  void show_samples();
  TrialFrame frame_of(const TrialSample& sample, sim::BodyIndex wheel);
  void show_frame();

  const TrialSetup setup_;  // of this point
  TrialWatch watch_;
  TrialCheckpoint checkpoint_;
  Phase phase_ = Phase::outside;
  Phase next_ = Phase::outside;  // entered by move_on()
  TrialRecord record_;
  TrialConditions conditions_;
  terrain::Packing packing_;
  std::optional<SavedRun> saved_;  // until the first attempt has entered a place
  std::chrono::steady_clock::time_point next_save_;

  // Of the attempt under way.
  terrain::Numerics numerics_;
  sim::StepSettings settings_;
  Places* places_ = nullptr;
  sim::WorldIndex place_ = 0;
  Index step_ = 0;  // of the phase's world
  std::shared_ptr<const sim::SceneWorld> world_;
  std::string bed_scene_, scene_;  // hashes, when they have been needed
  TiltedBed bed_;

  // Of what was shown.
  Index shown_samples_ = 0;
  std::int64_t frame_count_ = 0;
  sim::Snapshot before_;  // of the latest look
  Index replay_to_ = 0;   // step in which the world stops

  std::future<ReadyWorld> coming_;  // last member: destroyed, and so waited for, first
};

}  // namespace gonogo::campaign
