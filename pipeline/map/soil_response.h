// How P(go) and the class of one soil depend on slope: the model folded into a table, so that a map costs little more
// than reading and writing its rasters, however large it is.
#pragma once
#include <string>
#include <vector>

#include "pipeline/map/outcome_model.h"
#include "pipeline/map/rules.h"

namespace gonogo::pipeline {

/// Slopes are rounded to this before the model is asked: 1/64 degree, far less than what the elevation's own error
/// does. The map's P(go) is the model's own value at the rounded slope.
inline constexpr double kSlopeSteps = 64;  // per degree
double rounded_slope(double slope_deg);

/// Everything a map says about a cell.
struct CellAnswer {
  CellClass result;
  float p_go = 0;           // not-a-number where nothing sampled is near, or only steeper than sampled
  float outside_share = 1;  // share of what the soil may be, at this slope, that was never sampled
};

class SoilResponse {
 public:
  /// `points` are those of soil_points(); the heading is uphill (slope_along = slope, slope_across = 0).
  SoilResponse(const OutcomeModel& model, const MapRules& rules, std::vector<std::vector<double>> points);

  /// For a slope in [0, 90] degrees. Steeper than what was sampled a cell is no_go if the steepest sampled slope is,
  /// with its reason, and unknown otherwise.
  const CellAnswer& at(double slope_deg) const;

  /// Steepest and gentlest sampled slope [deg].
  Range sampled_slope() const { return sampled_slope_; }
  /// "cohesion 6.1 kPa is outside 0 to 5 kPa" for each variable that keeps points of this soil out; empty when none
  /// does.
  const std::vector<std::string>& outside_because() const { return outside_because_; }

 private:
  Prospect prospect_at(const OutcomeModel& model, double slope_deg) const;
  void sort_points(const OutcomeModel& model, std::vector<std::vector<double>> points);
  CellAnswer answer_at(const OutcomeModel& model, const MapRules& rules, double slope_deg) const;

  std::vector<double> inside_points_;  // [count x variables], slope filled in per call
  std::size_t inside_count_ = 0, point_count_ = 0;
  Range sampled_slope_;
  std::vector<std::string> outside_because_;
  std::vector<CellAnswer> table_;  // by slope x kSlopeSteps; the last one holds for everything steeper
};

}  // namespace gonogo::pipeline
