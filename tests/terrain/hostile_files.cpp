// Files that are damaged, lie the other way up, or name hosts and other files.
#include <arpa/inet.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "base/files/file.h"
#include "terrain/raster/gdal_support.h"
#include "terrain/raster/raster_source.h"
#include "terrain/raster/vector/read_vector.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"
#include "tests/terrain/vector_maker.h"

using namespace gonogo;
using namespace gonogo::terrain;
using test::make_raster;
using test::make_squares;
namespace fs = std::filesystem;

namespace {

/// 40 x 40 cells of 10 m in UTM zone 10.
MapGrid grid_of_test(const TemporaryFolder& folder) {
  make_raster(folder / "grid.tif", {.columns = 40, .rows = 40});
  return RasterSource::open_as_it_lies(folder / "grid.tif").grid();
}

void cut(const fs::path& file, double share) {
  fs::resize_file(file, std::uintmax_t(share * double(fs::file_size(file))));
}

int marked(const std::vector<std::uint8_t>& cells) { return int(std::count(cells.begin(), cells.end(), 1)); }

void write_geometry(const fs::path& file, const std::string& wkt) {
  GDALAllRegister();
  GDALDataset* out =
      GetGDALDriverManager()->GetDriverByName("GPKG")->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr);
  OGRSpatialReference crs;
  crs.importFromEPSG(32610);
  OGRLayer* layer = out->CreateLayer("shapes", &crs, wkbUnknown, nullptr);
  OGRGeometry* geometry = nullptr;
  REQUIRE(OGRGeometryFactory::createFromWkt(wkt.c_str(), nullptr, &geometry) == OGRERR_NONE);
  OGRFeature* feature = OGRFeature::CreateFeature(layer->GetLayerDefn());
  feature->SetGeometryDirectly(geometry);
  REQUIRE(layer->CreateFeature(feature) == OGRERR_NONE);
  OGRFeature::DestroyFeature(feature);
  GDALClose(out);
}

}  // namespace

TEST_CASE("a vector file that is cut off anywhere is refused, and the whole one is read") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of_test(folder);
  struct Case {
    const char *format, *file, *damaged;
  };
  const auto [format, name, damaged] =
      GENERATE(Case{"ESRI Shapefile", "a.shp", "a.shp"}, Case{"ESRI Shapefile", "a.shp", "a.dbf"},
               Case{"ESRI Shapefile", "a.shp", "a.shx"}, Case{"GeoJSON", "a.geojson", "a.geojson"},
               Case{"GPKG", "a.gpkg", "a.gpkg"}, Case{"FlatGeobuf", "a.fgb", "a.fgb"});
  INFO(damaged);
  make_squares(folder / name, format);
  CHECK(marked(cells_under(folder / name, grid)) == 40);
  for (const double share : {0.97, 0.8, 0.5, 0.3}) {
    INFO(share);
    cut(folder / damaged, share);
    CHECK(contains(input_error([&] { cells_under(folder / name, grid); }), std::string(folder / name)));
    ShapeCells cells(grid);
    CHECK_FALSE(input_error([&] {
                  cells.add(folder / name, "", [](const FeatureNumbers&) { return ShapeMark{.value = 1}; });
                }).empty());
  }
}

TEST_CASE("line-separated GeoJSON with a line that is cut off is refused") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of_test(folder);
  make_squares(folder / "a.geojsonl", "GeoJSONSeq");
  const int whole = marked(cells_under(folder / "a.geojsonl", grid));
  CHECK(whole >= 40);
  fs::resize_file(folder / "a.geojsonl", fs::file_size(folder / "a.geojsonl") - 40);
  CHECK(contains(input_error([&] { cells_under(folder / "a.geojsonl", grid); }), "damaged or incomplete"));
}

