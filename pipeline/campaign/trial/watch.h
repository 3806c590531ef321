// Watching a trial: samples after every step, frames for films at intervals. Watching does not change its bits.
#pragma once
#include <functional>
#include <string>

#include "pipeline/campaign/trial/judge.h"

namespace gonogo::campaign {

/// State of a trial after a step, for observers. Numbers of the drive are NaN where the bed failed before there was a
/// wheel.
struct TrialSample {
  double time = 0;                   // from letting the wheel down [s]
  double x = kNaN;                   // travelled [m]
  double y = kNaN;                   // [m]
  double sinkage = kNaN;             // [m]
  double speed = kNaN;               // [m/s]
  double slip = kNaN;                // of the latest 0.25 s [-]
  double torque = kNaN;              // [N m]
  double residual = 0;               // root mean square over contacts [m/s]
  int contacts = 0, iterations = 0;  // of the step
};
using TrialObserver = std::function<void(const TrialSample&)>;

/// A sample as a line of a CSV file, and the names of its columns.
inline constexpr const char* kSampleColumns =
    "time_s,x_m,y_m,sinkage_m,speed_m_per_s,slip,torque_N_m,residual_m_per_s,contacts,iterations\n";
std::string csv_line(const TrialSample& s);

/// The bodies of a running trial, valid during the call.
struct TrialFrame {
  const TrialSample& sample;
  const sim::SceneWorld& world;  // shapes, masses and bounds; its bodies are where they were at the start
  sim::Simulation& simulation;   // now; only to be read
  sim::WorldIndex place;         // of this world in it
  sim::BodyIndex wheel;          // -1 when the bed failed before there was one
};

/// Observers of a trial. Watching does not change its bits.
struct TrialWatch {
  std::function<void()> start;  // before each attempt: drop what an earlier one showed
  TrialObserver sample;         // after every step, or at intervals and at the end
  double sample_interval = 0;   // [s]; 0: every step
  std::function<void(const std::vector<sim::PartShare>&)> shares;  // of a divided world, before samples are shown
  std::function<void(const TrialFrame&)> frame;                    // at the start, at intervals, and at the end
  double frame_interval = 0.02;                                    // [s]
};

/// A world of a batch while a trial runs in it.
struct RunningWorld {
  sim::Simulation& simulation;
  sim::WorldIndex place;
  const sim::SceneWorld& world;
  Index step;  // of its phase
};

/// Shows a trial to its observers.
class TrialWatcher {
 public:
  TrialWatcher(const TrialSetup& setup, TrialWatch watch);

  /// `step`: of the attempt [s].
  void begin_attempt(double step);
  void show_failed_bed(const RunningWorld& now, double residual);
  /// The drive begins, from its start or from where a checkpoint left it.
  void begin_drive(const RunningWorld& now);
  /// Shows what the observers have not seen of the drive.
  void look(const RunningWorld& now, bool stopped);
  /// Step at which the next look is due.
  Index next_look(Index step) const;

  /// A world is stepped on after it has stopped until the next look. An observer of frames gets the step in which it
  /// stopped: sets the world back to the latest look, from where its steps are taken again, with the same bits. Returns
  /// the step it is at; none where nobody needs that.
  std::optional<Index> rewind(const RunningWorld& now, Index stop);

 private:
  Index next_frame() const;
  void pass_due_frames(Index step);
  void remember(const RunningWorld& now);
  void show_shares(const RunningWorld& now);
  void show_samples(const RunningWorld& now, bool stopped);
  void show_frame(const RunningWorld& now);
  /// Means over the driven wheels; sinkage over all that touch the ground.
  struct Means {
    double rolled = 0, sinkage = 0, torque = 0;  // [m], [m], [N m]
  };
  template <class SampleOf>
  Means mean_of_wheels(SampleOf&& sample_of) const;
  Means means_at(const RunningWorld& now, Index sample) const;
  double recent_slip(const RunningWorld& now, Index count, double x, double rolled) const;
  TrialSample seen(const RunningWorld& now, const sim::MonitorSample& s, const Means& wheels, Index count) const;

  TrialWatch watch_;
  std::vector<WatchedWheel> wheels_;
  double step_ = 0;  // [s]
  Index shown_samples_ = 0;
  std::int64_t frame_count_ = 0;
  sim::Snapshot before_;  // of the latest look
  Index replay_to_ = 0;   // step in which the world that was set back stops
};

}  // namespace gonogo::campaign
