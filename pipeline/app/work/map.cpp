#include <cstdio>

#include "pipeline/app/work/map_request.h"
#include "pipeline/app/work/work.h"
#include "pipeline/campaign/study/study.h"

namespace gonogo::app {
namespace {

std::string as_text(const map::MapSummary& summary) {
  char text[160];
  std::snprintf(text, sizeof text, "%.2f km2, gravity %.4g m/s2%s\n", summary.area_km2, summary.gravity,
                summary.reused ? ", map kept: nothing changed" : "");
  std::string out = text;
  for (const campaign::VerdictInfo& verdict : campaign::contract().verdicts) {
    std::snprintf(text, sizeof text, "  %-8s %5.1f %%\n", verdict.label.c_str(),
                  100 * summary.area.share(campaign::Verdict(verdict.code)));
    out += text;
  }
  for (const std::string& remark : summary.remarks) out += "  " + remark + "\n";
  for (const auto& file : summary.files) out += file.string() + "\n";
  return out;
}

Json as_json(const map::MapSummary& summary) {
  Json result = Json::object();
  result["area_km2"] = summary.area_km2;
  result[campaign::kGravityKey] = summary.gravity;
  Json shares = Json::object();
  for (const campaign::VerdictInfo& verdict : campaign::contract().verdicts)
    shares[verdict.name] = summary.area.share(campaign::Verdict(verdict.code));
  result["share"] = shares;
  result["area"] = summary.area.to_json();
  result["remarks"] = Json(summary.remarks);
  result["reused"] = summary.reused;
  Json files = Json::array();
  for (const auto& file : summary.files) files.push_back(file.string());
  result["files"] = files;
  return result;
}

}  // namespace

void map_work(const Globals& globals, const map::MapFiles& files) {
  const map::MapSummary summary = map::make_map(map_request_of(globals, files));
  print_result(globals, as_json(summary), as_text(summary));
}

}  // namespace gonogo::app