TEST_CASE("points of a grid that are cut off within a line are refused") {
  const TemporaryFolder folder;
  std::string points;
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 8; ++column)
      points += std::to_string(500005 + 10 * column) + " " + std::to_string(4399995 - 10 * row) + " " +
                std::to_string(100 + column + 10 * row) + "\n";
  write_file_atomically(folder / "a.xyz.aux.xml", "<PAMDataset><SRS>EPSG:32610</SRS></PAMDataset>");
  const auto sentence = [&](std::size_t length) {
    write_file_atomically(folder / "a.xyz", points.substr(0, length));
    return input_error([&] { RasterSource::open_heights(folder / "a.xyz", {}, {}); });
  };
  CHECK(sentence(points.size()).empty());
  CHECK(sentence(points.size() - 1).empty());  // all points, without a line end
  const std::size_t line = points.size() / 48;
  for (std::size_t length = 21 * line + 1; length < 22 * line; ++length) {
    INFO(length);
    CHECK_FALSE(sentence(length).empty());
  }
  CHECK(contains(sentence(22 * line - 2),
                 "is cut off: its last line has no end, and the grid of its points has 24 cells for 22 points"));
}

TEST_CASE("curves, collections and surfaces mark the cells of their straight forms") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of_test(folder);
  const auto cells_of = [&](const std::string& wkt) {
    fs::remove(folder / "shape.gpkg");
    write_geometry(folder / "shape.gpkg", wkt);
    return cells_under(folder / "shape.gpkg", grid);
  };
  // A circle of 100 m: pi r2 is 314 cells of 100 m2, and the rim touches at most 4 (2 r / cell) more.
  const int circle = marked(cells_of(
      "CURVEPOLYGON(CIRCULARSTRING(500100 4399800,500200 4399900,500300 4399800,500200 4399700,500100 4399800))"));
  CHECK(circle >= 314);
  CHECK(circle <= 314 + 80);
  const std::string square = "((500101 4399899,500199 4399899,500199 4399801,500101 4399801,500101 4399899))";
  const auto straight = cells_of("POLYGON" + square);
  CHECK(marked(straight) == 100);
  CHECK(cells_of("GEOMETRYCOLLECTION(POLYGON" + square + ")") == straight);
  CHECK(cells_of("MULTISURFACE(" + square + ")") == straight);
  CHECK(cells_of("POLYHEDRALSURFACE(" + square + ")") == straight);
  CHECK(cells_of("TIN(((500101 4399899,500199 4399899,500199 4399801,500101 4399899)),"
                 "((500101 4399899,500199 4399801,500101 4399801,500101 4399899)))") == straight);
}

TEST_CASE("a polygon with a corner that is no number is refused, and one without a shape is none") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of_test(folder);
  const auto cells_of = [&](const std::string& corner, const std::string& first = "") {
    write_file_atomically(
        folder / "a.geojson",
        R"({"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32610"}},)"
        R"( "features": [)" +
            first +
            R"({"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [[)"
            "[500101, 4399801], [" +
            corner + R"(, 4399801], [500199, 4399899], [500101, 4399899], [500101, 4399801]]]}}]})");
    return marked(cells_under(folder / "a.geojson", grid));
  };
  CHECK(cells_of("500199") == 100);
  for (const char* corner : {"NaN", "Infinity", "1e999"})
    CHECK(contains(input_error([&] { cells_of(corner); }), "feature 0: has no place in the map's coordinate system"));
  for (const char* geometry : {"null", R"({"type": "Polygon", "coordinates": []})"})
    CHECK(cells_of("500199", R"({"type": "Feature", "properties": {}, "geometry": )" + std::string(geometry) + "}, ") ==
          100);
}

