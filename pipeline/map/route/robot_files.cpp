#include "pipeline/map/route/robot_files.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/parallel/host_loop.h"
#include "terrain/raster/layer/geotiff.h"

namespace gonogo::map {
namespace {

constexpr double kSquare = 1e-6;  // relative difference of the sides of a cell

/// Cost per metre of the dearest heading that passes; or why there is none.
struct WorstCost {
  float per_metre = 0;
  Passability passage = Passability::unknown;
};

WorstCost worst_cost(const SoilTable& table, const RouteCells& cells, const RouteCosts& costs, std::size_t cell) {
  WorstCost worst{0, Passability::no_go};
  bool any = false;
  for (const int heading : kRobotHeadings) {
    const float cost = costs.per_metre(cells, cell, heading);
    if (std::isfinite(cost)) {
      worst.per_metre = any ? std::max(worst.per_metre, cost) : cost;
      any = true;
    } else if (!any && passability(table, cells, cell, heading) == Passability::unknown) {
      worst.passage = Passability::unknown;
    }
  }
  if (any) worst.passage = Passability::passes;
  return worst;
}

std::string yaml_text(const std::filesystem::path& pgm, const terrain::MapGrid& grid, const CostmapScale& scale,
                      RouteCost cost) {
  const double south = grid.south(), m = grid.metres_per_unit;
  const std::string unit = std::string(unit_of(cost)) + "/m";
  return "# Costmap for nav2_map_server (mode raw), " + grid.crs_name + ".\n" +
         "# 0 to 98: cost per metre of the dearest of eight headings that pass, 100: no-go, 255: unknown.\n" +
         line("# cost = %.9g + value / 98 * (%.9g - %.9g) %s, by the cost \"%s\"; what is dearer has the value 98.\n",
              scale.at_0, scale.at_98, scale.at_0, unit.c_str(), name_of(cost).c_str()) +
         "# Let the costmap's static layer use trinary_costmap: false and track_unknown_space: true.\n" +
         "image: " + Json(pgm.filename().string()).dump() + "\nmode: raw\n" +
         line("resolution: %.9g\norigin: [%.9f, %.9f, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.25\n",
              grid.cell_width_m(), grid.west * m, south * m) +
         line("gonogo:\n  cost: %s\n  unit: %s\n  at_0: %.9g\n  at_98: %.9g\n  no_go: 100\n  unknown: 255\n",
              name_of(cost).c_str(), unit.c_str(), scale.at_0, scale.at_98);
}

std::vector<terrain::FloatLayer> layers_of(RouteCost cost) {
  std::vector<terrain::FloatLayer> layers = {{"elevation", "m"}};
  for (const int heading : kRobotHeadings)
    layers.push_back({line("cost_%03d", heading), std::string(unit_of(cost)) + "/m"});
  for (const int heading : kRobotHeadings) layers.push_back({line("go_%03d", heading), "1"});
  return layers;
}

std::vector<std::pair<std::string, std::string>> grid_map_metadata(const terrain::MapGrid& grid, RouteCost cost) {
  const double length_x = grid.columns * grid.cell_width_m(), length_y = grid.rows * grid.cell_height_m();
  const double m = grid.metres_per_unit;
  return {{"grid_map_frame", grid.crs_name},
          {"grid_map_resolution", line("%.9g", grid.cell_width_m())},
          {"grid_map_length_x", line("%.9g", length_x)},
          {"grid_map_length_y", line("%.9g", length_y)},
          {"grid_map_position_x", line("%.9f", grid.west * m + length_x / 2)},
          {"grid_map_position_y", line("%.9f", grid.north * m - length_y / 2)},
          {"gonogo_cost", name_of(cost)},
          {"gonogo_headings",
           "degrees clockwise from grid north; cost_*: NaN where the heading does not pass; go_*: 1 "
           "passes, 0 no-go, NaN unknown"}};
}

}  // namespace

Passability passability(const SoilTable& table, const RouteCells& cells, std::size_t cell, int heading) {
  const std::uint8_t soil = cells.soil[cell];
  if (soil == RouteCells::kClosed) return Passability::no_go;
  if (soil == RouteCells::kNowhere) return Passability::unknown;
  const double psi = fall_line_angle(heading, cells.aspect[cell]);
  const campaign::Verdict verdict =
      table.responses[soil].at(cells.slope[cell] / double(kSlopeSteps), psi).result.verdict;
  if (campaign::passes(verdict)) return Passability::passes;
  return verdict == campaign::Verdict::no_go ? Passability::no_go : Passability::unknown;
}

std::vector<std::uint8_t> costmap_of(const SoilTable& table, const RouteCells& cells, const RouteCosts& costs,
                                     CostmapScale& scale) {
  std::vector<WorstCost> worst(cells.soil.size());
  for_each_on_host(worst.size(), kCellsAtOnce, [&](std::size_t c) { worst[c] = worst_cost(table, cells, costs, c); });
  std::vector<float> known;
  for (const WorstCost& w : worst)
    if (w.passage == Passability::passes) known.push_back(w.per_metre);
  if (!known.empty()) {
    const auto high = known.begin() + std::ptrdiff_t(0.99 * double(known.size() - 1));
    std::nth_element(known.begin(), high, known.end());
    scale.at_98 = double(*high);
    scale.at_0 = double(*std::min_element(known.begin(), known.end()));
  }
  std::vector<std::uint8_t> map(worst.size());
  for (std::size_t c = 0; c < map.size(); ++c) {
    const double share =
        scale.at_98 > scale.at_0 ? (double(worst[c].per_metre) - scale.at_0) / (scale.at_98 - scale.at_0) : 0;
    map[c] = worst[c].passage == Passability::passes ? std::uint8_t(std::lround(kDearest * std::clamp(share, 0.0, 1.0)))
             : worst[c].passage == Passability::no_go ? kLethal
                                                      : kUnknownCost;
  }
  return map;
}

void write_costmap(const std::filesystem::path& yaml, const terrain::MapGrid& grid, const SoilTable& table,
                   const RouteCells& cells, const RouteCosts& costs, RouteCost cost) {
  if (yaml.extension() != ".yaml")
    throw InputError("route: --costmap: \"" + yaml.string() + "\" is no name of a costmap; give it as .yaml");
  if (std::abs(cells.cell_width / cells.cell_height - 1) > kSquare)
    throw InputError(
        line("route: --costmap: cells are %.9g x %.9g m, and a costmap has square ones; choose a grid with "
             "\"cell_m\" in the region",
             cells.cell_width, cells.cell_height));
  std::filesystem::path pgm = yaml;
  pgm.replace_extension(".pgm");
  CostmapScale scale;
  const std::vector<std::uint8_t> map = costmap_of(table, cells, costs, scale);
  write_file_atomically(pgm, line("P5\n%d %d\n255\n", cells.columns, cells.rows) + std::string(map.begin(), map.end()));
  write_file_atomically(yaml, yaml_text(pgm, grid, scale, cost));
}

void write_grid_map(const std::filesystem::path& path, const terrain::RasterSource& elevation, const SoilTable& table,
                    const RouteCells& cells, const RouteCosts& costs, RouteCost cost) {
  const terrain::MapGrid& grid = elevation.grid();
  const std::size_t headings = kRobotHeadings.size();
  const auto row_of = [&](std::size_t layer, int row) {
    if (layer == 0) return elevation.read({0, row, grid.columns, 1}).value;
    std::vector<float> value(static_cast<std::size_t>(grid.columns));
    const int heading = kRobotHeadings[(layer - 1) % headings];
    for (std::size_t column = 0; column < value.size(); ++column) {
      const std::size_t cell = std::size_t(row) * value.size() + column;
      if (layer <= headings) {
        const float per_metre = costs.per_metre(cells, cell, heading);
        value[column] = std::isfinite(per_metre) ? per_metre : std::nanf("");
      } else {
        const Passability way = passability(table, cells, cell, heading);
        value[column] = way == Passability::unknown ? std::nanf("") : way == Passability::passes ? 1.0f : 0.0f;
      }
    }
    return value;
  };
  terrain::write_float_layers(path, grid, layers_of(cost), grid_map_metadata(grid, cost), row_of);
}

}  // namespace gonogo::map
