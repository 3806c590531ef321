// Trials that are interrupted and go on.
#include <csignal>
#include <cstring>
#include <optional>

#include "base/error.h"
#include "base/files/file.h"
#include "base/progress.h"
#include "pipeline/campaign/trial/world.h"
#include "sim/simulation/layout/memory.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/refused.h"
#include "tests/support/short_trial.h"
#include "tests/support/temporary_folder.h"

namespace gonogo::campaign {

namespace {

namespace fs = std::filesystem;

DesignPoint point(double slope) { return design_point(slope, 30, 0.25); }

/// A trial whose state is saved after every step, with its bed settled.
struct SavedTrial {
  TemporaryFolder folder;
  TrialSetup setup = short_setup(0.3);
  DesignPoint p = point(5);
  TrialCheckpoint saved{folder / "trial.h5", 0};

  SavedTrial() { prepare_trials(setup, {&p, 1}, 1); }
};

struct Interrupted {};

/// Runs a trial until it has shown this many samples in its attempt number `attempt`, then drops it as a kill would.
void run_until(const TrialSetup& setup, const DesignPoint& p, int samples, int attempt, const TrialCheckpoint& to) {
  int attempts = 0, seen = 0;
  TrialWatch watch;
  watch.start = [&] { ++attempts, seen = 0; };
  watch.sample = [&](const TrialSample&) {
    if (attempts == attempt && ++seen > samples) throw Interrupted();
  };
  CHECK_THROWS_AS(run_trial(setup, p, watch, to), Interrupted);
}

using Samples = std::vector<TrialSample>;

TrialRecord finished(const TrialSetup& setup, const DesignPoint& p, const TrialCheckpoint& from, Samples& samples) {
  TrialWatch watch;
  watch.start = [&] { samples.clear(); };
  watch.sample = [&](const TrialSample& s) { samples.push_back(s); };
  return run_trial(setup, p, watch, from);
}

/// Frames of a trial that shows its beginning and its end only.
int frames_shown(const TrialSetup& setup, const DesignPoint& p, const TrialCheckpoint& from) {
  int frames = 0;
  TrialWatch watch;
  watch.frame = [&](const TrialFrame&) { ++frames; };
  watch.frame_interval = 1e6;
  (void)run_trial(setup, p, watch, from);
  return frames;
}

bool same_bits(const Samples& a, const Samples& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(TrialSample)) == 0;
}

void check_same(const TrialRecord& a, const TrialRecord& b) {
  CHECK(a.verdict == b.verdict);
  CHECK(a.reason == b.reason);
  CHECK(a.attempts == b.attempts);
  CHECK(std::memcmp(a.measures.data(), b.measures.data(), a.measures.size() * sizeof(double)) == 0);
}

}  // namespace

TEST_CASE_METHOD(SavedTrial, "a trial that was cut off goes on to the record and the samples of one that was not") {
  Samples whole, continued;
  const TrialRecord through = finished(setup, p, {}, whole);
  CHECK(frames_shown(setup, p, {}) == 2);
  for (const int cut : {40, 120, 170}) {
    run_until(setup, p, cut, 1, saved);
    REQUIRE(fs::exists(saved.path));
    const std::string file = read_file(saved.path);
    check_same(finished(setup, p, saved, continued), through);
    CHECK(same_bits(continued, whole));
    CHECK_FALSE(fs::exists(saved.path));  // the trial is over
    // It did go on: the frame that a trial shows before its first step is missing.
    write_file_atomically(saved.path, file);
    CHECK(frames_shown(setup, p, saved) == 1);
  }
}

TEST_CASE("a trial on clumps drives, and goes on with their orientations where it was cut off") {
  const TemporaryFolder folder;
  TrialSetup setup = short_setup(0.3);
  setup.calibration.shape = terrain::GrainShape::pair;
  setup.deepest_bed = 0.25;  // cut from a packing
  const DesignPoint p = design_point(5, 30, 0.15);
  prepare_trials(setup, {&p, 1}, 1);
  CHECK(settled_bed(setup, inputs_of(p)).spec.shape == terrain::GrainShape::pair);
  const TrialCheckpoint saved{folder / "trial.h5", 0};
  Samples whole, continued;
  const TrialRecord through = finished(setup, p, {}, whole);
  CHECK(through.verdict != Verdict::unknown);
  CHECK(whole.back().x > 0.02);
  run_until(setup, p, 120, 1, saved);
  check_same(finished(setup, p, saved, continued), through);
  CHECK(same_bits(continued, whole));
}

TEST_CASE_METHOD(SavedTrial, "a trial cut off in its second attempt does not take the first one again") {
  setup.thresholds.residual = 1e-9;  // no run can meet it
  Samples whole, continued;
  const TrialRecord through = finished(setup, p, {}, whole);
  CHECK(through.attempts == 2);
  run_until(setup, p, 150, 2, saved);
  REQUIRE(fs::exists(saved.path));
  int attempts = 0;
  TrialWatch watch;
  watch.start = [&] { ++attempts; };
  const std::string file = read_file(saved.path);
  check_same(run_trial(setup, p, watch, saved), through);
  CHECK(attempts == 1);
  write_file_atomically(saved.path, file);
  check_same(finished(setup, p, saved, continued), through);
  CHECK(same_bits(continued, whole));
}

