// Trials side by side: what each gives must not depend on the others.
#include "pipeline/campaign/trial/trial.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <map>

#include "base/error.h"
#include "base/files/file.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/short_trial.h"
#include "tests/support/temporary_folder.h"

namespace gonogo::campaign {

namespace {

namespace fs = std::filesystem;

/// Steps of the two phases share no divisor, so that trials that began together soon look at different times.
TrialSetup batch_setup() {
  TrialSetup s = short_setup(0.35);
  s.bed_settle_time = 0.074;
  s.run_in_distance = 0.02;
  s.test_distance = 0.08;
  s.thresholds.immobile_time = 0.1;
  return s;
}

DesignPoint point(std::uint64_t index, double slope, double friction_angle, double depth, double payload = 0) {
  DesignPoint p = design_point(slope, friction_angle, depth);
  p.index = index;
  p.seed = 5 + index % 2;
  p.variables[contract().variable_index("payload")] = payload;
  return p;
}

/// Trials of differing lengths on beds of three depths, shallow ones first so that places have to grow; number 4 fails
/// before its wheel is there.
std::vector<DesignPoint> some_points() {
  return {point(0, 0, 34, 0.2),      point(1, 32, 18, 0.2),        point(2, 10, 30, 0.25),
          point(3, 5, 40, 0.2, 500), point(4, 44, 18, 0.2),        point(5, 20, 22, 0.3),
          point(6, 0, 16, 0.2),      point(7, 15, 35, 0.25, 1000), point(8, 28, 25, 0.3)};
}

using Records = std::map<std::uint64_t, TrialRecord>;

/// Keeps the batch full until all trials are over. `max_waiting`: trials that waited for a second attempt at a time.
Records run_all(const TrialSetup& setup, const std::vector<DesignPoint>& points, sim::Backend backend, int places,
                int* max_waiting = nullptr) {
  TrialBatch batch(setup, {backend, places, 1});
  std::deque<DesignPoint> todo(points.begin(), points.end());
  Records records;
  while (batch.running() > 0 || !todo.empty()) {
    for (; batch.free_places() > 0 && !todo.empty(); todo.pop_front()) batch.start(todo.front());
    for (TrialRecord& r : batch.advance()) records.emplace(r.point.index, std::move(r));
    if (max_waiting != nullptr) *max_waiting = std::max(*max_waiting, batch.waiting());
  }
  return records;
}

void check_same(const TrialRecord& a, const TrialRecord& b) {
  INFO("trial " << a.point.index);
  CHECK(a.verdict == b.verdict);
  CHECK(a.reason == b.reason);
  CHECK(a.attempts == b.attempts);
  CHECK(std::memcmp(a.measures.data(), b.measures.data(), a.measures.size() * sizeof(double)) == 0);
}

void check_same(const Records& a, const Records& b) {
  REQUIRE(a.size() == b.size());
  for (const auto& [index, record] : a) check_same(record, b.at(index));
}

}  // namespace

TEST_CASE("a trial's record has the same bits alone and in 1, 3 and 8 places, in any order") {
  const TrialSetup setup = batch_setup();
  std::vector<DesignPoint> points = some_points();
  prepare_trials(setup, points, 2);
  for (const sim::Backend backend : test::backends()) {
    INFO(test::name_of(backend));
    const Records alone = run_all(setup, points, backend, 1);
    if (backend == sim::Backend::cpu)
      for (const DesignPoint& p : {points[0], points[5]}) check_same(run_trial(setup, p), alone.at(p.index));
    check_same(run_all(setup, points, backend, 3), alone);
    std::vector<DesignPoint> backwards(points.rbegin(), points.rend());
    check_same(run_all(setup, backwards, backend, 8), alone);
    // The trials are as different as they are meant to be.
    CHECK(alone.at(4).reason == Reason::slope_unstable);
    std::vector<double> times;
    for (const auto& [index, record] : alone) times.push_back(measure_of(record, "drive_time"));
    const double longest = *std::max_element(times.begin(), times.end());
    CHECK(std::count_if(times.begin(), times.end(), [&](double t) { return t > 0 && t < 0.9 * longest; }) >= 3);
  }
}

TEST_CASE("trials that need a second attempt have the bits that they have alone, and so have the others") {
  TrialSetup setup = batch_setup();
  std::vector<DesignPoint> points = some_points();
  points.resize(6);
  prepare_trials(setup, points, 2);
  const Records first = run_all(setup, points, sim::Backend::cpu, 1);
  std::vector<double> residuals;
  for (const auto& [index, record] : first) residuals.push_back(measure_of(record, "worst_residual"));
  std::sort(residuals.begin(), residuals.end());
  setup.thresholds.residual = 0.5 * (residuals[2] + residuals[3]);  // half of the trials miss it
  for (const sim::Backend backend : test::backends()) {
    const Records alone = run_all(setup, points, backend, 1);
    const auto attempts = [&](std::uint64_t n) {
      return std::count_if(alone.begin(), alone.end(), [n](const auto& r) { return r.second.attempts == n; });
    };
    CHECK(attempts(1) >= 2);
    CHECK(attempts(2) >= 2);
    int waited_alone = 0, waited = 0;
    check_same(run_all(setup, points, backend, 3, &waited_alone), alone);
    check_same(run_all(setup, points, backend, 12, &waited), alone);
    CHECK(waited_alone <= 1);  // one of three places is enough to begin
    CHECK(waited >= 2);        // of twelve it takes three, or as many as go on
  }
}

TEST_CASE("a world that raises a flag makes its own trial unknown and leaves the others alone") {
  TrialSetup setup = batch_setup();
  setup.vehicle.driveline.engine.value = {1e9};  // the wheel of number 2 really turns as fast as it is told to
  std::vector<DesignPoint> points = some_points();
  points.resize(4);
  prepare_trials(setup, points, 2);
  for (const sim::Backend backend : test::backends()) {
    const Records sound = run_all(setup, points, backend, 4);
    std::vector<DesignPoint> mixed = points;
    mixed[2].variables[contract().variable_index("commanded_speed")] = 1e5;
    const Records records = run_all(setup, mixed, backend, 4);
    CHECK(records.at(2).verdict == Verdict::unknown);
    CHECK(records.at(2).reason == Reason::simulation_failed);
    CHECK((records.at(2).failed_checks & (check_not_finite | check_too_fast | check_left_domain)) != 0);
    CHECK(records.at(2).attempts == 2);
    CHECK(sound.at(2).verdict != Verdict::unknown);
    for (const std::uint64_t other : {0, 1, 3}) check_same(records.at(other), sound.at(other));
  }
}

TEST_CASE("trials cut off in a batch of three go on in another batch to the same records") {
  const TemporaryFolder folder;
  const TrialSetup setup = batch_setup();
  const std::vector<DesignPoint> all = some_points(), cut{all[0], all[2], all[3]};
  prepare_trials(setup, all, 2);
  const auto saved = [&](const DesignPoint& p) {
    return TrialCheckpoint{folder / ("trial-" + std::to_string(p.index) + ".h5"), 0, false};
  };
  for (const sim::Backend backend : test::backends()) {
    const Records alone = run_all(setup, all, backend, 1);
    // Looks to the end of a trial that is not cut off.
    const auto looks_to_end = [&](const DesignPoint& p) {
      TrialBatch batch(setup, {backend, 1, 1});
      batch.start(p);
      int looks = 1;
      while (batch.advance().empty()) ++looks;
      return looks;
    };
    for (const int looks : {1, 2, 4}) {  // in the first phase, at its end, in the second
      for (const DesignPoint& p : cut) fs::remove(saved(p).path);
      {
        TrialBatch batch(setup, {backend, 3, 1});
        for (const DesignPoint& p : cut) batch.start(p, {}, saved(p));
        for (int k = 0; k < looks; ++k) REQUIRE(batch.advance().empty());
      }
      const std::string image = read_file(saved(cut[0]).path);
      TrialBatch batch(setup, {backend, 4, 1});  // in other places, with other company
      batch.start(all[5]);
      for (const int k : {2, 1, 0}) batch.start(cut[std::size_t(k)], {}, saved(cut[std::size_t(k)]));
      while (batch.running() > 0)
        for (const TrialRecord& r : batch.advance()) check_same(r, alone.at(r.point.index));
      // It did go on, and did not begin anew.
      write_file_atomically(saved(cut[0]).path, image);
      TrialBatch rest(setup, {backend, 1, 1});
      rest.start(cut[0], {}, saved(cut[0]));
      int looks_left = 1;
      while (rest.advance().empty()) ++looks_left;
      const int all_looks = looks_to_end(cut[0]);
      CHECK(looks_left < all_looks);
      CHECK(looks_left >= all_looks - looks);  // one or more of those passed while its next world was made
    }
  }
}

TEST_CASE("a file that cannot be used is set aside where that was asked for, and the trial starts anew") {
  const TemporaryFolder folder;
  const TrialSetup setup = batch_setup();
  const DesignPoint p = some_points()[0], other = some_points()[2];
  prepare_trials(setup, std::vector<DesignPoint>{p, other}, 1);
  const TrialRecord expected = run_trial(setup, p);
  const TrialCheckpoint saved{folder / "trial.h5", 0, true};
  const auto image_of = [&](const DesignPoint& of) {
    TrialBatch batch(setup, {});
    batch.start(of, {}, saved);
    for (int k = 0; k < 4; ++k) REQUIRE(batch.advance().empty());
    return read_file(saved.path);
  };
  const std::string foreign = image_of(other);
  fs::remove(saved.path);
  for (const std::string& image : {foreign, foreign.substr(0, foreign.size() / 2), std::string("words")}) {
    write_file_atomically(saved.path, image);
    check_same(run_trial(setup, p, {}, saved), expected);
    CHECK(read_file(saved.path.string() + ".damaged") == image);
  }
}

TEST_CASE("a batch without places and one that is full refuse") {
  const TrialSetup setup = batch_setup();
  CHECK_THROWS_AS(TrialBatch(setup, {sim::Backend::cpu, 0, 1}), InputError);
  const DesignPoint p = some_points()[0];
  prepare_trials(setup, {&p, 1}, 1);
  TrialBatch batch(setup, {});
  batch.start(p);
  CHECK_THROWS_AS(batch.start(p), InputError);
}

}  // namespace gonogo::campaign
