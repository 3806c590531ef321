#include "pipeline/lab/validate/trials.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/progress.h"
#include "pipeline/campaign/setup/setup.h"
#include "vehicle/world/engine_vehicle.h"

namespace gonogo::lab {

std::vector<campaign::DesignPoint> replicates(const std::vector<double>& variables, int count) {
  std::vector<campaign::DesignPoint> points;
  for (int i = 0; i < count; ++i) {
    campaign::DesignPoint p;
    p.index = p.seed = std::uint64_t(i);
    p.variables = variables;
    points.push_back(p);
  }
  return points;
}

std::vector<double> plain_variables(const campaign::TrialSetup& setup, double slope_along, double friction_angle,
                                    double speed) {
  std::vector<double> values(campaign::contract().variables.size(), 0);
  const auto set = [&](const char* name, double x) { values[campaign::contract().variable_index(name)] = x; };
  set("slope_along", slope_along);
  set("friction_angle", friction_angle);
  set("relative_density", kRelativeDensity);
  set("tyre_friction", setup.vehicle.wheel.front().friction);
  set("bed_depth", 0.3);
  set("commanded_speed", speed);
  return values;
}

std::vector<campaign::TrialRecord> run_trials(const campaign::TrialSetup& setup,
                                              const std::vector<campaign::DesignPoint>& points,
                                              const campaign::BatchSettings& batch,
                                              const std::vector<campaign::TrialWatch>& watch) {
  campaign::prepare_trials(setup, points, batch.threads);
  campaign::TrialBatch trials(setup, batch);
  return run_batch(trials, points.size(), [&](std::size_t i) {
    trials.start(points[i], i < watch.size() ? watch[i] : campaign::TrialWatch{});
  });
}

std::vector<campaign::TrialRecord> run_batch(campaign::TrialBatch& batch, std::size_t count,
                                             const std::function<void(std::size_t)>& start) {
  std::vector<campaign::TrialRecord> records(count);
  Progress progress("validate", "trials", count);
  for (std::size_t next = 0, done = 0; done < count; progress.update(done)) {
    for (; batch.free_places() > 0 && next < count; ++next) start(next);
    for (campaign::TrialRecord& r : batch.advance()) {
      records[std::size_t(r.point.index)] = std::move(r);
      ++done;
    }
  }
  return records;
}

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
  side.grains = campaign::settled_bed(bed.setup, campaign::inputs_of(points.front())).grain.size();
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
    Json one = Json::Object{{"slip", c.slip[k].mean},         {"slip_error", c.slip[k].error},
                            {"sinkage_m", c.sinkage[k].mean}, {"sinkage_error_m", c.sinkage[k].error},
                            {"grains", c.grains[k]},          {"length_m", c.length[k]},
                            {"width_m", c.width[k]}};
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

namespace {

constexpr double kBinWidth = 0.04;  // [m]

campaign::TrialSetup folded_setup(const BedsRequest& r, double width) {
  campaign::TrialSetup s = setup_of(r);
  campaign::fold_bed(s);
  if (width > 0) s.bed_width = width;
  campaign::check_lanes(s);
  fit_to_request(r, s);
  return s;
}

campaign::TrialSetup wide_setup(const campaign::TrialSetup& folded) {
  campaign::TrialSetup s = folded;
  s.folded = false;
  s.tiles_across = int(std::ceil(3 * campaign::folded_width(s.vehicle) / s.bed_width - 1e-6));
  return s;
}

/// Foremost and rearmost axle, lanes and width of the tyres.
struct Wheels {
  double front = -1e9, rear = 1e9, reach = 0, width = 0;
  std::vector<double> lane;
};

Wheels wheels_of(const vehicle::Vehicle& v) {
  Wheels w;
  for (const vehicle::RunningPart& p : vehicle::running_parts(v)) {
    w.front = std::max(w.front, p.centre.x);
    w.rear = std::min(w.rear, p.centre.x);
    w.reach = std::max(w.reach, p.reach);
    w.width = std::max(w.width, p.width);
    w.lane.push_back(p.centre.y);
  }
  return w;
}

/// Way of grains that all wheels of their side have passed, by distance from the nearest lane.
class Rut {
 public:
  Rut(const campaign::TrialSetup& setup, int seeds)
      : setup_(setup), wheels_(wheels_of(setup.vehicle)), start_(std::size_t(seeds)), sum_(bins()), count_(bins()) {}

  void see(std::size_t seed, const campaign::TrialFrame& frame) {
    const auto bodies = frame.simulation.bodies(frame.place);
    auto& start = start_[seed];
    if (start.empty() || frame.sample.time == 0) {
      start.clear();
      for (const sim::BodyState& b : bodies) start.push_back(b.position);
      return;
    }
    if (frame.wheel < 0) return;
    const double x = bodies[std::size_t(frame.wheel)].position.x;
    // Grains come first in a bed's world, and after them the base, which is fixed.
    for (std::size_t i = 0; !sim::is_fixed(frame.world.mass[i]); ++i)
      if (passed(start[i].x - x)) add(start[i], bodies[i].position);
  }

