// Ways as files: GPX tracks with heights and times, or lines with what they cost.
#pragma once
#include <vector>

#include "pipeline/map/evaluate/cell.h"
#include "pipeline/map/route/find_ways.h"
#include "pipeline/map/route/search/any_angle.h"
#include "terrain/raster/raster_source.h"
#include "terrain/raster/vector/write_vector.h"

namespace gonogo::map {

/// Centre of a cell in the grid's coordinate system.
terrain::TrackPoint centre_of(std::uint32_t cell, const terrain::MapGrid& grid);

/// Height at a place, bilinear between the centres of cells [m]. NaN where one of them has none.
double height_at(const terrain::RasterSource& elevation, double x, double y);

/// Points of the way: its corners and all places where it enters another cell. Heights are bilinear; seconds add up the
/// costs `time` and are left out without them.
std::vector<terrain::TrackPoint> track_of(const FoundRoute& route, const RouteCells& cells, const RouteCosts* time,
                                          const terrain::RasterSource& elevation);

/// How far what is left out may lie from the line between its neighbours.
struct TrackTolerance {
  double distance = 1;  // [units of the grid]
  double height = 1;    // [m]
  double seconds = 5;
  /// Longest line between points that stay, where there are points [units of the grid]. Programs draw lines straight in
  /// longitude and latitude. Over a length L these leave the straight line of the grid by about L^2 tan(latitude) / 8
  /// R: 0.02 m at 45 degrees, but 18 m over 30 km.
  double piece = 1000;
};

/// Leaves out points by the method of Ramer (1972) and Douglas and Peucker (1973), with places, heights and seconds of
/// a point compared with those at its share of the way between the points that stay. Then halves lines that are longer
/// than `most.piece`.
std::vector<terrain::TrackPoint> simplified(const std::vector<terrain::TrackPoint>& track, const TrackTolerance& most);

/// Writes `request.lines`, .gpx as tracks and waypoints, otherwise as lines; the weakest stretches are marked in both.
void write_ways(const RouteRequest& request, const MapSources& sources, const RouteCells& cells, const AllCosts& costs,
                const std::vector<FoundWay>& ways);

}  // namespace gonogo::map
