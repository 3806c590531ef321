// How P(go) and the class of one soil depend on slope: the model folded into a table, so that a map costs little more
// than reading and writing its rasters, however large it is.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "pipeline/map/evaluate/heading_table.h"
#include "pipeline/map/evaluate/outcome_model.h"
#include "pipeline/map/evaluate/soil_points.h"
#include "pipeline/map/region/rules.h"

namespace gonogo::map {

/// Slopes are rounded to this before the model is asked: 1/64 degree, far less than what the elevation's own error
/// does. The map's P(go) is the model's own value at the rounded slope.
inline constexpr double kSlopeSteps = 64;  // per degree
double rounded_slope(double slope_deg);

/// Everything a map says about a cell whatever its aspect.
struct CellAnswer {
  CellClass result;                        // uphill heading
  float p_go = 0;                          // not-a-number where nothing sampled is near, or only steeper than sampled
  float p_slow = 0;                        // of it slow_go
  float outside_share = 1;                 // share of what the soil may be, at this slope, that was never sampled
  float p_low = 0, p_high = 0;             // 5 % and 95 % points of P(go), uphill heading
  float novelty = 0;                       // of the inputs, uphill heading; not-a-number when the model does not tell
  float speed = 0, slip = 0, sinkage = 0;  // expected, uphill heading; not-a-number when the model does not tell
  HeadingRange headings;
};

class SoilResponse {
 public:
  /// `points` are those of soil_points(), `soft` those of soft_points(). The heading is uphill (slope_along = slope,
  /// slope_across = 0) where nothing else is said. `gradient_error`: standard error of the rise per metre that follows
  /// from the elevation's error.
  SoilResponse(const OutcomeModel& model, const MapRules& rules, std::vector<std::vector<double>> points,
               double gradient_error = 0, SoftPoints soft = {});

  /// For a slope in [0, 90] degrees. Steeper than what was sampled a cell is no_go if the steepest sampled slope is,
  /// with its reason, and unknown otherwise.
  const CellAnswer& at(double slope_deg) const;
  /// Any heading; psi as in bed_slopes().
  const HeadingAnswer& at(double slope_deg, double psi) const {
    return headings_.at(bed_slopes(rounded_slope(slope_deg), psi));
  }

  /// Probability of outcome `o` at slope step i (uphill); 0 where nothing was sampled.
  double uphill_outcome(std::size_t i, std::size_t o) const {
    return uphill_outcomes_[i].empty() ? 0.0 : uphill_outcomes_[i][o];
  }

  /// Steepest and gentlest sampled slope [deg].
  Range sampled_slope() const { return sampled_slope_; }
  const SoilPoints& points() const { return points_; }
  const HeadingTable& headings() const { return headings_; }
  /// Expected measures of trials that pass, by name; empty when the model does not tell.
  const std::map<std::string, SlopeMeasure>& measures() const { return measures_; }
  const std::vector<std::string>& outside_because() const { return points_.outside_because(); }

 private:
  void tabulate(const OutcomeModel& model, const MapRules& rules);
  CellAnswer answer_at(const OutcomeModel& model, const MapRules& rules, int step);
  void add_interval(double gradient_error, std::size_t models);
  void add_measures(const OutcomeModel& model);

  SoilPoints points_;
  HeadingTable headings_;
  std::map<std::string, SlopeMeasure> measures_;
  Range sampled_slope_;
  std::vector<CellAnswer> table_;                     // by slope x kSlopeSteps, to 90 degrees
  std::vector<std::vector<double>> uphill_outcomes_;  // [step][outcome]; empty where nothing was sampled
  std::vector<std::vector<double>> p_each_;           // [step][sampled point], only while the tables are made
};

}  // namespace gonogo::map
