#include "pipeline/app/work/campaign_report.h"

namespace gonogo::app {

Json counts_json(const std::map<std::string, std::size_t>& counts) {
  Json object = Json::object();
  for (const auto& [name, number] : counts) object[name] = std::uint64_t(number);
  return object;
}

Json campaign_json(const campaign::CampaignSummary& summary) {
  Json result = Json::object();
  result["dataset"] = summary.dataset.string();
  result["trials"] = std::uint64_t(summary.trials);
  result["computed"] = std::uint64_t(summary.computed);
  result["reused"] = std::uint64_t(summary.reused);
  result["damaged"] = std::uint64_t(summary.damaged);
  result["worker_deaths"] = std::uint64_t(summary.worker_deaths);
  result["verdicts"] = counts_json(summary.by_verdict);
  result["reasons"] = counts_json(summary.by_reason);
  return result;
}

std::string campaign_text(const campaign::CampaignSummary& summary) {
  return summary.dataset.string() + ": " + std::to_string(summary.trials) + " trials, " +
         std::to_string(summary.computed) +
         " computed now: " + campaign::counts_line(summary.by_verdict, summary.by_reason);
}

}  // namespace gonogo::app
