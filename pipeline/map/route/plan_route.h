// Plans routes over a region between two places, and what can be reached from one.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "pipeline/map/route/cost.h"
#include "pipeline/map/write/make_map.h"

namespace gonogo::map {

struct Place {
  double x = 0, y = 0;  // in the region's coordinate system
};

/// Reads "218000,4370000". Throws InputError for other forms, with `where` first.
Place parse_place(const std::string& text, const std::string& where);

/// 2000-01-01T00:00:00Z: stands for "some day".
inline constexpr std::int64_t kNoDate = 946684800;

/// Reads "2026-05-01T06:00:00Z" as seconds since 1970-01-01T00:00:00Z. Throws InputError for other forms.
std::int64_t parse_departure(const std::string& text, const std::string& where);

struct RouteRequest {
  MapRequest map;  // model, region and rules; `out` is ignored
  std::optional<Place> from, to;
  std::vector<Place> via;            // places between, in their order
  std::filesystem::path avoid;       // polygons that no way may touch; empty: none
  bool eight_directions = false;     // in place of any direction: quicker, as the page does
  double turning = 0;                // a turn by 90 degrees costs as much as so many metres; 0: nothing
  std::int64_t departure = kNoDate;  // of GPX tracks [s since 1970-01-01T00:00:00Z]
  std::vector<RouteCost> costs;      // a route for each; reach and isochrones use the first
  std::filesystem::path lines;       // .gpkg, .geojson or .gpx; empty: none
  std::filesystem::path reach;       // .tif of the min cost from `from`; empty: none
  std::filesystem::path isochrones;  // .gpkg of bands of that cost; empty: none
  double interval = 0;               // width of a band [unit_of(cost)]; 0: a round one
  std::filesystem::path costmap;     // .yaml for Nav2, with a .pgm beside it, by the first cost; empty: none
  std::filesystem::path grid_map;    // .tif or .nc of the first cost by heading; empty: none
  std::filesystem::path regions;     // .gpkg of the connected regions; empty: none
};

/// Writes the files asked for and returns { crs, cells, directions, routes: [{ cost, found, length_m, risk, time_s,
/// energy_j, corners, turned_degrees, turning_m, and those of forecast_json() (drive_of_way.h) }], regions, files }.
/// time_s and energy_j need a model with measures; regions and turns are there if asked for. Throws InputError if a
/// place is missing or nothing is asked for.
Json plan_route(const RouteRequest& request);
std::string route_text(const Json& result);

}  // namespace gonogo::map
