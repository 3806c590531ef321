// P(go) and class of one soil as functions of slope and heading, tabulated once from the model. A map then costs little
// more than reading and writing its rasters.
#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>

#include "pipeline/map/evaluate/outcome_model.h"
#include "pipeline/map/evaluate/soil_points.h"
#include "pipeline/map/region/rules.h"

namespace gonogo::map {

/// Slopes along and across are rounded to 1/2 degree. P(go) of a heading is the model's value at the rounded slopes.
/// Independent elevation errors of 0.2 m at 10 m cells change the slope by as much.
inline constexpr int kHeadingSteps = 2;  // per degree

/// Slopes in steps of 1 / kHeadingSteps degrees.
struct SlopeNode {
  int along = 0, across = 0;
};

struct HeadingAnswer {
  CellClass result;
  Prospect prospect;  // no outcomes outside the sampled box
  float p_go = 0;     // NaN outside the sampled box
};

/// Worst and best answer over all headings, for one slope of the ground.
struct HeadingRange {
  CellClass worst, best;
  float p_worst = 0, p_best = 0;  // P(go), over the sampled headings; NaN when there is none
  float sampled_share = 0;        // share of the headings whose slopes were sampled [0, 1]
};
/// P(go) of single points of a soil, for chances along a way.
struct PassageTable {
  static constexpr std::size_t kStride = 2 * kHeadingSteps;  // nodes of a HeadingTable, 2 degrees
  static constexpr std::size_t kMostPoints = 16;
  std::size_t along = 0, across = 0;  // nodes
  std::vector<std::size_t> point;     // which of the sampled points
  std::vector<float> p_go;            // [point][along][across]; NaN where the model is not asked
};

/// P(go) and class of one soil for every pair of slopes along and across the heading. The model is evaluated once for
/// each pair; after that any heading of any cell is a look-up.
class HeadingTable {
 public:
  /// Evaluates the model at every node inside the sampled box. `points`: what the soil may be.
  HeadingTable(const OutcomeModel& model, const MapRules& rules, const SoilPoints& points);

  /// The answer at the node nearest to `slopes`. Outside the sampled box the answer is unknown, with one exception:
  /// steeper uphill than sampled it is no_go if the steepest sampled node at the same slope across is no_go.
  const HeadingAnswer& at(BedSlopes slopes) const;
  const HeadingAnswer& at(SlopeNode nearest) const;

  /// Worst and best of kHeadings headings on ground of one slope, by the nodes nearest to the slopes of each.
  /// worst: no_go if any heading is no_go; else unknown if any is unknown; else the lowest class.
  /// best: go if any heading is go; else slow_go if any is; else unknown if any is; else no_go.
  /// The reason of unknown is soft_soil if any heading has that reason.
  HeadingRange over_headings(std::span<const SlopeNode, kHeadings> nearest) const;

  const PassageTable& passage() const { return passage_; }

  /// Node (i, j) lies at slopes (first_along + i, first_across + j) / kHeadingSteps [deg]. Only sampled nodes exist.
  int first_along() const { return first_along_; }
  int first_across() const { return first_across_; }
  int along_count() const { return along_count_; }
  int across_count() const { return across_count_; }
  BedSlopes slopes(int along, int across) const {
    return {double(first_along_ + along) / kHeadingSteps, double(first_across_ + across) / kHeadingSteps};
  }
  /// along * across_count() + across of the nearest node, or -1 outside the sampled box.
  int index_of(BedSlopes slopes) const;
  const HeadingAnswer& node(int along, int across) const {
    return nodes_[std::size_t(along) * std::size_t(across_count_) + std::size_t(across)];
  }

 private:
  void take_passages(const SoilPoints& points, const std::vector<SoilPoints::Each>& each);

