// A route over a region from what the user names: two places and a cost.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "pipeline/map/make_map.h"
#include "pipeline/route/cost.h"

namespace gonogo::pipeline {

struct Place {
  double x = 0, y = 0;  // in the region's coordinate system
};

/// "218000,4370000"; throws InputError, `where` first.
Place parse_place(const std::string& text, const std::string& where);

struct RouteRequest {
  MapRequest map;  // model, region, rules; its folder is not used
  Place from, to;
  std::vector<RouteCost> costs;  // one line each
  std::filesystem::path lines;   // .gpkg, .geojson or .gpx; empty: none
  std::filesystem::path reach;   // .tif of the least cost from `from`, by the first of `costs`; empty: none
};

/// { crs, cells, routes: [{ cost, found, length_m, chance, time_s, energy_j }], files }; the last two where the model
/// tells
Json plan_route(const RouteRequest& request);
std::string route_text(const Json& result);

}  // namespace gonogo::pipeline
