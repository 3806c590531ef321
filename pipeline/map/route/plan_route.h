// A route over a region from what the user names: two places and a cost.
#pragma once
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

/// "218000,4370000"; throws InputError, `where` first.
Place parse_place(const std::string& text, const std::string& where);

struct RouteRequest {
  MapRequest map;  // model, region, rules; its folder is not used
  std::optional<Place> from, to;
  std::vector<RouteCost> costs;      // one line each; what can be reached goes by the first
  std::filesystem::path lines;       // .gpkg, .geojson or .gpx; empty: none
  std::filesystem::path reach;       // .tif of the least cost from `from`; empty: none
  std::filesystem::path isochrones;  // .gpkg of bands of it; empty: none
  double interval = 0;               // width of a band, in the cost's unit; 0: a round one
  std::filesystem::path regions;     // .gpkg of the connected regions; empty: none
};

/// { crs, cells, routes: [{ cost, found, length_m, chance, time_s, energy_j }], regions, files }: time and energy where
/// the model tells, regions where they are asked for. Throws InputError where a place is missing or nothing is asked
/// for.
Json plan_route(const RouteRequest& request);
std::string route_text(const Json& result);

}  // namespace gonogo::map