  std::vector<double> moved() const {
    std::vector<double> mean;
    for (std::size_t k = 0; k < sum_.size(); ++k) mean.push_back(count_[k] > 0 ? sum_[k] / count_[k] : 0);
    return mean;
  }

 private:
  double length() const { return setup_.tiles_along * setup_.bed_length; }
  double width() const { return setup_.tiles_across * setup_.bed_width; }
  /// Half the way to the next lane, which lies at least a track away.
  std::size_t bins() const { return std::size_t(0.75 * campaign::folded_width(setup_.vehicle) / kBinWidth); }

  bool passed(double ahead) const {
    const double d = std::remainder(ahead, length());
    return d < wheels_.rear - wheels_.reach && d > -setup_.patch().reach;
  }

  void add(const Vec3d& from, const Vec3d& to) {
    double beside = width();
    for (const double lane : wheels_.lane)
      beside = std::min(beside, std::fabs(std::remainder(from.y - 0.5 * width() - lane, width())));
    const auto bin = std::size_t(beside / kBinWidth);
    if (bin >= sum_.size()) return;
    sum_[bin] +=
        std::hypot(std::remainder(to.x - from.x, length()), std::remainder(to.y - from.y, width()), to.z - from.z);
    count_[bin] += 1;
  }

  const campaign::TrialSetup& setup_;
  Wheels wheels_;
  std::vector<std::vector<Vec3d>> start_;
  std::vector<double> sum_, count_;
};

double half_width(const std::vector<double>& moved, double tyre_width) {
  const auto under = std::size_t(tyre_width / 2 / kBinWidth);
  double largest = 0;
  for (std::size_t k = 0; k < under; ++k) largest += moved[k] / double(under);
  std::size_t last = 0;
  for (std::size_t k = 0; k < moved.size(); ++k)
    if (moved[k] > 0.1 * largest) last = k + 1;
  return double(last) * kBinWidth;
}

}  // namespace

FoldedReport compare_folded(const BedsRequest& r, double width) {
  const campaign::TrialSetup folded = folded_setup(r, width), wide = wide_setup(folded);
  Rut rut(wide, r.seeds);
  FoldedReport report;
  report.beds =
      compare_beds(r, {"folded", "folded bed", folded, {}},
                   {"wide", "wide bed", wide, [&](std::size_t i, const campaign::TrialFrame& f) { rut.see(i, f); }});
  report.tyre_width = wheels_of(folded.vehicle).width;
  report.lane_distance = campaign::lane_gap(folded.vehicle, folded.bed_width) + report.tyre_width;
  report.bin_width = kBinWidth;
  report.moved = rut.moved();
  report.rut_half_width = half_width(report.moved, report.tyre_width);
  return report;
}

Json as_json(const FoldedReport& r) {
  Json json = as_json(r.beds);
  json["lane_distance_m"] = r.lane_distance;
  json["tyre_width_m"] = r.tyre_width;
  json["rut_half_width_m"] = r.rut_half_width;
  json["bin_width_m"] = r.bin_width;
  for (const double m : r.moved) json["moved_m"].push_back(m);
  return json;
}

std::string as_text(const FoldedReport& r) {
  std::string text = as_text(r.beds) + "grains moved on the wide bed, by distance from the lane's middle\n";
  for (std::size_t k = 0; k < r.moved.size(); ++k)
    text += line("%6.2f m  %7.2f mm\n", (double(k) + 0.5) * r.bin_width, 1e3 * r.moved[k]);
  return text + line("a tenth of those under the tyre from %.2f m on; neighbouring lanes are %.2f m apart\n",
                     r.rut_half_width, r.lane_distance);
}

namespace {

/// A quarter vehicle's bed as tiles a metre long; a whole vehicle's has tiles already.
campaign::TrialSetup patch_setup(const BedsRequest& r) {
  campaign::TrialSetup s = setup_of(r);
  if (vehicle::is_quarter(s.vehicle)) {
    const vehicle::Wheel& w = s.vehicle.wheel.front();
    const double d = s.calibration.grain_diameter, wheel = w.radius + w.lug_height;
    s.bed_length = std::max(12 * d, 1.0);
    s.bed_width = std::max(8 * d, 2.5 * w.width);
    s.moving_patch = true;
    s.tiles_along = int(std::ceil((2 * s.patch().reach + std::max(4 * d, wheel)) / s.bed_length));
  }
  s.tiles_along += s.tiles_along % 2;
  s.start = 0.5 * s.tiles_along * s.bed_length;
  fit_to_request(r, s);
  terrain::check_patch(s.patch(), s.calibration.grain_diameter);
  return s;
}

/// The same tiles, so many that the patch's reach stays on ground that nobody has been on.
campaign::TrialSetup fixed_setup(const campaign::TrialSetup& patch, double distance) {
  campaign::TrialSetup s = patch;
  s.moving_patch = false;
  s.tiles_along += int(std::ceil((distance + 0.5) / s.bed_length));
  return s;
}

}  // namespace

BedComparison compare_patch(const BedsRequest& r) {
  const campaign::TrialSetup patch = patch_setup(r);
  return compare_beds(r, {"patch", "moving patch", patch, {}},
                      {"fixed", "fixed bed", fixed_setup(patch, r.distance), {}});
}

}  // namespace gonogo::lab
