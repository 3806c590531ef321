#include "pipeline/map/evaluate/block.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/error.h"
#include "base/line.h"
#include "terrain/raster/slope.h"

namespace gonogo::map {

using terrain::MapGrid;
using terrain::RasterKind;
using terrain::RasterSource;
using terrain::Tile;
using terrain::Window;
namespace {

constexpr float kNoData = std::numeric_limits<float>::quiet_NaN();

constexpr std::size_t kMostSoils = 250;  // entries of the table that page and routes tell apart

/// Codes, water contents, land cover, cone indices and flat areas of a tile, as far as the region has them.
struct Readings {
  std::optional<Tile> soil, moisture, land, cone_index, flat, obstacle;
};

/// A whole number that a raster holds, or nothing.
std::optional<int> code_at(const Tile& tile, std::size_t cell) {
  const float value = tile.value[cell];
  if (std::isnan(value) || value != std::floor(value) || std::abs(value) > 1e6f) return std::nullopt;
  return int(value);
}

/// 0: any; k: the region's k-th state.
int moisture_state(const Region& region, const MapRules& rules, const Readings& readings, std::size_t cell) {
  for (std::size_t k = 0; k < region.moistures.size(); ++k) {
    const MoistureState& state = region.moistures[k];
    if (!rules.moisture.empty()) {
      if (state.name == rules.moisture) return int(k) + 1;
    } else if (readings.moisture) {
      const float water = readings.moisture->value[cell];
      if (water >= state.low && water < state.high) return int(k) + 1;
    }
  }
  return 0;
}

/// Position of a cell's soil in the table, or -1 when the raster does not say or the table does not list it.
int soil_of(const SoilTable& table, const Readings& readings, int state, std::size_t cell) {
  if (!readings.soil) return table.find(0, state);
  const auto code = code_at(*readings.soil, cell);
  return code ? table.find(*code, state) : SoilTable::kUnknown;
}

/// 0: the soil decides; 1 + position in land_rules().
int rule_of(const Region& region, const Readings& readings, std::size_t cell) {
  if (!readings.land) return readings.flat && readings.flat->value[cell] > 0 ? int(flat_rule(region)) + 1 : 0;
  const auto code = code_at(*readings.land, cell);
  std::size_t r = 0;
  while (r < region.land.size() && !(code && region.land[r].code == *code)) ++r;
  return r == land_unknown_rule(region) || region.land[r].verdict ? int(r) + 1 : 0;
}

/// What decides in a cell: its soil, or a rule. `ditch`: number of the ditch that crosses the soil; 0: none.
struct Decision {
  int soil = SoilTable::kUnknown, rule = 0, ditch = 0;
};

/// Number of a feature's cells: positive 1 + the rule's position, minus the code of a road's soil, minus the number of
/// a ditch, which is below those codes, 0 where the soil decides.
float mark_of(const Region& region, std::size_t obstacle, Crossing crossing, int ditch) {
  const Obstacle& o = region.obstacles[obstacle];
  if (o.kind == ObstacleKind::road) return float(-o.road_soil);
  if (crossing == Crossing::modelled) return float(-ditch);
  return crossing == Crossing::passes ? 0 : float(obstacle_rule(region, obstacle, crossing) + 1);
}

/// Of two features in a cell the higher one decides.
int rank_of(const Obstacle& o, Crossing crossing) {
  if (o.kind == ObstacleKind::road) return 3;
  return crossing == Crossing::no_go ? 2 : crossing == Crossing::unknown;
}

/// Calls `mark` for every feature of every obstacle with its numbers.
template <class Mark>
terrain::ShapeCells cells_of(const Region& region, const MapGrid& grid, const Mark& mark) {
  terrain::ShapeCells cells(grid);
  for (std::size_t k = 0; k < region.obstacles.size(); ++k) {
    const Obstacle& o = region.obstacles[k];
    cells.add(o.file, o.layer, [&](const terrain::FeatureNumbers& numbers) {
      const Crossing crossing = cross(o, region.crossing, numbers);
      return terrain::ShapeMark{.value = mark(k, crossing, numbers),
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
  cells_of(region, grid, [&](std::size_t k, Crossing crossing, const terrain::FeatureNumbers& numbers) {
    if (crossing == Crossing::modelled) exact.insert(size_of(region.obstacles[k], numbers));
    return 0.0f;
  });
  for (sources.ditch_step = 0.05;; sources.ditch_step *= 2) {
    rounded.clear();
    for (const DitchSize& d : exact) rounded.insert(rounded_ditch(*region.crossing, d, sources.ditch_step));
    if (rounded.size() <= most_sizes) break;
  }
  sources.ditches.assign(rounded.begin(), rounded.end());
}

void read_obstacles(const Region& region, const MapGrid& grid, MapSources& sources) {
  if (region.obstacles.empty()) return;
  find_ditches(region, grid, sources);
  const auto ditch = [&](std::size_t k, const terrain::FeatureNumbers& numbers) {
    const DitchSize size = rounded_ditch(*region.crossing, size_of(region.obstacles[k], numbers), sources.ditch_step);
    return int(std::lower_bound(sources.ditches.begin(), sources.ditches.end(), size) - sources.ditches.begin()) + 1;
  };
  sources.obstacles = std::make_shared<const terrain::ShapeCells>(
      cells_of(region, grid, [&](std::size_t k, Crossing crossing, const terrain::FeatureNumbers& numbers) {
        return mark_of(region, k, crossing, crossing == Crossing::modelled ? ditch(k, numbers) : 0);
      }));
}

/// In fine-grained soil a measured cone index decides: too low is a rule, high enough is the firm entry of the table.
/// Without a measurement cohesion and friction angle decide.
Decision decide(const Region& region, const MapRules& rules, const SoilTable& table, const Readings& readings,
                std::size_t cell) {
  const int state = moisture_state(region, rules, readings, cell);
  Decision decision{soil_of(table, readings, state, cell), rule_of(region, readings, cell)};
  if (const int mark = readings.obstacle ? int(readings.obstacle->value[cell]) : 0; mark <= -kRoadCode)
    return {table.find(-mark, state), 0};
  else if (mark < 0)
    decision.ditch = -mark;
  else if (mark > 0)
    decision.rule = mark;
  if (!readings.cone_index || decision.soil < 0 || decision.rule > 0) return decision;
  const double index = double(readings.cone_index->value[cell]) * region.cone_index->unit;
  if (std::isnan(index) || !table.may_be_soft[std::size_t(decision.soil)]) return decision;
  if (index < table.need.one_pass)
    decision.rule = int(below_one_pass_rule(region)) + 1;
  else if (index < table.need.fifty_passes)
    decision.rule = int(below_fifty_passes_rule(region)) + 1;
  else
    decision.soil = table.find_firm(table.soils[std::size_t(decision.soil)].code, state);
  return decision;
}

/// The same, with the ditch's entry in place of the soil's.
Decision decide_with_ditch(const Region& region, const MapRules& rules, const SoilTable& table,
                           const Readings& readings, std::size_t cell) {
  Decision decision = decide(region, rules, table, readings, cell);
  if (decision.ditch > 0 && decision.rule == 0 && decision.soil >= 0)
    decision.soil = table.find_ditch(decision.soil, decision.ditch);
  return decision;
}

CellState in_heading(const SoilResponse& soil, const MapRules& rules, float slope, float aspect) {
  const CellAnswer& answer = soil.at(slope);
  switch (rules.heading_mode) {
    case HeadingMode::worst:
      return {answer.headings.worst, answer.headings.p_worst, &answer};
    case HeadingMode::best:
      return {answer.headings.best, answer.headings.p_best, &answer};
    case HeadingMode::set: {
      const double falls_towards = std::isnan(aspect) ? 0 : rounded_aspect(aspect);
      const HeadingAnswer& set = soil.at(slope, fall_line_angle(rules.heading, falls_towards));
      return {set.result, set.p_go, &answer};
    }
    default:
      return {answer.result, answer.p_go, &answer};
  }
}

/// What the map says about a cell. A land rule wins over the soil.
CellState state_of(const SoilTable& table, const std::vector<LandRule>& land, const MapRules& rules, Decision decision,
                   float slope, float aspect) {
  if (decision.rule > 0) {
    const LandRule& decides = land[std::size_t(decision.rule) - 1];
    return {{*decides.verdict, decides.reason}, kNoData, nullptr};
  }
  if (decision.soil < 0) return {{campaign::Verdict::unknown, campaign::Reason::input_missing}, kNoData, nullptr};
  CellState state = in_heading(table.responses[std::size_t(decision.soil)], rules, slope, aspect);
  const bool unknown = state.result.verdict == campaign::Verdict::unknown;
  if (unknown && !table.soils[std::size_t(decision.soil)].given) state.result.reason = campaign::Reason::input_missing;
  return state;
}

/// A soil in one moisture state; nothing if it has no sample in that state.
std::optional<Soil> soil_in(const Soil& soil, const MoistureState& state) {
  Soil part = soil;
  part.name = soil.name + ", " + state.name;
  part.samples = samples_in(soil, state);
  if (part.samples.empty() && !soil.samples.empty()) return std::nullopt;
  return part;
}

/// Adds a soil with softness by cohesion and friction angle. If the region has measured cone indices, adds it once more
/// for cells whose index is high enough.
void add_soil(const OutcomeModel& model, const Region& region, const MapRules& rules, double error_of_gradient,
              const Soil& soil, int state, SoilTable& table) {
  MapRules own = rules;
  own.max_speed = std::min(rules.max_speed, soil.max_speed);
  const auto points = soil_points(region, soil, rules.values, rules.draws);
  const bool may_be_soft = is_fine_grained(region, soil).value_or(true);
  table.add(soil, state, may_be_soft, false,
            SoilResponse(model, own, points, error_of_gradient, soft_points(region, soil, points, model.cone_index)));
  if (!region.cone_index || !may_be_soft) return;
  Soil firm = soil;
  firm.name += ", measured firm";
  table.add(firm, state, may_be_soft, true, SoilResponse(model, rules, points, error_of_gradient));
}

Spread fixed_size(double metres) { return {Spread::Kind::fixed, metres, metres, "obstacles of the region"}; }

/// Adds a ditch in the soil at a position of the table, measured firm or not as that is.
void add_ditch(const OutcomeModel& model, const Region& region, const MapRules& rules, double error_of_gradient,
               DitchSize size, int position, int number, SoilTable& table) {
  const Soil ground = table.soils[std::size_t(position)];
  Soil soil = ground;
  soil.name += line(", ditch %.3g m wide, %.3g m deep", size.width, size.depth);
  MapRules own = rules;
  own.values["ditch_width"] = fixed_size(size.width);
  own.values["ditch_depth"] = fixed_size(size.depth);
  const Range speed = model.crossing_sampled[campaign::contract().variable_index("commanded_speed")];
  own.max_speed = std::min({rules.max_speed, soil.max_speed, speed.maximum});
  soil.max_speed = own.max_speed;
  const auto points = soil_points(region, soil, own.values, rules.draws);
  const bool firm = table.find_firm(ground.code, table.moisture[std::size_t(position)]) == position;
  const SoftPoints soft = firm ? SoftPoints{} : soft_points(region, soil, points, model.cone_index);
  table.add_ditch(position, number, std::move(soil), SoilResponse(model, own, points, error_of_gradient, soft));
}

/// Which states of moisture a map needs: 0 is "any".
std::vector<int> states_of(const Region& region, const MapRules& rules) {
  std::vector<int> states;
  for (std::size_t k = 0; k < region.moistures.size(); ++k)
    if (rules.moisture.empty() ? region.moisture.has_value() : region.moistures[k].name == rules.moisture)
      states.push_back(int(k) + 1);
  if (!rules.moisture.empty() && states.empty())
    throw InputError(region.file.string() + ": moisture: does not say what \"" + rules.moisture +
                     "\" is; add its range of water content, or leave the moisture open");
  if (rules.moisture.empty()) states.push_back(0);
  return states;
}

std::optional<RasterSource> open_again(const std::optional<RasterSource>& source) {
  return source ? std::optional(source->again()) : std::nullopt;
}

std::optional<Tile> read_part(const std::optional<RasterSource>& source, Window window) {
  return source ? std::optional(source->read(window)) : std::nullopt;
}

Readings read_window(const MapSources& sources, Window window) {
  return {.soil = read_part(sources.soil_class, window),
          .moisture = read_part(sources.moisture, window),
          .land = read_part(sources.land_cover, window),
          .cone_index = read_part(sources.cone_index, window),
          .flat = sources.elevation.has_flat() ? std::optional(sources.elevation.read_flat(window)) : std::nullopt,
          .obstacle = sources.obstacles ? std::optional(sources.obstacles->read(window)) : std::nullopt};
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
  const auto open = [&](const std::optional<RegionRaster>& raster, RasterKind kind) {
    return raster ? std::optional(RasterSource::open_on_grid(raster->files, sources.elevation.grid(), kind))
                  : std::nullopt;
  };
  sources.soil_class = open(region.soil_class, RasterKind::classes);
  sources.land_cover = open(region.land_cover, RasterKind::classes);
  sources.moisture = open(region.moisture, RasterKind::continuous);
  sources.cone_index = open(region.cone_index, RasterKind::continuous);
  read_obstacles(region, grid, sources);
  return sources;
}

Region with_occurring_soils(const Region& region, const MapSources& sources) {
  constexpr int rows_at_once = 256;
  if (!sources.soil_class) return region;
  const MapGrid& grid = sources.elevation.grid();
  std::set<int> codes;
  for (int row = 0; row < grid.rows; row += rows_at_once) {
    const Tile tile = sources.soil_class->read({0, row, grid.columns, std::min(rows_at_once, grid.rows - row)});
    for (std::size_t i = 0; i < tile.value.size(); ++i)
      if (const auto code = code_at(tile, i)) codes.insert(*code);
  }
  Region occurring = region;
  std::erase_if(occurring.soils, [&](const Soil& soil) {
    return soil.draws > 0 && soil.code < kRoadCode && codes.count(soil.code) == 0;
  });
  return occurring.soils.empty() ? region : occurring;
}

double gradient_error(const RegionRaster& elevation, const MapGrid& grid) {
  const double cell = std::sqrt(grid.cell_area_m2());
  return elevation.error * std::sqrt(1 - elevation.error_correlation) * std::sqrt(12.0) / (8 * cell);
}

SoilTable make_soil_table(const OutcomeModel& model, const Region& region, const MapRules& rules,
                          double error_of_gradient) {
  SoilTable table;
  std::vector<Soil> soils = region.soils;
  if (soils.empty())
    soils.push_back({.code = 0, .name = "all soils", .note = "", .texture = "", .samples = {}, .values = {}});
  if (region.cone_index && !model.cone_index)
    throw InputError(region.file.string() +
                     ": rasters: a cone_index raster tells nothing without a vehicle; name one "
                     "by --vehicle, or by \"cone_index_of\" in the section map of the study");
  if (model.cone_index) table.need = *model.cone_index;
  for (const int state : states_of(region, rules))
    for (const Soil& soil : soils) {
      const auto part = state == 0 ? std::optional(soil) : soil_in(soil, region.moistures[std::size_t(state) - 1]);
      if (!part) {
        table.without_samples.push_back(region.moistures[std::size_t(state) - 1].name + " " + soil.name);
        continue;
      }
      add_soil(model, region, rules, error_of_gradient, *part, state, table);
    }
  if (table.soils.empty())
    throw InputError(region.file.string() + ": soils: no sample of any soil is " + rules.moisture +
                     "; give samples with such a water_percent, or leave the moisture open");
  return table;
}

void add_ditches(const OutcomeModel& model, const Region& region, const MapRules& rules, double error_of_gradient,
                 const MapSources& sources, SoilTable& table) {
  constexpr int rows_at_once = 256;
  if (sources.ditches.empty()) return;
  const MapGrid& grid = sources.elevation.grid();
  std::set<std::pair<int, int>> occurring;  // (soil, ditch)
  for (int row = 0; row < grid.rows; row += rows_at_once) {
    const Window window{0, row, grid.columns, std::min(rows_at_once, grid.rows - row)};
    const Readings readings = read_window(sources, window);
    for (std::size_t i = 0; i < readings.obstacle->value.size(); ++i)
      if (const Decision d = decide(region, rules, table, readings, i); d.ditch > 0 && d.rule == 0 && d.soil >= 0)
        occurring.emplace(d.soil, d.ditch);
  }
  if (table.soils.size() + occurring.size() > kMostSoils)
    throw InputError(region.file.string() + ": obstacles: its ditches lie in " + std::to_string(occurring.size()) +
                     " pairs of size and soil, and " + std::to_string(kMostSoils - table.soils.size()) +
                     " can be told apart; give widths and depths in fewer classes");
  for (const auto& [soil, ditch] : occurring)
    add_ditch(model, region, rules, error_of_gradient, sources.ditches[std::size_t(ditch) - 1], soil, ditch, table);
}

TileLayers evaluate_tile(const MapSources& sources, const Region& region, const SoilTable& table,
                         const std::vector<MapLayer>& layers, const MapRules& rules, Window window) {
  const MapGrid& grid = sources.elevation.grid();
  const Tile bordered =
      sources.elevation.read({window.column - 1, window.row - 1, window.columns + 2, window.rows + 2});
  const Readings readings = read_window(sources, window);
  const std::vector<LandRule> land = land_rules(region);
  const terrain::CellSize cell = {grid.cell_width_m(), grid.cell_height_m()};
  const Tile empty(window.columns, window.rows, kNoData);
  TileLayers tile{.window = window,
                  .elevation = empty,
                  .slope = terrain::slope_degrees(bordered, cell, 1),
                  .aspect = terrain::aspect_degrees(bordered, cell, 1),
                  .shade = terrain::hillshade(bordered, cell, 315, 45, 1),
                  .soil = empty,
                  .rule = Tile(window.columns, window.rows, 0),
                  .layer = std::vector<Tile>(layers.size(), empty)};
  for (int row = 0; row < window.rows; ++row)
    for (int column = 0; column < window.columns; ++column) {
      tile.elevation.at(column, row) = bordered.at(column + 1, row + 1);
      const float slope = tile.slope.at(column, row);
      if (std::isnan(slope)) continue;
      const std::size_t i = std::size_t(row) * std::size_t(window.columns) + std::size_t(column);
      const Decision decision = decide_with_ditch(region, rules, table, readings, i);
      tile.soil.value[i] = float(decision.soil);
      tile.rule.value[i] = float(decision.rule);
      const CellState state = state_of(table, land, rules, decision, slope, tile.aspect.value[i]);
      for (std::size_t l = 0; l < layers.size(); ++l) tile.layer[l].value[i] = layers[l].value(state);
    }
  return tile;
}

}  // namespace gonogo::map
