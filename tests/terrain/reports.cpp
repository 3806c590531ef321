// Inputs like those of reports in public trackers, with the right answers. tests/data/cases/README.md lists all of
// them.
#include <ogr_srs_api.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>

#include "base/error.h"
#include "base/files/file.h"
#include "terrain/raster/raster_source.h"
#include "terrain/raster/vector/read_vector.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"

using namespace gonogo;
using namespace gonogo::terrain;
using test::make_raster;
namespace fs = std::filesystem;

namespace {

constexpr double kSurveyFoot = 1200.0 / 3937.0;

RasterSource heights(const fs::path& file) { return RasterSource::open_heights(file, {}, {}); }

Tile all_of(const RasterSource& source) { return source.read({0, 0, source.grid().columns, source.grid().rows}); }

long missing(const RasterSource& source) {
  const Tile tile = all_of(source);
  return std::count_if(tile.value.begin(), tile.value.end(), [](float v) { return std::isnan(v); });
}

std::string remarks(const RasterSource& source) {
  std::string text;
  for (const std::string& remark : source.remarks()) text += remark + "\n";
  return text;
}

/// 48 heights that rise eastward, a third of which is `code`.
std::vector<float> with_voids(float code) {
  std::vector<float> value;
  for (int i = 0; i < 48; ++i) value.push_back(i < 16 ? code : float(20 + i % 8));
  return value;
}

/// 40 x 40 cells of 10 m in UTM zone 10, from 500000, 4400000 on.
MapGrid grid_of(const TemporaryFolder& folder, const test::RasterRecipe& recipe = {.columns = 40, .rows = 40}) {
  make_raster(folder / "grid.tif", recipe);
  return RasterSource::open_as_it_lies(folder / "grid.tif").grid();
}

using Ring = std::vector<std::array<double, 2>>;

Ring square(double west, double south, double east, double north) {
  return {{west, south}, {east, south}, {east, north}, {west, north}, {west, south}};
}

std::string coordinates(const Ring& ring) {
  std::string text;
  for (const auto& [x, y] : ring)
    text += (text.empty() ? "[" : ", [") + std::to_string(x) + ", " + std::to_string(y) + "]";
  return "[" + text + "]";
}

/// Polygons, each of an outline and holes, in UTM zone 10 or in degrees.
void write_polygons(const fs::path& file, const std::vector<std::vector<Ring>>& polygons, bool degrees = false) {
  std::string shapes;
  for (const auto& rings : polygons) {
    std::string inner;
    for (const Ring& ring : rings) inner += (inner.empty() ? "" : ", ") + coordinates(ring);
    shapes += (shapes.empty() ? "[" : ", [") + inner + "]";
  }
  const std::string crs =
      degrees ? "" : R"("crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32610"}}, )";
  write_file_atomically(file, R"({"type": "FeatureCollection", )" + crs +
                                  R"("features": [{"type": "Feature", "properties": {}, "geometry": )" +
                                  R"({"type": "MultiPolygon", "coordinates": [)" + shapes + "]}}]}");
}

long marked(const std::vector<std::uint8_t>& cells) { return std::count(cells.begin(), cells.end(), 1); }

/// A place on the map's grid in degrees.
class ToDegrees {
 public:
  explicit ToDegrees(int epsg) {
    OGRSpatialReference from, to;
    from.importFromEPSG(epsg);
    to.importFromEPSG(4326);
    for (OGRSpatialReference* crs : {&from, &to}) crs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    turn_.reset(OGRCreateCoordinateTransformation(&from, &to));
  }
  std::array<double, 2> operator()(double x, double y) const {
    turn_->Transform(1, &x, &y);
    return {x, y};
  }