  int first_along_ = 0, along_count_ = 0, first_across_ = 0, across_count_ = 0;
  PassageTable passage_;
  std::vector<HeadingAnswer> nodes_;
  std::vector<HeadingAnswer> steeper_;  // [across_count_]
  HeadingAnswer outside_;
};

/// Slopes are rounded to 1/64 degree, far less than the error of slopes from elevation. P(go) uphill is the model's
/// value at the rounded slope.
inline constexpr double kSlopeSteps = 64;  // per degree
double rounded_slope(double slope_deg);

/// What a map says about a cell that does not depend on its aspect.
struct CellAnswer {
  CellClass result;             // uphill heading
  float p_go = 0;               // uphill; NaN: no point of the soil was sampled, or the slope is too steep
  float p_slow = 0;             // the part of p_go that is slow_go
  float outside_share = 1;      // share of the soil's points that no trial answers for, at this slope
  float p_low = 0, p_high = 0;  // 5 % and 95 % points of P(go), uphill heading
  float novelty = 0;            // uphill heading; NaN: the model gives none
  float speed = 0;              // top speed uphill [m/s]; NaN: not given
  float slip = 0, sinkage = 0;  // [-], [m] expected of trials that pass, uphill; NaN: not given
  HeadingRange headings;
};
/// P(go) and class of one soil as a function of slope, tabulated once from the model. A map then costs little more than
/// reading and writing its rasters. SoilResponse::at() gives P(go) of a cell; SoilPoints::at() computes the entries.
class SoilResponse {
 public:
  /// `points`: from soil_points(). `soft`: from soft_points(), `alternative` from point_alternatives() for the same
  /// points. `gradient_error`: standard error of the slope that
  /// follows from the elevation's error [rise per metre]; it widens p_low and p_high.
  SoilResponse(const OutcomeModel& model, const MapRules& rules, std::vector<std::vector<double>> points,
               double gradient_error = 0, SoftPoints soft = {}, std::vector<int> alternative = {});

  /// Straight uphill (slope_along = slope_deg, slope_across = 0), slope_deg in [0, 90]. A cell steeper than sampled is
  /// no_go if the steepest sampled slope is no_go, with its reason. Otherwise it is unknown.
  const CellAnswer& at(double slope_deg) const;
  /// In any heading; psi [rad] as in bed_slopes().
  const HeadingAnswer& at(double slope_deg, double psi) const {
    return headings_.at(bed_slopes(rounded_slope(slope_deg), psi));
  }

  /// What decides uphill at slope i / kSlopeSteps [deg].
  struct Uphill {
    std::vector<double> reason_weight;  // [outcome], see Prospect; empty where nothing was sampled
    PassageBounds bounds;
  };
  const Uphill& uphill(std::size_t i) const { return uphill_[i]; }

  /// Sampled range of slope_along [deg].
  Range sampled_slope() const { return sampled_slope_; }
  const SoilPoints& points() const { return points_; }
  const HeadingTable& headings() const { return headings_; }
  /// Expected measures of trials that pass, by name. Empty without a dataset.
  const std::map<std::string, SlopeMeasure>& measures() const { return measures_; }
  /// Whether the model gives top speeds.
  bool has_speed() const { return !heading_speed_.empty(); }
  /// Top speed [m/s] at node (along, across) of headings(), passable or not. The response must have speeds.
  double heading_speed(int along, int across) const {
    return heading_speed_[std::size_t(along) * std::size_t(headings_.across_count()) + std::size_t(across)];
  }
  const std::vector<std::string>& outside_because() const { return points_.outside_because(); }

 private:
  void tabulate(const OutcomeModel& model, const MapRules& rules);
  CellAnswer answer_at(const Prospect& prospect, const MapRules& rules, int step);
  void add_interval(double gradient_error, std::size_t models);
  void add_measures(const OutcomeModel& model);
  void add_speeds(const OutcomeModel& model, const MapRules& rules);

  SoilPoints points_;
  HeadingTable headings_;
  std::map<std::string, SlopeMeasure> measures_;
  Range sampled_slope_;
  std::vector<float> heading_speed_;      // [node of headings_] [m/s]; empty: not given
  std::vector<CellAnswer> table_;         // [round(slope x kSlopeSteps)], 0 to 90 degrees
  std::vector<Uphill> uphill_;            // [step]
  std::vector<SoilPoints::Each> p_each_;  // [step]; freed after construction
};

}  // namespace gonogo::map
