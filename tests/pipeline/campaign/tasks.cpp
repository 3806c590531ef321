// Types of trials: what each does to the ground, what it takes to pass, and what is refused.
#include "pipeline/campaign/setup/task.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/format.h"
#include "base/units.h"
#include "pipeline/campaign/trial/judge.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/message.h"
#include "tests/support/refused.h"
#include "tests/support/short_trial.h"
#include "vehicle/model/statics.h"

namespace gonogo::campaign {

namespace {

using test::agrees;

/// The quarter vehicle of the demo on a bed that is long enough for a task of this text.
TrialSetup rig_setup(const std::string& task) {
  const std::filesystem::path root = GONOGO_SOURCE_DIR;
  TrialSetup s =
      vehicle_trial_setup(root / "configs/vehicles/hmmwv_quarter.json", root / "configs/soils/calibration_90mm.json",
                          parse_task(task), {}, std::filesystem::temp_directory_path() / "gonogo-test-beds");
  s.bed_width = 0.7;
  s.numerics = {2e-3, 1, 60, 0.01};
  s.bed_settle_time = 0.1;
  s.packing_seeds = 1;
  return s;
}

/// Grains of the undisturbed bed and of the bed of the task, which keeps their order.
struct Beds {
  terrain::Packing whole, shaped;
  Course course;
};

Beds beds_of(const std::string& task) {
  TrialSetup s = rig_setup(task);
  const DesignPoint p = design_point(0, 34, 0.3);
  Beds b;
  b.shaped = settled_bed(s, inputs_of(p));
  b.course = s.course(b.shaped.surface);
  s.task = default_task();
  b.whole = settled_bed(s, inputs_of(p));
  return b;
}

TrialRecord run(const TrialSetup& s, double slope, double friction_angle) {
  const DesignPoint p = design_point(slope, friction_angle, 0.3);
  prepare_trials(s, {&p, 1}, 1);
  return run_trial(s, p);
}

}  // namespace

TEST_CASE("a ditch takes out the grains above its profile and no others") {
  const Beds b = beds_of("ditch:width_m=0.8,depth_m=0.15,side_deg=45");
  const double from = b.course.start + b.course.front + 0.2;
  std::size_t kept = 0;
  for (const terrain::Grain& g : b.whole.grain) {
    double x = g.position.x;
    if (x < from) x += b.course.length;
    const bool over = x > from && x < from + 0.8;
    const double profile = b.course.surface - std::min({0.15, x - from, from + 0.8 - x});
    if (over && g.position.z > profile) continue;
    REQUIRE(kept < b.shaped.grain.size());
    CHECK(length(g.position - b.shaped.grain[kept].position) == 0);
    ++kept;
  }
  CHECK(kept == b.shaped.grain.size());
  CHECK(kept < b.whole.grain.size());
}

TEST_CASE("a step stands in the bed where no grain is, as high over the surface as it says") {
  const Beds b = beds_of("step:height_m=0.3,length_m=0.6");
  const TrialSetup s = rig_setup("step:height_m=0.3,length_m=0.6");
  const DesignPoint p = design_point(0, 34, 0.3);
  const sim::SceneWorld w = bed_alone(s, b.shaped, conditions_of(s, inputs_of(p)));
  const sim::Shape& box = w.shape.back();
  REQUIRE(box.type == sim::ShapeType::box);
  const Vec3d at = w.body.back().position;
  CHECK(agrees("top over the surface [m]", 0.3, at.z + box.size.z - b.course.surface, 1e-6));
  CHECK(agrees("near side from the tyre [m]", 0.2, at.x - box.size.x - b.course.start - b.course.front, 1e-6));
  for (const terrain::Grain& g : b.shaped.grain)
    CHECK(std::fabs(std::remainder(g.position.x - at.x, b.course.length)) >= box.size.x + g.radius - 1e-6);
}

TEST_CASE("the strip of a crossing holds the grains of its length in softer soil, and all others keep theirs") {
  const TrialSetup s = rig_setup("crossing:length_m=0.9,friction_angle_deg=18");
  const DesignPoint p = design_point(0, 34, 0.3);
  const terrain::Packing bed = settled_bed(s, inputs_of(p));
  const TrialConditions c = conditions_of(s, inputs_of(p));
  const sim::SceneWorld w = bed_alone(s, bed, c);
  const Course course = s.course(bed.surface);
  const double from = course.start + course.front + 0.2;
  int soft = 0;
  for (std::size_t i = 0; i < bed.grain.size(); ++i) {
    const double x = std::fmod(bed.grain[i].position.x - from + 2 * course.length, course.length);
    CHECK((w.shape[i].material == 3) == (x < 0.9));
    soft += x < 0.9;
  }
  CHECK(soft > 0);
  CHECK(double(w.law[3][3].friction) < double(w.law[0][0].friction));
  CHECK(w.law[3][0].friction == w.law[3][3].friction);
}

TEST_CASE("a wheel climbs a low step and not one far higher than its axle") {
  const TrialRecord low = run(rig_setup("step:height_m=0.06,length_m=0.5"), 0, 36);
  INFO(contract().info(low.reason).name);
  CHECK((low.verdict == Verdict::go || low.verdict == Verdict::slow_go));
  const TrialRecord high = run(rig_setup("step:height_m=0.8,length_m=0.5"), 0, 36);
  CHECK(high.verdict == Verdict::no_go);
  CHECK(high.reason != Reason::slid_back);
  CHECK(high.measures[contract().measure_index("distance")] < 0.3);  // the step is 0.2 m before it
}

TEST_CASE("in a drawbar sweep slip grows, and its pull is what the grains do to the wheel") {
  TrialSetup s = rig_setup("drawbar:max_pull_per_weight=1,sweep_s=2.4");
  s.min_drive_time = 0.6;
  s.bed_length = 3.6;
  s.numerics.step = 1e-3;  // with half of both the wheel pulls more than it weighs
  s.numerics.iterations = 120;
  const DesignPoint p = design_point(0, 38, 0.3);
  prepare_trials(s, {&p, 1}, 1);
  TrialWatch watch;
  watch.frame_interval = 0.002;
  std::vector<double> force;
  watch.frame = [&](const TrialFrame& f) {
    if (f.wheel >= 0 && f.sample.time > s.tow_start())
      force.push_back(f.simulation.contact_force(f.place, f.wheel).x / s.weight(0));
  };
  const TrialRecord r = run_trial(s, p, watch);
  REQUIRE(r.pull.size() >= 6);
  CHECK(r.verdict != Verdict::unknown);
  CHECK(r.pull.back().slip > r.pull.front().slip + 0.5);  // no tyre pulls its own weight
  // Parts of 0.24 s are 120 frames; bumps of single parts cancel in the mean of six.
  double pull = 0, contacts = 0;
  for (int k = 0; k < 6; ++k) pull += r.pull[std::size_t(k)].pull / 6;
  REQUIRE(force.size() >= 720);
  for (int k = 0; k < 720; ++k) contacts += force[std::size_t(k)] / 720;
  CHECK(agrees("pull over weight, mean of six parts", contacts, pull, 0.05));
}

TEST_CASE("a wheel that is led has the slip it is given, and the carriage carries what the grains do to the wheel") {
  double pull[2];
  for (const int k : {0, 1}) {
    const double slip = k == 0 ? -0.1 : 0.5;
    TrialSetup s = rig_setup("single_wheel:slip=" + std::to_string(slip));
    s.bed_length = 3.6;
    s.time_limit = 1.6;
    const DesignPoint p = design_point(0, 38, 0.3);
    prepare_trials(s, {&p, 1}, 1);
    TrialWatch watch;
    watch.frame_interval = 0.002;
    std::vector<double> force, speed;  // on and of the wheel in every step
    watch.frame = [&](const TrialFrame& f) {
      if (f.wheel < 0) return;
      force.push_back(f.simulation.contact_force(f.place, f.wheel).x / s.weight(0));
      speed.push_back(double(f.simulation.body(f.place, f.wheel).velocity.x));
    };
    const TrialRecord r = run_trial(s, p, watch);
    REQUIRE(r.pull.size() == 1);
    CHECK(agrees("slip", slip, r.pull[0].slip, 0.02));
    const std::size_t half = force.size() / 2, count = force.size() - half;
    const double contacts = std::accumulate(force.begin() + std::ptrdiff_t(half), force.end(), 0.0) / double(count);
    const double gained = (speed.back() - speed[half]) / (double(count - 1) * 0.002) / kGravity;
    CHECK(agrees("pull of the carriage, of the contacts less what speeds the wheel up, per weight", contacts - gained,
                 r.pull[0].pull, 0.02));
    pull[k] = r.pull[0].pull;
  }
  CHECK(pull[0] < pull[1]);
  CHECK(pull[0] < 0);
}

TEST_CASE(
    "a wheel led at a slip angle is pushed aside by what its grains do to it, and the mirrored wheel the other way") {
  double side[2] = {};
  for (const int n : {0, 1, 2, 3, 4, 5}) {  // three places of the bed each: grains are a third of the wheel's width
    const double angle = n % 2 == 0 ? 20 : -20;
    TrialSetup s = rig_setup("single_wheel:slip=0.2,slip_angle_deg=" + std::to_string(angle));
    s.numerics = terrain::numerics_by_table(s.calibration, s.calibration_file);
    s.bed_length = 3.6;
    s.time_limit = 1.6;
    DesignPoint p = design_point(0, 38, 0.3);
    p.seed = 5 + std::uint64_t(n);
    prepare_trials(s, {&p, 1}, 1);
    TrialWatch watch;
    watch.frame_interval = 0.002;
    std::vector<Vec3d> force, velocity;  // on and of the wheel in every step
    watch.frame = [&](const TrialFrame& f) {
      if (f.wheel < 0) return;
      force.push_back(static_cast<Vec3d>(f.simulation.contact_force(f.place, f.wheel)) * (1 / s.weight(0)));
      velocity.push_back(static_cast<Vec3d>(f.simulation.body(f.place, f.wheel).velocity));
    };
    const TrialRecord r = run_trial(s, p, watch);
    REQUIRE(r.pull.size() == 1);
    const std::size_t half = force.size() / 2, count = force.size() - half;
    Vec3d mean;
    for (std::size_t i = half; i < force.size(); ++i) mean += force[i] * (1 / double(count));
    const Vec3d left_over = mean - (velocity.back() - velocity[half]) * (1 / (double(count - 1) * 0.002 * kGravity));
    const double cosine = std::cos(angle * kDegree), sine = std::sin(angle * kDegree);
    CHECK(agrees("pull along the heading, of the contacts per weight", cosine * left_over.x + sine * left_over.y,
                 r.pull[0].pull, 0.02));
    CHECK(agrees("side force to the left, of the contacts per weight", cosine * left_over.y - sine * left_over.x,
                 r.pull[0].side, 0.02));
    CHECK(agrees("drift of a wheel that is held [m]", 0, measure_of(r, "drift"), 0.01));
    side[n % 2] += r.pull[0].side / 3;
  }
  CHECK(side[0] > 0.05);
  CHECK(side[1] < -0.05);
  CHECK(agrees("the mirrored wheel's side force, mean of three places of the bed", -side[0], side[1], 0.3 * side[0]));
}

TEST_CASE("the example of every type of task makes a task of its name, within the ranges that the type states") {
  REQUIRE(task_types().size() >= 7);
  for (const TaskType* type : task_types()) {
    INFO(type->name);
    CHECK(parse_task(type->example)->name() == type->name);
    CHECK(contains(task_examples(), type->example));
    for (const TaskParameter& p : type->parameters) {
      const std::string beyond =
          line("%s%s%s=%g", type->example, contains(type->example, ":") ? "," : ":", p.key, p.allowed.maximum + 1);
      refused([&] { parse_task(beyond); }, p.key);
    }
  }
}

TEST_CASE("tasks that cannot be done are refused") {
  refused([] { parse_task("single_wheel:slip=0.2,slip_angle_deg=91"); }, "slip_angle_deg");
  refused([] { parse_task("jump"); }, "type");
  refused([] { parse_task("step:height_m=high"); }, "type:name=number");
  refused([] { parse_task("step"); }, "height_m");
  refused([] { parse_task("ditch:width_m=1,depth_m=0.2,colour=3"); }, "colour");
  refused([] { beds_of("ditch:width_m=1,depth_m=0.29"); }, "deeper");
  refused(
      [] {
        vehicle_trial_setup(std::filesystem::path(GONOGO_SOURCE_DIR) / "configs/vehicles/hmmwv.json",
                            std::filesystem::path(GONOGO_SOURCE_DIR) / "configs/soils/calibration_90mm.json",
                            parse_task("single_wheel:slip=0.2"));
      },
      "quarter");
  refused(
      [] {
        vehicle_trial_setup(std::filesystem::path(GONOGO_SOURCE_DIR) / "configs/vehicles/hmmwv.json",
                            std::filesystem::path(GONOGO_SOURCE_DIR) / "configs/soils/calibration_90mm.json",
                            parse_task("single_wheel:slip=0.2,slip_angle_deg=10"));
      },
      "slip angle");
  CHECK(parse_task("climb")->name() == "climb");
  const auto judged = [](const char* task, Verdict verdict, Reason reason, double travelled, double drift) {
    return parse_task(task)->judge({.verdict = verdict,
                                    .reason = reason,
                                    .travelled = travelled,
                                    .drift = drift,
                                    .vehicle_length = 4,
                                    .go_slip = 0.4,
                                    .pull = {}});
  };
  CHECK(judged("side_slope", Verdict::go, Reason::none, 5, 1.5).second == Reason::slid_back);
  CHECK(judged("side_slope", Verdict::go, Reason::none, 5, 0.5).first == Verdict::go);
  CHECK(judged("ditch:width_m=1,depth_m=0.1", Verdict::no_go, Reason::timeout, 1, 0).second == Reason::obstacle);
}

}  // namespace gonogo::campaign
