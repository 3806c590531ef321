#include "pipeline/map/write/compare_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/progress.h"
#include "base/version.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/map/region/region.h"
#include "pipeline/map/write/make_map.h"
#include "pipeline/map/write/map_tiles.h"
#include "pipeline/report/figure/map_figure.h"
#include "terrain/raster/layer/geotiff.h"
#include "terrain/raster/layer/layer_picture.h"
#include "terrain/raster/raster_source.h"

namespace gonogo::map {
namespace fs = std::filesystem;
using terrain::GeoTiffWriter;
using terrain::LayerInfo;
using terrain::LegendEntry;
using terrain::MapGrid;
using terrain::RasterKind;
using terrain::RasterSource;
using terrain::Tile;
using terrain::Window;
namespace {

constexpr double kTwoSided = 1.96;  // standard deviations that 5 % exceed
constexpr double kFifthPercentile = 1.645;

struct OneMap {
  RasterSource go, p, low, high;
  std::string name, region;
  double gravity = kGravity;  // [m/s^2]
};

std::string heading_of(const fs::path& folder) {
  return Json::read(folder / "map.json").at("inputs").at("rules").at("heading").string();
}

OneMap open_map(const fs::path& folder, const MapGrid& grid) {
  if (heading_of(folder) != "uphill heading")
    throw InputError(folder.string() + ": is a map for the " + heading_of(folder) +
                     "; the interval on P(go) is for the uphill heading, so compare maps for that heading");
  require_whole_map(folder, {"go.tif", "p_go.tif", "p_go_low.tif", "p_go_high.tif"});
  const auto open = [&](const char* file) {
    return RasterSource::open_on_grid(folder / file, grid, RasterKind::classes);
  };
  const Json inputs = Json::read(folder / "map.json").at("inputs");
  const Json* gravity = inputs.find(campaign::kGravityKey);
  const std::string& moisture = inputs.at("rules").at("moisture").string();
  return {.go = open("go.tif"),
          .p = open("p_go.tif"),
          .low = open("p_go_low.tif"),
          .high = open("p_go_high.tif"),
          .name = inputs.at("vehicle").string() + (moisture.empty() ? "" : ", " + moisture) + ", model " +
                  inputs.at("model_hash").string().substr(0, 8),
          .region = inputs.at("region").string(),
          .gravity = gravity ? gravity->number() : kGravity};
}

MapGrid common_grid(const CompareRequest& request) {
  MapGrid first = RasterSource::open_elevation(request.first / "go.tif").grid();
  const MapGrid second = RasterSource::open_elevation(request.second / "go.tif").grid();
  if (first.crs_wkt != second.crs_wkt || first.columns != second.columns || first.rows != second.rows ||
      first.west != second.west || first.north != second.north || first.cell_width != second.cell_width)
    throw InputError(request.second.string() + ": lies on another grid than " + request.first.string() +
                     "; map the same region twice");
  return first;
}

std::vector<LegendEntry> pass_legend(const std::string& first, const std::string& second) {
  return {{1, "both pass", "#b8e186"},
          {2, "only the first passes: " + first, "#2166ac"},
          {3, "only the second passes: " + second, "#f1a340"},
          {4, "neither passes", "#d7191c"},
          {5, "unknown in one or both", "#8e8e9c"}};
}

std::vector<LegendEntry> go_legend() {
  return {{1, "P(go) significantly lower in the second", "#2166ac"},
          {2, "no significant difference", "#f7f7f7"},
          {3, "P(go) significantly higher in the second", "#f1a340"}};
}

std::vector<LayerInfo> layers_of(const OneMap& a, const OneMap& b) {
  const std::vector<std::pair<std::string, std::string>> metadata = {{"GONOGO_first", a.name},
                                                                     {"GONOGO_second", b.name}};
  const auto layer = [&](std::string name, bool classes, std::vector<LegendEntry> legend) {
    return LayerInfo{.name = std::move(name),
                     .unit = classes ? "" : "1",
                     .classes = classes,
                     .legend = std::move(legend),
                     .metadata = metadata};
  };
  const std::vector<LegendEntry> two_sided = {{-1, "-1", "#2166ac"}, {0, "0", "#f7f7f7"}, {1, "1", "#b35806"}};
  const std::vector<LegendEntry> deviations = {{-4, "-4", "#2166ac"}, {0, "0", "#f7f7f7"}, {4, "4", "#b35806"}};
  return {layer("which map passes", true, pass_legend(a.name, b.name)),
          layer("difference of P(go), second minus first", false, two_sided),
          layer("difference of P(go) in standard deviations", false, deviations),
          layer("significance of the difference of P(go)", true, go_legend())};
}

/// Values of the four layers in a cell.
std::array<float, 4> compare_cell(const std::array<Tile, 4>& a, const std::array<Tile, 4>& b, std::size_t i) {
  std::array<float, 4> out = {kNoData, kNoData, kNoData, kNoData};
  if (std::isnan(a[0].value[i]) || std::isnan(b[0].value[i])) return out;
  out[0] = float(int(pass_change(int(a[0].value[i]), int(b[0].value[i]))));
  if (std::isnan(a[1].value[i]) || std::isnan(b[1].value[i])) return out;
  out[1] = b[1].value[i] - a[1].value[i];
  const double z =
      significance(a[1].value[i], a[2].value[i], a[3].value[i], b[1].value[i], b[2].value[i], b[3].value[i]);
  out[2] = float(std::clamp(z, -99.0, 99.0));
  out[3] = float(int(z <= -kTwoSided  ? GoChange::lower
                     : z >= kTwoSided ? GoChange::higher
                                      : GoChange::not_significant));
  return out;
}

/// A reduced copy of a layer, every cell the map's cell under its middle, filled window by window.
class Reduced {
 public:
  explicit Reduced(const MapGrid& grid) : grid_(grid) {
    const double scale = std::min(1.0, double(kPictureCells) / std::max(grid.columns, grid.rows));
    tile_ = Tile(std::max(1, int(std::lround(grid.columns * scale))), std::max(1, int(std::lround(grid.rows * scale))),
                 kNoData);
  }
  void take(const Tile& from, Window window) {
    for (int row = 0; row < tile_.rows; ++row) {
      const int y = int((row + 0.5) * grid_.rows / tile_.rows) - window.row;
      if (y < 0 || y >= window.rows) continue;
      for (int column = 0; column < tile_.columns; ++column) {
        const int x = int((column + 0.5) * grid_.columns / tile_.columns) - window.column;
        if (x >= 0 && x < window.columns) tile_.at(column, row) = from.at(x, y);
      }
    }
  }
  const Tile& tile() const { return tile_; }

