#include "pipeline/map/region/rules.h"

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
    if (outcomes[i].verdict == campaign::Verdict::no_go && prospect.outcome[i] > best) {
      best = prospect.outcome[i];
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

CellClass classify(const Prospect& prospect, const MapRules& rules) {
  if (prospect.outside_share >= 1) return {campaign::Verdict::unknown, reason_of_unknown(prospect)};
  const double not_sampled = prospect.outside_share - prospect.soft_share;
  const double outside = prospect.soft_share + (not_sampled > rules.tolerated_outside_share ? not_sampled : 0);
  const double lower = prospect.p_go() * (1 - outside), upper = lower + outside;
  const bool slow = prospect.of(campaign::Verdict::slow_go) > prospect.of(campaign::Verdict::go);
  const campaign::Verdict verdict = verdict_at(lower, slow, rules);
  if (verdict != verdict_at(upper, slow, rules)) return {campaign::Verdict::unknown, reason_of_unknown(prospect)};
  return {verdict, verdict == campaign::Verdict::no_go ? likeliest_no_go_reason(prospect) : campaign::Reason::none};
}

}  // namespace gonogo::map
