// Maps of a region from a model and rasters, routes over them, and their comparison. Link gonogo::map.
//
// Places are in the region's coordinate system, which is that of its elevation raster where that is in metres.
#pragma once
#include <gonogo/campaign.h>

namespace gonogo::api {

struct MapRequest {
  std::string model{};             // as Model::read()
  std::filesystem::path region{};  // region file; or, in its place,
  std::filesystem::path dem{};     // an elevation raster in any format of GDAL
  std::string soil{};  // with `dem`: USDA texture, class of the USCS, soil of configs/soils, or raster of textures;
                       // empty: any soil
  std::vector<std::filesystem::path> members{};  // bootstrap members of the model
  std::string study{};                           // rules of its section map; empty: the usual ones
  std::string vehicle{};                         // must be the model's; empty: whichever that is
  std::string moisture{};                        // "dry", "moist" or "wet"; empty: the study's
  Values mission{};                              // payload, commanded speed, ...; others are summed out
  std::string heading{};        // "uphill", "worst", "best" or degrees clockwise from grid north; empty: the study's
  double max_speed_km_h = 0;    // 0: the study's, or none
  std::filesystem::path out{};  // folder of the map
  bool colour_blind_safe = false;
  int threads = 0;           // 0: all cores; no bit depends on them
  std::string cone_index{};  // with `dem`, of fine-grained soil: "60" [psi], "414kPa", or a raster [psi]
};

struct MapSummary {
  double area_km2 = 0;                // of the cells that have a slope
  std::map<Verdict, double> share{};  // of that area [0, 1]
  std::vector<std::filesystem::path> files{};
  std::vector<std::string> remarks{};  // one sentence each: what the map cannot say, and why
  bool reused = false;                 // the folder already held this map
};

/// Writes the map's folder: GeoTIFF layers, figure, page and tables. Memory does not grow with the raster. A run that
/// was killed goes on where it was. Throws InputError for unusable rasters; earlier files stay then.
MapSummary make_map(const MapRequest& request);

struct Place {
  double x = 0, y = 0;
};

struct RouteRequest {
  MapRequest map{};  // its `out` is ignored
  Place start{}, end{};
  std::vector<Place> via{};                  // in their order
  std::vector<std::string> costs{"safest"};  // "shortest", "fastest", "safest", "least-energy": a route for each
  std::filesystem::path avoid{};             // polygons that no way may touch; empty: none
  double turning = 0;                        // a turn by 90 degrees costs as much as so many metres; 0: nothing
  std::filesystem::path lines{};             // to write: .gpkg, .geojson or .gpx; empty: none
};

struct Route {
  std::string cost{};                      // what it is the cheapest by
  bool found = false;                      // false: no way leads there, and the rest is empty
  double length = 0;                       // [m]
  std::optional<double> time{}, energy{};  // [s], [J]; of a model with measures
  double chance = 0, chance_error = 0;     // to get through, with its standard error
  std::string weakest{};                   // where the vehicle most likely gets stuck, and why; empty: nowhere
};

/// The cheapest way by each cost. Throws InputError for a place outside the region.
std::vector<Route> plan_routes(const RouteRequest& request);

/// A part of the cells of two maps.
struct CellClass {
  std::string label{};
  double area_km2 = 0, share = 0;
};
struct MapComparison {
  std::vector<CellClass> passing{};       // passable in both, in one, in none
  std::vector<CellClass> significance{};  // of the difference of P(go)
  std::vector<std::filesystem::path> files{};
};
/// Compares two map folders of one region for the uphill heading and writes layers and figures to `out`.
MapComparison compare_maps(const std::filesystem::path& first, const std::filesystem::path& second,
                           const std::filesystem::path& out);

/// A north-up raster of equal cells, or a layer of a map's folder.
struct Raster {
  int columns = 0, rows = 0;
  double west = 0, north = 0;              // outer corner of the first cell [units of the coordinate system]
  double cell_width = 0, cell_height = 0;  // [the same]
  std::string crs{};                       // coordinate system as WKT2
  std::vector<float> value{};              // [row][column], row 0 in the north; NaN: no data
};
/// Band 1 of any raster that GDAL opens, with its scale and offset.
Raster read_raster(const std::filesystem::path& file);

}  // namespace gonogo::api
