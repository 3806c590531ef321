#include "pipeline/map/evaluate/soil_response.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel/host_loop.h"
#include "base/units.h"

namespace gonogo::map {

namespace {

constexpr double kRounding = 1e-6;  // steps; a range's end that went through a file is still its own node

int first_step(Range range) { return int(std::ceil(range.minimum * kHeadingSteps - kRounding)); }
int last_step(Range range) { return int(std::floor(range.maximum * kHeadingSteps + kRounding)); }

SlopeNode nearest_node(BedSlopes slopes) {
  return {int(std::lround(slopes.along * kHeadingSteps)), int(std::lround(slopes.across * kHeadingSteps))};
}

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
  std::vector<double> alongs, acrosses;
  for (int i = 0; i < along_count_; ++i) alongs.push_back(double(first_along_ + i) / kHeadingSteps);
  for (int j = 0; j < across_count_; ++j) acrosses.push_back(double(first_across_ + j) / kHeadingSteps);
  if (points.sampled_count() + points.bounded_count() > 0) {
    std::vector<SoilPoints::Each> each;
    std::vector<Prospect> prospects =
        points.on_slopes(model, alongs, acrosses, &each, {PassageTable::kStride, /*members=*/false});
    take_passages(points, each);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      nodes_[i].result = classify(prospects[i], rules);
      nodes_[i].p_go = float(prospects[i].p_go());
      nodes_[i].prospect = std::move(prospects[i]);
    }
  }
  steeper_.assign(std::size_t(across_count_), outside_);
  for (int j = 0; j < across_count_ && along_count_ > 0; ++j)
    if (node(along_count_ - 1, j).result.verdict == campaign::Verdict::no_go)
      steeper_[std::size_t(j)].result = node(along_count_ - 1, j).result;
}

void HeadingTable::take_passages(const SoilPoints& points, const std::vector<SoilPoints::Each>& each) {
  const auto nodes = [](int count) { return (std::size_t(count) + PassageTable::kStride - 1) / PassageTable::kStride; };
  passage_.along = nodes(along_count_);
  passage_.across = nodes(across_count_);
  const std::size_t count = points.sampled_count(),
                    skip =
                        std::max<std::size_t>(1, (count + PassageTable::kMostPoints - 1) / PassageTable::kMostPoints);
  for (std::size_t k = 0; k < count && !each.empty(); k += skip) {
    passage_.point.push_back(k);
    for (const SoilPoints::Each& node : each)
      passage_.p_go.push_back(node.sampled.empty() ? kNoData : float(node.sampled[k]));
  }
}

const HeadingAnswer& HeadingTable::at(BedSlopes slopes) const { return at(nearest_node(slopes)); }

const HeadingAnswer& HeadingTable::at(SlopeNode nearest) const {
  const int along = nearest.along - first_along_, across = nearest.across - first_across_;
  if (along < 0 || across < 0 || across >= across_count_) return outside_;
  return along < along_count_ ? node(along, across) : steeper_[std::size_t(across)];
}

int HeadingTable::index_of(BedSlopes slopes) const {
  const SlopeNode nearest = nearest_node(slopes);
  const int along = nearest.along - first_along_, across = nearest.across - first_across_;
  if (along < 0 || along >= along_count_ || across < 0 || across >= across_count_) return -1;
  return along * across_count_ + across;
}

