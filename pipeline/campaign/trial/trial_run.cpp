#include "pipeline/campaign/trial/trial_run.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/error.h"
#include "base/format.h"
#include "base/progress.h"
#include "sim/io/checkpoint.h"

namespace gonogo::campaign {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kRenewEvery = 0.1;  // of the moving patch [s]
constexpr Index kNever = std::numeric_limits<Index>::max();

Clock::time_point in_seconds(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

/// Part of the interval after which a trial is saved first: spread over trials, so that those of a batch that began
/// together are not all saved together.
double first_part(std::uint64_t index) {
  constexpr double golden = 0.6180339887498949;
  const double x = double(index % 1000000) * golden;
  return 1 - (x - std::floor(x));
}

void store_measures(const DriveOutcome& o, TrialRecord& record) {
  const auto set = [&](const char* name, double x) { record.measures[contract().measure_index(name)] = x; };
  set("distance", o.distance);
  set("drive_time", o.drive_time);
  set("mean_speed", o.mean_speed);
  set("slip", o.slip);
  set("sinkage", o.sinkage);
  set("drift", o.drift);
  set("mean_torque", o.mean_torque);
  set("energy_per_metre", o.energy_per_metre);
  set("bed_creep", o.bed_creep);
  set("worst_residual", o.worst_residual);
  set("energy_error", o.energy_error);
}

static_assert(int(check_not_finite) == sim::flag_not_finite && int(check_too_fast) == sim::flag_too_fast &&
              int(check_left_domain) == sim::flag_left_domain);

/// Bits of the checks that the simulation failed; its outcome counts when there are none.
std::uint64_t failed_checks(const TrialSetup& setup, const DriveOutcome& o) {
  std::uint64_t failed = std::uint64_t(o.flags);
  if (!(o.worst_residual <= setup.thresholds.residual)) failed |= check_residual;
  if (!(o.energy_error <= setup.thresholds.energy_error)) failed |= check_energy;
  return failed;
}

}  // namespace

TrialRun::TrialRun(const TrialSetup& setup, const DesignPoint& point, TrialWatch watch, TrialCheckpoint checkpoint)
    : setup_(setup_at(setup, point)),
      watch_(std::move(watch)),
      checkpoint_(std::move(checkpoint)),
      conditions_(conditions_of(setup_, point)),
      packing_(settled_bed(setup_, point)),
      next_save_(in_seconds(checkpoint_.every * first_part(point.index))) {
  record_.point = point;
  record_.measures.assign(contract().measures.size(), kNaN);
  if (!saves() || !std::filesystem::exists(checkpoint_.path)) return;
  try {
    saved_.emplace(checkpoint_.path);
    record_.attempts = saved_->attempt();
  } catch (const InputError& error) {
    set_aside(error.what());
  }
}

void TrialRun::enter(Places& places) {
  numerics_ = attempt_numerics(setup_, attempt());
  settings_ = attempt_settings(setup_, attempt());
  places_ = &places;
  place_ = places.take();
  bed_scene_.clear();
  shown_samples_ = 0;
  frame_count_ = 0;
  if (watch_.start) watch_.start();
  if (saved_) {
    try {
      resume(*saved_);
    } catch (const InputError& error) {
      set_aside(error.what());
    }
  }
  if (phase_ == Phase::outside) send_for(Phase::bed_coming);
}

/// Everything is read and checked before the place is touched.
void TrialRun::resume(const SavedRun& saved) {
  ReadyWorld bed = bed_world();
  bed_scene_ = scene_of(*bed.world);
  if (!saved.driving()) {
    const sim::Snapshot from = saved.world(bed_scene_);
    begin(Phase::bed, std::move(bed), &from);
  } else {
    bed_ = saved.bed(bed_scene_);
    ReadyWorld drive = drive_world();
    const sim::Snapshot from = saved.world(scene_of(*drive.world));
    begin(Phase::drive, std::move(drive), &from);
  }
  saved_.reset();
}

/// A trial whose file cannot be used begins anew where that was asked for.
void TrialRun::set_aside(const std::string& why) {
  if (!checkpoint_.set_aside) throw InputError(why);
  saved_.reset();
  std::filesystem::path damaged = checkpoint_.path;
  damaged += ".damaged";
  std::error_code ignored;
  std::filesystem::rename(checkpoint_.path, damaged, ignored);
  log_line("trial " + std::to_string(record_.point.index),
           why + "; the file is set aside as " + damaged.filename().string() + " and the trial starts anew");
}

ReadyWorld TrialRun::bed_world() const { return places_->ready(place_, bed_alone(setup_, packing_, conditions_)); }

ReadyWorld TrialRun::drive_world() const {
  return places_->ready(place_, vehicle_on_bed(setup_, packing_, bed_, conditions_));
}

void TrialRun::send_for(Phase coming) {
  phase_ = next_ = coming;
  const bool bed = coming == Phase::bed_coming;
  coming_ = std::async(std::launch::async, [this, bed] { return bed ? bed_world() : drive_world(); });
}

void TrialRun::arrive(bool wait) {
  if (!is_coming() || (!wait && coming_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)) return;
  begin(phase_ == Phase::bed_coming ? Phase::bed : Phase::drive, coming_.get(), nullptr);
}

void TrialRun::begin(Phase phase, ReadyWorld ready, const sim::Snapshot* from) {
  world_ = ready.world;
  places_->put(place_, std::move(ready), from);
  phase_ = next_ = phase;
  scene_.clear();
  step_ = from ? from->steps : 0;
  if (phase == Phase::bed) return;
  show_samples();
  if (step_ == 0) show_frame();
  pass_due_frames();
  remember_for_replay();
}

Index TrialRun::due() const {
  if (phase_ == Phase::bed) return bed_steps(setup_, settings_) - step_;
  if (phase_ == Phase::replay) return replay_to_ - step_;
  const Index frame = std::max<Index>(1, next_frame() - step_);
  return setup_.moving_patch ? std::min(frame, renewal_steps() - step_ % renewal_steps()) : frame;
}

/// Steps between two renewals of the ground: fixed in the trial's own time, whatever the batch's looks are.
Index TrialRun::renewal_steps() const { return std::max<Index>(1, Index(std::lround(kRenewEvery / numerics_.step))); }

void TrialRun::renew_when_due() {
  if (!setup_.moving_patch || step_ % renewal_steps() != 0) return;
  terrain::renew_ground(simulation(), place_, setup_.patch(), bed_.grain, simulation().monitor(place_, 0).position.x);
}

void TrialRun::look(Index steps, const sim::WorldStop& stop) {
  step_ += steps;
  if (phase_ == Phase::bed) next_ = look_at_bed();
  if (phase_ == Phase::drive) next_ = look_at_drive(stop);
  if (phase_ == Phase::replay) next_ = look_at_replay(stop);
}

void TrialRun::move_on() {
  phase_ = next_;
  if (phase_ == Phase::drive_coming) send_for(phase_);
  if (phase_ == Phase::outside || phase_ == Phase::over) leave();
}

void TrialRun::leave() {
  places_->release(place_);
  places_ = nullptr;
  world_.reset();
}

TrialRun::Phase TrialRun::look_at_bed() {
  if (step_ < bed_steps(setup_, settings_)) return Phase::bed;
  bed_ = tilted_bed(simulation(), place_, packing_);
  if (!fails(setup_, bed_)) return Phase::drive_coming;
  if (watch_.frame) {
    const TrialSample sample{.residual = bed_.residual};
    watch_.frame(frame_of(sample, -1));
  }
  return end_attempt(outcome_of_failed_bed(bed_));
}

/// A world is stepped on after it has stopped until the next look. A watcher of frames gets the step in which it
/// stopped: the steps from the look before are taken again, with the same bits.
TrialRun::Phase TrialRun::look_at_drive(const sim::WorldStop& stop) {
  const bool passed = stop.cause != sim::StopCause::none && stop.step < step_;
  if (!watch_.frame || !passed) return follow_drive(stop);
  simulation().restore(place_, before_);
  step_ = before_.steps;
  replay_to_ = stop.step;
  return Phase::replay;
}

TrialRun::Phase TrialRun::look_at_replay(const sim::WorldStop& stop) { return follow_drive(stop); }

/// Shows what the watchers have not seen; stays in the phase unless the world has stopped.
TrialRun::Phase TrialRun::follow_drive(const sim::WorldStop& stop) {
  const bool stopped = stop.cause != sim::StopCause::none;
  if (!stopped) renew_when_due();
  show_samples();
  if (stopped || step_ >= next_frame()) show_frame();
  if (stopped) return end_attempt(judge_drive(setup_, conditions_, bed_, numerics_.step, simulation(), place_));
  remember_for_replay();
  return phase_;
}

TrialRun::Phase TrialRun::end_attempt(const DriveOutcome& outcome) {
  store_measures(outcome, record_);
  record_.wheels = outcome.wheels;
  record_.pull = outcome.pull;
  const std::uint64_t failed = failed_checks(setup_, outcome);
  say_what_was_slowed();
  if (failed == 0) {
    record_.verdict = outcome.verdict;
    record_.reason = outcome.reason;
    return Phase::over;
  }
  if (attempt() == 2) {
    record_.failed_checks = failed;
    return Phase::over;  // unknown / simulation_failed
  }
  say_what_failed(failed, outcome);
  record_.attempts = 2;
  return Phase::outside;
}

void TrialRun::say_what_failed(std::uint64_t failed, const DriveOutcome& outcome) {
  const std::string numbers =
      "residual " + number_text(outcome.worst_residual) + " m/s, energy error " + number_text(outcome.energy_error);
  const std::string fault = sim::description(simulation().report(place_).fault, numerics_.step);
  say("the first attempt failed the checks " + names_of_checks(failed) + " (" + numbers +
      (fault.empty() ? "" : "; " + fault) + "); the second one takes half the step");
}

void TrialRun::say_what_was_slowed() {
  const Index times = simulation().report(place_).slowed;
  if (times == 0) return;
  say("grains were limited to one bin per step, " + std::to_string(times) + " times");
}

void TrialRun::say(const std::string& what) const { log_line("trial " + std::to_string(record_.point.index), what); }

std::string TrialRun::scene_of(const sim::SceneWorld& world) const { return sim::scene_hash(world, settings_); }

void TrialRun::save_when_due(bool at_once) {
  if (!saves() || !in_place() || is_coming() || (!at_once && Clock::now() < next_save_)) return;
  if (bed_scene_.empty()) bed_scene_ = scene_of(bed_alone(setup_, packing_, conditions_));
  if (scene_.empty()) scene_ = scene_of(*world_);
  const TiltedBed* bed = phase_ == Phase::bed ? nullptr : &bed_;
  save_run(checkpoint_.path, {.attempt = attempt(),
                              .bed_scene = bed_scene_,
                              .scene = scene_,
                              .bed = bed,
                              .world = simulation().snapshot(place_)});
  next_save_ = in_seconds(checkpoint_.every);
}

/// Step at which the next frame is due.
Index TrialRun::next_frame() const {
  if (!watch_.frame) return kNever;
  return Index(std::min(1e9, std::round(double(frame_count_) * watch_.frame_interval / numerics_.step)));
}

void TrialRun::pass_due_frames() {
  while (next_frame() <= step_) ++frame_count_;
}

void TrialRun::remember_for_replay() {
  if (watch_.frame) before_ = simulation().snapshot(place_);
}

double TrialRun::recent_slip(Index count, double x, double rolled) {
  constexpr double window = 0.25, rolling = 0.01;  // [s], [m]
  const Index back = Index(std::lround(window / numerics_.step));
  double x_then = 0, rolled_then = 0;
  if (count > back) {
    const sim::MonitorSample then = simulation().samples(place_, 0, count - 1 - back, 1).front();
    x_then = then.x;
    rolled_then = setup_.whole ? seen_wheels(setup_, simulation(), place_, count - 1 - back).rolled
                               : then.turned * setup_.rig.radius;
  }
  const double turned = rolled - rolled_then;
  return turned > rolling ? 1 - (x - x_then) / turned : 0;
}

TrialSample TrialRun::seen(const sim::MonitorSample& s, const SeenWheels& wheels, Index count) {
  const bool whole = setup_.whole.has_value();
  return {.time = s.step * numerics_.step,
          .x = s.x,
          .y = s.y,
          .sinkage = whole ? wheels.sinkage : s.drop,
          .speed = s.speed,
          .slip = recent_slip(count, s.x, whole ? wheels.rolled : s.turned * setup_.rig.radius),
          .torque = whole ? wheels.torque : s.torque,
          .residual = s.residual,
          .contacts = s.contact_count,
          .iterations = s.iterations};
}

/// Gives the observer the samples that it has not seen.
void TrialRun::show_samples() {
  if (!watch_.sample) return;
  const Index count = simulation().monitor(place_, 0).sample_count - shown_samples_;
  const auto samples = simulation().samples(place_, 0, shown_samples_, count);
  for (Index k = 0; k < count; ++k) {
    const Index at = shown_samples_ + k;
    const SeenWheels wheels = setup_.whole ? seen_wheels(setup_, simulation(), place_, at) : SeenWheels{};
    watch_.sample(seen(samples[std::size_t(k)], wheels, at + 1));
  }
  shown_samples_ += count;
}

TrialFrame TrialRun::frame_of(const TrialSample& sample, sim::BodyIndex wheel) {
  return {.sample = sample, .world = *world_, .simulation = simulation(), .place = place_, .wheel = wheel};
}

void TrialRun::show_frame() {
  if (!watch_.frame) return;
  const sim::MonitorState monitor = simulation().monitor(place_, 0);
  const SeenWheels wheels = setup_.whole ? seen_wheels(setup_, simulation(), place_) : SeenWheels{};
  const TrialSample sample = seen(monitor.now, wheels, monitor.sample_count);
  watch_.frame(frame_of(sample, world_->monitor.front().body));
  pass_due_frames();
}

}  // namespace gonogo::campaign
