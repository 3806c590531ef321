#include "pipeline/lab/validate/grade.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/units.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/report/figure/chart.h"
#include "terrain/soil/calibration.h"
#include "vehicle/world/engine_vehicle.h"

namespace gonogo::lab {
namespace {

constexpr double kAngles[] = {14, 20, 25, 30, 35, 40, 45};      // [deg]
constexpr double kSlopes[] = {-20, -10, 0, 5, 10, 15, 20, 35};  // [deg]
constexpr double kSlips[] = {0.02, 0.2, 0.4, 0.6, 0.8, 0.95};
constexpr double kMinSlope = 2;       // [deg]
constexpr double kMinDistance = 0.2;  // [m]

double degrees(double pull) { return std::atan(pull) / kDegree; }

/// The wheel of a trial and the load on it.
WheelOnSand wheel_of(const vehicle::Vehicle& quarter, double payload, double along, double across) {
  const double a = std::tan(along * kDegree), b = std::tan(across * kDegree);
  return {.radius = quarter.wheel.front().radius,
          .width = quarter.wheel.front().width,
          .load = vehicle::loaded_mass(quarter, payload) * kGravity / std::sqrt(1 + a * a + b * b)};
}

bool is_of_interest(const campaign::TrialRecord& r, const GradeRequest& request) {
  return r.verdict != campaign::Verdict::unknown && campaign::variable_of(r, "cohesion") <= request.max_cohesion &&
         std::fabs(campaign::variable_of(r, "slope_across")) <= request.max_across &&
         campaign::variable_of(r, "tyre_friction") >= std::tan(campaign::variable_of(r, "friction_angle") * kDegree);
}

bool moved_uphill(const campaign::TrialRecord& r) {
  const double slip = campaign::measure_of(r, "slip");
  return campaign::variable_of(r, "slope_along") >= kMinSlope && campaign::measure_of(r, "distance") >= kMinDistance &&
         slip > kSlips[0] && slip < kSlips[std::size(kSlips) - 1];
}

/// The table of the trials' grains; none where the dataset does not hold it.
std::optional<terrain::Calibration> table_of(const campaign::Dataset& dataset, const std::string& file) {
  const std::string* text = campaign::input_text(dataset.provenance, "calibration");
  if (!text) return std::nullopt;
  return terrain::read_calibration(Config::parse(*text, file + ": calibration"));
}

terrain::MacroscopicSoil on_plane(const std::optional<terrain::Calibration>& table,
                                  const terrain::MacroscopicSoil& soil) {
  return table ? terrain::on_shear_plane(*table, soil) : terrain::on_shear_plane(soil);
}

GradePoint point_of(const campaign::TrialRecord& r, const vehicle::Vehicle& quarter,
                    const std::optional<terrain::Calibration>& table) {
  GradePoint p;
  p.slope = campaign::variable_of(r, "slope_along");
  p.friction_angle = campaign::variable_of(r, "friction_angle");
  p.cohesion = campaign::variable_of(r, "cohesion");
  p.commanded_speed = campaign::variable_of(r, "commanded_speed");
  p.slip = campaign::measure_of(r, "slip"), p.speed = campaign::measure_of(r, "mean_speed"),
  p.sinkage = campaign::measure_of(r, "sinkage");
  p.verdict = r.verdict;
  p.reason = r.reason;
  const WheelOnSand wheel =
      wheel_of(quarter, campaign::variable_of(r, "payload"), p.slope, campaign::variable_of(r, "slope_across"));
  const terrain::MacroscopicSoil soil =
      on_plane(table, {p.friction_angle, 1e3 * p.cohesion, 0, campaign::variable_of(r, "relative_density")});
  p.band = sand_band(wheel, soil.friction_angle, p.slip, soil.cohesion);
  return p;
}

std::vector<LabelCount> empty_counts() {
  std::vector<LabelCount> counts;
  for (std::size_t a = 0; a + 1 < std::size(kAngles); ++a)
    for (std::size_t s = 0; s + 1 < std::size(kSlopes); ++s)
      counts.push_back({{kAngles[a], kAngles[a + 1]}, {kSlopes[s], kSlopes[s + 1]}});
  return counts;
}

void count(std::vector<LabelCount>& counts, const campaign::TrialRecord& r) {
  const double angle = campaign::variable_of(r, "friction_angle"), slope = campaign::variable_of(r, "slope_along");
  for (LabelCount& c : counts)
    if (angle >= c.angle[0] && angle < c.angle[1] && slope >= c.slope[0] && slope < c.slope[1]) {
      ++c.trials;
      c.passed += campaign::passes(r.verdict);
    }
}

}  // namespace

double GradePoint::pull() const { return std::tan(slope * kDegree); }

GradeReport grade_report(const GradeRequest& request) {
  const vehicle::Vehicle quarter = vehicle::read_quarter_vehicle(request.vehicle);
  GradeReport report;
  report.label = empty_counts();
  const campaign::Dataset dataset = campaign::read_dataset(request.dataset);
  const auto table = table_of(dataset, request.dataset.string());
  for (const campaign::TrialRecord& r : dataset.records) {
    if (!is_of_interest(r, request)) continue;
    count(report.label, r);
    if (moved_uphill(r)) report.point.push_back(point_of(r, quarter, table));
  }
  if (report.point.empty())
    throw InputError(request.dataset.string() + ": no trial drove uphill on soil of at most " +
                     number_text(request.max_cohesion) + " kPa that its tyre grips; raise --cohesion");
  const TractionBand band = sand_band(wheel_of(quarter, 0, 0, 0), on_plane(table, {30, 0, 0, 0.5}).friction_angle, 0.4);
  for (int k = 0; k < 2; ++k) report.go_band[k] = degrees(band.pull[k]);
  for (const GradePoint& p : report.point) report.unsteady_passed += campaign::passes(p.verdict) && p.slip > 0.4;
  return report;
}

namespace {

/// Points of a span of friction angles and slips.
struct Cell {
  int points = 0, below = 0, above = 0;
  double slope = 0, sinkage = 0, band[2] = {};  // sums

