// Slopes that the quarter vehicle of a dataset climbs at its slips, beside the bands of semi-empirical formulas for the
// same wheel, load and soil. On a slope the wheel pulls the vehicle's weight along it. At constant speed, that pull
// over the load on the ground is tan(slope_along), whatever the slope across.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/lab/validate/drawbar.h"

namespace gonogo::lab {

struct GradeRequest {
  std::filesystem::path dataset;
  std::filesystem::path vehicle;  // the quarter vehicle of its trials
  double max_cohesion = 5;        // of trials that are looked at [kPa]
  double max_across = 12;         // slope across, either way [deg]
};

/// One trial, uphill, whose wheel moved on.
struct GradePoint {
  double slope = 0, friction_angle = 0, cohesion = 0;  // [deg], [deg], [kPa]
  double slip = 0, speed = 0, commanded_speed = 0;     // [-], [m/s], [m/s]
  double sinkage = 0;                                  // [m]
  TractionBand band;
  campaign::Verdict verdict = campaign::Verdict::unknown;
  campaign::Reason reason = campaign::Reason::none;

  double pull() const;  // tan(slope)
  bool below() const { return pull() < band.pull[0]; }
  bool above() const { return pull() > band.pull[1]; }
};

/// Passed and all trials of a span of slopes and friction angles, moved on or not.
struct LabelCount {
  double angle[2], slope[2];  // [deg]
  int passed = 0, trials = 0;
};

struct GradeReport {
  std::vector<GradePoint> point;
  std::vector<LabelCount> label;
  int unsteady_passed = 0;  // of the points: passed at a slip above that of `go`
  double go_band[2] = {};   // slopes at a slip of 0.4 on sand of 30 degrees by the formulas, no payload [deg]
};

/// Takes trials whose tyre friction is at least tan(friction angle). In the others the tyre slides on the soil, which
/// says nothing of the soil. Throws InputError for a dataset that cannot be read or has no such trial.
GradeReport grade_report(const GradeRequest& request);

Json as_json(const GradeReport& r);
std::string as_text(const GradeReport& r);
/// quarter_wheel_grade.csv and, where the build has pictures, .png.
void write_grade(const std::filesystem::path& folder, const GradeReport& r);

}  // namespace gonogo::lab
