#include "terrain/raster/grid.h"

#include <cpl_conv.h>
#include <algorithm>

#include "terrain/raster/gdal_support.h"

namespace gonogo::terrain {

namespace {

using Corners = std::array<std::array<double, 2>, 4>;

std::string body_name(double radius) {
  const auto body = body_of_radius(radius);
  return body ? body->name : "";
}

bool turn_bounds(OGRCoordinateTransformation* turn, const MapGrid& grid, DegreeBox& box) {
  const double east = grid.east(), south = grid.south();
  return turn &&
         turn->TransformBounds(grid.west, south, east, grid.north, &box.west, &box.south, &box.east, &box.north, 21) &&
         std::isfinite(box.west + box.south + box.east + box.north) && box.south < box.north && box.width() > 0;
}

/// Counter-clockwise from the south-west.
bool turn_corners(OGRCoordinateTransformation& turn, const MapGrid& grid, Corners& corners) {
  const double east = grid.east(), south = grid.south();
  corners = {{{grid.west, south}, {east, south}, {east, grid.north}, {grid.west, grid.north}}};
  for (auto& [x, y] : corners)
    if (!turn.Transform(1, &x, &y)) return false;
  return true;
}

DegreeRing ring_of(const DegreeBox& box) {
  return {{box.west, box.south},
          {box.east, box.south},
          {box.east, box.north},
          {box.west, box.north},
          {box.west, box.south}};
}

/// The part of a convex ring west (side -1) or east (+1) of the antimeridian (Sutherland and Hodgman 1974). Longitudes
/// of the ring run on beyond 180; those of the part lie in [-180, 180].
DegreeRing half_of(const Corners& corners, int side) {
  DegreeRing part;
  const auto add = [&](double x, double y) { part.push_back({side > 0 ? x - 360 : x, y}); };
  for (std::size_t i = 0; i < 4; ++i) {
    const auto &a = corners[i], &b = corners[(i + 1) % 4];
    const double from = side * (a[0] - 180), to = side * (b[0] - 180);
    if (from >= 0) add(a[0], a[1]);
    if ((from < 0) != (to < 0)) add(180, a[1] + (b[1] - a[1]) * from / (from - to));
  }
  if (!part.empty()) part.push_back(part.front());
  return part;
}

void add_pieces(GlobePlace& place, Corners corners) {
  const bool holds_pole = place.box.width() >= 360 - 1e-9;
  if (holds_pole || place.box.west <= place.box.east) {
    place.pieces = {place.box};
    DegreeRing ring(corners.begin(), corners.end());
    ring.push_back(corners.front());
    place.outline = {holds_pole ? ring_of(place.box) : ring};
    return;
  }
  place.pieces = {{place.box.west, place.box.south, 180, place.box.north},
                  {-180, place.box.south, place.box.east, place.box.north}};
  for (auto& [x, y] : corners) x += x < 0 ? 360 : 0;
  for (const int side : {-1, 1})
    if (DegreeRing part = half_of(corners, side); part.size() > 3) place.outline.push_back(std::move(part));
}

bool place_in(const OGRSpatialReference& degrees, const MapGrid& grid, GlobePlace& place) {
  const OGRSpatialReference from = system_of(grid);
  const Transformation turn(OGRCreateCoordinateTransformation(&from, &degrees));
  Corners corners;
  if (!turn_bounds(turn.get(), grid, place.box) || !turn_corners(*turn, grid, corners)) return false;
  place.system = degrees.GetName() ? degrees.GetName() : "unnamed";
  place.wkt = export_wkt(degrees);
  add_pieces(place, corners);
  return true;
}

}  // namespace

std::vector<Window> windows_of(const MapGrid& grid, int columns, int rows) {
  std::vector<Window> windows;
  for (int row = 0; row < grid.rows; row += rows)
    for (int column = 0; column < grid.columns; column += columns)
      windows.push_back({column, row, std::min(columns, grid.columns - column), std::min(rows, grid.rows - row)});
  return windows;
}

GlobeAnswer place_on_globe(const MapGrid& grid) {
  GdalCall call;
  GlobePlace place;
  place.body = body_name(grid.body_radius);
  if (place_in(wgs84(), grid, place)) return {place, ""};
  place.is_wgs84 = false;
  if (place_in(own_degrees(system_of(grid)), grid, place)) return {place, ""};
  return {std::nullopt, "the map's place in degrees cannot be told (" + call.message() + ")"};
}

std::optional<DegreeNodes> degree_nodes(const MapGrid& grid, const GlobePlace& place, int most) {
  const GdalCall call;
  if (place.box.width() > 180) return std::nullopt;
  OGRSpatialReference degrees;
  degrees.importFromWkt(place.wkt.c_str());
  degrees.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const OGRSpatialReference from = system_of(grid);
  const Transformation turn(OGRCreateCoordinateTransformation(&from, &degrees));
  DegreeNodes nodes{.columns = std::min(most, grid.columns + 1),
                    .rows = std::min(most, grid.rows + 1),
                    .longitude = {},
                    .latitude = {}};
  const double middle = place.box.west + place.box.width() / 2;
  for (int j = 0; j < nodes.rows; ++j)
    for (int i = 0; i < nodes.columns; ++i) {
      double x = grid.west + grid.columns * grid.cell_width * i / (nodes.columns - 1);
      double y = grid.north - grid.rows * grid.cell_height * j / (nodes.rows - 1);
      if (!turn || !turn->Transform(1, &x, &y)) return std::nullopt;
      nodes.longitude.push_back(middle + std::remainder(x - middle, 360.0));
      nodes.latitude.push_back(y);
    }
  return nodes;
}

std::string remark_on(const GlobePlace& place) {
  if (place.is_wgs84) return "";
  return "the map's longitudes and latitudes are fixed to " +
         (place.body.empty() || place.body == "Earth" ? "its own body" : "the body " + place.body) + " (" +
         place.system + "), because no way to WGS 84 is known";
}

}  // namespace gonogo::terrain
