// The page of a map: its arrays, its text, and the whole page of the sample region in a real browser.
#include <cmath>
#include <cstdlib>

#include "base/files/file.h"
#include "base/format.h"
#include "base/math/random.h"
#include "pipeline/map/page/page.h"
#include "pipeline/map/route/find_ways.h"
#include "pipeline/map/route/plan_route.h"
#include "pipeline/map/route/search/search.h"
#include "pipeline/map/write/make_map.h"
#include "terrain/raster/raster_source.h"
#include "tests/pipeline/map/analytic_model.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/line_reader.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;
using terrain::RasterKind;
using terrain::RasterSource;
using terrain::Tile;

namespace {

const std::string kHostile =
    "Valley </script><script>window.broken = 1</script> <img src=x onerror=\"window.broken = 2\"> & {{js}} \"'";

/// P(go) depends on both slopes, so that headings differ; speed falls uphill.
OutcomeModel directional_model() {
  OutcomeModel model = test::AnalyticModel{.width_deg = 3, .weaker_deg = 8}.outcome_model();
  const auto uphill = model.probabilities;
  const std::size_t width = contract().variables.size();
  const std::size_t along = contract().variable_index("slope_along"),
                    across = contract().variable_index("slope_across");
  model.sampled[along] = {-25, 35};
  model.sampled[across] = {-25, 25};
  model.probabilities = [=](std::span<const double> points, std::span<double> result) {
    std::vector<double> turned(points.begin(), points.end());
    for (std::size_t i = 0; i * width < turned.size(); ++i)
      turned[i * width + along] += 0.6 * std::abs(turned[i * width + across]);
    uphill(turned, result);
  };
  model.cone_index = ConeIndexNeed{"a made vehicle", 69e3, 207e3};  // 30 psi: loam is too soft, clay loam is not
  model.novelty = [](std::span<const double>) { return 0.75; };
  std::vector<double> points, slip;
  for (int i = 0; i < 40; ++i) {
    for (std::size_t v = 0; v < width; ++v)
      points.push_back(v == along ? -20 + 50 * random_unit(8, 0, std::uint64_t(i)) : 1.0);
    slip.push_back(0.2 + 0.005 * points[points.size() - width + along]);
  }
  model.measures.push_back(fit_measure("slip", "-", points, slip));
  SpeedModel speed;
  speed.drive = vehicle::TractiveForce(vehicle::read_vehicle(GONOGO_SOURCE_DIR "/configs/vehicles/hmmwv.json"));
  speed.mass = 2600;
  speed.rut_width = 0.5;
  speed.resistance = {.constant = 0.1, .lowest = 0.1, .highest = 0.1, .fastest = 3, .trials = 1};
  speed.slip = fit_measure("slip", "-", points, slip);
  speed.sinkage = fit_measure("sinkage", "m", points, std::vector<double>(40, 0.03));
  model.speed = speed;
  return model;
}

MapRequest hostile_request(const TemporaryFolder& folder) {
  MapRequest request;
  request.region = read_region(GONOGO_SOURCE_DIR "/configs/regions/sagehen.json");
  request.region.name = request.region.about = request.region.elevation.source = kHostile;
  request.region.soils.front().name = kHostile;
  for (Soil& soil : request.region.soils)
    if (soil.name == "loam") {  // one of two samples is firm
      soil.samples.push_back(soil.samples.front());
      soil.samples.back().values["cohesion"].low = soil.samples.back().values["cohesion"].high = 8;
    }
  request.model = directional_model();
  request.model.vehicle = kHostile;
  request.out = folder / "map";
  return request;
}

Json number(float value) { return std::isnan(value) ? Json() : Json(double(value)); }
Json code(float value) { return std::isnan(value) ? Json() : Json(int(value)); }

/// Cells of the GeoTIFFs, corners and random ones.
Json expected_cells(const MapRequest& request, const terrain::MapGrid& grid) {
  const auto layer = [&](const char* name) {
    return RasterSource::open_on_grid(request.out / name, grid, RasterKind::classes)
        .read({0, 0, grid.columns, grid.rows});
  };
  const Tile go = layer("go.tif"), reason = layer("reason.tif"), p = layer("p_go.tif"), worst = layer("p_go_worst.tif"),
             best = layer("p_go_best.tif");
  Json cells = Json::array();
  for (int i = 0; i < 300; ++i) {
    const int column = i == 0 ? 0 : int(random_bits(21, 0, std::uint64_t(i)) % std::uint64_t(grid.columns));
    const int row = i == 0 ? 0 : int(random_bits(21, 1, std::uint64_t(i)) % std::uint64_t(grid.rows));
    Json cell = Json::object();
    cell["column"] = column;
    cell["row"] = row;
    cell["verdict"] = code(go.at(column, row));
    cell["reason"] = code(reason.at(column, row));
    cell["p_go"] = number(p.at(column, row));
    cell["p_worst"] = number(worst.at(column, row));
    cell["p_best"] = number(best.at(column, row));
    cells.push_back(cell);
  }
  return cells;
}

/// Costs by the program between two cells that can be clicked apart on a screen.
Json expected_route(const MapRequest& request, const MapSources& sources) {
  const SoilTable table = make_soil_table(request.model, request.region, request.rules, 0);
  const RouteCells cells = read_route_cells(sources, request.region, table, request.rules, 0);
  const std::uint32_t start = std::uint32_t(500 * cells.columns + 300), end = std::uint32_t(150 * cells.columns + 620);
  Json route = Json::object();
  route["start"] = std::uint64_t(start);
  route["end"] = std::uint64_t(end);
  for (const RouteCost cost : {RouteCost::length, RouteCost::time, RouteCost::risk}) {
    const auto found = find_route(cells, RouteCosts(table, cost, request.rules.correlation_length), start, end);
    REQUIRE(found);
    route[name_of(cost)] = found->cost;
    const auto pieces = pieces_of(*found, cells, RouteCosts(table, RouteCost::length, 1));
    const auto soils = way_soils(table);
    route[name_of(cost) + " chance"] =
        forecast_passage(pieces, soils, request.model,
                         passage_doubt(request.region.elevation, request.rules, sources.elevation.grid()))
            .chance;
  }
  return route;
}

std::vector<std::uint16_t> unfiltered(const std::vector<std::uint16_t>& difference, std::size_t width, int filter,
                                      int bits) {
  std::vector<std::uint16_t> v(difference.size());
  for (std::size_t i = 0; i < v.size(); ++i) {
    const int left = i % width ? v[i - 1] : 0, up = i >= width ? v[i - width] : 0;
    const int corner = i % width && i >= width ? v[i - width - 1] : 0;
    const int expected = filter == 1 ? left : filter == 2 ? left + up - corner : filter == 3 ? (left + up) / 2 : 0;
    v[i] = std::uint16_t((difference[i] + expected) & ((1 << bits) - 1));
  }
  return v;
}

}  // namespace

