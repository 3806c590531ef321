#include "pipeline/map/region/rules.h"

#include <algorithm>

#include "base/error.h"
#include "base/format.h"

namespace gonogo::map {
namespace {

campaign::Verdict verdict_at(double p_go, bool slow_is_likelier, const MapRules& rules) {
  if (p_go < rules.no_go) return campaign::Verdict::no_go;
  if (p_go < rules.go || slow_is_likelier) return campaign::Verdict::slow_go;
  return campaign::Verdict::go;
}

campaign::Reason likeliest_no_go_reason(const Prospect& prospect) {
  const auto& outcomes = campaign::contract().outcomes;
  double best = -1;
  campaign::Reason reason = campaign::Reason::none;
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    if (outcomes[i].verdict == campaign::Verdict::no_go && prospect.reason_weight(i) > best) {
      best = prospect.reason_weight(i);
      reason = outcomes[i].reason;
    }
  return reason;
}

}  // namespace

MapRules read_map_rules(const std::optional<Config>& section) {
  MapRules rules;
  if (!section) return rules;
  rules.go = section->number_or("go", rules.go, {0, 1});
  rules.no_go = section->number_or("no_go", rules.no_go, {0, rules.go});
  rules.tolerated_outside_share = section->number_or("tolerated_outside_share", 0, {0, 1});
  rules.draws = int(section->integer_or("draws", rules.draws, {1, 4096}));
  if (section->has("moisture")) rules.moisture = section->choice("moisture", {"dry", "moist", "wet"});
  rules.fidelity = section->text_or("fidelity", rules.fidelity);
  rules.correlation_length = section->number_or("correlation_length_m", rules.correlation_length, {1, 1e6});
  if (section->has("max_speed_km_h")) rules.max_speed = section->number("max_speed_km_h", kMaxSpeedRange) / kKmPerHour;
  if (section->has("heading")) set_heading(rules, section->text("heading"), "map.heading");
  if (section->has("cone_index_of")) rules.cone_index_of = section->path("cone_index_of");
  if (const auto values = section->object_if("values")) rules.values = read_spreads(*values);
  section->finish();
  return rules;
}

void set_heading(MapRules& rules, const std::string& text, const std::string& where) {
  if (text == "uphill" || text == "worst" || text == "best") {
    rules.heading_mode = text == "uphill"  ? HeadingMode::uphill
                         : text == "worst" ? HeadingMode::worst
                                           : HeadingMode::best;
    return;
  }
  const double degrees = parsed<double>(text).value_or(-1);
  if (!(degrees >= 0 && degrees < 360))
    throw InputError(where + ": \"" + text +
                     "\" is no heading; use uphill, worst, best, or degrees clockwise from grid north, 0 to below 360");
  rules.heading_mode = HeadingMode::set;
  rules.heading = degrees;
}

std::string heading_text(const MapRules& rules) {
  if (rules.heading_mode == HeadingMode::uphill) return "uphill heading";
  if (rules.heading_mode == HeadingMode::worst) return "worst heading";
  if (rules.heading_mode == HeadingMode::best) return "best heading";
  return line("heading %g degrees from grid north", rules.heading);
}

double Prospect::of(campaign::Verdict verdict) const {
  double sum = 0;
  for (std::size_t o = 0; o < outcome.size(); ++o)
    if (campaign::contract().outcomes[o].verdict == verdict) sum += outcome[o];
  return sum;
}

double Prospect::p_go() const {
  if (outside_share >= 1) return std::numeric_limits<double>::quiet_NaN();
  return of(campaign::Verdict::go) + of(campaign::Verdict::slow_go);
}

campaign::Reason reason_of_unknown(const Prospect& prospect) {
  const bool soft = prospect.soft_share > 0 && 2 * prospect.soft_share >= prospect.outside_share;
  return soft ? campaign::Reason::soft_soil : campaign::Reason::outside_sampled;
}

double Prospect::reason_weight(std::size_t o) const {
  const double sampled = outcome.empty() ? 0 : outcome[o] * (1 - outside_share);
  return sampled + (bounding.empty() ? 0 : bounding[o] * outside_share);
}

namespace {

Range bounds_of(const Estimate& e, const MapRules& rules) {
  const double not_sampled = e.outside_share - e.soft_share;
  const bool counts = e.outside_share >= 1 || not_sampled > rules.tolerated_outside_share;
  const double outside = e.soft_share + (counts ? not_sampled : 0);
  const double lower = e.outside_share >= 1 ? 0 : e.p_go * (1 - outside);
  return {lower, lower + e.soft_share * e.soft_most + (counts ? not_sampled * e.outside_most : 0)};
}

}  // namespace

PassageBounds bounds_of(const Prospect& p, const MapRules& rules) {
  const Range all = bounds_of(
      Estimate{p.outside_share >= 1 ? 0 : p.p_go(), p.outside_share, p.soft_share, p.soft_most, p.outside_most}, rules);
  PassageBounds bounds{all.minimum, all.maximum, all.minimum, all.maximum};
  for (const Estimate& e : p.alternative) {
    const Range one = bounds_of(e, rules);
    bounds.least = std::min(bounds.least, one.minimum);
    bounds.most = std::max(bounds.most, one.maximum);
  }
  return bounds;
}

CellClass classify(const Prospect& prospect, const MapRules& rules) {
  using campaign::Verdict;
  const PassageBounds bounds = bounds_of(prospect, rules);
  if (bounds.most < rules.no_go) return {Verdict::no_go, likeliest_no_go_reason(prospect)};
  const CellClass unknown = {
      Verdict::unknown, prospect.outside_share > 0 ? reason_of_unknown(prospect) : campaign::Reason::input_missing};
  if (bounds.least < rules.no_go) return unknown;
  const bool slow = prospect.of(Verdict::slow_go) > prospect.of(Verdict::go);
  const Verdict verdict = verdict_at(bounds.lower, slow, rules);
  if (verdict != verdict_at(bounds.upper, slow, rules)) return unknown;
  return {verdict == Verdict::go && bounds.least < rules.go ? Verdict::slow_go : verdict, campaign::Reason::none};
}

}  // namespace gonogo::map
