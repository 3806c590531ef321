#include "pipeline/map/write/map_figure.h"

#include <algorithm>
#include <cstdio>

#include "base/version.h"
#include "pipeline/map/evaluate/layers.h"
#include "pipeline/map/write/map_record.h"
#include "pipeline/report/figure/figure.h"

namespace gonogo::map {
namespace {

std::string number(double x, const char* format = "%g") {
  char text[32];
  std::snprintf(text, sizeof text, format, x);
  return text;
}

void add_legends(const MapRequest& request, const MapSummary& summary, report::MapFigure& figure) {
  for (const auto& entry : class_legend(request.colour_blind_safe))
    figure.classes.push_back(
        {int(entry.value), entry.label, entry.colour, summary.area.share(campaign::Verdict(int(entry.value)))});
  for (const auto& entry : reason_legend()) {
    double share = 0;
    for (const campaign::VerdictInfo& verdict : campaign::contract().verdicts)
      share += summary.area.share(campaign::Verdict(verdict.code), campaign::Reason(int(entry.value)));
    if (share > 0) figure.reasons.push_back({int(entry.value), entry.label, entry.colour, share});
  }
  for (const auto& stop : p_go_legend()) figure.p_go_ramp.push_back({stop.value, stop.colour});
}

/// One curve per soil that occurs, the most frequent first.
void add_curves(const SoilTable& table, const MapSummary& summary, report::MapFigure& figure) {
  std::vector<std::size_t> order;
  for (std::size_t s = 0; s < table.soils.size(); ++s)
    if (table.soils.size() == 1 || table.cells[s] > 0) order.push_back(s);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return table.cells[a] > table.cells[b]; });
  for (const std::size_t s : order) {
    report::FigureCurve curve;
    curve.label = table.soils[s].name;
    if (summary.area.total() > 0 && table.cells[s] > 0)
      curve.label += "  " + number(100.0 * double(table.cells[s]) / double(summary.area.total()), "%.1f") + " %";
    const SoilResponse& response = table.responses[s];
    for (double slope = 0; slope <= response.sampled_slope().maximum; slope += 1 / kSlopeSteps) {
      curve.slope_deg.push_back(slope);
      curve.p_go.push_back(response.at(slope).p_go);
    }
    figure.curves.push_back(std::move(curve));
    figure.steepest_sampled_deg = response.sampled_slope().maximum;
  }
}

void add_notes(const MapRequest& request, const terrain::MapGrid& grid, const MapSummary& summary,
               report::MapFigure& figure) {
  const MapRules& rules = request.rules;
  figure.notes.push_back("go: P(go) \u2265 " + number(rules.go) + ";  slow-go: " + number(rules.no_go) +
                         " \u2264 P(go) < " + number(rules.go) + ", or slower than the go speed;  no-go: P(go) < " +
                         number(rules.no_go) +
                         ".  P(go) is the probability that a valid trial ends in go or slow-go.  Grey is never a "
                         "guess: the soil is not known or too soft, or nothing like it was simulated.");
  for (const std::string& remark : summary.remarks) figure.notes.push_back(remark);
  figure.notes.push_back("Elevation: " + request.region.elevation.source +
                         (request.region.soil_class ? ".  Soil: " + request.region.soil_class->source : ""));
  figure.notes.push_back((grid.crs_code.empty() ? grid.crs_name : grid.crs_name + " (" + grid.crs_code + ")") +
                         ", cells " + number(grid.cell_width_m()) + " m, slope by Horn 1981.  gonogo " +
                         program_version() + " " + program_revision() + ", model " + request.model.hash.substr(0, 12));
}

}  // namespace

void write_map_figure(const MapRequest& request, const terrain::MapGrid& grid, const SoilTable& table,
                      const MapSummary& summary, const Picture& picture, const std::filesystem::path& path) {
  report::MapFigure figure;
  figure.title = (request.model.vehicle.empty() ? "" : request.model.vehicle + ", ") + request.region.name;
  figure.subtitle = "Go/NoGo map of " + vehicle_text(request.model) + ", " + heading_text(request.rules) + ", " +
                    request.rules.fidelity;
  figure.grid = grid;
  figure.shade = picture.shade;
  figure.verdict = picture.verdict;
  figure.reason = picture.reason;
  figure.p_go = picture.p_go;
  figure.area_km2 = summary.area_km2;
  figure.go_threshold = request.rules.go;
  figure.no_go_threshold = request.rules.no_go;
  add_legends(request, summary, figure);
  add_curves(table, summary, figure);
  add_notes(request, grid, summary, figure);
  report::draw_map_figure(path, figure);
}

}  // namespace gonogo::map
