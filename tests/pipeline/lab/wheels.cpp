// Benchmarks of wheels: what ships against numbers that others computed from it, agreement by hand, and the conversions
// between what trials give and what experiments count.
#include <cmath>

#include "pipeline/lab/wheels/analytic.h"
#include "pipeline/lab/wheels/plan.h"
#include "pipeline/lab/wheels/report.h"
#include "tests/support/catch.h"
#include "vehicle/model/statics.h"

using namespace gonogo;
using namespace gonogo::lab;

namespace {

double rms(const Benchmark& b, const Predictor& p, Quantity q, double up_to = 1e9) {
  return agreement_of(compared(b, p, q, up_to)).rms;
}

/// Predicts what was measured, plus `off`.
Predictor perfect(const Benchmark& b, double off = 0) {
  Predictor p{"perfect", "", {}};
  for (const BenchmarkPoint& point : b.point) {
    auto& at = p.point.emplace_back();
    for (const auto& [q, m] : point.measured) at[q] = {m.mean + off, 0, m.mean + off, m.mean + off};
  }
  return p;
}

}  // namespace

TEST_CASE("the published simulation of MGRU3 and the tests of 2022 have the slip errors computed from their tables") {
  const Benchmark b = read_benchmark("mgru3");
  REQUIRE(b.point.size() == 6);
  REQUIRE(b.published.size() == 2);
  const Predictor published = interpolated(b, b.published[0]), repeated = interpolated(b, b.published[1]);
  CHECK(rms(b, published, Quantity::slip) == Approx(0.094).epsilon(0.01));
  CHECK(rms(b, published, Quantity::slip, 15) == Approx(0.050).epsilon(0.02));
  CHECK(repeated.point[0].at(Quantity::slip).mean == Approx(0.0251));  // below the first slope: the first slip
  CHECK(repeated.point[3].at(Quantity::slip).mean == Approx(0.1043 + 4.93 / 5.277 * 0.2508));
  CHECK(rms(b, repeated, Quantity::slip) == Approx(0.046).epsilon(0.02));
}

TEST_CASE("rows at one slip are repeats of a point") {
  const Benchmark b = read_benchmark("trec");
  REQUIRE(b.point.size() == 10);
  const Measured& m = b.point[2].measured.at(Quantity::traction_slope);
  CHECK(m.mean == Approx((13.82 + 16.93) / 2));
  CHECK(m.low == Approx(13.82));
  CHECK(m.tests == 2);
  CHECK(b.scatter_at(b.point[2], Quantity::traction_slope) == Approx((16.93 - 13.82) / 2));
  double widest = 0;
  for (const BenchmarkPoint& p : b.point) {
    const Measured& at = p.measured.at(Quantity::traction_slope);
    widest = std::max(widest, at.high - at.low);
  }
  CHECK(b.bound.front().at_most == Approx(widest));  // the bar is how far two tests at one slip are apart
  const Benchmark cmu = read_benchmark("cmu_smooth");
  CHECK(cmu.point.size() == 35);  // seven slip angles, five slips from 0 on
  for (const BenchmarkPoint& p : cmu.point) {
    CHECK(p.measured.at(Quantity::pull).tests == 3);
    CHECK(p.led.at(Quantity::load) > 15);
  }
}

TEST_CASE("a prediction that equals what was measured keeps all bounds, one that could not be made none") {
  for (const std::string& name : benchmark_names()) {
    const Benchmark b = read_benchmark(name);
    INFO(name);
    WheelOutcome outcome;
    outcome.predictor = perfect(b);
    const WheelReport good = report_of(b, outcome, {}, {});
    CHECK(good.check.size() == b.bound.size());
    CHECK_FALSE(good.check.empty());
    CHECK(failures(good) == 0);
    outcome.predictor.point[0].clear();
    CHECK(failures(report_of(b, outcome, {}, {})) == int(b.bound.size()));
  }
}