TEST_CASE("a GeoJSON file of which GDAL drops a shape without a word is refused with the number of them") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of_test(folder);
  const std::string whole =
      R"("coordinates": [[[500101, 4399801], [500199, 4399801], [500199, 4399899], [500101, 4399801]]])";
  const std::string crs = R"("crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32610"}})";
  const auto feature = [](const std::string& shape) {
    return R"({"type": "Feature", "properties": {}, "geometry": )" + shape + "}";
  };
  const auto read = [&](const std::string& second) {
    write_file_atomically(folder / "a.geojson", R"({"type": "FeatureCollection", )" + crs + R"(, "features": [)" +
                                                    feature(R"({"type": "Polygon", )" + whole + "}") + ", " +
                                                    feature(second) + "]}");
    return input_error([&] { cells_under(folder / "a.geojson", grid); });
  };
  for (const char* none :
       {"null", R"({"type": "Polygon", "coordinates": []})", R"({"type": "MultiPolygon", "coordinates": [[]]})"}) {
    INFO(none);
    CHECK(read(none).empty());
  }
  for (const std::string& dropped :
       {std::string(R"({"type": "Polygon", "coordinates": "x"})"), R"({"type": "Polgon", )" + whole + "}",
        std::string(R"({"type": "Polygon", "coordinates": [[500301, 4399671], [500329, 4399671], [500301, 4399671]]})"),
        std::string(R"({"type": "Polygon", "coordinates": [[[500301, 4399671], null, [500301, 4399671]]]})")}) {
    INFO(dropped);
    CHECK(contains(read(dropped), "2 features state a shape, and only 1 of them can be read"));
  }
}

TEST_CASE("edges that are straight in degrees are curved on the map, as their parallels are") {
  const TemporaryFolder folder;
  make_raster(folder / "grid.tif", {.columns = 200, .rows = 200, .transform = {400000, 1000, 0, 4500000, 0, -1000}});
  const MapGrid grid = RasterSource::open_as_it_lies(folder / "grid.tif").grid();
  write_file_atomically(
      folder / "a.geojson",
      R"({"type": "Polygon", "coordinates": [[[-124, 39], [-122, 39], [-122, 40], [-124, 40], [-124, 39]]]})");
  const auto cells = cells_under(folder / "a.geojson", grid);
  OGRSpatialReference utm, degrees;
  utm.importFromEPSG(32610);
  degrees.importFromEPSG(4326);
  for (OGRSpatialReference* crs : {&utm, &degrees}) crs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> to_degrees(OGRCreateCoordinateTransformation(&utm, &degrees));
  const auto is_inside = [&](double column, double row) {
    double x = 400000 + 1000 * column, y = 4500000 - 1000 * row;
    to_degrees->Transform(1, &x, &y);
    return x > -124 && x < -122 && y > 39 && y < 40;
  };
  int wrong = 0, on_the_edge = 0;
  for (int row = 0; row < 200; ++row)
    for (int column = 0; column < 200; ++column) {
      int corners = 0;
      for (const int dr : {0, 1})
        for (const int dc : {0, 1}) corners += is_inside(column + dc, row + dr);
      const int mark = cells[std::size_t(200 * row + column)];
      if (corners == 0 || corners == 4) wrong += mark != (corners == 4);
      on_the_edge += corners > 0 && corners < 4;
    }
  CHECK(wrong <= 4);  // an edge may cut a cell between two corners; the chord of the parallel misses it by 470 m
  CHECK(on_the_edge > 400);
}

TEST_CASE("a raster whose first row is the southern one reads as the one the other way up") {
  const TemporaryFolder folder;
  std::vector<float> value, upside_down;
  for (int i = 0; i < 48; ++i) value.push_back(float(i * i % 97));
  value[13] = -9999;
  for (int row = 5; row >= 0; --row)
    upside_down.insert(upside_down.end(), &value[std::size_t(8 * row)], &value[std::size_t(8 * row)] + 8);
  make_raster(folder / "north.tif", {.value = value, .scale = 0.5, .offset = 3});
  make_raster(folder / "south.tif",
              {.transform = {500000, 10, 0, 4399940, 0, 10}, .value = upside_down, .scale = 0.5, .offset = 3});
  const RasterSource north = RasterSource::open_elevation(folder / "north.tif");
  const RasterSource south = RasterSource::open_elevation(folder / "south.tif");
  CHECK(north.grid().north == south.grid().north);
  CHECK(north.grid().cell_height == south.grid().cell_height);
  const Tile a = north.read({0, 0, 8, 6}), b = south.read({0, 0, 8, 6});
  for (std::size_t i = 0; i < a.value.size(); ++i) {
    CHECK(std::isnan(a.value[i]) == std::isnan(b.value[i]));
    if (!std::isnan(a.value[i])) CHECK(a.value[i] == b.value[i]);
  }
}