TEST_CASE("the filters of the page's arrays can be undone") {
  for (const int bits : {8, 16})
    for (const int filter : {0, 1, 2, 3}) {
      Blob blob{"b", bits, 7, {}};
      for (std::uint64_t i = 0; i < 7 * 9; ++i)
        blob.value.push_back(std::uint16_t(random_bits(1, 2, i) & ((1u << bits) - 1)));
      CHECK(unfiltered(filtered(blob, BlobFilter(filter)), 7, filter, bits) == blob.value);
    }
}

TEST_CASE("base64 is that of RFC 4648") {
  CHECK(base64("") == "");
  CHECK(base64("f") == "Zg==");
  CHECK(base64("fo") == "Zm8=");
  CHECK(base64("foobar") == "Zm9vYmFy");
}

TEST_CASE("text of the metadata cannot end the page's script, and marks in it are not filled in") {
  Json meta = Json::object();
  meta["title"] = kHostile;
  const std::string page = page_file(meta, {});
  CHECK_FALSE(contains(page,
                       "window.broken"
                       " = 1</script>"));
  CHECK_FALSE(contains(page, "<img src=x"));
  CHECK(contains(page, "& {{js}}") == false);
  CHECK(contains(page, "\\u0026 {{js}}"));
}

TEST_CASE("the page of the sample region works in a browser and says what the GeoTIFFs say") {
  const TemporaryFolder folder;
  const MapRequest request = hostile_request(folder);
  make_map(request);
  const MapSources sources = open_sources(request.region);
  CHECK(std::filesystem::file_size(request.out / "index.html") < 4u << 20);
  Json expected = Json::object();
  expected["title"] = kHostile;
  expected["cells"] = expected_cells(request, sources.elevation.grid());
  expected["route"] = expected_route(request, sources);
  write_file_atomically(request.out / "expected.json", expected.dump());
  const char* pictures = std::getenv("GONOGO_PAGE_PICTURES");  // folder for screenshots, to look at
  const std::string command =
      std::string("python3 '" GONOGO_SOURCE_DIR "/tests/page/check.py' '" GONOGO_BROWSER "' '") + request.out.string() +
      "'" + (pictures ? std::string(" '") + pictures + "'" : "");
  CHECK(std::system(command.c_str()) == 0);
}