TEST_CASE("agreement has the numbers worked by hand") {
  const std::vector<ComparedValue> values{
      {.measured = 10, .predicted = 12, .scatter = 1, .load = 20, .low = 11, .high = 13},
      {.measured = -4, .predicted = -3, .scatter = 2, .load = 10, .low = -3, .high = -3},
      {.measured = 5, .predicted = 4, .load = 40, .low = 4, .high = 4}};
  const Agreement a = agreement_of(values);
  CHECK(a.rms == Approx(std::sqrt((4 + 1 + 1) / 3.0)));
  CHECK(a.bias == Approx((2 + 1 - 1) / 3.0));
  CHECK(a.rms_over_load == Approx(std::sqrt((0.01 + 0.01 + 0.000625) / 3)));
  CHECK(a.bias_over_load == Approx((0.1 + 0.1 - 0.025) / 3));
  CHECK(a.median_relative_error == Approx(0.2));
  CHECK(a.worst_factor == Approx(4.0 / 3));
  CHECK(a.with_scatter == 2);
  CHECK(a.inside == 1);
  CHECK(a.band_meets == 2);
  std::vector<ComparedValue> wrong_sign = values;
  wrong_sign[0].predicted = -12;
  CHECK(std::isinf(agreement_of(wrong_sign).worst_factor));
  wrong_sign[0].predicted = std::nan("");
  for (const std::string& measure : measure_names()) CHECK(std::isnan(measure_of(agreement_of(wrong_sign), measure)));
}

TEST_CASE("slip over the lugs and slip of the rim are each other's inverse; sinkage differs by the lugs") {
  const Benchmark b = read_benchmark("mgru3");
  const vehicle::Wheel& w = wheel_of(b);  // 225 mm and lugs of 25 mm
  CHECK(slip_from_rim(b, w, 0) == Approx(0.1));
  CHECK(slip_of_rim(b, w, 0) == Approx(1 - 10.0 / 9));
  for (const double slip : {-0.2, 0.0, 0.4, 1.0}) CHECK(slip_from_rim(b, w, slip_of_rim(b, w, slip)) == Approx(slip));
  CHECK(sinkage_from_tips(b, w, 0.03) == 0.03);
  const Benchmark ding = read_benchmark("ding_lugs");
  CHECK(slip_from_rim(ding, wheel_of(ding), 0.3) == 0.3);
  CHECK(sinkage_from_tips(ding, wheel_of(ding), 0.017) == Approx(0.007));
}

TEST_CASE("a wheel's quarter carries its load, and each point of CMU its own") {
  const Benchmark ding = read_benchmark("ding_smooth");
  CHECK(vehicle::weigh(ding.vehicle).total * 9.81 == Approx(80).epsilon(1e-3));
  const Benchmark cmu = read_benchmark("cmu_smooth");
  double least = 1e9;
  for (const BenchmarkPoint& p : cmu.point) least = std::min(least, p.led.at(Quantity::load));
  CHECK(load_at(cmu, cmu.point.back()) == cmu.point.back().led.at(Quantity::load));
  CHECK(vehicle::weigh(cmu.vehicle).total * 9.81 == Approx(least).epsilon(0.02));
  const Benchmark rover = read_benchmark("mgru3_rover");
  CHECK(load_at(rover, rover.point[0]) == Approx(88 * 9.81 / 4).epsilon(1e-3));
}

TEST_CASE("wheels take the numerics of their table, or the iterations asked for") {
  const auto numerics = [](WheelRun run) {
    run.calibration = std::string(GONOGO_SOURCE_DIR) + "/configs/soils/calibration_32mm.json";
    return plan_wheels({read_benchmark("ding_smooth")}, run).setup.front()->numerics;
  };
  CHECK(numerics({}) == terrain::usual_numerics(0.032));
  WheelRun asked;
  asked.numerics.iterations = 3;
  CHECK(numerics(asked).iterations == 3);
}

TEST_CASE("rims turn as fast as the experiment's, and no slower than at a quarter of sqrt(g r)") {
  Benchmark b = read_benchmark("ding_smooth");
  const double radius = b.vehicle.wheel.front().radius, slowest = 0.25 * std::sqrt(9.81 * radius);
  CHECK(rim_speed_of(b) == Approx(slowest));
  b.rim_turning = 0.1;
  CHECK(rim_speed_of(b) == Approx(slowest));
  b.rim_turning = 10;
  CHECK(rim_speed_of(b) == Approx(10 * radius));
}

WheelRun nominal_run() {
  WheelRun run;
  run.calibration = std::string(GONOGO_SOURCE_DIR) + "/configs/soils/calibration_32mm.json";
  run.band = false;
  run.seeds = 1;
  return run;
}

