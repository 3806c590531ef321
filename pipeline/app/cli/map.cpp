#include <cstdio>
#include <memory>

#include "pipeline/app/cli/map_options.h"

namespace gonogo::app {
namespace {

std::string as_text(const map::MapSummary& summary) {
  char text[160];
  std::snprintf(text, sizeof text, "%.2f km2%s\n", summary.area_km2,
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

void add_map_command(CLI::App& app, const Globals& globals) {
  CLI::App* command =
      app.add_subcommand("map", "Go/NoGo map of a region: a page, GeoTIFF layers, QGIS styles, figure, area table");
  auto files = std::make_shared<map::MapFiles>();
  add_map_file_options(*command, *files);
  command->add_option("--members", files->members,
                      "Members of the model (gonogo train --members): their spread widens the interval on P(go)");
  command->add_option("--heading", files->heading,
                      "Of class, P(go) and reason: uphill, worst, best, or degrees clockwise from grid north");
  command->add_option("--out", files->out, "Folder of the map")->required();
  command->add_flag("--colour-blind-safe", files->colour_blind_safe, "Class colours that do not rely on red and green");
  command->footer(
      "Writes index.html, a page that opens from disk; go.tif (class), p_go.tif, reason.tif and more layers, each with "
      "a\n"
      "QGIS style; map.png, area.csv and map.json. Quarter vehicle; docs/map.md says what the numbers mean.\n\n"
      "Example:\n  gonogo map --model out/demo/model.h5 --region configs/regions/sagehen.json --out out/map");
  command->callback([files, &globals] {
    const map::MapSummary summary = map::make_map(map_request_of(*files, globals));
    print_result(globals, as_json(summary), as_text(summary));
  });
}

}  // namespace gonogo::app
