#include "pipeline/validate/patch.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/line.h"

namespace gonogo::pipeline {
namespace {

/// A quarter vehicle's bed as tiles a metre long; a whole vehicle's has tiles already.
TrialSetup patch_setup(const PatchRequest& r) {
  TrialSetup s = vehicle_trial_setup(r.vehicle, r.calibration);
  s.settled_on = r.batch.backend;
  if (!s.whole) {
    const double d = s.calibration.grain_diameter, wheel = s.rig.radius + s.rig.lug_height;
    s.bed_length = std::max(12 * d, 1.0), s.bed_width = std::max(8 * d, 2.5 * s.rig.width);
    s.moving_patch = true;
    s.tiles_along = int(std::ceil((2 * s.patch().reach + std::max(4 * d, wheel)) / s.bed_length));
  }
  s.tiles_along += s.tiles_along % 2;
  s.start = 0.5 * s.tiles_along * s.bed_length;
  s.run_in_distance = 0.25 * r.distance;
  s.test_distance = 0.75 * r.distance;
  s.time_limit = 3 * r.distance / r.speed + 2;
  s.numerics.iterations = r.iterations, s.numerics.tolerance = 0;
  terrain::check_patch(s.patch(), s.calibration.grain_diameter);
  return s;
}

/// The same tiles, so many that the patch's reach stays on ground that nobody has been on.
TrialSetup fixed_setup(const TrialSetup& patch, double distance) {
  TrialSetup s = patch;
  s.moving_patch = false;
  s.tiles_along += int(std::ceil((distance + 0.5) / s.bed_length));
  return s;
}

/// Contact-iterations over the first and the second half of the way.
struct Meter {
  double distance = 0;
  double cost[2] = {}, way[2] = {}, last = 0;

  void add(const TrialSample& s) {
    if (!std::isfinite(s.x)) return;
    const int half = s.x < 0.5 * distance ? 0 : 1;
    cost[half] += double(s.contacts) * s.iterations;
    way[half] += s.x - last;
    last = s.x;
  }
};

struct Side {
  std::vector<double> slip, sinkage;
  double cost[2] = {};
  std::size_t grains = 0;
  int passed = 0;
};

Side run_side(const TrialSetup& setup, const PatchRequest& r, const std::vector<DesignPoint>& points) {
  std::vector<Meter> meter(points.size(), Meter{r.distance});
  std::vector<TrialWatch> watch(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    watch[i].start = [&meter, &r, i] { meter[i] = Meter{r.distance}; };
    watch[i].sample = [&meter, i](const TrialSample& s) { meter[i].add(s); };
  }
  Side side;
  for (const TrialRecord& record : run_trials(setup, points, r.batch, watch)) {
    if (record.verdict == Verdict::unknown) throw DeviceError("a trial of the comparison failed its checks");
    side.passed += record.verdict != Verdict::no_go;
    side.slip.push_back(measure_of(record, "slip"));
    side.sinkage.push_back(measure_of(record, "sinkage"));
  }
  for (int half = 0; half < 2; ++half)
    for (const Meter& m : meter) side.cost[half] += m.cost[half] / m.way[half] / double(meter.size());
  side.grains = settled_bed(setup, points.front()).grain.size();
  return side;
}

MeanOf difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> d;
  for (std::size_t i = 0; i < a.size(); ++i) d.push_back(a[i] - b[i]);
  return mean_of(d);
}

}  // namespace

PatchReport compare_patch(const PatchRequest& r) {
  const TrialSetup patch = patch_setup(r), fixed = fixed_setup(patch, r.distance);
  const terrain::AngleRange reach = terrain::reachable_angles(patch.calibration);
  const double angle = r.friction_angle > 0 ? r.friction_angle : 0.5 * (reach.lowest + reach.highest);
  const auto points = replicates(plain_variables(patch, r.slope, angle, r.speed), r.seeds);
  const Side side[2] = {run_side(patch, r, points), run_side(fixed, r, points)};
  PatchReport report;
  for (int k = 0; k < 2; ++k) {
    const TrialSetup& s = k == 0 ? patch : fixed;
    report.slip[k] = mean_of(side[k].slip), report.sinkage[k] = mean_of(side[k].sinkage);
    report.grains[k] = side[k].grains;
    report.length[k] = s.tiles_along * s.bed_length;
    report.passed += side[k].passed;
    for (int half = 0; half < 2; ++half) report.cost[k][half] = side[k].cost[half];
  }
  report.slip_difference = difference(side[0].slip, side[1].slip);
  report.sinkage_difference = difference(side[0].sinkage, side[1].sinkage);
  return report;
}

Json as_json(const PatchReport& r) {
  Json json;
  const char* const name[2] = {"patch", "fixed"};
  for (int k = 0; k < 2; ++k) {
    Json one;
    one["slip"] = r.slip[k].mean, one["slip_error"] = r.slip[k].error;
    one["sinkage_m"] = r.sinkage[k].mean, one["sinkage_error_m"] = r.sinkage[k].error;
    one["grains"] = r.grains[k], one["length_m"] = r.length[k];
    for (const double cost : r.cost[k]) one["contact_iterations_per_metre"].push_back(cost);
    json[name[k]] = std::move(one);
  }
  json["slip_deviation"] = r.slip_deviation();
  json["slip_deviation_error"] = r.slip_difference.error / std::fabs(r.slip[1].mean);
  json["sinkage_deviation"] = r.sinkage_deviation();
  json["sinkage_deviation_error"] = r.sinkage_difference.error / std::fabs(r.sinkage[1].mean);
  json["cost_of_second_half"] = r.cost[0][1] / r.cost[0][0];
  return json;
}

std::string as_text(const PatchReport& r) {
  std::string text = "               bed [m]  grains     slip          sinkage [mm]   contact-iterations per metre\n";
  for (int k = 0; k < 2; ++k) {
    text += line("%-13s %8.1f %7zu  %.4f +- %.4f  %6.1f +- %.1f  %.3e, then %.3e\n",
                 k == 0 ? "moving patch" : "fixed bed", r.length[k], r.grains[k], r.slip[k].mean, r.slip[k].error,
                 1e3 * r.sinkage[k].mean, 1e3 * r.sinkage[k].error, r.cost[k][0], r.cost[k][1]);
  }
  return text + line("difference: slip %+.1f +- %.1f %%, sinkage %+.1f +- %.1f %%\n", 100 * r.slip_deviation(),
                     100 * r.slip_difference.error / std::fabs(r.slip[1].mean), 100 * r.sinkage_deviation(),
                     100 * r.sinkage_difference.error / std::fabs(r.sinkage[1].mean));
}

}  // namespace gonogo::pipeline
