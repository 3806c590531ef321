#include <cstdio>
#include <memory>

#include "pipeline/cli/command.h"
#include "pipeline/map/map_request.h"
#include "pipeline/vehicle/locate.h"

namespace gonogo::pipeline::cli {
namespace {

std::string as_text(const MapSummary& summary) {
  char text[160];
  std::snprintf(text, sizeof text, "%.2f km2%s\n", summary.area_km2,
                summary.reused ? ", map kept: nothing changed" : "");
  std::string out = text;
  for (const VerdictInfo& verdict : contract().verdicts) {
    std::snprintf(text, sizeof text, "  %-8s %5.1f %%\n", verdict.label.c_str(),
                  100 * summary.area.share(Verdict(verdict.code)));
    out += text;
  }
  for (const std::string& remark : summary.remarks) out += "  " + remark + "\n";
  for (const auto& file : summary.files) out += file.string() + "\n";
  return out;
}

Json as_json(const MapSummary& summary) {
  Json result = Json::object();
  result["area_km2"] = summary.area_km2;
  Json shares = Json::object();
  for (const VerdictInfo& verdict : contract().verdicts)
    shares[verdict.name] = summary.area.share(Verdict(verdict.code));
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
  auto files = std::make_shared<MapFiles>();
  command->add_option("--model", files->model, "Trained model (model.h5)")->required();
  command->add_option("--region", files->region, "Region file; by default the one that the study names");
  command->add_option("--study", files->study, "Study file: thresholds and mission values of its section \"map\"");
  command->add_option("--dataset", files->dataset, "Trials (dataset.h5): adds expected speed, slip and sinkage");
  command->add_option("--members", files->members,
                      "Members of the model (gonogo train --members): their spread widens the interval on P(go)");
  command->add_option("--heading", files->heading,
                      "Of class, P(go) and reason: uphill, worst, best, or degrees clockwise from grid north");
  command->add_option("--vehicle", files->vehicle,
                      "Vehicle (file or name) whose cone index fine-grained soil must reach; by default the study's");
  command->add_option("--moisture", files->moisture,
                      "Scenario: dry, moist or wet; by default the raster's or every sample");
  command->add_option("--out", files->out, "Folder of the map")->required();
  command->add_flag("--colour-blind-safe", files->colour_blind_safe, "Class colours that do not rely on red and green");
  command->footer(
      "Writes index.html, a page that opens from disk; go.tif (class), p_go.tif, reason.tif and more layers, each with "
      "a\n"
      "QGIS style; map.png, area.csv and map.json. Quarter vehicle; docs/map.md says what the numbers mean.\n\n"
      "Example:\n  gonogo map --model out/demo/model.h5 --region configs/regions/sagehen.json --out out/map");
  command->callback([files, &globals] {
    files->threads = globals.threads;
    if (!files->vehicle.empty()) files->vehicle = vehicle_file(files->vehicle.string());
    const MapSummary summary = make_map(read_map_request(*files));
    print_result(globals, as_json(summary), as_text(summary));
  });
}

}  // namespace gonogo::pipeline::cli
