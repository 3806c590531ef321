#include "pipeline/map/region/sources.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <span>
#include <string_view>

#include "base/error.h"
#include "base/format.h"
#include "base/shell.h"
#include "terrain/raster/layer/slope.h"

namespace gonogo::map {

using terrain::MapGrid;
using terrain::RasterKind;
using terrain::RasterSource;
using terrain::Tile;
using terrain::Window;
namespace {

constexpr int kRowsAtOnce = 256;
constexpr double kWettest = 2000;               // water content of fibrous peat [% of the dry mass]
constexpr double kHardest = 1e8;                // cone index of rock; no cone penetrometer shows as much [Pa]
constexpr std::uint32_t kMostMarks = 1u << 22;  // of a kind: with four kinds a float holds every number exactly

/// The number of a mark's cells. No mark is 0, as ShapeCells asks.
float number_of(ObstacleMark mark) {
  GONOGO_ASSERT(mark.index < kMostMarks);
  return float(std::uint32_t(mark.kind) * kMostMarks + mark.index);
}

ObstacleMark mark_of(float number) {
  const auto whole = std::uint32_t(number);
  return {ObstacleMark::Kind(whole / kMostMarks), whole % kMostMarks};
}

/// A whole number that a raster of codes holds, or nothing.
std::optional<int> code_of(float value) {
  if (!has_data(value) || value != std::floor(value) || std::abs(value) > 1e6f) return std::nullopt;
  return int(value);
}

ObstacleMark mark_for(const Region& region, std::size_t obstacle, Crossing crossing, std::uint32_t ditch) {
  const Obstacle& o = region.obstacles[obstacle];
  if (o.kind == ObstacleKind::road) return {ObstacleMark::Kind::road, std::uint32_t(o.road_soil)};
  if (crossing == Crossing::modelled) return {ObstacleMark::Kind::ditch, ditch};
  if (crossing == Crossing::passes) return {};
  return {ObstacleMark::Kind::rule, std::uint32_t(obstacle_rule(region, obstacle, crossing))};
}

/// Among features in a cell the highest rank decides.
int rank_of(const Obstacle& o, Crossing crossing) {
  if (o.kind == ObstacleKind::road) return 3;
  return crossing == Crossing::no_go ? 2 : crossing == Crossing::unknown;
}

/// Calls `mark` for every feature of every obstacle with its numbers.
template <class Mark>
terrain::ShapeCells marked_cells(const Region& region, const MapGrid& grid, const Mark& mark) {
  terrain::ShapeCells cells(grid);
  for (std::size_t k = 0; k < region.obstacles.size(); ++k) {
    const Obstacle& o = region.obstacles[k];
    cells.add(o.file, o.layer, [&](const terrain::FeatureNumbers& numbers) {
      const Crossing crossing = cross(o, region.crossing, numbers);
      return terrain::ShapeMark{.value = number_of(mark(k, crossing, numbers)),
                                .width = o.width.of(numbers, kObstacleMetres, o.file.string()),
                                .rank = rank_of(o, crossing)};
    });
  }
  return cells;
}

/// Up to a whole number of steps: a larger ditch is no easier. No larger than what was sampled.
double rounded_up(double size, double step, Range sampled) {
  return std::min(step * std::ceil(size / step - 1e-9), sampled.maximum);
}

DitchSize rounded_ditch(const CrossingLimits& v, DitchSize d, double step) {
  return {rounded_up(d.width, step, v.ditch_width), rounded_up(d.depth, step, v.ditch_depth)};
}

/// Every size has tables of its own in every soil; sizes are rounded to the finest step that leaves few of them.
void find_ditches(const Region& region, const MapGrid& grid, MapSources& sources) {
  constexpr std::size_t most_sizes = 12;
  if (!region.crossing || !(region.crossing->ditch_width.minimum <= region.crossing->ditch_width.maximum)) return;
  std::set<DitchSize> exact, rounded;
  marked_cells(region, grid, [&](std::size_t k, Crossing crossing, const terrain::FeatureNumbers& numbers) {
    if (crossing == Crossing::modelled) exact.insert(size_of(region.obstacles[k], numbers));
    return ObstacleMark{};
  });
  for (sources.ditch_step = 0.05;; sources.ditch_step *= 2) {
    rounded.clear();
    for (const DitchSize& d : exact) rounded.insert(rounded_ditch(*region.crossing, d, sources.ditch_step));
    if (rounded.size() <= most_sizes) break;
  }
  sources.ditches.assign(rounded.begin(), rounded.end());
}

void open_obstacles(const Region& region, const MapGrid& grid, MapSources& sources) {
  if (region.obstacles.empty()) return;
  find_ditches(region, grid, sources);
  const auto ditch = [&](std::size_t k, const terrain::FeatureNumbers& numbers) {
    const DitchSize size = rounded_ditch(*region.crossing, size_of(region.obstacles[k], numbers), sources.ditch_step);
    return std::uint32_t(std::lower_bound(sources.ditches.begin(), sources.ditches.end(), size) -
                         sources.ditches.begin());
  };
  sources.obstacles = std::make_shared<const terrain::ShapeCells>(
      marked_cells(region, grid, [&](std::size_t k, Crossing crossing, const terrain::FeatureNumbers& numbers) {
        return mark_for(region, k, crossing, crossing == Crossing::modelled ? ditch(k, numbers) : 0);
      }));
}

std::optional<RasterSource> open_again(const std::optional<RasterSource>& source) {
  return source ? std::optional(source->again()) : std::nullopt;
}

std::optional<Tile> read_part(const std::optional<RasterSource>& source, Window window) {
  return source ? std::optional(source->read(window)) : std::nullopt;
}

constexpr int kShareDraws = 64;  // points of a soil

bool holds(const campaign::SampledVariable& range, double value) {
  return value >= range.minimum && value <= range.maximum;
}

/// Share of the soil's points whose known variables lie inside.
double share_of_soil(const Region& region, const Soil& soil, const campaign::DesignSpec& spec) {
  const std::vector<std::vector<double>> points = soil_points(region, soil, {}, kShareDraws);
  std::size_t inside = 0;
  for (const std::vector<double>& point : points) {
    bool all = true;
    for (const campaign::SampledVariable& range : spec.ranges)
      all = all && (std::isnan(point[range.variable]) || holds(range, point[range.variable]));
    inside += all;
  }
  return points.empty() ? 0 : double(inside) / double(points.size());
}

/// Whether a slope, uphill, and none across lie inside.
bool holds_slope(const campaign::DesignSpec& spec, double slope) {
  const std::size_t along = campaign::contract().variable_index("slope_along"),
                    across = campaign::contract().variable_index("slope_across");
  for (const campaign::SampledVariable& range : spec.ranges) {
    if (range.variable == along && !holds(range, slope)) return false;
    if (range.variable == across && !holds(range, 0)) return false;
  }
  return true;
}

}  // namespace

MapSources MapSources::again() const {
  return {.elevation = elevation.again(),
          .soil_class = open_again(soil_class),
          .land_cover = open_again(land_cover),
          .moisture = open_again(moisture),
          .cone_index = open_again(cone_index),
          .obstacles = obstacles,
          .ditches = ditches,
          .ditch_step = ditch_step};
}

std::vector<std::string> MapSources::remarks() const {
  std::vector<std::string> list = elevation.remarks();
  for (const std::optional<RasterSource>* source : {&soil_class, &land_cover, &moisture, &cone_index})
    if (*source) list.insert(list.end(), (*source)->remarks().begin(), (*source)->remarks().end());
  if (obstacles) list.insert(list.end(), obstacles->remarks().begin(), obstacles->remarks().end());
  return list;
}

/// A unit as files write it, in lower case, and what one of it is in the base unit.
struct FileUnit {
  std::string_view name;
  double size;
};

constexpr FileUnit kPressures[] = {{"psi", kPsi},  {"lbf/in2", kPsi}, {"pa", 1},      {"kpa", 1e3},
                                   {"kn/m2", 1e3}, {"mpa", 1e6},      {"n/mm2", 1e6}, {"n/cm2", 1e4}};
// Of the dry mass. Shares of the volume are another quantity.
constexpr FileUnit kWaterContents[] = {{"%", 1},       {"percent", 1}, {"1", 100},       {"fraction", 100},
                                       {"kg/kg", 100}, {"g/g", 100},   {"kg kg-1", 100}, {"g g-1", 100}};

/// Refuses a raster that states another unit than it is read in.
void require_unit(const RasterSource& raster, std::span<const FileUnit> known, const std::string& read_in,
                  double size) {
  std::string unit = raster.unit();
  std::transform(unit.begin(), unit.end(), unit.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  if (unit.empty()) return;
  const std::string said =
      raster.name() + ": says that its values are in \"" + raster.unit() + "\", and they are read in " + read_in;
  const auto found = std::find_if(known.begin(), known.end(), [&](const FileUnit& u) { return u.name == unit; });
  if (found == known.end()) throw InputError(said + "; give a raster in " + read_in);
  if (std::abs(found->size / size - 1) > 1e-3)
    throw InputError(said + "; convert it with: gdal_calc.py -A " + shell_word(raster.name()) + " --calc=\"A*" +
                     number_text(found->size / size, 6) + "\" --type=Float32 --outfile=converted.tif");
}

MapSources open_sources(const Region& region) {
  MapSources sources{
      .elevation = RasterSource::open_heights(region.elevation.files, region.grid, region.elevation.heights),
      .soil_class = {},
      .land_cover = {},
      .moisture = {},
      .cone_index = {},
      .obstacles = {}};
  const MapGrid& grid = sources.elevation.grid();
  if (grid.columns < 3 || grid.rows < 3)
    throw InputError(region.elevation.files.file.front().string() + ": makes a map of " + std::to_string(grid.columns) +
                     " x " + std::to_string(grid.rows) +
                     " cells; a slope takes a cell and its eight neighbours, so give at least 3 x 3");
  const auto open = [&](const std::optional<RegionRaster>& raster, RasterKind kind,
                        const std::optional<terrain::ValueRange>& range = {}) {
    return raster ? std::optional(RasterSource::open_on_grid(raster->files, sources.elevation.grid(), kind, range))
                  : std::nullopt;
  };
  sources.soil_class = open(region.soil_class, RasterKind::classes);
  sources.land_cover = open(region.land_cover, RasterKind::classes);
  sources.moisture =
      open(region.moisture, RasterKind::continuous, terrain::ValueRange{0, kWettest, "water content [%]"});
  if (region.cone_index)
    sources.cone_index = open(region.cone_index, RasterKind::continuous,
                              terrain::ValueRange{0, kHardest / region.cone_index->unit, "cone index"});
  if (sources.moisture) require_unit(*sources.moisture, kWaterContents, "% of the dry mass", 1);
  if (sources.cone_index)
    require_unit(*sources.cone_index, kPressures, region.cone_index->unit == kPsi ? "psi" : "kPa",
                 region.cone_index->unit);
  open_obstacles(region, grid, sources);
  return sources;
}

Readings::Readings(const MapSources& sources, Window window)
    : size_(std::size_t(window.columns) * std::size_t(window.rows)),
      soil_(read_part(sources.soil_class, window)),
      moisture_(read_part(sources.moisture, window)),
      land_(read_part(sources.land_cover, window)),
      cone_index_(read_part(sources.cone_index, window)),
      flat_(sources.elevation.has_flat() ? std::optional(sources.elevation.read_flat(window)) : std::nullopt),
      obstacle_(sources.obstacles ? std::optional(sources.obstacles->read(window)) : std::nullopt) {}

std::optional<int> Readings::soil_code(std::size_t cell) const { return soil_ ? code_of(soil_->value[cell]) : 0; }

int Readings::moisture_state(const Region& region, const MapRules& rules, std::size_t cell) const {
  for (std::size_t k = 0; k < region.moistures.size(); ++k) {
    const MoistureState& state = region.moistures[k];
    if (!rules.moisture.empty()) {
      if (state.name == rules.moisture) return int(k) + 1;
    } else if (moisture_) {
      const float water = moisture_->value[cell];
      if (water >= state.low && water < state.high) return int(k) + 1;
    }
  }
  return 0;
}

std::optional<std::size_t> Readings::land_rule(const Region& region, std::size_t cell) const {
  if (!land_) return flat_ && flat_->value[cell] > 0 ? std::optional(flat_rule(region)) : std::nullopt;
  const auto code = code_of(land_->value[cell]);
  std::size_t r = 0;
  while (r < region.land.size() && !(code && region.land[r].code == *code)) ++r;
  return r == land_unknown_rule(region) || region.land[r].verdict ? std::optional(r) : std::nullopt;
}

ObstacleMark Readings::obstacle(std::size_t cell) const {
  return obstacle_ ? mark_of(obstacle_->value[cell]) : ObstacleMark{};
}

std::optional<double> Readings::cone_index(std::size_t cell) const {
  if (!cone_index_ || !has_data(cone_index_->value[cell])) return std::nullopt;
  return double(cone_index_->value[cell]);
}

std::set<int> soil_codes(const MapSources& sources) {
  const MapGrid& grid = sources.elevation.grid();
  std::set<int> codes;
  for (const Window band : windows_of(grid, grid.columns, kRowsAtOnce))
    for (const float value : sources.soil_class->read(band).value)
      if (const auto code = code_of(value)) codes.insert(*code);
  return codes;
}

double share_inside(const Region& region, const campaign::DesignSpec& spec) {
  const RasterSource elevation =
      RasterSource::open_heights(region.elevation.files, region.grid, region.elevation.heights);
  const terrain::MapGrid& grid = elevation.grid();
  std::optional<RasterSource> soils;
  if (region.soil_class) soils = RasterSource::open_on_grid(region.soil_class->files, grid, RasterKind::classes);
  std::map<int, double> share_of_code;
  for (const Soil& soil : region.soils) share_of_code[soil.code] = share_of_soil(region, soil, spec);
  const double everywhere = share_of_soil(region, Soil{}, spec);
  double inside = 0, cells = 0;
  for (const Window band : windows_of(grid, grid.columns, kRowsAtOnce)) {
    const Tile slope = terrain::slope_degrees(elevation.read({-1, band.row - 1, grid.columns + 2, band.rows + 2}),
                                              {grid.cell_width_m(), grid.cell_height_m()});
    Tile codes;
    if (soils) codes = soils->read(band);
    for (std::size_t i = 0; i < slope.value.size(); ++i) {
      if (std::isnan(slope.value[i])) continue;
      ++cells;
      if (!holds_slope(spec, slope.value[i])) continue;
      if (!soils) {
        inside += everywhere;
      } else if (!std::isnan(codes.value[i])) {
        const auto found = share_of_code.find(int(std::lround(codes.value[i])));
        if (found != share_of_code.end()) inside += found->second;
      }
    }
  }
  return cells > 0 ? inside / cells : 0;
}

}  // namespace gonogo::map
