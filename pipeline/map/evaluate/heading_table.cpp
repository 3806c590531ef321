#include "pipeline/map/evaluate/heading_table.h"

#include <algorithm>
#include <limits>

#include "base/cancel.h"
#include "base/units.h"

namespace gonogo::map {
namespace {

constexpr float kNoData = std::numeric_limits<float>::quiet_NaN();
constexpr double kRounding = 1e-6;  // steps; a range's end that went through a file is still its own node

int first_step(Range range) { return int(std::ceil(range.minimum * kHeadingSteps - kRounding)); }
int last_step(Range range) { return int(std::floor(range.maximum * kHeadingSteps + kRounding)); }

bool is_below(campaign::Verdict a, campaign::Verdict b) { return int(a) > int(b); }  // no_go below slow_go below go

}  // namespace

HeadingTable::HeadingTable(const OutcomeModel& model, const MapRules& rules, const SoilPoints& points) {
  const Range along = model.sampled[campaign::contract().variable_index("slope_along")];
  const Range across = model.sampled[campaign::contract().variable_index("slope_across")];
  first_along_ = first_step(along);
  first_across_ = first_step(across);
  along_count_ = std::max(0, last_step(along) - first_along_ + 1);
  across_count_ = std::max(0, last_step(across) - first_across_ + 1);
  outside_ = {{campaign::Verdict::unknown, points.reason_outside()}, {{}, 1, points.soft_share()}, kNoData};
  nodes_.assign(std::size_t(along_count_) * std::size_t(across_count_), outside_);
#pragma omp parallel for schedule(dynamic, 64)
  for (int i = 0; i < along_count_ * across_count_; ++i) {
    if (cancel_requested() || points.sampled_count() == 0) continue;
    HeadingAnswer& node = nodes_[std::size_t(i)];
    const int along_step = first_along_ + i / across_count_, across_step = first_across_ + i % across_count_;
    node.prospect = points.at(model, double(along_step) / kHeadingSteps, double(across_step) / kHeadingSteps);
    node.result = classify(node.prospect, rules);
    node.p_go = float(node.prospect.p_go());
  }
  stop_if_cancelled();
  steeper_.assign(std::size_t(across_count_), outside_);
  for (int j = 0; j < across_count_ && along_count_ > 0; ++j)
    if (node(along_count_ - 1, j).result.verdict == campaign::Verdict::no_go)
      steeper_[std::size_t(j)].result = node(along_count_ - 1, j).result;
}

const HeadingAnswer& HeadingTable::at(BedSlopes slopes) const {
  const int along = int(std::lround(slopes.along * kHeadingSteps)) - first_along_;
  const int across = int(std::lround(slopes.across * kHeadingSteps)) - first_across_;
  if (along < 0 || across < 0 || across >= across_count_) return outside_;
  return along < along_count_ ? node(along, across) : steeper_[std::size_t(across)];
}

int HeadingTable::index_of(BedSlopes slopes) const {
  const int along = int(std::lround(slopes.along * kHeadingSteps)) - first_along_;
  const int across = int(std::lround(slopes.across * kHeadingSteps)) - first_across_;
  if (along < 0 || along >= along_count_ || across < 0 || across >= across_count_) return -1;
  return along * across_count_ + across;
}

HeadingRange HeadingTable::over_headings(double slope_deg) const {
  HeadingRange range{.worst = {campaign::Verdict::go, campaign::Reason::none},
                     .best = {campaign::Verdict::no_go, campaign::Reason::none},
                     .p_worst = kNoData,
                     .p_best = kNoData,
                     .sampled_share = 0};
  bool any_unknown = false, any_soft = false;
  int sampled = 0;
  for (int h = 0; h < kHeadings; ++h) {
    const HeadingAnswer& answer = at(bed_slopes(slope_deg, 2 * kPi * h / kHeadings));
    const campaign::Verdict verdict = answer.result.verdict;
    if (!std::isnan(answer.p_go)) {
      ++sampled;
      if (!(answer.p_go >= range.p_worst)) range.p_worst = answer.p_go;
      if (!(answer.p_go <= range.p_best)) range.p_best = answer.p_go;
    }
    if (verdict == campaign::Verdict::unknown) {
      any_unknown = true;
      any_soft = any_soft || answer.result.reason == campaign::Reason::soft_soil;
      continue;
    }
    if (is_below(verdict, range.worst.verdict)) range.worst = answer.result;
    if (is_below(range.best.verdict, verdict) || (h == 0 && verdict == campaign::Verdict::no_go))
      range.best = answer.result;
  }
  const CellClass unknown = {campaign::Verdict::unknown,
                             any_soft ? campaign::Reason::soft_soil : campaign::Reason::outside_sampled};
  if (any_unknown && range.worst.verdict != campaign::Verdict::no_go) range.worst = unknown;
  if (any_unknown && range.best.verdict == campaign::Verdict::no_go) range.best = unknown;
  range.sampled_share = float(sampled) / kHeadings;
  return range;
}

}  // namespace gonogo::map
