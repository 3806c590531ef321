#include "pipeline/map/write/map_page.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/files/file.h"
#include "base/format.h"
#include "base/parallel/host_loop.h"
#include "base/units.h"
#include "pipeline/campaign/study/contract.h"
#include "terrain/raster/grid.h"

namespace gonogo::map {
namespace {

/// Marks in the page's arrays.
enum PageMark : std::uint16_t {
  kNone = 65535,   // no such value
  kNoSlope = 255,  // in place of a soil
  kNoSoil = 254,   // unknown soil
};
constexpr double kMinShown = 0.002;  // a reason whose probability never reaches this is left out

std::uint16_t stored(double p) {
  return std::isnan(p) ? std::uint16_t(kNone) : std::uint16_t(std::lround(std::clamp(p, 0.0, 1.0) * 65534));
}

/// In steps of 0.01 km/h.
std::uint16_t stored_speed(double metres_per_second) {
  if (std::isnan(metres_per_second)) return kNone;
  return std::uint16_t(std::lround(std::min(650.0, kKmPerHour * metres_per_second) * 100));
}

/// "cohesion 1.04 kPa", "cohesion 1 to 5 kPa".
std::string value_text(const campaign::Variable& variable, const Spread& spread) {
  std::string text = variable.label + line(" %g", spread.low);
  if (spread.kind == Spread::Kind::range) text += line(" to %g", spread.high);
  return variable.unit == "-" ? text : text + " " + variable.unit;
}

const campaign::Variable& variable_named(const std::string& name) {
  return campaign::contract().variables[campaign::contract().variable_index(name)];
}

/// "friction angle 28 deg, cohesion 1.04 kPa: Wong, ..." for each sample.
std::vector<std::string> inputs_of(const Soil& soil) {
  if (!soil.given) return {line("nobody said what the soil is: %zu states of USDA textures", soil.samples.size())};
  std::vector<std::string> lines;
  for (const SoilSample& sample : soil.samples) {
    std::string text;
    for (const auto& [name, spread] : sample.values)
      text += (text.empty() ? "" : ", ") + value_text(variable_named(name), spread);
    lines.push_back(text + ". " + sample.source);
  }
  if (!soil.texture.empty()) lines.push_back("USDA texture " + soil.texture);
  if (soil.samples.empty()) lines.push_back("no sample; see the values of the region");
  return lines;
}

/// Values of the mission that a map by name leaves to the trials.
std::vector<std::string> open_values_of(const MapRequest& request, const Soil& soil) {
  std::vector<std::string> lines;
  for (const auto& [name, spread] : request.region.values) {
    const bool in_sample = std::any_of(soil.samples.begin(), soil.samples.end(),
                                       [&n = name](const SoilSample& sample) { return sample.values.count(n) > 0; });
    if (spread.kind == Spread::Kind::range && request.rules.values.count(name) == 0 && !in_sample)
      lines.push_back(value_text(variable_named(name), spread) + ", every value as likely");
  }
  return lines;
}

/// Variables that the points leave open and those held fixed in all trials.
std::vector<std::string> unknown_of(const MapRequest& request, const Soil& soil, const SoilResponse& response) {
  std::vector<std::string> lines = open_values_of(request, soil);
  const auto& variables = campaign::contract().variables;
  for (std::size_t v = 0; v < variables.size(); ++v) {
    if (variables[v].name == "slope_along" || variables[v].name == "slope_across") continue;
    const Range sampled = request.model.sampled[v];
    if (campaign::is_task_variable(variables[v]) && sampled.maximum == 0) continue;
    if (sampled.minimum == sampled.maximum)
      lines.push_back(
          line("%s: all trials had %g %s", variables[v].label.c_str(), sampled.minimum, variables[v].unit.c_str()));
    else if (std::any_of(response.points().all().begin(), response.points().all().end(),
                         [v](const std::vector<double>& point) { return std::isnan(point[v]); }))
      lines.push_back(line("%s: not known, summed out over %g to %g %s", variables[v].label.c_str(), sampled.minimum,
                           sampled.maximum, variables[v].unit.c_str()));
  }
  return lines;
}

Json measure_json(const SlopeMeasure& m) {
  return Json::Object{{"base", m.base},       {"along", m.along},   {"along2", m.along2},  {"across", m.across},
                      {"across2", m.across2}, {"lowest", m.lowest}, {"highest", m.highest}};
}

/// One array for each no-go reason that ever matters: [entries] from `outcome_at`.
template <class OutcomeAt>
void add_reasons(const std::string& table, int index, std::size_t count, std::size_t width, OutcomeAt outcome_at,
                 std::vector<Blob>& blobs) {
  const std::string prefix = table + "_" + std::to_string(index) + "_";
  for (std::size_t o = 0; o < campaign::contract().outcomes.size(); ++o) {
    if (campaign::contract().outcomes[o].verdict != campaign::Verdict::no_go) continue;
    Blob blob{prefix + campaign::contract().info(campaign::contract().outcomes[o].reason).name, 8, width, {}};
    double most = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double p = outcome_at(i, o);
      most = std::max(most, p);
      blob.value.push_back(std::uint16_t(std::lround(std::clamp(p, 0.0, 1.0) * 255)));
    }
    if (most >= kMinShown) blobs.push_back(std::move(blob));
  }
}

/// Whether classes need more than P(go) of the sampled points: points were not sampled, or nobody said which soil it
/// is.
bool is_bounded(const SoilResponse& response) {
  const SoilPoints& points = response.points();
  return points.sampled_count() < points.all().size() || points.has_alternatives();
}

/// Appends the bounds that classes follow from, as probabilities.
template <class BoundsAt>
void add_bounds(const char* table, int index, std::size_t count, std::size_t width, const BoundsAt& bounds_at,
                std::vector<Blob>& blobs) {
  const std::pair<const char*, double PassageBounds::*> parts[] = {{"lower", &PassageBounds::lower},
                                                                   {"upper", &PassageBounds::upper},
                                                                   {"least", &PassageBounds::least},
                                                                   {"most", &PassageBounds::most}};
  for (const auto& [name, member] : parts) {
    Blob blob{std::string(table) + "_" + name + "_" + std::to_string(index), 16, width, {}};
    for (std::size_t i = 0; i < count; ++i) {
      const std::optional<PassageBounds> bounds = bounds_at(i);
      blob.value.push_back(bounds ? stored((*bounds).*member) : std::uint16_t(kNone));
    }
    blobs.push_back(std::move(blob));
  }
}

void add_heading_blobs(const SoilResponse& response, const MapRules& rules, int index, std::vector<Blob>& blobs) {
  const HeadingTable& table = response.headings();
  const std::size_t width = std::size_t(std::max(1, table.across_count()));
  const std::size_t count = std::size_t(table.along_count()) * std::size_t(table.across_count());
  const auto node = [&](std::size_t i) -> const HeadingAnswer& { return table.node(int(i / width), int(i % width)); };
  Blob go{"heading_go_" + std::to_string(index), 16, width, {}};
  Blob slow{"heading_slow_" + std::to_string(index), 16, width, {}};
  Blob speed{"heading_speed_" + std::to_string(index), 16, width, {}};
  for (std::size_t i = 0; i < count; ++i) {
    go.value.push_back(stored(node(i).p_go));
    slow.value.push_back(stored(std::isnan(node(i).p_go) ? NAN : node(i).prospect.of(campaign::Verdict::slow_go)));
    if (response.has_speed())
      speed.value.push_back(stored_speed(response.heading_speed(int(i / width), int(i % width))));
  }
  blobs.push_back(std::move(go));
  blobs.push_back(std::move(slow));
  if (response.has_speed()) blobs.push_back(std::move(speed));
  add_reasons(
      "heading", index, count, width,
      [&](std::size_t i, std::size_t o) {
        return node(i).prospect.outcome.empty() ? 0.0 : node(i).prospect.reason_weight(o);
      },
      blobs);
  if (is_bounded(response))
    add_bounds(
        "heading", index, count, width,
        [&](std::size_t i) {
          const Prospect& prospect = node(i).prospect;
          return prospect.outcome.empty() ? std::nullopt : std::optional(bounds_of(prospect, rules));
        },
        blobs);
}

/// Name, samples, unknown variables, table sizes and measures of a soil.
Json page_soil(const MapRequest& request, const Soil& soil, const SoilResponse& response) {
  Json json = Json::object(), measures = Json::object(), outcomes = Json::array();
  json["name"] = soil.name;
  json["note"] = soil.note;
  json["given"] = soil.given;
  json["inputs"] = Json(inputs_of(soil));
  json["unknown"] = Json(unknown_of(request, soil, response));
  json["outside_because"] = Json(response.outside_because());
  json["stronger_because"] = Json(response.points().stronger_because());
  json["soft_because"] = Json(response.points().soft_because());
  json["soft_share"] = response.points().soft_share();
  json["bounded"] = is_bounded(response);
  json["outside_share"] = 1 - double(response.points().sampled_count()) / double(response.points().all().size());
  json["first_along"] = response.headings().first_along();
  json["first_across"] = response.headings().first_across();
  json["along_count"] = response.headings().along_count();
  json["across_count"] = response.headings().across_count();
  for (const auto& [name, measure] : response.measures()) measures[name] = measure_json(measure);
  json["measures"] = measures;
  for (const campaign::Outcome& outcome : campaign::contract().outcomes) {
    if (outcome.verdict != campaign::Verdict::no_go) continue;
    outcomes.push_back(Json::Object{{"reason", campaign::contract().info(outcome.reason).name}});
  }
  json["no_go_outcomes"] = outcomes;
  return json;
}

/// Appends P(go) of points of the soil at slopes some degrees apart, [point][along][across], and returns { stride,
/// along, across, points: [point][variable] }. Variables without the slopes are in units of the sampled ranges.
Json add_passage_table(const OutcomeModel& model, const SoilResponse& response, int index, std::vector<Blob>& blobs) {
  const PassageTable& passage = response.headings().passage();
  Blob blob{"drive_" + std::to_string(index), 16, passage.across, {}};
  for (const float p : passage.p_go) blob.value.push_back(stored(p));
  if (!passage.point.empty()) blobs.push_back(std::move(blob));
  Json rows = Json::array();
  for (const std::size_t k : passage.point) {
    Json row = Json::array();
    const auto x = response.points().sampled().subspan(k * model.sampled.size(), model.sampled.size());
    for (std::size_t v = 0; v < x.size(); ++v) {
      if (campaign::contract().variables[v].name.rfind("slope", 0) == 0) continue;
      const double width = model.sampled[v].maximum - model.sampled[v].minimum;
      row.push_back(width > 0 && !std::isnan(x[v]) ? (x[v] - model.sampled[v].minimum) / width : 0.0);
    }
    rows.push_back(row);
  }
  return Json::Object{
      {"stride", PassageTable::kStride}, {"along", passage.along}, {"across", passage.across}, {"points", rows}};
}

/// Appends the tables as blobs whose names end with `index`. P(go) is in steps of 1/65534 (65535: none). The
/// probability of each no-go reason is in steps of 1/255, speeds are in steps of 0.01 km/h (65535: none).
void add_soil_blobs(const SoilResponse& response, const MapRules& rules, int index, std::vector<Blob>& blobs) {
  add_heading_blobs(response, rules, index, blobs);
  const std::size_t count = std::size_t(90 * kSlopeSteps) + 1;
  const std::string end = "_" + std::to_string(index);
  Blob go{"uphill_go" + end, 16, count, {}}, slow{"uphill_slow" + end, 16, count, {}};
  Blob speed{"uphill_speed" + end, 16, count, {}};
  Blob low{"low" + end, 16, count, {}}, high{"high" + end, 16, count, {}}, novelty{"novelty" + end, 16, count, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const CellAnswer& answer = response.at(double(i) / kSlopeSteps);
    go.value.push_back(stored(answer.p_go));
    slow.value.push_back(stored(answer.p_slow));
    speed.value.push_back(stored_speed(answer.speed));
    low.value.push_back(stored(answer.p_low));
    high.value.push_back(stored(answer.p_high));
    novelty.value.push_back(std::isnan(answer.novelty)
                                ? std::uint16_t(kNone)
                                : std::uint16_t(std::lround(std::min(60.0, double(answer.novelty)) * 1000)));
  }
  for (Blob* blob : {&go, &slow, &low, &high, &novelty}) blobs.push_back(std::move(*blob));
  if (response.has_speed()) blobs.push_back(std::move(speed));
  add_reasons(
      "uphill", index, count, count,
      [&](std::size_t i, std::size_t o) {
        const auto& weight = response.uphill(i).reason_weight;
        return weight.empty() ? 0.0 : weight[o];
      },
      blobs);
  if (is_bounded(response))
    add_bounds(
        "uphill", index, count, count,
        [&](std::size_t i) {
          return response.uphill(i).reason_weight.empty() ? std::nullopt : std::optional(response.uphill(i).bounds);
        },
        blobs);
}

double finite_or(double value, double fallback) { return std::isfinite(value) ? value : fallback; }

struct Heights {
  double lowest = 0, highest = 1, step = 0.1;  // [m]
};

Heights heights_of(const PageCells& cells) {
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (std::size_t i = 0; i < cells.mark.size(); ++i) {
    if (!cells.mark[i].has_slope()) continue;
    low = std::min(low, cells.elevation[i]);
    high = std::max(high, cells.elevation[i]);
  }
  Heights heights{std::floor(finite_or(low, 0)), std::ceil(finite_or(high, 1)), 0.1};
  while ((heights.highest - heights.lowest) / heights.step > 65000) heights.step *= 2;
  return heights;
}

std::vector<Blob> cell_blobs(const PageCells& cells, const Heights& heights) {
  const std::size_t width = std::size_t(cells.columns), count = cells.mark.size();
  Blob slope{"slope", 16, width, std::vector<std::uint16_t>(count, 0)}, aspect = slope, height = slope, soil = slope;
  aspect.name = "aspect";
  height.name = "height";
  soil.name = "soil";
  soil.bits = 8;
  for (std::size_t i = 0; i < count; ++i) {
    if (!cells.mark[i].has_slope()) {
      soil.value[i] = kNoSlope;
      height.value[i] = kNone;
      continue;
    }
    slope.value[i] = std::uint16_t(std::lround(cells.slope[i] * kSlopeSteps));
    aspect.value[i] = std::isnan(cells.aspect[i]) ? 0 : std::uint16_t(rounded_aspect(cells.aspect[i]));
    height.value[i] = std::uint16_t(std::lround((cells.elevation[i] - heights.lowest) / heights.step));
    soil.value[i] = cells.mark[i].has_soil() ? cells.mark[i].soil : std::uint16_t(kNoSoil);
  }
  std::vector<Blob> blobs = {slope, aspect, height, soil};
  if (std::any_of(cells.mark.begin(), cells.mark.end(), [](const CellMark& mark) { return mark.has_rule(); })) {
    Blob rule{"rule", 8, width, std::vector<std::uint16_t>(count, 0)};
    for (std::size_t i = 0; i < count; ++i)
      rule.value[i] = cells.mark[i].has_rule() ? std::uint16_t(cells.mark[i].rule + 1) : 0;
    blobs.push_back(std::move(rule));
  }
  return blobs;
}

Json grid_json(const terrain::MapGrid& grid) {
  return Json::Object{{"columns", grid.columns},
                      {"rows", grid.rows},
                      {"west", grid.west},
                      {"north", grid.north},
                      {"cell_width_m", grid.cell_width_m()},
                      {"cell_height_m", grid.cell_height_m()},
                      {"metres_per_unit", grid.metres_per_unit},
                      {"unit_name", grid.unit_name},
                      {"crs", grid.crs_code.empty() ? grid.crs_name : grid.crs_name + " (" + grid.crs_code + ")"}};
}

/// Null where longitude and latitude are not known. Steps of 1e-7 degrees, 1 cm.
Json degrees_json(const terrain::MapGrid& grid) {
  constexpr int most = 33;
  const terrain::GlobeAnswer globe = terrain::place_on_globe(grid);
  if (!globe.place) return Json();
  const auto nodes = terrain::degree_nodes(grid, *globe.place, most);
  if (!nodes) return Json();
  const auto list = [](std::vector<double> values) {
    for (double& v : values) v = std::round(v * 1e7) / 1e7;
    return values;
  };
  return Json::Object{{"wgs84", globe.place->is_wgs84},
                      {"columns", nodes->columns},
                      {"rows", nodes->rows},
                      {"longitude", list(nodes->longitude)},
                      {"latitude", list(nodes->latitude)}};
}

Json verdicts_json() {
  Json list = Json::array();
  for (const campaign::VerdictInfo& v : campaign::contract().verdicts) {
    list.push_back(Json::Object{{"code", v.code},
                                {"name", v.name},
                                {"label", v.label},
                                {"colour", v.colour},
                                {"colour_blind_safe", v.colour_blind_safe}});
  }
  return list;
}

Json reasons_json() {
  Json list = Json::array();
  for (const campaign::ReasonInfo& r : campaign::contract().reasons) {
    list.push_back(
        Json::Object{{"code", r.code}, {"name", r.name}, {"label", r.label}, {"about", r.about}, {"colour", r.colour}});
  }
  return list;
}

Json land_json(const Region& region) {
  Json list = Json::array();
  for (const LandRule& rule : land_rules(region)) {
    list.push_back(Json::Object{{"of", rule.reason == campaign::Reason::soft_soil ? "Strength" : "Land cover"},
                                {"name", rule.name},
                                {"verdict", rule.verdict ? int(*rule.verdict) : 0},
                                {"reason", int(rule.reason)}});
  }
  return list;
}

Json note(const std::string& title, const std::vector<std::string>& lines) { return Json::Array{title, lines}; }

/// "0.0665", "452 J/m", "2113 J/m": three digits, never in exponent form.
std::string quantity(double x, const std::string& unit) {
  const std::string number = x >= 100 ? line("%.0f", x) : line("%.3g", x);
  return unit == "-" ? number : number + " " + unit;
}

std::string spaced(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

Json speed_note(const MapRequest& request) {
  const ResistanceFit& fit = request.model.speed->resistance;
  const double sampled = kKmPerHour * fit.fastest;
  std::vector<std::string> lines = {
      "Top speed is where the driveline's tractive force at full throttle equals slope and motion resistance; ride, "
      "sight, brakes and bends are not in it",
      line("Motion resistance over weight: %.3f + %.2f per metre of rut + %.3f slip + %.4f per m/s, error %.3f, "
           "from %zu trials that measured %.2f to %.2f",
           fit.constant, fit.per_rut, fit.per_slip, fit.per_speed, fit.error, fit.trials, fit.lowest, fit.highest),
      line("Trials drove up to %.1f km/h. Faster speeds add the inertia of all soil in the ruts to their resistance; "
           "no trial checks that",
           sampled),
      "Downhill it is no faster than on the level; where slope or soil were not sampled there is no speed"};
  if (std::isfinite(request.rules.max_speed))
    lines.push_back(line("No faster than %g km/h, the limit that was asked for", kKmPerHour * request.rules.max_speed));
  return note("Top speed", lines);
}

Json notes_json(const MapRequest& request, const MapSummary& summary, const PageCells& cells) {
  const MapRules& rules = request.rules;
  Json notes = Json::array();
  notes.push_back(
      note("What the classes mean",
           {line("go: P(go) of %g or more, and go likelier than slow-go", rules.go),
            line("slow-go: P(go) from %g to %g, or slow-go likelier than go", rules.no_go, rules.go),
            line("no-go: P(go) below %g; steeper uphill than sampled where the steepest sampled slope is "
                 "no-go already",
                 rules.no_go),
            "unknown: the soil is not known or too soft, or nothing like it was simulated; never a guess"}));
  std::vector<std::string> limits = summary.remarks;
  limits.push_back(
      "Slopes are rounded to 1/64 degree uphill and to 1/2 degree for other headings; azimuths are from "
      "grid north");
  if (cells.step > 1)
    limits.push_back(
        line("This page shows every %d. cell of the map in both directions; the GeoTIFF files beside it "
             "hold all of them",
             cells.step));
  notes.push_back(note("Limits", limits));
  if (request.model.speed) notes.push_back(speed_note(request));
  if (request.model.measures.empty()) return notes;
  std::vector<std::string> fits;
  for (const MeasureFit& fit : request.model.measures)
    fits.push_back(spaced(fit.name) + ": error " + quantity(fit.error, fit.unit) +
                   " left out in turn, standard deviation " + quantity(fit.spread, fit.unit) +
                   line(", %zu trials that passed", fit.trials));
  notes.push_back(note("Expected measures", fits));
  return notes;
}

Json provenance_json(const MapRequest& request, const terrain::MapGrid& grid, const Metadata& metadata) {
  Json list = Json::array();
  const auto add = [&list](const std::string& name, const std::string& value) {
    list.push_back(Json::Array{name, value});
  };
  const auto add_raster = [&](const char* name, const RegionRaster& raster) {
    add(name, raster.source + " (" + raster.licence + ")");
  };
  add_raster("Elevation", request.region.elevation);
  if (request.region.soil_class) add_raster("Soil", *request.region.soil_class);
  if (request.region.land_cover) add_raster("Land cover", *request.region.land_cover);
  if (request.region.moisture) add_raster("Moisture", *request.region.moisture);
  if (request.region.cone_index) add_raster("Cone index", *request.region.cone_index);
  if (const auto index = request.region.cone_index_everywhere)
    add("Cone index", line("%.4g psi (%.4g kPa) of all fine-grained soil, as given", *index / kPsi, *index / 1e3));
  if (!request.rules.moisture.empty()) add("Scenario", request.rules.moisture);
  add("Coordinates", grid.crs_code.empty() ? grid.crs_name : grid.crs_name + ", " + grid.crs_code);
  for (const auto& [key, value] : metadata)
    if (key.rfind("GONOGO_", 0) == 0) add(key.substr(7), value);
  return list;
}

constexpr double kFastestShown = 80;  // end of the ramp of speeds [km/h]

double largest(const MapRequest& request, const std::string& name, double fallback) {
  for (const MeasureFit& fit : request.model.measures)
    if (fit.name == name && fit.highest > 0) return fit.highest;
  return fallback;
}

}  // namespace

PageCells::PageCells(const terrain::MapGrid& grid) {
  while (std::int64_t(grid.columns / step) * std::int64_t(grid.rows / step) > kPageCells) ++step;
  columns = std::max(1, grid.columns / step);
  rows = std::max(1, grid.rows / step);
  const std::size_t count = std::size_t(columns) * std::size_t(rows);
  slope.assign(count, kNoData);
  aspect = elevation = slope;
  mark.resize(count);
}

void write_map_page(const MapRequest& request, const terrain::MapGrid& grid, const SoilTable& table,
                    const MapSummary& summary, const PageCells& cells, const Metadata& metadata,
                    const std::filesystem::path& path) {
  const Heights heights = heights_of(cells);
  std::vector<Blob> blobs = cell_blobs(cells, heights);
  Json meta, soils = Json::array();
  meta["title"] = map_title(request);
  meta["subtitle"] =
      "Go/NoGo map of " + request.region.name + "; " + conditions_text(request) + "; " + request.rules.fidelity;
  meta["about"] = request.region.about.empty() ? request.region.name : request.region.about;
  meta["grid"] = grid_json(grid);
  meta["degrees"] = degrees_json(grid);
  meta["cells"] = Json::Object{{"columns", cells.columns}, {"rows", cells.rows}, {"step", cells.step}};
  meta["height"] = Json::Object{{"lowest", heights.lowest}, {"highest", heights.highest}, {"step", heights.step}};
  meta["rules"] = rules_json(request.rules);
  meta["height_error"] = request.region.elevation.error * std::sqrt(1 - request.region.elevation.error_correlation);
  meta["slope_steps"] = kSlopeSteps;
  meta["heading_steps"] = kHeadingSteps;
  meta["headings"] = kHeadings;
  meta["verdicts"] = verdicts_json();
  meta["reasons"] = reasons_json();
  for (std::size_t s = 0; s < table.soils.size(); ++s) {
    Json soil = page_soil(request, table.soils[s], table.responses[s]);
    soil["drive"] = add_passage_table(request.model, table.responses[s], int(s), blobs);
    soils.push_back(soil);
    add_soil_blobs(table.responses[s], request.rules, int(s), blobs);
  }
  meta["soils"] = soils;
  meta["max_speed"] = kFastestShown;
  meta["max_sinkage"] = largest(request, "sinkage", 0.1);
  meta["energy_of"] = request.model.whole_vehicle ? "Energy at the wheels" : "Energy of one wheel";
  meta["not_modelled"] =
      Json::Array{request.region.land_cover ? "obstacles and what other vehicles did to the ground"
                                            : "vegetation, water, obstacles and what other vehicles did to the ground"};
  meta["land"] = land_json(request.region);
  meta["map_heading"] = heading_text(request.rules);
  meta["notes"] = notes_json(request, summary, cells);
  meta["provenance"] = provenance_json(request, grid, metadata);
  write_file_atomically(path, page_file(meta, blobs));
}

}  // namespace gonogo::map