HeadingRange HeadingTable::over_headings(std::span<const SlopeNode, kHeadings> nearest) const {
  HeadingRange range{.worst = {campaign::Verdict::go, campaign::Reason::none},
                     .best = {campaign::Verdict::no_go, campaign::Reason::none},
                     .p_worst = kNoData,
                     .p_best = kNoData,
                     .sampled_share = 0};
  bool any_unknown = false, any_soft = false;
  int sampled = 0;
  for (int h = 0; h < kHeadings; ++h) {
    const HeadingAnswer& answer = at(nearest[std::size_t(h)]);
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

namespace {

constexpr int kLastStep = int(90 * kSlopeSteps);

/// Middles of nine equally likely parts of the standard normal distribution: quantiles at (k + 1/2) / 9.
constexpr std::array<double, 9> kNormalParts = {-1.59322, -0.967422, -0.589456, -0.282216, 0,
                                                0.282216, 0.589456,  0.967422,  1.59322};

/// Value below which a share of the sorted values lies (nearest rank).
double quantile(const std::vector<double>& sorted, double share) {
  const auto rank = std::size_t(share * double(sorted.size()));
  return sorted[std::min(rank, sorted.size() - 1)];
}

}  // namespace

namespace {

/// Nodes of all headings at every step of the slope: the same for all soils.
const std::vector<std::array<SlopeNode, kHeadings>>& nodes_over_headings() {
  static const std::vector<std::array<SlopeNode, kHeadings>> nodes = [] {
    std::vector<std::array<SlopeNode, kHeadings>> result(kLastStep + 1);
    std::vector<FallLine> lines;
    for (int h = 0; h < kHeadings; ++h) lines.emplace_back(2 * kPi * h / kHeadings);
    for_each_on_host(result.size(), 64, [&](std::size_t i) {
      const double rise = std::tan(double(i) / kSlopeSteps * kDegree);
      for (std::size_t h = 0; h < lines.size(); ++h) result[i][h] = nearest_node(bed_slopes(rise, lines[h]));
    });
    return result;
  }();
  return nodes;
}

}  // namespace

double rounded_slope(double slope_deg) { return std::round(slope_deg * kSlopeSteps) / kSlopeSteps; }

SoilResponse::SoilResponse(const OutcomeModel& model, const MapRules& rules, std::vector<std::vector<double>> points,
                           double gradient_error, SoftPoints soft, std::vector<int> alternative)
    : points_(model, std::move(points), std::move(soft), std::move(alternative)), headings_(model, rules, points_) {
  sampled_slope_ = model.sampled[campaign::contract().variable_index("slope_along")];
  tabulate(model, rules);
  add_interval(gradient_error, 1 + model.members.size());
  p_each_ = {};
  add_measures(model);
  add_speeds(model, rules);
}

void SoilResponse::tabulate(const OutcomeModel& model, const MapRules& rules) {
  table_.resize(kLastStep + 1);
  p_each_.resize(table_.size());
  uphill_.resize(table_.size());
  const int steepest = std::clamp(int(std::floor(sampled_slope_.maximum * kSlopeSteps)), 0, kLastStep);
  std::vector<double> slopes;
  for (int i = 0; i <= kLastStep; ++i) slopes.push_back(i / kSlopeSteps);
  const double level = 0;
  const std::size_t sampled = std::size_t(steepest) + 1;
  const std::vector<Prospect> prospects =
      points_.on_slopes(model, std::span(slopes).first(sampled), {&level, 1}, &p_each_);
  p_each_.resize(table_.size());
  for (std::size_t i = 0; i < sampled; ++i) table_[i] = answer_at(prospects[i], rules, int(i));
  CellAnswer steeper;
  steeper.result = classify(points_.at(model, sampled_slope_.maximum, 0), rules);
  if (steeper.result.verdict != campaign::Verdict::no_go)
    steeper.result = {campaign::Verdict::unknown, points_.reason_outside()};
  steeper.p_go = steeper.p_slow = steeper.speed = steeper.slip = steeper.sinkage = kNoData;
  steeper.outside_share = 1;
  std::fill(table_.begin() + steepest + 1, table_.end(), steeper);
  std::vector<double> novelty;
  if (model.novelty) {
    for (double& slope : slopes) slope = std::min(slope, 89.9);
    novelty = points_.novelty_uphill(model, slopes);
  }
  const auto& nodes = nodes_over_headings();
  for_each_on_host(table_.size(), 64, [&](std::size_t i) {
    table_[i].headings = headings_.over_headings(nodes[i]);
    table_[i].novelty = novelty.empty() ? kNoData : float(novelty[i]);
  });
}

CellAnswer SoilResponse::answer_at(const Prospect& prospect, const MapRules& rules, int step) {
  Uphill& uphill = uphill_[std::size_t(step)];
  uphill.bounds = bounds_of(prospect, rules);
  if (points_.is_asked(step / kSlopeSteps, 0))
    for (std::size_t o = 0; o < prospect.outcome.size(); ++o) uphill.reason_weight.push_back(prospect.reason_weight(o));
  CellAnswer answer;
  answer.result = classify(prospect, rules);
  answer.p_go = float(prospect.p_go());
  answer.outside_share = float(prospect.outside_share);
  answer.p_slow = answer.outside_share >= 1 ? kNoData : float(prospect.of(campaign::Verdict::slow_go));
  return answer;
}

/// Interval on P(go) from the spread of soil, slope and model: every point, at nine equally likely slopes, by the model
/// and each of its members. A point that was not sampled counts as 0 in the low end, and in the high end as the most
/// that it may be. Steeper than sampled, the high end is that of the steepest sampled slope.
void SoilResponse::add_interval(double gradient_error, std::size_t models) {
  const int steepest = std::clamp(int(std::floor(sampled_slope_.maximum * kSlopeSteps)), 0, kLastStep);
  const std::size_t points = points_.all().size() * models;
  for_each_on_host(table_.size(), 64, [&](std::size_t i) {
    std::vector<double> low, high;
    const double rise = std::tan(to_radians(double(i) / kSlopeSteps));
    for (const double part : kNormalParts) {
      const double slope = to_degrees(std::atan(std::abs(rise + part * gradient_error)));
      const int step = std::clamp(int(std::lround(slope * kSlopeSteps)), 0, kLastStep);
      const SoilPoints::Each &known = p_each_[std::size_t(step)],
                             &most = p_each_[std::size_t(std::min(step, steepest))];
      const std::size_t before = low.size();
      low.insert(low.end(), known.sampled.begin(), known.sampled.end());
      low.resize(before + points, 0.0);
      high.insert(high.end(), most.sampled.begin(), most.sampled.end());
      high.insert(high.end(), most.most.begin(), most.most.end());
      high.resize(before + points, 1.0);
      if (gradient_error == 0) break;
    }
    std::sort(low.begin(), low.end());
    std::sort(high.begin(), high.end());
    table_[i].p_low = float(quantile(low, 0.05));
    table_[i].p_high = float(quantile(high, 0.95));
  });
}

void SoilResponse::add_measures(const OutcomeModel& model) {
  for (const MeasureFit& fit : model.measures) measures_[fit.name] = on_soil(fit, points_.all());
  for (std::size_t i = 0; i < table_.size(); ++i) {
    CellAnswer& answer = table_[i];
    const auto value = [&](const char* name) {
      const auto found = measures_.find(name);
      if (found == measures_.end() || std::isnan(answer.p_go)) return kNoData;
      return float(found->second.at({double(i) / kSlopeSteps, 0}));
    };
    answer.slip = value("slip");
    answer.sinkage = value("sinkage");
  }
}

void SoilResponse::add_speeds(const OutcomeModel& model, const MapRules& rules) {
  for (CellAnswer& answer : table_) answer.speed = kNoData;
  if (!model.speed) return;
  const SoilSpeed speed(*model.speed, points_.all(), rules.max_speed);
  const int width = headings_.across_count(), nodes = headings_.along_count() * width;
  heading_speed_.resize(std::size_t(nodes));
  for_each_on_host(heading_speed_.size(), 64, [&](std::size_t i) {
    heading_speed_[i] = float(speed.at(headings_.slopes(int(i) / width, int(i) % width)));
  });
  for_each_on_host(table_.size(), 64, [&](std::size_t i) {
    if (!std::isnan(table_[i].p_go)) table_[i].speed = float(speed.at({double(i) / kSlopeSteps, 0}));
  });
}

const CellAnswer& SoilResponse::at(double slope_deg) const {
  const double step = std::round(slope_deg * kSlopeSteps);
  return table_[std::size_t(std::clamp(step, 0.0, double(table_.size() - 1)))];
}

}  // namespace gonogo::map