TEST_CASE("a site grid that nobody related to the globe has cells in metres") {
  const TemporaryFolder folder;
  const std::string site = R"(LOCAL_CS["site",UNIT["metre",1]])";
  make_raster(folder / "site.tif", {.transform = {1000, 0.5, 0, 2040, 0, -0.5}, .crs = site});
  const RasterSource source = RasterSource::open_heights(folder / "site.tif", {}, {});
  CHECK(source.grid().cell_width_m() == 0.5);
  CHECK_FALSE(place_on_globe(source.grid()).place.has_value());
  const RasterSource again = RasterSource::open_on_grid(folder / "site.tif", source.grid(), RasterKind::continuous);
  CHECK(again.read({2, 2, 1, 1}).value[0] == source.read({2, 2, 1, 1}).value[0]);
  make_raster(folder / "globe.tif", {});
  CHECK(contains(
      input_error([&] { RasterSource::open_on_grid(folder / "globe.tif", source.grid(), RasterKind::continuous); }),
      "not related to the globe"));
}

TEST_CASE("datums of the Earth's centre are taken with a remark in metres, others are refused") {
  const TemporaryFolder folder;
  const auto remarks = [&](const std::string& map, const std::string& other, double cell, double north = 4400000) {
    make_raster(folder / "map.tif", {.transform = {500000, cell, 0, 4400000, 0, -cell}, .crs = map});
    make_raster(folder / "other.tif", {.transform = {500000, cell, 0, north, 0, -cell}, .crs = other});
    const MapGrid grid = RasterSource::open_as_it_lies(folder / "map.tif").grid();
    const RasterSource source = RasterSource::open_on_grid(folder / "other.tif", grid, RasterKind::continuous);
    std::string text;
    for (const std::string& remark : source.remarks()) text += remark;
    return text;
  };
  CHECK(contains(remarks("EPSG:4509", "EPSG:32650", 30, 0.9996 * 4400000), "up to 2.5 m"));  // CGCS2000, WGS 84
  CHECK(contains(remarks("EPSG:22210", "EPSG:32610", 30), "up to 2.5 m"));                   // NAD83(CSRS)v7
  CHECK(remarks("EPSG:32610", "EPSG:32610", 30).empty());
  CHECK(contains(input_error([&] { remarks("EPSG:4509", "EPSG:32650", 2); }), "more than half of a cell of 2 m"));
  CHECK(contains(input_error([&] { remarks("EPSG:4509", "EPSG:21460", 30); }), "hundreds of metres"));  // Beijing 1954
}

TEST_CASE("what an attribute raster cannot hold is left out and named") {
  const TemporaryFolder folder;
  const MapGrid grid = [&] {
    make_raster(folder / "grid.tif", {});
    return RasterSource::open_as_it_lies(folder / "grid.tif").grid();
  }();
  const float code = GENERATE(-9999.f, -32768.f, -3.4028235e38f, 1e20f);
  std::vector<float> value(48, 40.f);
  for (std::size_t i = 0; i < 16; ++i) value[i] = code;
  const ValueRange range{0, 1000, "cone index"};
  make_raster(folder / "cone.tif", {.nodata = {}, .value = value});
  const RasterSource source = RasterSource::open_on_grid(folder / "cone.tif", grid, RasterKind::continuous, range);
  REQUIRE(source.remarks().size() == 1);
  CHECK(contains(source.remarks()[0], "16 cells"));
  const Tile tile = source.read({0, 0, 8, 6});
  for (std::size_t i = 0; i < 48; ++i) CHECK(std::isnan(tile.value[i]) == (i < 16));
  make_raster(folder / "cone.tif", {.nodata = -3.4e38, .value = std::vector<float>(48, -3.4028235e38f)});
  const RasterSource digits = RasterSource::open_on_grid(folder / "cone.tif", grid, RasterKind::continuous, range);
  CHECK(std::isnan(digits.read({3, 3, 1, 1}).value[0]));
}