TEST_CASE_METHOD(SavedTrial, "a checkpoint of another trial and a damaged one are refused, and left as they are") {
  const DesignPoint other = point(6);
  prepare_trials(setup, {&other, 1}, 1);
  run_until(setup, p, 60, 1, saved);
  const std::string file = read_file(saved.path);
  refused([&] { (void)run_trial(setup, other, {}, saved); }, "another scene");
  CHECK(read_file(saved.path) == file);
  write_file_atomically(saved.path, file.substr(0, file.size() / 2));
  refused([&] { (void)run_trial(setup, p, {}, saved); }, "trial.h5");
  write_file_atomically(saved.path, "words");
  refused([&] { (void)run_trial(setup, p, {}, saved); }, "trial.h5");
}

TEST_CASE_METHOD(SavedTrial, "a trial beyond the memory of GPUs is refused before its first step and writes nothing") {
  int samples = 0, frames = 0;
  TrialWatch watch;
  watch.sample = [&](const TrialSample&) { ++samples; };
  watch.frame = [&](const TrialFrame&) { ++frames; };
  const sim::PlantedMemory small(1e5);
  for (const int gpus : {1, 2}) try {
      (void)run_trial(setup, p, watch, saved, {sim::Backend::cpu, 1, gpus});
      FAIL("it fits");
    } catch (const OutOfMemory& error) {
      CHECK(contains(error.what(), gpus == 1 ? "memory: the world needs " : "memory: the largest of 2 parts of the "));
      CHECK(contains(error.what(), "no number of GPUs of this kind up to 8 would do"));
    }
  CHECK((samples == 0 && frames == 0));
  CHECK(fs::is_empty(folder.path()));
}

TEST_CASE_METHOD(SavedTrial, "when parts fail the last checkpoint is named and fewer go on with the same bits") {
  Samples whole, continued;
  const TrialRecord through = finished(setup, p, {}, whole);
  // The three ranks find too little memory when they next divide the world.
  std::optional<sim::PlantedMemory> small;
  int samples = 0;
  TrialWatch watch;
  watch.sample = [&](const TrialSample&) {
    if (++samples == 60) small.emplace(1e4);
  };
  try {
    (void)run_trial(setup, p, watch, saved, {sim::Backend::cpu, 1, 3});
    FAIL("no rank failed");
  } catch (const DeviceError& error) {
    CHECK(contains(error.what(), "the largest of 3 parts"));
    CHECK(contains(error.what(), "; the last checkpoint is " + saved.path.string() +
                                     ", from which the same command goes on, with fewer GPUs too"));
  }
  small.reset();
  REQUIRE(fs::exists(saved.path));
  const auto files = [&] { return std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()); };
  CHECK(files() == 4);  // one for each part, and the one that names them
  const TemporaryFolder kept;
  const auto all = fs::copy_options::recursive | fs::copy_options::overwrite_existing;
  fs::copy(folder.path(), kept.path(), all);
  for (const int gpus : {2, 1}) {
    fs::copy(kept.path(), folder.path(), all);
    Samples rest;
    TrialWatch again;
    again.sample = [&](const TrialSample& s) { rest.push_back(s); };
    check_same(run_trial(setup, p, again, saved, {sim::Backend::cpu, 1, gpus}), through);
    CHECK(same_bits(rest, whole));
    CHECK(files() == 0);
  }
}

TEST_CASE("a divided trial shows the shares of its parts and one in one piece shows none") {
  const TrialSetup setup = short_setup(0.1);
  const DesignPoint p = point(5);
  prepare_trials(setup, {&p, 1}, 1);
  for (const int parts : {1, 2}) {
    std::size_t shown = 0, bodies = 0;
    TrialWatch watch;
    watch.frame = [&](const TrialFrame& frame) { bodies = frame.world.body.size(); };
    watch.shares = [&](const std::vector<sim::PartShare>& shares) {
      ++shown;
      REQUIRE(shares.size() == 2);
      CHECK(std::size_t(shares[0].bodies + shares[1].bodies) == bodies);
    };
    (void)run_trial(setup, p, watch, {}, {sim::Backend::cpu, 1, parts});
    CHECK((shown > 0) == (parts == 2));
  }
}

TEST_CASE("a saved trial goes on over the GPUs that are left; a new one wants all that it asked for") {
  const TemporaryFolder folder;
  const TrialCheckpoint saved{folder / "trial.h5"};
  CHECK(gpus_left(4, 3, saved) == 4);
  write_file_atomically(saved.path, "state");
  CHECK(gpus_left(4, 3, saved) == 3);
  CHECK(gpus_left(2, 3, saved) == 2);
  CHECK(gpus_left(4, 0, saved) == 4);  // no GPU answers: that is refused
  CHECK(gpus_left(4, 3, {}) == 4);
}

TEST_CASE_METHOD(SavedTrial, "nothing is saved before the interval has passed") {
  run_until(setup, p, 150, 1, {saved.path, 1e6});
  CHECK_FALSE(fs::exists(saved.path));
}

}  // namespace gonogo::campaign
