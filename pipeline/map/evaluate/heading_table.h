// What one soil says about every pair of slopes along and across the heading: the model folded into a table, so that
// any heading of any cell is a look-up.
#pragma once
#include <vector>

#include "pipeline/map/evaluate/heading.h"
#include "pipeline/map/evaluate/soil_points.h"

namespace gonogo::map {

/// Slopes along and across are rounded to this before the model is asked: 1/2 degree. P(go) of a heading is the model's
/// own value there. Independent elevation errors of 0.2 m at 10 m cells already do as much to the slope.
inline constexpr int kHeadingSteps = 2;  // per degree

struct HeadingAnswer {
  CellClass result;
  Prospect prospect;  // empty outcomes where it lies outside the sampled box
  float p_go = 0;     // not-a-number there
};

/// Answers over the heading for one slope of the ground.
struct HeadingRange {
  CellClass worst, best;
  float p_worst = 0, p_best = 0;  // of the sampled headings; not-a-number when there is none
  float sampled_share = 0;        // of the headings, [0, 1]
};

class HeadingTable {
 public:
  HeadingTable(const OutcomeModel& model, const MapRules& rules, const SoilPoints& points);

  /// Rounds both slopes [deg]. Outside the sampled box the answer is unknown; steeper uphill than sampled it is no_go
  /// if the steepest sampled slope along is, at the same slope across.
  const HeadingAnswer& at(BedSlopes slopes) const;

  /// Over kHeadings headings. worst: no_go if any heading is, else unknown if any is, else the lower class. best: go if
  /// any heading is, else slow_go, else unknown if any is, else no_go. Unknown is soft_soil if any heading is.
  HeadingRange over_headings(double slope_deg) const;

  /// Sampled nodes, along by along: node(i, j) is at ((first_along + i), (first_across + j)) / kHeadingSteps degrees.
  int first_along() const { return first_along_; }
  int first_across() const { return first_across_; }
  int along_count() const { return along_count_; }
  int across_count() const { return across_count_; }
  BedSlopes slopes(int along, int across) const {
    return {double(first_along_ + along) / kHeadingSteps, double(first_across_ + across) / kHeadingSteps};
  }
  /// along * across_count() + across of the node that at() takes, or -1 when it takes none.
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
