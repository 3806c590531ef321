#include "pipeline/campaign/trial/trial_run.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include "base/error.h"
#include "base/format.h"
#include "base/hdf5/hdf5.h"
#include "base/progress.h"
#include "sim/io/checkpoint.h"
#include "sim/io/part_files.h"

namespace gonogo::campaign {
namespace {

constexpr const char* kGroup = "trial";
constexpr const char* kBed = "trial/bed";
constexpr const char* kGrains = "trial/bed/grains";
constexpr std::size_t kColumns = 7;

using Clock = std::chrono::steady_clock;

constexpr double kRenewEvery = 0.1;  // of the moving patch [s]

Clock::time_point in_seconds(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

/// A running trial to be saved. The hashes (sim/io/checkpoint.h) are those of the world of its first phase and of its
/// present world.
struct RunState {
  std::uint64_t attempt = 1;
  std::string bed_scene, scene;
  const TiltedBed* bed = nullptr;      // at the end of the first phase; null during it
  std::optional<sim::Snapshot> world;  // none where it is divided:
  std::vector<std::string> parts;      // names of the files with its parts
};

/// Writes the file, whole or not at all.
void save_run(const std::filesystem::path& path, const RunState& state) {
  Hdf5Writer out;
  out.group(kGroup);
  out.attribute(kGroup, "attempt", std::int64_t(state.attempt));
  if (state.bed) {
    out.group(kBed);
    out.attribute(kBed, "scene", state.bed_scene);
    out.attribute(kBed, "creep", state.bed->creep);
    out.attribute(kBed, "residual", state.bed->residual);
    std::vector<double> rows;
    for (const auto& [x, q] : state.bed->grain) rows.insert(rows.end(), {x.x, x.y, x.z, q.w, q.x, q.y, q.z});
    out.array(kGrains, rows, {state.bed->grain.size(), kColumns});
    out.attribute(kGrains, "columns",
                  std::vector<std::string>{"x [m]", "y [m]", "z [m]", "orientation w", "x", "y", "z"});
  }
  if (state.world)
    sim::store_snapshot(out, *state.world, state.scene);
  else
    sim::store_parts(out, state.parts);
  out.save(path);
}

}  // namespace

/// A running trial on disk: its attempt and phase, its bed, its world and the monitors' sums, in the order in which a
/// trial can check them. A killed trial goes on from there and ends with the bits of one that was never killed. All
/// throws InputError for a damaged file and one of another trial.
class SavedRun {
 public:
  explicit SavedRun(const std::filesystem::path& path) : in_(path) {
    if (!in_.has(kGroup)) in_.fail(kGroup, "this is no checkpoint of a trial; name another file or remove this one");
  }

  std::uint64_t attempt() const {
    const std::int64_t attempt = in_.integer_attribute(kGroup, "attempt");
    if (attempt != 1 && attempt != 2)
      in_.fail(kGroup, "attempt is " + std::to_string(attempt) + ", allowed are 1 and 2; remove the file");
    return std::uint64_t(attempt);
  }

  /// Whether the first phase was over.
  bool driving() const { return in_.has(kBed); }

  TiltedBed bed(const std::string& bed_scene) const {
    if (in_.text_attribute(kBed, "scene") != bed_scene)
      in_.fail(kBed,
               "belongs to another scene or other numerics; give the file the trial it came from, or remove it and "
               "start from the beginning");
    TiltedBed bed;
    bed.creep = in_.number_attribute(kBed, "creep");
    bed.residual = in_.number_attribute(kBed, "residual");
    const auto shape = in_.shape(kGrains);
    if (shape.size() != 2 || shape[1] != kColumns)
      in_.fail(kGrains, "expected seven columns; remove the file, and the trial starts from the beginning");
    const auto rows = in_.array<double>(kGrains);
    for (std::size_t i = 0; i + kColumns <= rows.size(); i += kColumns)
      bed.grain.push_back({{rows[i], rows[i + 1], rows[i + 2]},
                           {Real(rows[i + 3]), Real(rows[i + 4]), Real(rows[i + 5]), Real(rows[i + 6])}});
    return bed;
  }

