// One trial on its way through a place of a batch. Its bed settles alone; then the wheel is let down and drives until a
// stop rule holds; an attempt that fails a check is followed by a second one with a smaller step. The batch takes the
// steps: in which company and how many between two looks does not change the record.
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
  /// Goes on from the checkpoint's file where there is one. `setup` must outlive it.
  TrialRun(const TrialSetup& setup, const DesignPoint& point, TrialWatch watch, TrialCheckpoint checkpoint);

  /// Attempt that is next or under way: the places that it enters must take the steps of attempt_settings().
  std::uint64_t attempt() const { return record_.attempts; }
  void enter(Places& places);
  bool in_place() const { return places_ != nullptr; }
  sim::WorldIndex place() const { return place_; }

  /// The host makes the world of the next phase while the batch goes on with others. Puts it into the place once it is
  /// made, which `wait` waits for. May rebuild the batch.
  void arrive(bool wait);
  bool is_coming() const { return coming_.valid(); }

  /// After at most this many steps the batch has to look; it may do so sooner.
  Index due() const;
  /// Takes note of the `steps` taken since the last look. `stop` is that of its place.
  void look(Index steps, const sim::WorldStop& stop);
  /// Has the world of the next phase made, or leaves the place.
  void move_on();

  /// Writes the checkpoint when its interval has passed, or at once.
  void save_when_due(bool at_once);
  bool saves() const { return !checkpoint_.path.empty(); }

  /// The record is final.
  bool over() const { return over_; }
  const TrialRecord& record() const { return record_; }

 private:
  enum class Phase { bed, drive };
  enum class Next { stay, drive, leave };

  sim::Simulation& simulation() { return places_->simulation(); }
  void resume(const SavedRun& saved);
  void set_aside(const std::string& why);
  void send_for(Phase phase);
  ReadyWorld bed_world() const;
  ReadyWorld drive_world() const;
  void begin(Phase phase, ReadyWorld ready, const sim::Snapshot* from);
  void look_at_bed();
  void look_at_drive(const sim::WorldStop& stop);
  void end_attempt(const DriveOutcome& outcome);
  void say(const std::string& what) const;  // on standard error, of this trial
  void say_what_was_slowed();
  void say_what_failed(std::uint64_t failed, const DriveOutcome& outcome);
  std::string scene_of(const sim::SceneWorld& world) const;

  Index renewal_steps() const;
  void renew_when_due();

  Index next_frame() const;
  void pass_due_frames();
  void remember_for_replay();
  TrialSample seen(const sim::MonitorSample& s) const;
  TrialSample seen_whole(const sim::MonitorSample& s, const SeenWheels& wheels) const;
  void show_samples();
  void show_frame();

  const TrialSetup& setup_;
  TrialWatch watch_;
  TrialCheckpoint checkpoint_;
  TrialRecord record_;
  TrialConditions conditions_;
  terrain::Packing packing_;
  bool over_ = false;
  std::optional<SavedRun> saved_;  // until the first attempt has entered a place
  std::chrono::steady_clock::time_point next_save_;

  // Of the attempt under way.
  terrain::Numerics numerics_;
  sim::StepSettings settings_;
  Places* places_ = nullptr;
  sim::WorldIndex place_ = 0;
  Phase phase_ = Phase::bed;
  Next next_ = Next::stay;
  Index step_ = 0;  // of the phase's world
  std::shared_ptr<const sim::SceneWorld> world_;
  std::string bed_scene_, scene_;  // hashes, when they have been needed
  TiltedBed bed_;

  // Of what was shown.
  Index shown_samples_ = 0;
  std::int64_t frame_count_ = 0;
  sim::Snapshot before_;  // of the latest look
  Index replay_to_ = 0;   // above zero: step in which the world stops

  Phase coming_phase_ = Phase::bed;
  std::future<ReadyWorld> coming_;  // the last member: it is waited for before what it reads goes
};

}  // namespace gonogo::campaign