 private:
  std::unique_ptr<OGRCoordinateTransformation> turn_;
};

/// Sets the value of an entry of the first directory of a little-endian TIFF.
void set_tag(const fs::path& file, unsigned tag, std::uint16_t value) {
  std::string bytes = read_file(file);
  const auto at = [&](std::size_t place, std::size_t width) {
    std::size_t number = 0;
    for (std::size_t k = width; k-- > 0;) number = number << 8 | static_cast<unsigned char>(bytes[place + k]);
    return number;
  };
  const std::size_t directory = at(4, 4);
  for (std::size_t entry = directory + 2; entry < directory + 2 + 12 * at(directory, 2); entry += 12)
    if (at(entry, 2) == tag) {
      bytes[entry + 8] = char(value & 0xff);
      bytes[entry + 9] = char(value >> 8);
    }
  write_file_atomically(file, bytes);
}

template <class Call>
std::string refused_in_time(const Call& call) {
  const auto start = std::chrono::steady_clock::now();
  const std::string sentence = input_error(call);
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(10));
  return sentence;
}

}  // namespace

TEST_CASE("rgrass#66: the least whole number of 16 bits, undeclared, is no height") {
  const TemporaryFolder folder;
  make_raster(folder / "a.tif", {.nodata = {}, .value = with_voids(-32768), .type = GDT_Int16});
  CHECK(missing(heights(folder / "a.tif")) == 16);
  CHECK(contains(remarks(heights(folder / "a.tif")), "16 cells of the elevation hold -32768"));
}

TEST_CASE("gdal#2759: Surfer's blank, undeclared, is no height") {
  const TemporaryFolder folder;
  make_raster(folder / "a.tif", {.nodata = {}, .value = with_voids(1.70141e38f)});
  CHECK(missing(heights(folder / "a.tif")) == 16);
}

TEST_CASE("MDAL#104: where no nodata is declared, heights of 0 are heights") {
  const TemporaryFolder folder;
  std::vector<float> shore;
  for (int i = 0; i < 48; ++i) shore.push_back(std::max(0.f, float(i % 8) - 3));
  make_raster(folder / "a.tif", {.nodata = {}, .value = shore});
  CHECK(missing(heights(folder / "a.tif")) == 0);
  CHECK(remarks(heights(folder / "a.tif")).empty());
}

TEST_CASE("PDAL#2412, dem-stitcher#151: a height of a point lies in the middle of its cell") {
  const TemporaryFolder folder;
  CPLSetConfigOption("GTIFF_POINT_GEO_IGNORE", "TRUE");  // writes the corner as if it were the first point
  make_raster(folder / "point.tif", {});
  GDALDataset* raster = static_cast<GDALDataset*>(GDALOpen((folder / "point.tif").c_str(), GA_Update));
  raster->SetMetadataItem("AREA_OR_POINT", "Point");
  GDALClose(raster);
  CPLSetConfigOption("GTIFF_POINT_GEO_IGNORE", nullptr);
  const MapGrid grid = heights(folder / "point.tif").grid();
  CHECK(grid.west == 499995);
  CHECK(grid.north == 4400005);
}

TEST_CASE("gdal#14503: heights of a system in US survey feet, upright and along the ground, come in metres") {
  const TemporaryFolder folder;
  make_raster(folder / "a.tif", {.transform = {1650000, 30, 0, 1480000, 0, -30}, .crs = "EPSG:6529+6360"});
  const RasterSource source = heights(folder / "a.tif");
  CHECK(source.read({3, 3, 1, 1}).value[0] == Approx(33 * kSurveyFoot));
  CHECK(source.grid().cell_width_m() == Approx(30 * kSurveyFoot));
}