TEST_CASE("a code that scale or type make a possible value is left out where it lies far from all others") {
  const TemporaryFolder folder;
  make_raster(folder / "grid.tif", {});
  const MapGrid grid = RasterSource::open_as_it_lies(folder / "grid.tif").grid();
  const ValueRange range{0, 2000, "water content [%]"};
  const auto missing = [&](const test::RasterRecipe& recipe) {
    make_raster(folder / "water.tif", recipe);
    const RasterSource source = RasterSource::open_on_grid(folder / "water.tif", grid, RasterKind::continuous, range);
    const Tile tile = source.read({0, 0, 8, 6});
    CHECK(source.remarks().size() == std::size_t(std::isnan(tile.value[0])));
    return std::count_if(tile.value.begin(), tile.value.end(), [](float v) { return std::isnan(v); });
  };
  std::vector<float> value(48, 20.f);
  std::fill_n(value.begin(), 16, 255.f);
  CHECK(missing({.nodata = {}, .value = value, .type = GDT_Byte}) == 16);
  value[47] = 230;  // the byte's end is a value among others
  CHECK(missing({.nodata = {}, .value = value, .type = GDT_Byte}) == 0);
  std::fill_n(value.begin(), 16, -9999.f);
  CHECK(missing({.nodata = {}, .value = value, .scale = 0.01, .offset = 100}) == 16);
}

TEST_CASE("rows of a Shapefile that are marked as deleted are no damage") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of_test(folder);
  make_squares(folder / "a.shp", "ESRI Shapefile");
  GDALDataset* file =
      GDALDataset::Open((folder / "a.shp").c_str(), GDAL_OF_VECTOR | GDAL_OF_UPDATE, nullptr, nullptr, nullptr);
  for (const GIntBig id : {3, 17}) REQUIRE(file->GetLayer(0)->DeleteFeature(id) == OGRERR_NONE);
  GDALClose(file);
  CHECK(marked(cells_under(folder / "a.shp", grid)) == 38);
}

TEST_CASE("raw rasters and classic NetCDF that are cut off are refused") {
  const TemporaryFolder folder;
  struct Case {
    const char *format, *file;
  };
  const auto [format, name] = GENERATE(Case{"ENVI", "a.dat"}, Case{"PCRaster", "a.map"}, Case{"netCDF", "a.nc"},
                                       Case{"SAGA", "a.sdat"}, Case{"EHdr", "a.bil"});
  INFO(format);
  make_raster(folder / "a.tif", {.columns = 30, .rows = 30});
  GDALDataset* source = GDALDataset::Open((folder / "a.tif").c_str());
  GDALClose(GetGDALDriverManager()->GetDriverByName(format)->CreateCopy((folder / name).c_str(), source, FALSE, nullptr,
                                                                        nullptr, nullptr));
  GDALClose(source);
  const auto opening = [&] {
    return input_error([&] {
      const RasterSource whole = RasterSource::open_elevation(folder / name);
      whole.read({0, 0, 30, 30});
    });
  };
  CHECK(opening().empty());
  fs::resize_file(folder / name, fs::file_size(folder / name) - 40);
  CHECK(contains(opening(), std::string(folder / name)));
}

TEST_CASE("a stored -9999 under a scale is a height where the ground goes on around it") {
  const TemporaryFolder folder;
  std::vector<float> value;
  for (int i = 0; i < 60 * 60; ++i) value.push_back(float(-9999 + i / 60 - 30));
  make_raster(folder / "moon.tif",
              {.columns = 60, .rows = 60, .nodata = -32768, .value = value, .scale = 0.5, .type = GDT_Int16});
  const RasterSource source = RasterSource::open_heights(folder / "moon.tif", {}, {});
  CHECK(source.remarks().empty());
  CHECK(source.read({10, 30, 1, 1}).value[0] == -4999.5f);
}

