#include "pipeline/lab/validate/folded.h"

#include <algorithm>
#include <cmath>

#include "base/line.h"
#include "pipeline/campaign/trial/lanes.h"
#include "vehicle/model/engine_vehicle.h"

namespace gonogo::lab {
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
  s.tiles_across = int(std::ceil(3 * campaign::folded_width(*s.whole) / s.bed_width - 1e-6));
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
      : setup_(setup), wheels_(wheels_of(*setup.whole)), start_(std::size_t(seeds)), sum_(bins()), count_(bins()) {}

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
  std::size_t bins() const { return std::size_t(0.75 * campaign::folded_width(*setup_.whole) / kBinWidth); }

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
  report.tyre_width = wheels_of(*folded.whole).width;
  report.lane_distance = campaign::lane_gap(*folded.whole, folded.bed_width) + report.tyre_width;
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

}  // namespace gonogo::lab