TEST_CASE("gdal#11491: GML in latitude and longitude marks the cells of the same polygon in metres") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of(folder);
  const Ring ring = square(500101, 4399801, 500199, 4399899);
  write_polygons(folder / "a.geojson", {{ring}});
  const ToDegrees degrees(32610);
  std::string places;
  for (const auto& [x, y] : ring) {
    const auto [longitude, latitude] = degrees(x, y);
    char text[80];
    std::snprintf(text, sizeof text, "%.9f %.9f ", latitude, longitude);
    places += text;
  }
  write_file_atomically(
      folder / "a.gml",
      R"(<?xml version="1.0" encoding="utf-8"?><ogr:FeatureCollection xmlns:ogr="http://ogr.maptools.org/" )"
      R"(xmlns:gml="http://www.opengis.net/gml/3.2" gml:id="c"><ogr:featureMember><ogr:a gml:id="a.1">)"
      R"(<ogr:geometryProperty><gml:Polygon srsName="urn:ogc:def:crs:EPSG::4326" gml:id="g"><gml:exterior>)"
      R"(<gml:LinearRing><gml:posList>)" +
          places +
          "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon></ogr:geometryProperty></ogr:a>"
          "</ogr:featureMember></ogr:FeatureCollection>");
  CHECK(marked(cells_under(folder / "a.geojson", grid)) == 100);
  CHECK(cells_under(folder / "a.gml", grid) == cells_under(folder / "a.geojson", grid));
}

TEST_CASE("gdal#8689: a polygon in the hole of another is closed, and the rest of the hole is open") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of(folder);
  write_polygons(folder / "a.geojson",
                 {{square(500051, 4399701, 500299, 4399949), square(500101, 4399751, 500249, 4399899)},
                  {square(500151, 4399821, 500179, 4399849)}});
  // 25 x 25 cells, less the 13 x 13 that lie wholly in the hole, and 3 x 3 again.
  CHECK(marked(cells_under(folder / "a.geojson", grid)) == 625 - 169 + 9);
}

TEST_CASE("geoparquet-io#911, xagg#60: a polygon that is cut at the antimeridian is whole on a map across it") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of(
      folder,
      {.columns = 60, .rows = 60, .epsg = 0, .transform = {179500, 10, 0, 8173300, 0, -10}, .crs = "EPSG:32701"});
  const ToDegrees degrees(32701);
  const auto [middle, latitude] = degrees(179800, 8173000);
  CHECK(std::abs(std::abs(middle) - 180) < 0.003);
  constexpr double kHalf = 0.0015;
  const double south = latitude - kHalf, north = latitude + kHalf;
  write_polygons(folder / "a.geojson",
                 {{square(180 - kHalf, south, 180, north)}, {square(-180, south, -180 + kHalf, north)}}, true);
  const auto cells = cells_under(folder / "a.geojson", grid);
  int inside = 0, wrong = 0;
  for (int row = 0; row < 60; ++row)
    for (int column = 0; column < 60; ++column) {
      int corners = 0;
      for (const int dr : {0, 1})
        for (const int dc : {0, 1}) {
          const auto [x, y] = degrees(179500 + 10.0 * (column + dc), 8173300 - 10.0 * (row + dr));
          corners += 180 - std::abs(x) < kHalf && y > south && y < north;
        }
      inside += corners == 4;
      if (corners == 0 || corners == 4) wrong += cells[std::size_t(60 * row + column)] != (corners == 4);
    }
  CHECK(inside > 500);
  CHECK(wrong <= 4);  // an edge may cut a cell between two of its corners
}

TEST_CASE("rasterio#2244: a polygon that crosses itself closes the cells of its two triangles") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of(folder);
  const std::array<double, 2> nw{500101, 4399899}, ne{500199, 4399899}, sw{500101, 4399801}, se{500199, 4399801},
      middle{500150, 4399850};
  write_polygons(folder / "bow.geojson", {{{nw, se, ne, sw, nw}}});
  write_polygons(folder / "two.geojson", {{{nw, middle, sw, nw}}, {{ne, se, middle, ne}}});
  const auto bow = cells_under(folder / "bow.geojson", grid);
  CHECK(marked(bow) > 50);
  CHECK(bow == cells_under(folder / "two.geojson", grid));
}