TEST_CASE(
    "a wheel under slip angles ploughs a bed twice as deep, until its carriage has gone three radii or for twice the "
    "time") {
  WheelRun run = nominal_run();
  Benchmark b = read_benchmark("cmu_smooth");
  b.way = 0;
  const WheelBed bed = bed_of(b, run);
  CHECK(bed.grain == Approx(b.vehicle.wheel.front().width / 8));
  CHECK(bed.depth == Approx(1.6 * b.vehicle.wheel.front().radius));
  CHECK(bed.time == Approx(6.4 * b.vehicle.wheel.front().radius / rim_speed_of(b)));
  const WheelPlan plan = plan_wheels({b}, run);
  for (const PlannedTrial& t : plan.trial) {
    const double slip = b.point[t.at].led.at(Quantity::slip), time = t.setup->time_limit;
    CHECK(time == t.setup->min_drive_time);
    CHECK(time >= bed.time);
    CHECK(time <= 2.001 * bed.time);
    if (slip < 0 || time > 1.999 * bed.time) continue;
    CHECK((1 - slip) * rim_speed_of(b) * time >= 2.999 * b.vehicle.wheel.front().radius);
  }
  run.time = 1;
  CHECK(plan_wheels({b}, run).setup.back()->time_limit == 1);
}

TEST_CASE("the half of a led wheel's trial that counts has its middle where the experiment was averaged") {
  WheelRun run = nominal_run();
  const Benchmark b = read_benchmark("cmu_smooth");
  REQUIRE(b.way == 0.725);
  const WheelPlan plan = plan_wheels({b}, run);
  for (const PlannedTrial& t : plan.trial) {
    const double slip = b.point[t.at].led.at(Quantity::slip);
    CHECK(t.setup->time_limit == t.setup->min_drive_time);
    CHECK(0.75 * t.setup->time_limit * (1 - slip) * rim_speed_of(b) == Approx(0.725));
  }
  run.quick = true;
  for (const auto& setup : plan_wheels({b}, run).setup) CHECK(setup->time_limit <= 2.001 * bed_of(b, run).time);
}

TEST_CASE("grains roll on the wheels of benchmarks as on each other, or as asked") {
  WheelRun run;
  run.calibration = std::string(GONOGO_SOURCE_DIR) + "/configs/soils/calibration_32mm.json";
  const auto rolling = [&] { return plan_wheels({read_benchmark("ding_smooth")}, run).setup.front()->wheel_rolling; };
  CHECK(rolling() == 1);
  run.wheel_rolling = 0;
  CHECK(rolling() == 0);
}

TEST_CASE("grains are a tenth of the wheel's width, or as large as lower lugs down to a twentieth") {
  Benchmark b = read_benchmark("ding_lugs");
  WheelRun run;
  const double width = b.vehicle.wheel.front().width;
  REQUIRE(width == Approx(0.165));
  CHECK(bed_of(read_benchmark("ding_smooth"), run).grain == Approx(0.0165));
  CHECK(bed_of(b, run).grain == Approx(0.01));
  b.vehicle.wheel.front().lug_height = 0.03;
  CHECK(bed_of(b, run).grain == Approx(0.0165));
  b.vehicle.wheel.front().lug_height = 0.002;
  CHECK(bed_of(b, run).grain == Approx(0.00825));
  run.quick = true;
  CHECK(bed_of(b, run).grain == Approx(0.033));
  run.grain = 0.012;
  CHECK(bed_of(b, run).grain == Approx(0.012));
}

TEST_CASE("formulas climb the slope on which their pull is the load's part along it") {
  Benchmark b = read_benchmark("mgru3");
  BekkerCases sand{{{.n = 1.1,
                     .k_c = 990,
                     .k_phi = 1.528e6,
                     .cohesion = 0,
                     .friction_angle = 0.67,
                     .shear_modulus = 0.012,
                     .unit_weight = 1.7e4}}};
  const Predictor p = analytic_predictor(b, sand, "formula", "");
  const vehicle::Wheel& w = wheel_of(b);
  for (std::size_t i = 0; i < b.point.size(); ++i) {
    const double slip = p.point[i].at(Quantity::slip).mean;
    if (slip >= 1) continue;  // does not climb
    const double load = load_at(b, b.point[i]);
    const auto f = vehicle::wheel_forces_under(sand.soil[0], vehicle::RigidWheel{w.radius, w.width, w.lug_height},
                                               {slip, 0}, load);
    CHECK(f.drawbar_pull / load ==
          Approx(std::tan(b.point[i].led.at(Quantity::slope) * 3.14159265 / 180)).margin(2e-3));
  }
  CHECK(p.point[0].at(Quantity::slip).mean < p.point[3].at(Quantity::slip).mean);
}
