#include "pipeline/map/soil_response.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "base/cancel.h"

namespace gonogo::pipeline {
namespace {

constexpr float kNoData = std::numeric_limits<float>::quiet_NaN();

std::string describe_outside(const Variable& variable, double value, Range sampled) {
  std::ostringstream text;
  text << variable.name << " " << value << " " << variable.unit << " is outside " << sampled.minimum << " to "
       << sampled.maximum << " " << variable.unit;
  return text.str();
}

/// Room for the last digit of a range that went through a file.
bool contains(Range sampled, double value) {
  const double slack = 1e-9 * std::max(std::abs(sampled.minimum), std::abs(sampled.maximum));
  return value >= sampled.minimum - slack && value <= sampled.maximum + slack;
}

}  // namespace

double rounded_slope(double slope_deg) { return std::round(slope_deg * kSlopeSteps) / kSlopeSteps; }

SoilResponse::SoilResponse(const OutcomeModel& model, const MapRules& rules, std::vector<std::vector<double>> points) {
  sampled_slope_ = model.sampled[contract().variable_index("slope_along")];
  sort_points(model, std::move(points));
  const int last = std::max(0, int(std::floor(sampled_slope_.maximum * kSlopeSteps)));
  table_.resize(std::size_t(last) + 2);
#pragma omp parallel for schedule(dynamic, 16)
  for (int i = 0; i <= last; ++i)
    if (!cancel_requested()) table_[std::size_t(i)] = answer_at(model, rules, i / kSlopeSteps);
  stop_if_cancelled();
  CellAnswer steeper = answer_at(model, rules, sampled_slope_.maximum);
  if (steeper.result.verdict != Verdict::no_go) steeper.result = {Verdict::unknown, Reason::outside_sampled};
  steeper.p_go = kNoData;
  steeper.outside_share = 1;
  table_.back() = steeper;
}

const CellAnswer& SoilResponse::at(double slope_deg) const {
  const double step = std::round(slope_deg * kSlopeSteps);
  return table_[std::size_t(std::clamp(step, 0.0, double(table_.size() - 1)))];
}

void SoilResponse::sort_points(const OutcomeModel& model, std::vector<std::vector<double>> points) {
  const auto& variables = contract().variables;
  const std::size_t across = contract().variable_index("slope_across");
  point_count_ = points.size();
  for (std::vector<double>& point : points) {
    point[across] = 0;
    bool inside = true;
    for (std::size_t v = 0; v < variables.size(); ++v) {
      if (std::isnan(point[v]) || contains(model.sampled[v], point[v])) continue;
      inside = false;
      const std::string why = describe_outside(variables[v], point[v], model.sampled[v]);
      if (std::find(outside_because_.begin(), outside_because_.end(), why) == outside_because_.end())
        outside_because_.push_back(why);
    }
    if (!inside) continue;
    inside_points_.insert(inside_points_.end(), point.begin(), point.end());
    ++inside_count_;
  }
}

Prospect SoilResponse::prospect_at(const OutcomeModel& model, double slope_deg) const {
  const std::size_t variable_count = contract().variables.size(), outcome_count = contract().outcomes.size();
  Prospect prospect{std::vector<double>(outcome_count, 0.0), 1};
  if (inside_count_ == 0 || !contains(sampled_slope_, slope_deg)) return prospect;
  std::vector<double> points = inside_points_, result(inside_count_ * outcome_count);
  const std::size_t along = contract().variable_index("slope_along");
  for (std::size_t i = 0; i < inside_count_; ++i) points[i * variable_count + along] = slope_deg;
  model.probabilities(points, result);
  for (std::size_t i = 0; i < inside_count_; ++i)
    for (std::size_t o = 0; o < outcome_count; ++o)
      prospect.outcome[o] += result[i * outcome_count + o] / double(inside_count_);
  prospect.outside_share = 1 - double(inside_count_) / double(point_count_);
  return prospect;
}

CellAnswer SoilResponse::answer_at(const OutcomeModel& model, const MapRules& rules, double slope_deg) const {
  const Prospect prospect = prospect_at(model, slope_deg);
  return {classify(prospect, rules), float(prospect.p_go()), float(prospect.outside_share)};
}

}  // namespace gonogo::pipeline