TEST_CASE("gcd#349: heights above a vertical datum are taken as they are") {
  const TemporaryFolder folder;
  make_raster(folder / "a.tif", {.crs = "EPSG:6341+5703"});
  CHECK(heights(folder / "a.tif").read({3, 3, 1, 1}).value[0] == 33);
}

TEST_CASE("polar2grid#79: longitudes up to 360 are those that are less by 360") {
  const TemporaryFolder folder;
  const auto map = [&](double west) {
    make_raster(folder / "a.tif",
                {.columns = 20, .rows = 20, .transform = {west, 1e-4, 0, 39.5, 0, -1e-4}, .crs = "EPSG:4326"});
    return heights(folder / "a.tif");
  };
  const RasterSource east = map(237.5), west = map(-122.5);
  CHECK(east.grid().crs_code == "EPSG:32610");
  CHECK(east.grid().west == Approx(west.grid().west));
  const Tile a = all_of(east), b = all_of(west);
  REQUIRE(a.value.size() == b.value.size());
  for (std::size_t i = 0; i < a.value.size(); ++i) {
    CHECK(std::isnan(a.value[i]) == std::isnan(b.value[i]));
    if (!std::isnan(a.value[i])) CHECK(a.value[i] == Approx(b.value[i]).margin(1e-3));
  }
}

TEST_CASE("geopandas#3332: KML holds longitude before latitude") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of(folder);
  const Ring ring = square(500101, 4399801, 500199, 4399899);
  const ToDegrees degrees(32610);
  std::string places;
  for (const auto& [x, y] : ring) {
    char text[80];
    std::snprintf(text, sizeof text, "%.9f,%.9f,0 ", degrees(x, y)[0], degrees(x, y)[1]);
    places += text;
  }
  write_file_atomically(
      folder / "a.kml",
      R"(<?xml version="1.0"?><kml xmlns="http://www.opengis.net/kml/2.2"><Document><Placemark><Polygon>)"
      "<outerBoundaryIs><LinearRing><coordinates>" +
          places + "</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark></Document></kml>");
  write_polygons(folder / "a.geojson", {{ring}});
  CHECK(cells_under(folder / "a.kml", grid) == cells_under(folder / "a.geojson", grid));
}

TEST_CASE("gdal#12648: an ASCII grid that claims a thousand million columns is refused at once") {
  const TemporaryFolder folder;
  write_file_atomically(folder / "a.asc",
                        "ncols 1000000000\nnrows 1000000000\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2 3\n");
  write_file_atomically(folder / "a.asc.aux.xml", "<PAMDataset><SRS>EPSG:32610</SRS></PAMDataset>");
  CHECK(contains(refused_in_time([&] { heights(folder / "a.asc"); }), "a.asc"));
}

TEST_CASE("gdal#14400, xarray-spatial#1184: a TIFF that claims a size beyond its bytes is refused at once") {
  const TemporaryFolder folder;
  const auto claiming = [&](const std::vector<std::pair<unsigned, std::uint16_t>>& tags) {
    make_raster(folder / "a.tif", {});
    for (const auto& [tag, value] : tags) set_tag(folder / "a.tif", tag, value);
    return refused_in_time([&] { missing(heights(folder / "a.tif")); });
  };
  CHECK(contains(claiming({{277, 65529}}), "a.tif"));                // samples of a pixel
  CHECK(contains(claiming({{256, 60000}, {257, 60000}}), "a.tif"));  // columns and rows
}

TEST_CASE("nlohmann/json#5387, #1835: a file of 200,000 brackets is refused, not the end of the program") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of(folder);
  const std::string brackets = std::string(200000, '[') + std::string(200000, ']');
  write_file_atomically(folder / "a.geojson",
                        R"({"type": "FeatureCollection", "features": [{"type": "Feature", "geometry": )"
                        R"({"type": "Polygon", "coordinates": )" +
                            brackets + R"(}, "properties": {}}]})");
  CHECK(contains(refused_in_time([&] { cells_under(folder / "a.geojson", grid); }), "a.geojson"));
}