TEST_CASE("a route of the sample region is written as GeoPackage, GeoJSON and GPX that GDAL reads back") {
  const TemporaryFolder folder;
  RouteRequest request;
  request.map = hostile_request(folder);
  request.from = Place{216000, 4370500};
  request.to = Place{220500, 4369000};
  request.costs = {RouteCost::time, RouteCost::risk, RouteCost::length};
  for (const char* name : {"routes.gpkg", "routes.geojson", "routes.gpx"}) {
    INFO(name);
    request.lines = folder / name;
    const RouteResult result = plan_route(request);
    const auto& ways = result.ways;
    REQUIRE(ways.size() == 3);
    for (const auto& [cost, way] : ways) REQUIRE(way);
    CHECK(*ways[0].second->time <= *ways[2].second->time);
    CHECK(ways[1].second->risk <= ways[0].second->risk);
    CHECK(ways[2].second->length <= ways[1].second->length);
    const test::ReadLines lines = test::read_lines(folder / name);
    int stretches = 0;  // weakest ones, in a GPX waypoints
    for (const auto& [cost, way] : ways) stretches += bool(way->passage.weakest);
    CHECK(stretches > 0);
    CHECK(lines.count == (std::string(name) == "routes.gpx" ? 3 : 3 + stretches));
    CHECK(lines.degrees == (std::string(name) != "routes.gpkg"));
    CHECK(lines.west == Approx(lines.degrees ? -120.30 : 216000).margin(lines.degrees ? 0.02 : 200));
  }
  request.reach = folder / "reach.tif";
  request.isochrones = folder / "minutes.gpkg";
  request.interval = 60;
  request.regions = folder / "regions.gpkg";
  request.lines.clear();
  request.to.reset();  // not needed for what can be reached
  const RouteResult spread = plan_route(request);
  CHECK(spread.ways.empty());
  CHECK(spread.files.size() == 3);
  const auto dem = RasterSource::open_elevation(request.map.region.elevation.files);
  const auto cost = RasterSource::open_on_grid(folder / "reach.tif", dem.grid(), RasterKind::continuous);
  CHECK(cost.read({175, 300, 1, 1}).value[0] < 300);  // the start's surroundings, in seconds
  const std::map<int, double> bands = test::areas_by_code(folder / "minutes.gpkg", "isochrones");
  std::map<int, double> expected;
  for (const float seconds : cost.read({0, 0, dem.grid().columns, dem.grid().rows}).value)
    if (!std::isnan(seconds)) expected[int(seconds / 60)] += dem.grid().cell_area_m2() * 1e-6;
  REQUIRE(bands.size() == expected.size());
  CHECK(bands.size() > 2);
  for (const auto& [band, area] : expected) CHECK(bands.at(band) == Approx(area));
  const std::map<int, double> regions = test::areas_by_code(folder / "regions.gpkg", "regions");
  double all = 0;
  for (const auto& [rank, area] : regions) all += area;
  CHECK(regions.at(0) == Approx(spread.regions->largest));
  CHECK(all == Approx(spread.regions->passable));
  CHECK(spread.regions->count >= regions.size());
  request.isochrones = folder / "minutes.shp";
  CHECK(contains(input_error([&] { plan_route(request); }), "polygons are written as .gpkg"));
  request.isochrones.clear();
  request.reach.clear();
  request.regions.clear();
  CHECK(contains(input_error([&] { plan_route(request); }), "nothing is asked for"));
  request.to = Place{220500, 4369000};
  request.from = Place{0, 0};
  CHECK(contains(input_error([&] { plan_route(request); }), "--from 0,0 lies outside the elevation raster"));
  request.lines = folder / "routes.shp";
  request.from = Place{216000, 4370500};
  CHECK(contains(input_error([&] { plan_route(request); }), "use .gpkg, .geojson or .gpx"));
  CHECK(contains(input_error([] { parse_place("12", "route: --from"); }), "easting,northing"));
}
