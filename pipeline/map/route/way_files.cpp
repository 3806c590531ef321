#include "pipeline/map/route/way_files.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/format.h"

namespace gonogo::map {

using terrain::TrackPoint;

namespace {

/// Largest excess over the tolerances, as a factor, of the points between `first` and `last`, and where it is.
struct Excess {
  double factor = 0;
  std::size_t at = 0;
};

Excess excess_between(const std::vector<TrackPoint>& track, const std::vector<double>& way, std::size_t first,
                      std::size_t last, const TrackTolerance& most) {
  Excess worst;
  const TrackPoint &a = track[first], &b = track[last];
  const double length = way[last] - way[first];
  for (std::size_t i = first + 1; i < last; ++i) {
    const TrackPoint& p = track[i];
    const double t = length > 0 ? (way[i] - way[first]) / length : 0;
    const auto off = [t](double from, double value, double to) { return std::abs(from + t * (to - from) - value); };
    double factor = std::hypot(off(a.x, p.x, b.x), off(a.y, p.y, b.y)) / most.distance;
    if (const double h = off(a.height, p.height, b.height); !std::isnan(h)) factor = std::max(factor, h / most.height);
    if (const double s = off(a.seconds, p.seconds, b.seconds); !std::isnan(s))
      factor = std::max(factor, s / most.seconds);
    if (factor > worst.factor) worst = {factor, i};
  }
  return worst;
}

/// The point next to the middle of the way between `first` and `last`; needs a point between them.
std::size_t middle_of(const std::vector<double>& way, std::size_t first, std::size_t last) {
  const double half = (way[first] + way[last]) / 2;
  const auto begin = way.begin() + std::ptrdiff_t(first) + 1, end = way.begin() + std::ptrdiff_t(last) - 1;
  auto at = std::lower_bound(begin, end, half);
  if (at != begin && half - *(at - 1) < *at - half) --at;
  return std::size_t(at - way.begin());
}

}  // namespace

TrackPoint centre_of(std::uint32_t cell, const terrain::MapGrid& grid) {
  const auto columns = std::uint32_t(grid.columns), row = cell / columns;
  return {.x = grid.west + (cell % columns + 0.5) * grid.cell_width, .y = grid.north - (row + 0.5) * grid.cell_height};
}

double height_at(const terrain::RasterSource& elevation, double x, double y) {
  const terrain::MapGrid& grid = elevation.grid();
  const double column = std::clamp((x - grid.west) / grid.cell_width - 0.5, 0.0, double(grid.columns - 1));
  const double row = std::clamp((grid.north - y) / grid.cell_height - 0.5, 0.0, double(grid.rows - 1));
  const int left = std::min(int(column), grid.columns - 2), top = std::min(int(row), grid.rows - 2);
  const terrain::Tile tile = elevation.read({left, top, 2, 2});
  const double u = column - left, v = row - top;
  const auto between = [u](double a, double b) { return u == 0 ? a : u == 1 ? b : a + u * (b - a); };
  const double above = between(double(tile.at(0, 0)), double(tile.at(1, 0)));
  const double below = between(double(tile.at(0, 1)), double(tile.at(1, 1)));
  return v == 0 ? above : v == 1 ? below : above + v * (below - above);
}

std::vector<TrackPoint> track_of(const FoundRoute& route, const RouteCells& cells, const RouteCosts* time,
                                 const terrain::RasterSource& elevation) {
  const terrain::MapGrid& grid = elevation.grid();
  std::vector<TrackPoint> track;
  double seconds = 0;
  const auto add = [&](double x, double y) {
    track.push_back({x, y, height_at(elevation, x, y), time ? seconds : std::nan("")});
  };
  for (std::size_t i = 1; i < route.cell.size(); ++i) {
    const TrackPoint a = centre_of(route.cell[i - 1], grid), b = centre_of(route.cell[i], grid);
    if (i == 1) add(a.x, a.y);
    const LineOfCells line(cells, route.cell[i - 1], route.cell[i]);
    walk_line(cells.columns, route.cell[i - 1], route.cell[i], [&](std::uint32_t cell, double begin, double end) {
      if (time) seconds += line.length * (end - begin) * double(time->per_metre(cells, cell, line.heading));
      add(end == 1 ? b.x : a.x + end * (b.x - a.x), end == 1 ? b.y : a.y + end * (b.y - a.y));
      return true;
    });
  }
  if (route.cell.size() == 1) {
    const TrackPoint only = centre_of(route.cell[0], grid);
    add(only.x, only.y);
  }
  return track;
}

std::vector<TrackPoint> simplified(const std::vector<TrackPoint>& track, const TrackTolerance& most) {
  if (track.size() < 3) return track;
  std::vector<double> way(track.size(), 0);
  for (std::size_t i = 1; i < track.size(); ++i)
    way[i] = way[i - 1] + std::hypot(track[i].x - track[i - 1].x, track[i].y - track[i - 1].y);
  std::vector<char> kept(track.size());
  kept.front() = kept.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> open = {{0, track.size() - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    const Excess worst = excess_between(track, way, first, last, most);
    const bool long_line = way[last] - way[first] > most.piece && last - first > 1;
    if (worst.factor <= 1 && !long_line) continue;
    const std::size_t at = worst.factor > 1 ? worst.at : middle_of(way, first, last);
    kept[at] = 1;
    open.emplace_back(first, at);
    open.emplace_back(at, last);
  }
  std::vector<TrackPoint> rest;
  for (std::size_t i = 0; i < track.size(); ++i)
    if (kept[i]) rest.push_back(track[i]);
  return rest;
}

namespace {

constexpr const char* kWeakColour = "#ff7f0e";
/// Colours of the lines, in the order of RouteCost: told apart without red and green, and none is a class's.
constexpr std::array<const char*, 4> kLineColours = {"#1a1a1a", "#c2188f", "#1f4fbf", "#6b3fa0"};

/// Start, waypoints, end, and where the weakest stretches begin.
std::vector<terrain::Stop> named_places(const RouteRequest& request, const terrain::RasterSource& elevation,
                                        const RouteCells& cells, const std::vector<FoundWay>& ways) {
  std::vector<terrain::Stop> stops;
  const std::vector<std::uint32_t> places = stops_of(request, elevation.grid(), cells);
  for (std::size_t i = 0; i < places.size(); ++i) {
    terrain::TrackPoint at = centre_of(places[i], elevation.grid());
    at.height = height_at(elevation, at.x, at.y);
    stops.push_back({i == 0 ? "start" : i + 1 == places.size() ? "end" : line("waypoint %zu", i), at});
  }
  for (const FoundWay& way : ways)
    if (const auto& weakest = way.passage.weakest)
      stops.push_back({name_of(way.cost) + ", weakest stretch, " + weakest_text(*weakest),
                       {.x = weakest->line.front()[0], .y = weakest->line.front()[1]}});
  return stops;
}

/// Tracks with heights, and with times if the model tells them.
void write_tracks(const RouteRequest& request, const MapSources& sources, const RouteCells& cells,
                  const AllCosts& costs, const std::vector<FoundWay>& ways) {
  const terrain::MapGrid& grid = sources.elevation.grid();
  const auto time = costs.find(RouteCost::time);
  const TrackTolerance most{.distance = 0.25 * std::min(grid.cell_width, grid.cell_height)};
  std::vector<terrain::Track> tracks;
  for (const FoundWay& way : ways)
    tracks.push_back(
        {name_of(way.cost),
         simplified(track_of(way.route, cells, time == costs.end() ? nullptr : &time->second, sources.elevation),
                    most)});
  terrain::write_gpx(request.lines, grid, named_places(request, sources.elevation, cells, ways), tracks,
                     request.departure);
}

/// The ways and their weakest stretches.
std::vector<terrain::LineFeature> lines_of(const std::vector<FoundWay>& ways, const terrain::MapGrid& grid) {
  std::vector<terrain::LineFeature> lines;
  for (const FoundWay& way : ways) {
    terrain::LineFeature line{.name = name_of(way.cost),
                              .colour = kLineColours[std::size_t(way.cost)],
                              .point = {},
                              .attribute = numbers_of(way)};
    for (const std::uint32_t cell : way.route.cell) {
      const terrain::TrackPoint at = centre_of(cell, grid);
      line.point.push_back({at.x, at.y});
    }
    lines.push_back(std::move(line));
  }
  for (const FoundWay& way : ways)
    if (const auto& weakest = way.passage.weakest)
      lines.push_back({.name = name_of(way.cost) + ", weakest stretch, " + weakest_text(*weakest),
                       .colour = kWeakColour,
                       .point = weakest->line,
                       .attribute = {}});
  return lines;
}

}  // namespace

void write_ways(const RouteRequest& request, const MapSources& sources, const RouteCells& cells, const AllCosts& costs,
                const std::vector<FoundWay>& ways) {
  if (request.lines.extension() == ".gpx")
    write_tracks(request, sources, cells, costs, ways);
  else
    terrain::write_lines(request.lines, sources.elevation.grid(), "routes", lines_of(ways, sources.elevation.grid()));
}

}  // namespace gonogo::map
