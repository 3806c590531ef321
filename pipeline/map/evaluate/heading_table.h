// P(go) and class of one soil for every pair of slopes along and across the heading. The model is evaluated once for
// each pair; after that any heading of any cell is a look-up.
#pragma once
#include <vector>

#include "pipeline/map/evaluate/heading.h"
#include "pipeline/map/evaluate/soil_points.h"

namespace gonogo::map {

/// Slopes along and across are rounded to 1/2 degree. P(go) of a heading is the model's value at the rounded slopes.
/// Independent elevation errors of 0.2 m at 10 m cells change the slope by as much.
inline constexpr int kHeadingSteps = 2;  // per degree

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

class HeadingTable {
 public:
  /// Evaluates the model at every node inside the sampled box. `points`: what the soil may be.
  HeadingTable(const OutcomeModel& model, const MapRules& rules, const SoilPoints& points);

  /// The answer at the node nearest to `slopes`. Outside the sampled box the answer is unknown, with one exception:
  /// steeper uphill than sampled it is no_go if the steepest sampled node at the same slope across is no_go.
  const HeadingAnswer& at(BedSlopes slopes) const;

  /// Worst and best of kHeadings headings on ground of this slope.
  /// worst: no_go if any heading is no_go; else unknown if any is unknown; else the lowest class.
  /// best: go if any heading is go; else slow_go if any is; else unknown if any is; else no_go.
  /// The reason of unknown is soft_soil if any heading has that reason.
  HeadingRange over_headings(double slope_deg) const;

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
  int first_along_ = 0, along_count_ = 0, first_across_ = 0, across_count_ = 0;
  std::vector<HeadingAnswer> nodes_;
  std::vector<HeadingAnswer> steeper_;  // [across_count_]
  HeadingAnswer outside_;
};

}  // namespace gonogo::map