 private:
  const MapGrid& grid_;
  Tile tile_;
};

std::vector<report::FigureClass> figure_classes(const std::vector<LegendEntry>& legend,
                                                const std::vector<ComparedClass>& counts) {
  std::vector<report::FigureClass> classes;
  for (std::size_t i = 0; i < legend.size(); ++i)
    classes.push_back({int(legend[i].value), legend[i].label, legend[i].colour, counts[i].share});
  return classes;
}

/// The layers as a picture; `reduced` in the order of `layers`, `result` with the counts.
void write_figure(const fs::path& path, const OneMap& a, const OneMap& b, const MapGrid& grid,
                  const std::vector<LayerInfo>& layers, const std::vector<Reduced>& reduced,
                  const MapComparison& result) {
  report::ComparisonFigure figure;
  figure.title = "Two maps compared: " + a.region;
  figure.subtitle = "First: " + a.name + ".  Second: " + b.name + ".  Uphill heading." +
                    (a.gravity == kGravity ? "" : "  Gravity " + gravity_text(a.gravity) + ".");
  figure.notes = {
      "passes: go or slow-go.  Significant: P(go) differs by at least 1.96 standard deviations, each from the 90 % "
      "interval of its map, the two taken as independent; so differences are rather missed than made up.",
      (grid.crs_code.empty() ? grid.crs_name : grid.crs_name + " (" + grid.crs_code + ")") +
          line(", cells %g m.  gonogo %s %s", grid.cell_width_m(), program_version(), program_revision())};
  figure.grid = grid;
  figure.change = reduced[0].tile();
  figure.difference = reduced[1].tile();
  figure.difference_class = reduced[3].tile();
  figure.changes = figure_classes(layers[0].legend, result.change);
  figure.difference_classes = figure_classes(layers[3].legend, result.significance);
  for (const LegendEntry& stop : layers[1].legend) figure.difference_ramp.push_back({stop.value, stop.colour});
  for (const ComparedClass& row : result.change) figure.area_km2 += row.area;
  report::draw_comparison_figure(path, figure);
}

std::vector<ComparedClass> counted(const std::vector<LegendEntry>& legend, const std::array<std::uint64_t, 8>& cells,
                                   const MapGrid& grid) {
  std::uint64_t all = 0;
  for (const std::uint64_t c : cells) all += c;
  std::vector<ComparedClass> classes;
  for (const LegendEntry& entry : legend) {
    const std::uint64_t count = cells[std::size_t(entry.value)];
    classes.push_back({.code = int(entry.value),
                       .label = entry.label,
                       .cells = count,
                       .area = double(count) * grid.cell_area_m2() * 1e-6,
                       .share = all > 0 ? double(count) / double(all) : 0});
  }
  return classes;
}

std::string csv_rows(const char* layer, const std::vector<ComparedClass>& classes) {
  std::string csv;
  for (const ComparedClass& c : classes)
    csv += line("%s,%d,%llu,%.6f,%.6f\n", layer, c.code, static_cast<unsigned long long>(c.cells), c.area, c.share);
  return csv;
}

/// Adds the overlay's files, or the remark why there is none.
void write_change_overlay(const CompareRequest& request, const MapGrid& grid, const std::vector<LegendEntry>& legend,
                          MapComparison& result) {
  const terrain::GlobeAnswer globe = terrain::place_on_globe(grid);
  terrain::OverlayAnswer overlay{{}, globe.why_not};
  if (globe.place)
    overlay = terrain::write_overlay(request.out / "change.kml", request.out / "change.png", request.out / "change.tif",
                                     *globe.place, "Which map passes",
                                     "First: " + result.first + ". Second: " + result.second, legend);
  if (!overlay.why_not.empty()) result.remark = "there is no change.kml for globes: " + overlay.why_not;
  result.files.insert(result.files.end(), overlay.files.begin(), overlay.files.end());
}

}  // namespace

double significance(double p1, double low1, double high1, double p2, double low2, double high2) {
  const double s1 = (high1 - low1) / (2 * kFifthPercentile), s2 = (high2 - low2) / (2 * kFifthPercentile);
  const double s = std::hypot(s1, s2), difference = p2 - p1;
  if (s > 0) return difference / s;
  return difference == 0 ? 0 : std::copysign(std::numeric_limits<double>::infinity(), difference);
}

PassChange pass_change(int verdict1, int verdict2) {
  if (verdict1 == int(campaign::Verdict::unknown) || verdict2 == int(campaign::Verdict::unknown))
    return PassChange::unknown;
  const bool first = campaign::passes(campaign::Verdict(verdict1)),
             second = campaign::passes(campaign::Verdict(verdict2));
  if (first) return second ? PassChange::both : PassChange::only_first;
  return second ? PassChange::only_second : PassChange::neither;
}

MapComparison compare_maps(const CompareRequest& request) {
  const MapGrid grid = common_grid(request);
  const OneMap a = open_map(request.first, grid), b = open_map(request.second, grid);
  if (!is_same_gravity(a.gravity, b.gravity))
    throw InputError(request.second.string() + ": has a gravity of " + gravity_text(b.gravity) + ", and " +
                     request.first.string() + " has " + gravity_text(a.gravity) + "; compare maps of one gravity");
  create_folder(request.out);
  const std::array<const char*, 4> names = {"change.tif", "difference.tif", "significance.tif",
                                            "change_significance.tif"};
  const std::vector<LayerInfo> layers = layers_of(a, b);
  std::vector<std::unique_ptr<GeoTiffWriter>> writers;
  for (std::size_t l = 0; l < layers.size(); ++l)
    writers.push_back(std::make_unique<GeoTiffWriter>(request.out / names[l], grid, layers[l]));
  std::array<std::uint64_t, 8> pass{}, go{};
  std::vector<Reduced> reduced(layers.size(), Reduced(grid));
  for (const Window window : windows_of(grid, terrain::kTileCells, terrain::kTileCells)) {
    stop_if_cancelled();
    const std::array<Tile, 4> one = {a.go.read(window), a.p.read(window), a.low.read(window), a.high.read(window)};
    const std::array<Tile, 4> two = {b.go.read(window), b.p.read(window), b.low.read(window), b.high.read(window)};
    std::array<Tile, 4> out;
    out.fill(Tile(window.columns, window.rows, kNoData));
    for (std::size_t i = 0; i < out[0].value.size(); ++i) {
      const auto values = compare_cell(one, two, i);
      for (std::size_t l = 0; l < values.size(); ++l) out[l].value[i] = values[l];
      if (!std::isnan(values[0])) ++pass[std::size_t(values[0])];
      if (!std::isnan(values[3])) ++go[std::size_t(values[3])];
    }
    for (std::size_t l = 0; l < writers.size(); ++l) {
      writers[l]->write(window, out[l]);
      reduced[l].take(out[l], window);
    }
  }
  for (const auto& writer : writers) writer->finish(request.threads);
  MapComparison result{.first = a.name,
                       .second = b.name,
                       .gravity = a.gravity,
                       .change = counted(layers[0].legend, pass, grid),
                       .significance = counted(layers[3].legend, go, grid),
                       .remark = {},
                       .files = {}};
  write_file_atomically(request.out / "compare.csv", "layer,code,cells,area_km2,share\n" +
                                                         csv_rows("change", result.change) +
                                                         csv_rows("change_significance", result.significance));
  write_figure(request.out / "compare.png", a, b, grid, layers, reduced, result);
  for (const char* name : names) result.files.push_back(request.out / name);
  for (const char* name : {"compare.png", "compare.csv"}) result.files.push_back(request.out / name);
  write_change_overlay(request, grid, layers[0].legend, result);
  return result;
}

Json compare_json(const MapComparison& result) {
  const auto classes = [](const std::vector<ComparedClass>& rows) {
    Json list = Json::array();
    for (const ComparedClass& c : rows) {
      list.push_back(Json::Object{{"class", c.label}, {"cells", c.cells}, {"area_km2", c.area}, {"share", c.share}});
    }
    return list;
  };
  Json json = Json::Object{{"first", result.first},
                           {"second", result.second},
                           {campaign::kGravityKey, result.gravity},
                           {"change", classes(result.change)},
                           {"significance", classes(result.significance)}};
  Json files = Json::array();
  if (!result.remark.empty()) json["remark"] = result.remark;
  for (const fs::path& file : result.files) files.push_back(Json(file.string()));
  json["files"] = files;
  return json;
}

std::string compare_text(const MapComparison& result) {
  std::string text =
      "first:  " + result.first + "\nsecond: " + result.second + "\ngravity " + gravity_text(result.gravity) + "\n";
  for (const auto* part : {&result.change, &result.significance})
    for (const ComparedClass& row : *part)
      text += line("  %6.2f %%  %10.3f km2  ", 100 * row.share, row.area) + row.label + "\n";
  if (!result.remark.empty()) text += result.remark + "\n";
  for (const fs::path& file : result.files) text += file.string() + "\n";
  return text;
}

}  // namespace gonogo::map
