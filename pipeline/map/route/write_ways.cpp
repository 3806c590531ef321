#include "pipeline/map/route/write_ways.h"

#include <algorithm>
#include <array>

#include "base/line.h"
#include "pipeline/map/route/drive_of_way.h"
#include "pipeline/map/route/track.h"
#include "terrain/raster/gpx.h"
#include "terrain/raster/vector.h"

namespace gonogo::map {
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
    if (const Json* weakest = way.totals.find("weakest"))
      stops.push_back({name_of(way.cost) + ", weakest stretch, " + weakest_text(*weakest),
                       {.x = way.weakest.front()[0], .y = way.weakest.front()[1]}});
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
    terrain::LineFeature line{
        .name = name_of(way.cost), .colour = kLineColours[std::size_t(way.cost)], .point = {}, .attribute = {}};
    for (const std::uint32_t cell : way.route.cell) {
      const terrain::TrackPoint at = centre_of(cell, grid);
      line.point.push_back({at.x, at.y});
    }
    for (const auto& [key, value] : way.totals.members())
      if (value.is_number()) line.attribute.emplace_back(key, value.number());
    lines.push_back(std::move(line));
  }
  for (const FoundWay& way : ways)
    if (const Json* weakest = way.totals.find("weakest"))
      lines.push_back({.name = name_of(way.cost) + ", weakest stretch, " + weakest_text(*weakest),
                       .colour = kWeakColour,
                       .point = way.weakest,
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