  sim::Snapshot world(const std::string& scene) const {
    return by_parts() ? sim::read_parts(in_, scene) : sim::read_snapshot(in_, scene);
  }
  bool by_parts() const { return sim::has_parts(in_); }

 private:
  Hdf5Reader in_;
};

TrialRun::TrialRun(const TrialSetup& setup, const DesignPoint& point, TrialWatch watch, TrialCheckpoint checkpoint)
    : setup_(setup_at(setup, point)),
      watcher_(setup_, std::move(watch)),
      checkpoint_(std::move(checkpoint)),
      conditions_(conditions_of(setup_, setup_.inputs)),
      packing_(settled_bed(setup_, setup_.inputs)) {
  // Trials of a batch begin together. Their first saves come after other parts of the interval, so as not to coincide.
  constexpr double golden = 0.6180339887498949;
  const double turns = double(point.index % 1000000) * golden;
  next_save_ = in_seconds(checkpoint_.every * (1 - (turns - std::floor(turns))));
  record_.point = point;
  record_.measures.assign(contract().measures.size(), kNaN);
  if (!saves() || !std::filesystem::exists(checkpoint_.path)) return;
  try {
    saved_ = std::make_unique<SavedRun>(checkpoint_.path);
    record_.attempts = saved_->attempt();
    has_parts_ = saved_->by_parts();
  } catch (const InputError& error) {
    set_aside(error.what());
  }
}

TrialRun::~TrialRun() = default;

void TrialRun::enter(Places& places) {
  step_s_ = attempt_step(setup_, attempt());
  settings_ = attempt_settings(setup_, attempt());
  places_ = &places;
  place_ = places.take();
  bed_scene_.clear();
  watcher_.begin_attempt(step_s_);
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
  if (phase == Phase::drive) watcher_.begin_drive(now());
}

Index TrialRun::due() const {
  if (phase_ == Phase::bed) return bed_steps(setup_, settings_) - step_;
  const Index look = std::max<Index>(1, watcher_.next_look(step_) - step_);
  return setup_.moving_patch ? std::min(look, renewal_steps() - step_ % renewal_steps()) : look;
}

/// Steps between two renewals of the ground: fixed in the trial's own time, whatever the batch's looks are.
Index TrialRun::renewal_steps() const { return std::max<Index>(1, Index(std::lround(kRenewEvery / step_s_))); }

void TrialRun::renew_when_due() {
  if (!setup_.moving_patch || step_ % renewal_steps() != 0) return;
  terrain::renew_ground(simulation(), place_, setup_.patch(), bed_.grain, simulation().monitor(place_, 0).position.x);
}

void TrialRun::look(Index steps, const sim::WorldStop& stop) {
  step_ += steps;
  if (phase_ == Phase::bed) next_ = look_at_bed();
  if (phase_ == Phase::drive) next_ = look_at_drive(stop);
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
  watcher_.show_failed_bed(now(), bed_.residual);
  return end_attempt(outcome_of_failed_bed(bed_));
}

TrialRun::Phase TrialRun::look_at_drive(const sim::WorldStop& stop) {
  const bool stopped = stop.cause != sim::StopCause::none;
  if (stopped && stop.step < step_)
    if (const std::optional<Index> back = watcher_.rewind(now(), stop.step)) {
      step_ = *back;
      return Phase::drive;
    }
  if (!stopped) renew_when_due();
  watcher_.look(now(), stopped);
  if (!stopped) return Phase::drive;
  return end_attempt(judge_drive(setup_, conditions_, bed_, step_s_, simulation(), place_));
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
  const std::string fault = sim::description(simulation().report(place_).fault, step_s_);
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
  RunState state{.attempt = attempt(), .bed_scene = bed_scene_, .scene = scene_, .bed = bed, .world = {}, .parts = {}};
  if (sim::InParts* const divided = sim::in_parts(simulation()))
    state.parts = sim::write_parts(checkpoint_.path, *divided, scene_);
  else
    state.world = simulation().snapshot(place_);
  save_run(checkpoint_.path, state);
  if (has_parts_ || !state.world) sim::remove_parts_but(state.parts, checkpoint_.path);
  has_parts_ = !state.world;
  next_save_ = in_seconds(checkpoint_.every);
}

}  // namespace gonogo::campaign
