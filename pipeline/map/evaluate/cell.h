// What a map says about a cell, and all cells of a tile: every layer, from the region's rasters and the model's tables.
//
// P(go) of a cell comes about in these steps:
//
//   1. evaluate_tile() reads the rasters and computes slope and aspect of the cell (terrain/raster/layer/slope.h).
//   2. decide() finds what decides. A land rule (water, buildings, an obstacle, a cone index that is too low) comes
//      first. The cell then has no P(go).
//   3. Otherwise SoilTable::find() turns soil code and moisture into the SoilResponse of that soil.
//   4. SoilResponse::at(slope).p_go is P(go) uphill. at(slope, psi).p_go is P(go) in any other heading.
//      Both are look-ups in tables that make_soil_table() computes before the first tile.
//   5. SoilPoints::at() computes an entry of these tables. It asks the trained model about every point that the soil
//      may be, at the entry's slopes, and takes the mean. Prospect::p_go() adds up go and slow_go.
//   6. classify() in pipeline/map/region/rules.h turns the result into class and reason.
//
// The model itself is OutcomeModel::probabilities, which map_request.h makes from Predictor::outcome_probabilities().
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/map/evaluate/layers.h"
#include "pipeline/map/evaluate/soil_table.h"
#include "pipeline/map/region/sources.h"

namespace gonogo::map {

/// What decides in a cell: its rule if it has one, or its soil.
struct CellInputs {
  std::optional<std::size_t> soil;   // position in the soil table; nothing: unknown
  std::optional<std::size_t> rule;   // position in land_rules()
  std::optional<std::size_t> ditch;  // that crosses the soil, position in MapSources::ditches
};

/// The soil without its ditch. In fine-grained soil a measured cone index decides: below VCI1 is a rule, below VCI50
/// the soft and from there on the firm entry of the table. Without a measurement cohesion and friction angle decide.
CellInputs decide(const Region& region, const MapRules& rules, const SoilTable& table, const Readings& readings,
                  std::size_t cell);

/// The same, as it is kept for every cell.
struct CellMark {
  enum class Ground : std::uint8_t { no_slope, unknown_soil, known_soil };
  static constexpr std::uint16_t kNoRule = 65535;

  Ground ground = Ground::no_slope;
  std::uint16_t soil = 0;  // position in the soil table, where it is known; the entry of the ditch, if there is one
  std::uint16_t rule = kNoRule;  // position in land_rules()

  bool has_slope() const { return ground != Ground::no_slope; }
  bool has_soil() const { return ground == Ground::known_soil; }
  bool has_rule() const { return rule != kNoRule; }
};

/// Inputs and layers of the cells in `window`. Every terrain::Tile has the window's size.
struct TileLayers {
  TileLayers(terrain::Window window, std::size_t layers);

  terrain::Window window;
  terrain::Tile elevation;           // [m]; all of it, also where the slope is NaN
  terrain::Tile slope, aspect;       // [deg]; aspect points downhill, clockwise from grid north
  terrain::Tile shade;               // relief for the figure
  std::vector<CellMark> mark;        // [cell]
  std::vector<CellClass> result;     // [cell] in the heading of the map, where there is a slope
  terrain::Tile p_go;                // in the heading of the map
  std::vector<terrain::Tile> layer;  // in the order of map_layers()
};

/// Every layer of the cells in `window`. A cell depends on its own inputs only, so the split into windows changes no
/// bit. Threads must not share `sources`; see MapSources::again().
TileLayers evaluate_tile(const MapSources& sources, const Region& region, const SoilTable& table,
                         const std::vector<MapLayer>& layers, const MapRules& rules, terrain::Window window);

}  // namespace gonogo::map
