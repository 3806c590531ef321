#include "pipeline/lab/validate/two_beds.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/line.h"

namespace gonogo::lab {
namespace {

/// Contact-iterations over the first and the second half of the way.
struct Meter {
  double distance = 0;
  double cost[2] = {}, way[2] = {}, last = 0;

  void add(const campaign::TrialSample& s) {
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

Side run_side(const BedSide& bed, const BedsRequest& r, const std::vector<campaign::DesignPoint>& points) {
  std::vector<Meter> meter(points.size(), Meter{r.distance});
  std::vector<campaign::TrialWatch> watch(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    watch[i].start = [&meter, &r, i] { meter[i] = Meter{r.distance}; };
    watch[i].sample = [&meter, i](const campaign::TrialSample& s) { meter[i].add(s); };
    watch[i].frame_interval = 2 * bed.setup.time_limit;
    if (bed.frame) watch[i].frame = [&bed, i](const campaign::TrialFrame& frame) { bed.frame(i, frame); };
  }
  Side side;
  for (const campaign::TrialRecord& record : run_trials(bed.setup, points, r.batch, watch)) {
    if (record.verdict == campaign::Verdict::unknown)
      throw DeviceError("a trial on the " + bed.name + " failed its checks: residual " +
                        number_text(campaign::measure_of(record, "worst_residual")) + " m/s, energy error " +
                        number_text(campaign::measure_of(record, "energy_error")) +
                        "; give more --iterations or a smaller --step");
    side.passed += record.verdict != campaign::Verdict::no_go;
    side.slip.push_back(campaign::measure_of(record, "slip"));
    side.sinkage.push_back(campaign::measure_of(record, "sinkage"));
  }
  for (int half = 0; half < 2; ++half)
    for (const Meter& m : meter) side.cost[half] += m.cost[half] / m.way[half] / double(meter.size());
  side.grains = campaign::settled_bed(bed.setup, points.front()).grain.size();
  return side;
}

MeanError difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> d;
  for (std::size_t i = 0; i < a.size(); ++i) d.push_back(a[i] - b[i]);
  return mean_error(d);
}

}  // namespace

double BedComparison::worst_deviation() const {
  return std::max(std::fabs(slip_deviation()), std::fabs(sinkage_deviation()));
}

campaign::TrialSetup setup_of(const BedsRequest& r) {
  terrain::AskedNumerics asked = r.numerics;
  asked.tolerance = 0;
  return campaign::vehicle_trial_setup(r.vehicle, r.calibration, campaign::default_task(), asked);
}

void fit_to_request(const BedsRequest& r, campaign::TrialSetup& s) {
  s.settled_on = r.batch.backend;
  s.run_in_distance = 0.25 * r.distance;
  s.test_distance = 0.75 * r.distance;
  s.time_limit = 3 * r.distance / r.speed + 2;
}

BedComparison compare_beds(const BedsRequest& r, const BedSide& first, const BedSide& reference) {
  const terrain::AngleRange reach = terrain::reachable_angles(first.setup.calibration);
  const double angle = r.friction_angle > 0 ? r.friction_angle : 0.5 * (reach.lowest + reach.highest);
  const auto points = replicates(plain_variables(first.setup, r.slope, angle, r.speed), r.seeds);
  BedComparison c;
  Side side[2];
  for (int k = 0; k < 2; ++k) {
    const BedSide& bed = k == 0 ? first : reference;
    side[k] = run_side(bed, r, points);
    c.key[k] = bed.key;
    c.name[k] = bed.name;
    c.slip[k] = mean_error(side[k].slip);
    c.sinkage[k] = mean_error(side[k].sinkage);
    c.grains[k] = side[k].grains;
    c.length[k] = bed.setup.tiles_along * bed.setup.bed_length;
    c.width[k] = bed.setup.tiles_across * bed.setup.bed_width;
    c.passed += side[k].passed;
    for (int half = 0; half < 2; ++half) c.cost[k][half] = side[k].cost[half];
  }
  c.slip_difference = difference(side[0].slip, side[1].slip);
  c.sinkage_difference = difference(side[0].sinkage, side[1].sinkage);
  return c;
}

Json as_json(const BedComparison& c) {
  Json json;
  for (int k = 0; k < 2; ++k) {
    Json one;
    one["slip"] = c.slip[k].mean;
    one["slip_error"] = c.slip[k].error;
    one["sinkage_m"] = c.sinkage[k].mean;
    one["sinkage_error_m"] = c.sinkage[k].error;
    one["grains"] = c.grains[k];
    one["length_m"] = c.length[k];
    one["width_m"] = c.width[k];
    for (const double cost : c.cost[k]) one["contact_iterations_per_metre"].push_back(cost);
    json[c.key[k]] = std::move(one);
  }
  json["passed"] = c.passed;
  json["slip_deviation"] = c.slip_deviation();
  json["slip_deviation_error"] = c.slip_difference.error / std::fabs(c.slip[1].mean);
  json["sinkage_deviation"] = c.sinkage_deviation();
  json["sinkage_deviation_error"] = c.sinkage_difference.error / std::fabs(c.sinkage[1].mean);
  json["cost_of_second_half"] = c.cost[0][1] / c.cost[0][0];
  return json;
}

std::string as_text(const BedComparison& c) {
  std::string text =
      "                  bed [m]  grains     slip          sinkage [mm]   contact-iterations per metre\n";
  for (int k = 0; k < 2; ++k) {
    text += line("%-13s %5.2f x %.2f %7zu  %.4f +- %.4f  %6.1f +- %.1f  %.3e, then %.3e\n", c.name[k].c_str(),
                 c.length[k], c.width[k], c.grains[k], c.slip[k].mean, c.slip[k].error, 1e3 * c.sinkage[k].mean,
                 1e3 * c.sinkage[k].error, c.cost[k][0], c.cost[k][1]);
  }
  return text + line("difference: slip %+.1f +- %.1f %%, sinkage %+.1f +- %.1f %%\n", 100 * c.slip_deviation(),
                     100 * c.slip_difference.error / std::fabs(c.slip[1].mean), 100 * c.sinkage_deviation(),
                     100 * c.sinkage_difference.error / std::fabs(c.sinkage[1].mean));
}

}  // namespace gonogo::lab
