// The costmap for Nav2 against costs from the formulas and against what Nav2's static layer makes of its values.
#include "pipeline/map/route/robot_files.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/files/file.h"
#include "terrain/raster/grid.h"
#include "tests/pipeline/map/made_ground.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::map;

namespace {

constexpr int kColumns = 14, kRows = 11;

/// Two soils of made_table() and a third one that no heading passes; closed cells, unknown ones, and steep ones of
/// which some headings were not sampled.
RouteCells robot_cells() {
  RouteCells cells = test::made_cells(kColumns, kRows, 3);
  cells.cell_height = cells.cell_width;
  for (std::size_t c = 0; c < cells.soil.size(); ++c) {
    if (c % 7 == 3) cells.soil[c] = RouteCells::kClosed;
    if (c % 13 == 2) cells.slope[c] = 32 * 64;
    if (c % 11 == 5) {
      cells.soil[c] = 2;
      cells.slope[c] /= 3;
    }
  }
  return cells;
}

/// What a cell is in a heading, by formulas: a cost per metre, infinity for no-go, NaN for unknown.
double passage_of(const RouteCells& cells, std::size_t c, int heading) {
  if (cells.soil[c] == RouteCells::kClosed) return INFINITY;
  if (cells.soil[c] == RouteCells::kNowhere) return NAN;
  const BedSlopes slopes = bed_slopes(cells.slope[c] / kSlopeSteps, fall_line_angle(heading, double(cells.aspect[c])));
  const double along = std::round(2 * slopes.along) / 2, across = std::round(2 * slopes.across) / 2;
  const double weaker = cells.soil[c] == 2 ? 23 : cells.soil[c] == 1 ? 4 : 0;
  if (along > 30) return INFINITY;  // steeper than the steepest sampled slope, which is no-go
  if (along < -20 || std::abs(across) > 20) return NAN;
  return test::made_p_go(along + weaker, across) < 0.5 ? INFINITY : 1 / std::cos(to_radians(along));
}

/// What Nav2's static layer makes of a value of the picture, mode raw, with trinary_costmap false, track_unknown_space
/// true and other parameters at their defaults: ros-navigation/navigation2, nav2_map_server/src/map_io.cpp and
/// nav2_costmap_2d/plugins/static_layer.cpp.
int nav2_cost(int value) {
  if (value > 100) return 255;
  if (value == 99) return 253;
  return value == 100 ? 254 : int(value / 100.0 * 254);
}

SoilTable robot_table() { return test::made_table({35, 31, 12}); }

}  // namespace

TEST_CASE("a costmap has the dearest heading that passes, is lethal where none does, and unknown where nobody knows") {
  const SoilTable table = robot_table();
  const RouteCells cells = robot_cells();
  CostmapScale scale;
  const std::vector<std::uint8_t> map = costmap_of(table, cells, RouteCosts(table, RouteCost::length, 100), scale);
  std::vector<double> worst(cells.soil.size(), NAN), known;
  int lethal = 0, unknown = 0, closed = 0;
  for (std::size_t c = 0; c < worst.size(); ++c) {
    std::set<double> costs;
    bool some_unknown = false;
    for (const int heading : kRobotHeadings) {
      const double cost = passage_of(cells, c, heading);
      some_unknown = some_unknown || std::isnan(cost);
      if (std::isfinite(cost)) costs.insert(cost);
    }
    INFO("cell " << c << " has the value " << int(map[c]));
    if (!costs.empty()) {
      known.push_back(worst[c] = *costs.rbegin());
      CHECK(map[c] <= 98);
      CHECK(nav2_cost(map[c]) < 253);  // 253 and 254 are collisions
    } else if (some_unknown) {
      CHECK(nav2_cost(map[c]) == 255);
      ++unknown;
    } else {
      CHECK(nav2_cost(map[c]) == 254);
      ++lethal;
      closed += cells.soil[c] == RouteCells::kClosed;
    }
  }
  CHECK(closed > 15);
  CHECK(lethal > closed + 5);
  CHECK(unknown > 10);
  REQUIRE(known.size() > 60);
  std::sort(known.begin(), known.end());
  const double low = known.front(), high = known[std::size_t(0.99 * double(known.size() - 1))];
  CHECK(scale.at_0 == Approx(low).epsilon(1e-6));
  CHECK(scale.at_98 == Approx(high).epsilon(1e-6));
  std::set<int> values;
  for (std::size_t c = 0; c < worst.size(); ++c) {
    if (std::isnan(worst[c])) continue;
    CHECK(std::abs(map[c] - std::min(98.0, 98 * (worst[c] - low) / (high - low))) < 0.51);
    values.insert(map[c]);
  }
  CHECK(values.count(0) == 1);
  CHECK(values.count(98) == 1);
  CHECK(values.size() > 15);
}

TEST_CASE("the files of a costmap hold its values from the north and tell their meaning") {
  const TemporaryFolder folder;
  const SoilTable table = robot_table();
  const RouteCells cells = robot_cells();
  const RouteCosts costs(table, RouteCost::length, 100);
  const terrain::MapGrid grid{.columns = kColumns,
                              .rows = kRows,
                              .west = 500000,
                              .north = 4400000,
                              .cell_width = 10,
                              .cell_height = 10,
                              .crs_wkt = "",
                              .crs_name = "made",
                              .crs_code = ""};
  write_costmap(folder / "map.yaml", grid, table, cells, costs, RouteCost::length);
  const std::string pgm = read_file(folder / "map.pgm"), yaml = read_file(folder / "map.yaml");
  CostmapScale scale;
  const std::vector<std::uint8_t> map = costmap_of(table, cells, costs, scale);
  CHECK(pgm == "P5\n14 11\n255\n" + std::string(map.begin(), map.end()));
  for (const char* part : {"mode: raw", "resolution: 10\n", "origin: [500000.000000000, 4399890.000000000, 0.0]",
                           "no_go: 100", "unknown: 255", "at_0: ", "at_98: ", "trinary_costmap: false"})
    CHECK(contains(yaml, part));
  CHECK(contains(input_error([&] { write_costmap(folder / "m.png", grid, table, cells, costs, RouteCost::length); }),
                 "give it as .yaml"));
  RouteCells oblong = cells;
  oblong.cell_height = 12;
  CHECK(contains(input_error([&] { write_costmap(folder / "m.yaml", grid, table, oblong, costs, RouteCost::length); }),
                 "square"));
}
