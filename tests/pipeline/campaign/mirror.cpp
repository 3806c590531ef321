// Headings psi and -psi on a slope are mirror images of each other: so are trials on mirrored beds.
#include <cmath>

#include "pipeline/campaign/trial/judge.h"
#include "tests/support/catch.h"
#include "tests/support/locked_grains.h"
#include "tests/support/measure.h"
#include "tests/support/short_trial.h"

namespace gonogo::campaign {

namespace {

using test::agrees;

terrain::Packing mirrored(terrain::Packing p) {
  for (auto* grains : {&p.grain, &p.base})
    for (terrain::Grain& g : *grains) g.position.y = p.spec.width - g.position.y;
  return p;
}

struct Drive {
  DriveOutcome end;
  std::vector<sim::MonitorSample> sample;
};

/// Both phases of a trial on this settled bed.
Drive drive(const TrialSetup& setup, const DesignPoint& point, const terrain::Packing& settled) {
  const TrialConditions conditions = conditions_of(setup, inputs_of(point));
  const sim::StepSettings settings = attempt_settings(setup, 1);
  const auto alone = sim::make_simulation(sim::Backend::cpu, {bed_alone(setup, settled, conditions)}, settings, 1);
  alone->advance(bed_steps(setup, settings));
  const TiltedBed bed = tilted_bed(*alone, 0, settled);
  REQUIRE(!fails(setup, bed));
  const auto s =
      sim::make_simulation(sim::Backend::cpu, {vehicle_on_bed(setup, settled, bed, conditions)}, settings, 1);
  while (s->stop(0).cause == sim::StopCause::none) s->advance(20);
  return {judge_drive(setup, conditions, bed, setup.numerics.step, *s, 0),
          s->samples(0, 0, 0, s->monitor(0, 0).sample_count)};
}

DesignPoint traverse(double across) {
  DesignPoint p = design_point(4, 34, 0.2);
  p.variables[contract().variable_index("slope_across")] = across;
  return p;
}

}  // namespace

TEST_CASE("headings psi and -psi mirror each other: the same slip and sinkage, opposite drift") {
  TrialSetup setup = short_setup(0.6);
  setup.calibration = test::locked_grains();
  setup.numerics = {2e-3, 1, 400, 1e-4};
  const DesignPoint left = traverse(14), right = traverse(-14);
  prepare_trials(setup, {&left, 1}, 1);
  const terrain::Packing bed = settled_bed(setup, inputs_of(left));
  const Drive a = drive(setup, left, bed), b = drive(setup, right, mirrored(bed)), c = drive(setup, right, bed);
  REQUIRE(a.sample.size() == b.sample.size());
  double x = 0, y = 0, drop = 0, other = 0;
  for (std::size_t k = 0; k < a.sample.size(); ++k) {
    x = std::max(x, std::fabs(a.sample[k].x - b.sample[k].x));
    y = std::max(y, std::fabs(a.sample[k].y + b.sample[k].y));
    drop = std::max(drop, std::fabs(double(a.sample[k].drop - b.sample[k].drop)));
    other = std::max(other, std::fabs(a.sample[k].y + c.sample[k].y));
  }
  CHECK(a.end.drift < -0.01);  // down the slope, to the right
  // Rounding differs, and grains that are about to slide let it grow: a twentieth of a grain is allowed.
  CHECK(agrees("way along, difference [m]", 0, x, 5e-3));
  CHECK(agrees("drift of one plus drift of the other [m]", 0, y, 5e-3));
  CHECK(agrees("height of the axle, difference [m]", 0, drop, 5e-3));
  CHECK(agrees("slip", a.end.slip, b.end.slip, 3e-3));
  CHECK(agrees("mean sinkage [m]", a.end.sinkage, b.end.sinkage, 1e-3));
  std::printf("drift on a bed that is not mirrored differs by %.4f m\n", other);
  CHECK(other > 2 * y);
}

}  // namespace gonogo::campaign