TEST_CASE("files that name hosts or bytes of other files are refused before anything is asked of them") {
  const TemporaryFolder folder;
  const int listener = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(bind(listener, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
  REQUIRE(listen(listener, 8) == 0);
  socklen_t size = sizeof address;
  getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size);
  const std::string host = "127.0.0.1:" + std::to_string(ntohs(address.sin_port));
  const MapGrid grid = grid_of_test(folder);
  const std::string head =
      R"(<VRTDataset rasterXSize="8" rasterYSize="6"><SRS>EPSG:32610</SRS>)"
      R"(<GeoTransform>500000,10,0,4400000,0,-10</GeoTransform><VRTRasterBand dataType="Float32" band="1")";
  write_file_atomically(folder / "secret.txt", std::string(4000, 'x'));
  write_file_atomically(folder / "url.vrt", head + "><SimpleSource><SourceFilename>/vsicurl/http://" + host +
                                                "/a.tif</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>");
  write_file_atomically(folder / "raw.vrt",
                        head +
                            " subClass=\"VRTRawRasterBand\"><SourceFilename relativeToVRT=\"1\">secret.txt"
                            "</SourceFilename></VRTRasterBand></VRTDataset>");
  write_file_atomically(folder / "wms.tif", "<GDAL_WMS><Service name=\"TMS\"><ServerUrl>http://" + host +
                                                "/${z}/${x}/${y}.png</ServerUrl></Service></GDAL_WMS>");
  for (const char* name : {"url.vrt", "raw.vrt", "wms.tif"}) {
    INFO(name);
    CHECK(contains(input_error([&] { RasterSource::open_elevation(folder / name); }), "--allow-network"));
  }
  const std::string shape =
      R"("features":[{"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":)"
      R"([[[500001,4399999],[500009,4399999],[500009,4399991],[500001,4399999]]]}}]})";
  write_file_atomically(folder / "link.geojson",
                        R"({"type":"FeatureCollection","crs":{"type":"link","properties":{"href":"http://)" + host +
                            R"(/crs"}},)" + shape);
  write_file_atomically(folder / "wfs.xml", "<OGRWFSDataSource><URL>http://" + host + "/wfs</URL></OGRWFSDataSource>");
  write_file_atomically(folder / "ogr.vrt",
                        "<OGRVRTDataSource><OGRVRTLayer name=\"a\"><SrcDataSource>/vsicurl/http://" + host +
                            "/a.geojson</SrcDataSource></OGRVRTLayer></OGRVRTDataSource>");
  for (const char* name : {"link.geojson", "wfs.xml", "ogr.vrt"}) {
    INFO(name);
    CHECK_FALSE(input_error([&] { cells_under(folder / name, grid); }).empty());
  }
  CHECK(accept(listener, nullptr, nullptr) < 0);  // nobody called
  close(listener);
  REQUIRE(mkfifo((folder / "pipe.tif").c_str(), 0600) == 0);
  CHECK(
      contains(input_error([&] { RasterSource::open_elevation(folder / "pipe.tif"); }), "neither a file nor a folder"));
}

TEST_CASE("a raster in a zip is read, and of several none") {
  const TemporaryFolder folder;
  make_raster(folder / "a.tif", {});
  VSILFILE* zip = VSIFOpenL(("/vsizip/" + (folder / "one.zip").string() + "/a.tif").c_str(), "wb");
  REQUIRE(zip != nullptr);
  const std::string bytes = read_file(folder / "a.tif");
  VSIFWriteL(bytes.data(), 1, bytes.size(), zip);
  VSIFCloseL(zip);
  CHECK(RasterSource::open_elevation(folder / "one.zip").read({3, 2, 1, 1}).value[0] == 23);
  CHECK(files_behind(folder / "one.zip") == std::vector<fs::path>{folder / "one.zip"});
}
