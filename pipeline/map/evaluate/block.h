// Evaluates one tile of a map: every layer of every cell, from the region's rasters and the model's tables.
//
// P(go) of a cell comes about in these steps:
//
//   1. evaluate_tile() reads the rasters and computes slope and aspect of the cell (terrain/raster/slope.h).
//   2. A land rule (water, buildings, an obstacle, a cone index that is too low) decides first. The cell then has no
//   P(go).
//   3. Otherwise SoilTable::find() turns soil code and moisture into the SoilResponse of that soil.
//   4. SoilResponse::at(slope).p_go is P(go) uphill. at(slope, psi).p_go is P(go) in any other heading.
//      Both are look-ups in tables that make_soil_table() computes before the first tile.
//   5. SoilPoints::at() computes an entry of these tables. It asks the trained model about every point that the soil
//      may be, at the entry's slopes, and takes the mean. Prospect::p_go() adds up go and slow_go.
//   6. classify() in pipeline/map/region/rules.h turns the result into class and reason.
//
// The model itself is OutcomeModel::probabilities, which map_request.h makes from Predictor::outcome_probabilities().
#pragma once
#include <memory>
#include <optional>

#include "pipeline/map/evaluate/layers.h"
#include "pipeline/map/evaluate/soil_table.h"
#include "terrain/raster/raster_source.h"
#include "terrain/raster/shape_cells.h"

namespace gonogo::map {

struct MapSources {
  terrain::RasterSource elevation;
  std::optional<terrain::RasterSource> soil_class, land_cover, moisture, cone_index;
  std::shared_ptr<const terrain::ShapeCells> obstacles;  // null: none; numbers by mark_of()
  std::vector<DitchSize> ditches{};                      // that a model answers for; ditch k has the number k + 1
  double ditch_step = 0;                                 // to which their sizes are rounded up [m]

  /// Opens the same rasters again, for use by another thread.
  MapSources again() const;
};

/// Opens the region's rasters on the grid of its elevation. Throws InputError for files that cannot be read and for a
/// map of fewer than 3 x 3 cells.
MapSources open_sources(const Region& region);

/// Inputs and layers of the cells in `window`. Every terrain::Tile has the window's size.
struct TileLayers {
  terrain::Window window;
  terrain::Tile elevation;           // [m]; all of it, also where the slope is NaN
  terrain::Tile slope, aspect;       // [deg]; aspect points downhill, clockwise from grid north
  terrain::Tile shade;               // relief for the figure
  terrain::Tile soil;                // position in the soil table; -1: unknown; NaN: no slope
  terrain::Tile rule;                // 0: the soil decides; else 1 + position in land_rules()
  std::vector<terrain::Tile> layer;  // in the order of map_layers()
  const terrain::Tile& verdict() const { return layer[0]; }
  const terrain::Tile& p_go() const { return layer[1]; }
  const terrain::Tile& reason() const { return layer[2]; }
};

/// The region without soils by name whose code does not occur on the map. Their tables would cost time and answer
/// nothing.
Region with_occurring_soils(const Region& region, const MapSources& sources);

/// Standard error of Horn's gradient [rise per metre]: e sqrt(1 - r) sqrt(12) / (8 cell). e is the elevation's standard
/// error [m], r its correlation between neighbouring cells. 12 is the sum of the squared weights 1 2 1 of both sides.
double gradient_error(const RegionRaster& elevation, const terrain::MapGrid& grid);

/// Tabulates the model for every soil of the region and every moisture state that the map needs. `error_of_gradient`
/// [rise per metre] widens the interval on P(go). Throws InputError for a moisture that the region does not define.
SoilTable make_soil_table(const OutcomeModel& model, const Region& region, const MapRules& rules,
                          double error_of_gradient);

/// Adds an entry for every ditch of the sources in every soil of the table in which one of its cells lies. The vehicle
/// is no faster there than the trials that crossed ditches.
void add_ditches(const OutcomeModel& model, const Region& region, const MapRules& rules, double error_of_gradient,
                 const MapSources& sources, SoilTable& table);

/// Every layer of the cells in `window`. A cell depends on its own inputs only, so the split into windows changes no
/// bit. Threads must not share `sources`; see MapSources::again().
TileLayers evaluate_tile(const MapSources& sources, const Region& region, const SoilTable& table,
                         const std::vector<MapLayer>& layers, const MapRules& rules, terrain::Window window);

}  // namespace gonogo::map
