// The chance to get through a way that was found: its pieces and soils, and what is reported of the forecast.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "pipeline/map/evaluate/soil_table.h"
#include "pipeline/map/route/any_angle.h"
#include "pipeline/map/route/drive.h"
#include "terrain/raster/grid.h"

namespace gonogo::map {

/// Pieces of the way, one for each cell that a line crosses. `length`: costs of RouteCost::length.
std::vector<DrivePiece> pieces_of(const FoundRoute& route, const RouteCells& cells, const RouteCosts& length);

/// Soils in the order of the table, by their sampled points.
std::vector<DriveSoil> drive_soils(const SoilTable& table);

/// The line over pieces `first` to `last`, in the grid's coordinate system.
std::vector<std::array<double, 2>> line_over(const FoundRoute& route, const terrain::MapGrid& grid, std::size_t first,
                                             std::size_t last);

/// What is not known on a drive over the region.
DriveDoubt drive_doubt(const RegionRaster& elevation, const MapRules& rules, const terrain::MapGrid& grid);

/// { chance, chance_error, stuck_places, not_sampled, weakest: { from_km, to_km, stuck, reason, soil, slope_along_deg,
/// slope_across_deg } }. `weakest` is there if some draw stops.
Json forecast_json(const DriveForecast& forecast, const std::vector<DrivePiece>& pieces,
                   const std::vector<DriveSoil>& soils);

/// "km 2.31 to 2.48: no traction in 12 % of the draws, loam, 14 degrees along and 3 across".
std::string weakest_text(const Json& weakest);

}  // namespace gonogo::map
