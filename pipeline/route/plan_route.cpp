#include "pipeline/route/plan_route.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/line.h"
#include "pipeline/map/map_record.h"
#include "pipeline/route/map_cells.h"
#include "pipeline/route/search.h"
#include "terrain/raster/geotiff.h"
#include "terrain/raster/tile_codec.h"
#include "terrain/raster/vector.h"

namespace gonogo::pipeline {
namespace {

std::uint32_t cell_at(const Place& place, const terrain::MapGrid& grid, const RouteCells& cells, const char* which) {
  const double column = std::floor((place.x - grid.west) / grid.cell_width);
  const double row = std::floor((grid.north - place.y) / grid.cell_height);
  if (!(column >= 0 && column < grid.columns && row >= 0 && row < grid.rows))
    throw InputError(
        line("route: %s %.10g,%.10g lies outside the elevation raster, which covers %.10g to %.10g and "
             "%.10g to %.10g; give coordinates in its system",
             which, place.x, place.y, grid.west, grid.west + grid.columns * grid.cell_width,
             grid.north - grid.rows * grid.cell_height, grid.north));
  const auto cell = std::uint32_t(row) * std::uint32_t(grid.columns) + std::uint32_t(column);
  if (cells.soil[cell] == RouteCells::kNowhere)
    throw InputError(line("route: %s %.10g,%.10g has no elevation or no known soil; choose a place next to it", which,
                          place.x, place.y));
  return cell;
}

/// Cost of a way by another measure than the one it was found with.
double cost_along(const FoundRoute& route, const RouteCells& cells, const RouteCosts& costs) {
  const auto steps = route_steps(cells.cell_width, cells.cell_height);
  double sum = 0;
  for (std::size_t i = 1; i < route.cell.size(); ++i) {
    const int columns = cells.columns, a = int(route.cell[i - 1]), b = int(route.cell[i]);
    for (const RouteStep& step : steps)
      if (b % columns - a % columns == step.column && b / columns - a / columns == step.row)
        for (const int cell : {a, b})
          sum += step.length / 2 * double(costs.per_metre(cells, std::size_t(cell), step.heading));
  }
  return sum;
}

/// Every cost that the model tells.
using AllCosts = std::map<RouteCost, RouteCosts>;

AllCosts all_costs(const SoilTable& table, const std::vector<RouteCost>& asked, double correlation_length) {
  const auto& measures = table.responses.front().measures();
  AllCosts costs;
  for (const RouteCost cost : kRouteCosts) {
    const bool told = cost == RouteCost::time     ? measures.count("mean_speed") > 0
                      : cost == RouteCost::energy ? measures.count("energy_per_metre") > 0
                                                  : true;
    const bool wanted = std::find(asked.begin(), asked.end(), cost) != asked.end();
    if (told || wanted) costs.emplace(cost, RouteCosts(table, cost, correlation_length));  // refuses what is not told
  }
  return costs;
}

Json totals_of(const FoundRoute& route, const RouteCells& cells, const AllCosts& costs) {
  const auto total = [&](RouteCost cost) { return cost_along(route, cells, costs.at(cost)); };
  Json json = Json::object();
  json["length_m"] = total(RouteCost::length);
  json["chance"] = std::exp(-total(RouteCost::risk));
  if (costs.count(RouteCost::time)) json["time_s"] = total(RouteCost::time);
  if (costs.count(RouteCost::energy)) json["energy_j"] = total(RouteCost::energy);
  return json;
}

terrain::LineFeature line_of(const FoundRoute& route, const terrain::MapGrid& grid, const Json& totals,
                             const std::string& name) {
  terrain::LineFeature line;
  line.name = name;
  for (const std::uint32_t cell : route.cell)
    line.point.push_back({grid.west + (cell % std::uint32_t(grid.columns) + 0.5) * grid.cell_width,
                          grid.north - (cell / std::uint32_t(grid.columns) + 0.5) * grid.cell_height});
  for (const auto& [key, value] : totals.members()) line.attribute.emplace_back(key, value.number());
  return line;
}

void write_reach(const RouteRequest& request, const terrain::MapGrid& grid, const std::vector<float>& cost) {
  const char* unit = request.costs.front() == RouteCost::time     ? "s"
                     : request.costs.front() == RouteCost::length ? "m"
                     : request.costs.front() == RouteCost::energy ? "J"
                                                                  : "1";
  float most = 1;
  for (const float c : cost)
    if (std::isfinite(c)) most = std::max(most, c);
  terrain::GeoTiffWriter writer(request.reach, grid,
                                {.name = "least cost from the start, " + name_of(request.costs.front()),
                                 .unit = unit,
                                 .classes = false,
                                 .legend = {{0, "0", "#eff3ff"}, {double(most), line("%g %s", most, unit), "#54278f"}},
                                 .metadata = map_metadata(request.map, map_inputs(request.map))});
  for (int top = 0; top < grid.rows; top += terrain::kTileCells) {
    const int rows = std::min(terrain::kTileCells, grid.rows - top);
    terrain::Tile band(grid.columns, rows, 0);
    for (std::size_t i = 0; i < band.value.size(); ++i) {
      const float value = cost[std::size_t(top) * std::size_t(grid.columns) + i];
      band.value[i] = std::isfinite(value) ? value : std::numeric_limits<float>::quiet_NaN();
    }
    writer.write({0, top, grid.columns, rows}, band);
  }
  writer.finish(request.map.threads);
}

}  // namespace

Place parse_place(const std::string& text, const std::string& where) {
  Place place;
  const std::size_t comma = text.find(',');
  const auto number = [&](std::size_t from, std::size_t to, double& value) {
    const auto [end, error] = std::from_chars(text.data() + from, text.data() + to, value);
    return error == std::errc() && end == text.data() + to && std::isfinite(value);
  };
  if (comma == std::string::npos || !number(0, comma, place.x) || !number(comma + 1, text.size(), place.y))
    throw InputError(where + ": \"" + text + "\" is no place; give easting,northing in the region's coordinate system");
  return place;
}

Json plan_route(const RouteRequest& request) {
  const MapRequest& map = request.map;
  const MapSources sources = open_sources(map.region);
  const terrain::MapGrid& grid = sources.elevation.grid();
  const SoilTable table = make_soil_table(map.model, map.region, map.rules, 0);
  const RouteCells cells = read_route_cells(sources, map.region, table, map.rules, map.threads);
  const std::uint32_t start = cell_at(request.from, grid, cells, "--from");
  const std::uint32_t end = cell_at(request.to, grid, cells, "--to");
  const AllCosts costs = all_costs(table, request.costs, map.rules.correlation_length);
  Json result = Json::object(), routes = Json::array(), files = Json::array();
  std::vector<terrain::LineFeature> lines;
  for (const RouteCost cost : request.costs) {
    const auto found = find_route(cells, costs.at(cost), start, end);
    Json entry = Json::object();
    entry["cost"] = name_of(cost);
    entry["found"] = bool(found);
    if (found) {
      const Json sums = totals_of(*found, cells, costs);
      for (const auto& [key, value] : sums.members()) entry[key] = value;
      lines.push_back(line_of(*found, grid, sums, name_of(cost)));
    }
    routes.push_back(entry);
  }
  if (!request.lines.empty() && !lines.empty()) {
    terrain::write_lines(request.lines, grid, "routes", lines);
    files.push_back(request.lines.string());
  }
  if (!request.reach.empty()) {
    write_reach(request, grid, reach(cells, costs.at(request.costs.front()), start));
    files.push_back(request.reach.string());
  }
  result["crs"] = grid.crs_code.empty() ? grid.crs_name : grid.crs_code;
  result["cells"] = std::uint64_t(cells.soil.size());
  result["routes"] = routes;
  result["files"] = files;
  return result;
}

std::string route_text(const Json& result) {
  std::string text;
  for (const Json& route : result.at("routes").items()) {
    const std::string& cost = route.at("cost").string();
    if (!route.at("found").boolean()) {
      text += line("%-13s no way is known: every path crosses cells that are no-go or unknown in its direction\n",
                   cost.c_str());
      continue;
    }
    text += line("%-13s %8.3f km, chance to get through %.3f", cost.c_str(), route.at("length_m").number() / 1000,
                 route.at("chance").number());
    if (const Json* time = route.find("time_s")) text += line(", %.0f s", time->number());
    if (const Json* energy = route.find("energy_j")) text += line(", %.3f MJ of one wheel", energy->number() / 1e6);
    text += "\n";
  }
  for (const Json& file : result.at("files").items()) text += file.string() + "\n";
  return text;
}

}  // namespace gonogo::pipeline