  void add(const GradePoint& p) {
    ++points;
    below += p.below();
    above += p.above();
    slope += p.slope;
    sinkage += p.sinkage;
    for (int k = 0; k < 2; ++k) band[k] += degrees(p.band.pull[k]);
  }
};

Cell cell_of(const GradeReport& r, const double* angle, const double* slip) {
  Cell cell;
  for (const GradePoint& p : r.point)
    if (p.friction_angle >= angle[0] && p.friction_angle < angle[1] && p.slip >= slip[0] && p.slip < slip[1])
      cell.add(p);
  return cell;
}

std::string cells_text(const GradeReport& r) {
  std::string text =
      "friction angle       slip  trials  slope climbed  by formulas [deg]  below  inside  above  sinkage [mm]\n";
  for (std::size_t a = 0; a + 1 < std::size(kAngles); ++a)
    for (std::size_t s = 0; s + 1 < std::size(kSlips); ++s) {
      const Cell c = cell_of(r, kAngles + a, kSlips + s);
      if (c.points == 0) continue;
      const double n = c.points;
      text += line("%6.0f to %2.0f  %.2f to %.2f  %6d  %13.1f  %6.1f to %5.1f  %7d  %6d  %5d  %12.0f\n", kAngles[a],
                   kAngles[a + 1], kSlips[s], kSlips[s + 1], c.points, c.slope / n, c.band[0] / n, c.band[1] / n,
                   c.below, c.points - c.below - c.above, c.above, 1e3 * c.sinkage / n);
    }
  return text;
}

std::string labels_text(const GradeReport& r) {
  std::string text = "trials that pass, by friction angle and slope [deg]\n              ";
  const std::size_t slopes = std::size(kSlopes) - 1;
  for (std::size_t s = 0; s < slopes; ++s) text += line("%4.0f to %-4.0f", kSlopes[s], kSlopes[s + 1]);
  for (std::size_t k = 0; k < r.label.size(); ++k) {
    const LabelCount& c = r.label[k];
    if (k % slopes == 0) text += line("\n%6.0f to %2.0f  ", c.angle[0], c.angle[1]);
    text += line("%5d/%-6d", c.passed, c.trials);
  }
  return text + "\n";
}

Cell all_of(const GradeReport& r) {
  Cell all;
  for (const GradePoint& p : r.point) all.add(p);
  return all;
}

}  // namespace

Json as_json(const GradeReport& r) {
  const Cell all = all_of(r);
  Json json;
  json["grade_trials"] = all.points;
  json["grade_below"] = all.below;
  json["grade_above"] = all.above;
  json["grade_inside"] = all.points - all.below - all.above;
  json["passed_above_go_slip"] = r.unsteady_passed;
  json["go_slope_by_formulas_deg"].push_back(r.go_band[0]);
  json["go_slope_by_formulas_deg"].push_back(r.go_band[1]);
  for (const LabelCount& c : r.label) {
    Json row;
    for (int k = 0; k < 2; ++k) {
      row["friction_angle_deg"].push_back(c.angle[k]);
      row["slope_deg"].push_back(c.slope[k]);
    }
    row["passed"] = c.passed;
    row["trials"] = c.trials;
    json["labels"].push_back(std::move(row));
  }
  return json;
}

std::string as_text(const GradeReport& r) {
  const Cell all = all_of(r);
  return cells_text(r) +
         line(
             "%d trials climb: %d below the formulas' band, %d inside, %d above; %d of them pass at a slip above 0.4\n",
             all.points, all.below, all.points - all.below - all.above, all.above, r.unsteady_passed) +
         line("by formulas a slip of 0.4, the most of go, climbs %.1f to %.1f degrees on sand of 30 degrees\n",
              r.go_band[0], r.go_band[1]) +
         labels_text(r);
}

namespace {

/// Trials of friction angles between 25 and 35 degrees beside the formulas' least and most.
report::LinePlot plot_of(const GradeReport& r) {
  report::LinePlot plot;
  plot.title = "Quarter wheel: slope climbed over slip, soils of 25 to 35 degrees";
  plot.x_label = "slip";
  plot.y_label = "slope [deg]";
  report::PlotLine trial{"trials", {}, {}, true}, formulas{"formulas for each", {}, {}, true};
  std::vector<GradePoint> points;
  for (const GradePoint& p : r.point)
    if (p.friction_angle >= 25 && p.friction_angle < 35) points.push_back(p);
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.slip < b.slip; });
  for (const GradePoint& p : points) {
    trial.add(p.slip, p.slope);
    formulas.add(p.slip, degrees(p.band.pull[0]));
    formulas.upper.push_back(degrees(p.band.pull[1]));
  }
  plot.lines = {formulas, trial};
  plot.notes.push_back("formulas: Wong and Reece on two sands with the trial's friction angle and load, Mason et al.");
  return plot;
}

}  // namespace

void write_grade(const std::filesystem::path& folder, const GradeReport& r) {
  create_folder(folder);
  std::string csv =
      "slope_deg,friction_angle_deg,cohesion_kPa,slip,speed_m_per_s,commanded_speed_m_per_s,sinkage_m,verdict,reason,"
      "slope_least_deg,slope_most_deg\n";
  for (const GradePoint& p : r.point)
    csv += line("%.4g,%.4g,%.4g,%.4f,%.4f,%.4f,%.4f,%s,%s,%.4g,%.4g\n", p.slope, p.friction_angle, p.cohesion, p.slip,
                p.speed, p.commanded_speed, p.sinkage, campaign::contract().info(p.verdict).name.c_str(),
                campaign::contract().info(p.reason).name.c_str(), degrees(p.band.pull[0]), degrees(p.band.pull[1]));
  write_file_atomically(folder / "quarter_wheel_grade.csv", csv);
  report::draw_line_plot(folder / "quarter_wheel_grade.png", plot_of(r));
}

}  // namespace gonogo::lab
