#include <cstdlib>  // defines __GLIBC__
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <memory>

#include "base/format.h"
#include "pipeline/app/cli/work.h"
#include "pipeline/app/maps/map_options.h"
#include "pipeline/campaign/study/study.h"

namespace gonogo::app {
namespace {

std::string as_text(const map::MapSummary& summary) {
  std::string out = line("%.2f km2, gravity %.4g m/s2%s\n", summary.area_km2, summary.gravity,
                         summary.reused ? ", map kept: nothing changed" : "");
  for (const campaign::VerdictInfo& verdict : campaign::contract().verdicts) {
    out += line("  %-8s %5.1f %%\n", verdict.label.c_str(), 100 * summary.area.share(campaign::Verdict(verdict.code)));
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

/// Keeps freed memory for the next use. Tiles take and free buffers of 0.1 to 32 MB, which the kernel would give back
/// and clear anew each time.
void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the most that glibc takes
  mallopt(M_TRIM_THRESHOLD, 128 << 20);
#endif
}

void draw_map(const Globals& globals, const map::MapFiles& files) {
  keep_freed_memory();
  const map::MapSummary summary = map::make_map(map_request_of(globals, files));
  print_result(globals, as_json(summary), as_text(summary));
}

}  // namespace

void add_map_command(CLI::App& app, const Globals& globals) {
  CLI::App* command =
      app.add_subcommand("map", "Go/NoGo map of a region: a page, GeoTIFF layers, QGIS styles, figure, area table");
  const auto files = std::make_shared<map::MapFiles>();
  add_map_file_options(*command, *files);
  add_named(*command, "--members", files->members, kFile,
            "Members of the model (gonogo train --members): their spread widens the interval on P(go)");
  add_named(*command, "--heading", files->heading, one_of({"uphill", "worst", "best"}),
            "Of class, P(go) and reason: one of these, or degrees clockwise from grid north");
  add_named(*command, "--out", files->out, kFolder, "Folder of the map")->required();
  command->add_flag("--colour-blind-safe", files->colour_blind_safe, "Class colours that do not rely on red and green");
  add_examples(*command,
               {"gonogo map --model hmmwv --dem elevation.tif --soil sand --moisture wet --out out/map",
                "gonogo map --model out/demo/model.h5 --region configs/regions/sagehen.json --out out/map"},
               "Writes index.html, a page that opens from disk; go.tif (class), p_go.tif, reason.tif and more layers, "
               "each\nwith a QGIS style; map.png, area.csv and map.json. gonogo models lists the models that ship; "
               "docs/map.md\nsays what the numbers mean.");
  calls<draw_map>(*command, globals, files);
}

}  // namespace gonogo::app
