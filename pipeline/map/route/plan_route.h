// Plans routes over a region between two places, and what can be reached from one.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "pipeline/map/evaluate/cell.h"
#include "pipeline/map/route/passage.h"
#include "pipeline/map/route/search/search.h"
#include "pipeline/map/write/make_map.h"

namespace gonogo::map {

/// Reads the region's rasters band by band in threads. The result takes 5 bytes per cell. Throws InputError if the
/// region lists more soils than a byte can number.
RouteCells read_route_cells(const MapSources& sources, const Region& region, const SoilTable& table,
                            const MapRules& rules, int threads);

/// Plans routes over a region between two places, and what can be reached from one.
struct Place {
  double x = 0, y = 0;  // in the region's coordinate system
};

/// Reads "218000,4370000". Throws InputError for other forms, with `where` first.
Place parse_place(const std::string& text, const std::string& where);

/// 2000-01-01T00:00:00Z: no date was given.
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

/// A way over the stops of a request, the cheapest by one cost.
struct FoundWay {
  RouteCost cost;
  FoundRoute route;
  double length = 0, risk = 0;             // of all of it [m], [-]
  std::optional<double> time{}, energy{};  // [s], [J]; of a model with measures
  Passage passage{};
  std::optional<double> turned{};  // [deg] in all; where turns were asked for
  double turning = 0;              // metres of driving that the turns count as
};

/// Connected regions of the map.
struct ConnectedRegions {
  std::uint64_t count = 0;
  double largest = 0, passable = 0;  // area of the largest, of all [km2]
};

/// Where a journey ends that has no way on.
struct DeadEnd {
  Place place{};        // reachable, and nearest to the place that is not
  double short_of = 0;  // [m] from there
  std::string by{};     // what stops it
};

struct RouteResult {
  std::string crs;
  std::uint64_t cells = 0;
  bool eight_directions = false;
  std::vector<std::pair<RouteCost, std::optional<FoundWay>>> ways;  // by each cost asked for; nothing: there is none
  std::optional<DeadEnd> dead_end{};                                // where there is no way
  std::optional<ConnectedRegions> regions;                          // where they were asked for
  std::vector<std::filesystem::path> files;
};

/// Writes the files asked for. Throws InputError if a place is missing or nothing is asked for.
RouteResult plan_route(const RouteRequest& request);

/// { crs, cells, directions, routes: [{ cost, found, length_m, risk, time_s, energy_j, chance, chance_error,
/// stuck_places, not_sampled, weakest: { from_km, to_km, stuck, reason, soil, slope_along_deg, slope_across_deg },
/// corners, turned_degrees, turning_m }], dead_end: { place, short_of_m, by }, regions: { count, largest_km2,
/// passable_km2 }, files }.
Json route_json(const RouteResult& result);
std::string route_text(const RouteResult& result);
/// A clause without a full stop.
std::string dead_end_text(const DeadEnd& end);
/// "km 2.31 to 2.48: no traction in 12 % of the draws, loam, 14 degrees along and 3 across".
std::string weakest_text(const StuckStretch& stretch);
/// What a way costs, and the chance to get through, by name.
std::vector<std::pair<std::string, double>> numbers_of(const FoundWay& way);

}  // namespace gonogo::map
