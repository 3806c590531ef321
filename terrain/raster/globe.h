// Where a grid lies on its globe: longitude and latitude of its corners and bounds.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "terrain/raster/grid.h"

namespace gonogo::terrain {

/// Bounds [deg]. Across the antimeridian east is less than west.
struct DegreeBox {
  double west = 0, south = 0, east = 0, north = 0;
  double width() const { return east < west ? east - west + 360 : east - west; }
};

/// Closed ring of {longitude, latitude} [deg], counter-clockwise.
using DegreeRing = std::vector<std::array<double, 2>>;

/// Longitudes count eastward. They are WGS 84 where a way from the grid's system to it is known, otherwise those of
/// the grid's own datum, fixed to its body.
struct GlobePlace {
  bool is_wgs84 = true;
  std::string system;               // name of the geographic coordinate system
  std::string wkt;                  // the same as WKT2
  std::string body;                 // as in body.h, or empty for another radius
  DegreeBox box;                    // all of the grid
  std::vector<DegreeBox> pieces;    // the box; two west and east of the antimeridian if it crosses it
  std::vector<DegreeRing> outline;  // [piece] the grid's corners; the box if the grid holds a pole
};

/// The place, or why it cannot be told.
struct GlobeAnswer {
  std::optional<GlobePlace> place;
  std::string why_not;  // without a full stop
};
GlobeAnswer place_on_globe(const MapGrid& grid);

/// Longitude and latitude of nodes that divide the grid evenly, corners included, row by row from the north [rows *
/// columns]. Longitudes run on beyond 180 where they must, so that neighbours are near each other.
struct DegreeNodes {
  int columns = 0, rows = 0;
  std::vector<double> longitude, latitude;  // [deg]
};
/// At most `most` nodes a side. Nothing for a grid that holds a pole, where longitudes cannot be interpolated.
std::optional<DegreeNodes> degree_nodes(const MapGrid& grid, const GlobePlace& place, int most);

/// "the map's degrees are fixed to the Moon (GCS_Moon_2000), not WGS 84"; empty for WGS 84.
std::string remark_on(const GlobePlace& place);

}  // namespace gonogo::terrain
