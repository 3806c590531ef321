// Maps for robots: a costmap for Nav2 and layers of cost by heading for grid_map. What is unknown stays unknown.
#pragma once
#include <filesystem>

#include "pipeline/map/evaluate/cell.h"
#include "pipeline/map/route/search/cost.h"

namespace gonogo::map {

/// Headings of the layers [deg clockwise from grid north].
inline constexpr std::array<int, 8> kRobotHeadings = {0, 45, 90, 135, 180, 225, 270, 315};

/// What a cell is in a heading.
enum class Passability { passes, no_go, unknown };
Passability passability(const SoilTable& table, const RouteCells& cells, std::size_t cell, int heading);

/// Values of an occupancy grid. Nav2's static layer makes v / 100 * 254 of costs, 254 (lethal) of 100 and 255 (none) of
/// 255. 99 is no cost: since its pull request 5781 it means 253, a collision.
inline constexpr std::uint8_t kDearest = 98, kLethal = 100, kUnknownCost = 255;

/// Linear from 0, the cheapest cell, to kDearest; dearer cells than `at_98` are kDearest.
struct CostmapScale {
  double at_0 = 0, at_98 = 1;  // cost per metre [unit_of(cost) / m]
};

/// The costmap of all cells, row by row from the north, and its scale. A cell has the cost of its dearest heading among
/// the eight that pass. Without one it is kLethal, or kUnknownCost if a heading is unknown. at_98 is the 99 % point.
std::vector<std::uint8_t> costmap_of(const SoilTable& table, const RouteCells& cells, const RouteCosts& costs,
                                     CostmapScale& scale);

/// Writes `yaml` and the picture beside it, same name with .pgm, for nav2_map_server in mode raw: 0 to 98 cost, 100
/// lethal, 255 unknown. The mapping stands in comments and under the key "gonogo". Throws InputError unless cells are
/// square in metres and the extension is .yaml.
void write_costmap(const std::filesystem::path& yaml, const terrain::MapGrid& grid, const SoilTable& table,
                   const RouteCells& cells, const RouteCosts& costs, RouteCost cost);

/// Writes .tif or .nc with the layers elevation [m], cost_000 to cost_315 [unit_of(cost) / m], NaN where the heading
/// does not pass, and go_000 to go_315: 1 passes, 0 no-go, NaN unknown. Metadata give resolution, lengths and position
/// as grid_map has them.
void write_grid_map(const std::filesystem::path& path, const terrain::RasterSource& elevation, const SoilTable& table,
                    const RouteCells& cells, const RouteCosts& costs, RouteCost cost);

}  // namespace gonogo::map
