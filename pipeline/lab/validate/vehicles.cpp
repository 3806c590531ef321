#include "pipeline/lab/validate/vehicles.h"

#include <algorithm>

#include "base/files/file.h"
#include "base/format.h"
#include "base/progress.h"
#include "pipeline/report/figure/chart.h"

namespace gonogo::lab {
namespace {

using vehicle::HardGroundCheck;
using vehicle::HardGroundReport;

constexpr double kClimbingFriction = 0.5, kBrakingFriction = 0.4, kBrakingSpeed = 20;  // [-], [m/s]
constexpr double kSprocketSpeed = 6, kTrackFriction = 0.3, kTrackSlope = 0.22;         // [rad/s], [-], [rad]
constexpr int kGears = 4;  // higher ones need minutes to reach their speed

std::string csv_of(const HardGroundReport& r) {
  std::string csv = "line," + r.x_label + "," + r.y_label + "\n";
  for (const vehicle::Trace& t : r.trace)
    for (std::size_t i = 0; i < t.x.size(); ++i) {
      csv += t.label + line(",%.6g,%.6g\n", t.x[i], t.y[i]);
    }
  return csv;
}

report::LinePlot plot_of(const HardGroundReport& r) {
  report::LinePlot plot{.title = r.title, .x_label = r.x_label, .y_label = r.y_label};
  for (const vehicle::Trace& t : r.trace) plot.lines.push_back({t.label, t.x, t.y, t.points});
  for (const HardGroundCheck& c : r.check) {
    plot.notes.push_back(
        line("%s: expected %.5g, measured %.5g, tolerance %.2g", c.claim.c_str(), c.expected, c.measured, c.tolerance));
  }
  return plot;
}

}  // namespace

std::vector<HardGroundReport> check_on_hard_ground(const vehicle::Vehicle& v, const vehicle::HardGroundRun& run) {
  std::vector<int> gears;
  for (int g = 1; g <= std::min(kGears, int(v.driveline.gears.size())); ++g) gears.push_back(g);
  std::vector<HardGroundReport> reports;
  const auto add = [&](HardGroundReport r) {
    stop_if_cancelled();
    reports.push_back(std::move(r));
  };
  if (v.kind == vehicle::VehicleKind::tracked) {
    add(check_belts_at_rest(v, run));
    add(check_track_speed(v, kSprocketSpeed, run));
    add(check_track_traction(v, kTrackFriction, run));
    add(check_track_torque(v, kTrackSlope, run));
    return reports;
  }
  add(check_wheel_loads(v, run));
  add(check_gradeability(v, kClimbingFriction, run));
  add(check_top_speeds(v, gears, run));
  add(check_stopping(v, kBrakingSpeed, kBrakingFriction, run));
  add(check_suspension(v, run));
  return reports;
}

Json as_json(const std::vector<HardGroundReport>& reports) {
  Json json = Json::object();
  for (const HardGroundReport& r : reports)
    for (const HardGroundCheck& c : r.check) {
      json[c.key] = Json::Object{
          {"expected", c.expected}, {"measured", c.measured}, {"tolerance", c.tolerance}, {"holds", c.holds()}};
    }
  return json;
}

std::string as_text(const std::vector<HardGroundReport>& reports) {
  std::string text;
  for (const HardGroundReport& r : reports)
    for (const HardGroundCheck& c : r.check) {
      text += line("%-72s expected %10.5g measured %10.5g tolerance %8.2g%s\n", c.claim.c_str(), c.expected, c.measured,
                   c.tolerance, c.holds() ? "" : "  DIFFERS");
    }
  return text;
}

int failures(const std::vector<HardGroundReport>& reports) {
  int count = 0;
  for (const HardGroundReport& r : reports)
    for (const HardGroundCheck& c : r.check) count += !c.holds();
  return count;
}

void write_reports(const std::filesystem::path& folder, const std::string& vehicle,
                   const std::vector<HardGroundReport>& reports) {
  create_folder(folder);
  for (const HardGroundReport& r : reports) {
    const std::string name = vehicle + "_" + r.name;
    write_file_atomically(folder / (name + ".csv"), csv_of(r));
    report::draw_line_plot(folder / (name + ".png"), plot_of(r));
  }
  write_file_atomically(folder / (vehicle + ".json"), as_json(reports).dump(2) + "\n");
}

}  // namespace gonogo::lab
