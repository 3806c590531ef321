// Files of shapes as nobody should hand them over: each marks the cells that it says, or is refused in a sentence.
#include <filesystem>
#include <functional>

#include "base/error.h"
#include "base/files/file.h"
#include "terrain/raster/raster_source.h"
#include "terrain/raster/vector/read_vector.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"
#include "tests/terrain/vector_maker.h"

using namespace gonogo;
using namespace gonogo::terrain;
namespace fs = std::filesystem;

namespace {

constexpr long kSquare = 100;  // cells

const std::string kCrs = R"("crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32610"}})";
const std::string kRing =
    "[[500101, 4399801], [500199, 4399801], [500199, 4399899], [500101, 4399899], [500101, 4399801]]";
const std::string kPolygon = R"({"type": "Polygon", "coordinates": [)" + kRing + "]}";

std::string feature(const std::string& geometry, const std::string& more = "") {
  return R"({"type": "Feature", "properties": {}, )" + more + R"("geometry": )" + geometry + "}";
}

std::string collection(const std::string& features, const std::string& crs = kCrs + ", ") {
  return R"({"type": "FeatureCollection", )" + crs + R"("features": [)" + features + "]}";
}

std::string one(const std::string& geometry) { return collection(feature(geometry)); }

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

struct Case {
  std::string name, text;
  long cells = kSquare;   // that are marked
  std::string said = "";  // by the refusal; empty: it is taken
};

const std::string kDropped = "and only 1 of them can be read", kNowhere = "has no place in the map's coordinate system";

std::vector<Case> geojson_cases() {
  const std::string
      whole = feature(kPolygon),
      hole = "[[500121, 4399821], [500121, 4399879], [500179, 4399879], [500179, 4399821], [500121, 4399821]]";
  const auto second = [&](const std::string& geometry) { return collection(whole + ", " + feature(geometry)); };
  return {
      {"plain", one(kPolygon)},
      {"a single feature", replaced(feature(kPolygon), "{", "{" + kCrs + ", ")},
      {"a single shape", replaced(kPolygon, "{", "{" + kCrs + ", ")},
      {"a byte order mark", "\xef\xbb\xbf" + one(kPolygon)},
      {"heights", one(replaced(kPolygon, "4399801]", "4399801, 99.5]"))},
      {"not closed", one(replaced(kPolygon, ", [500101, 4399801]]", "]"))},
      {"the other way round",
       one(R"({"type": "Polygon", "coordinates": [[[500101, 4399801], [500101, 4399899], [500199, 4399899], [500199, 4399801], [500101, 4399801]]]})")},
      {"corners twice", one(replaced(kPolygon, "[500199, 4399801]", "[500199, 4399801], [500199, 4399801]"))},
      {"a spike without width",
       one(replaced(kPolygon, "[500101, 4399899]",
                    "[500150, 4399899], [500150, 4399890], [500150, 4399899], [500101, 4399899]"))},
      {"whole numbers with points", one(replaced(kPolygon, "500199", "500199.000"))},
      {"exponents", one(replaced(kPolygon, "500199", "5.00199E5"))},
      {"many of one kind", one(R"({"type": "MultiPolygon", "coordinates": [[)" + kRing + "]]}")},
      {"a collection", one(R"({"type": "GeometryCollection", "geometries": [)" + kPolygon + "]}")},
      {"a collection in a collection",
       one(R"({"type": "GeometryCollection", "geometries": [{"type": "GeometryCollection", "geometries": [)" +
           kPolygon + "]}]}")},
      {"twice the same", collection(whole + ", " + whole)},
      {"a hole", one(R"({"type": "Polygon", "coordinates": [)" + kRing + ", " + hole + "]}"), kSquare - 16},
      {"geometry twice, the last counts", collection(feature(kPolygon, R"("geometry": null, )"))},
      {"null beside it", second("null")},
      {"an empty polygon beside it", second(R"({"type": "Polygon", "coordinates": []})")},
      {"an empty collection beside it", second(R"({"type": "GeometryCollection", "geometries": []})")},
      {"one far away beside it", second(replaced(kPolygon, "[500101", "[400101")), -1},
      {"coordinates a text", second(R"({"type": "Polygon", "coordinates": "x"})"), 0, kDropped},
      {"a misspelt type", second(replaced(kPolygon, "Polygon", "Polgon")), 0, kDropped},
      {"misspelt coordinates", second(replaced(kPolygon, "coordinates", "coords")), 0, "a.geojson"},
      {"a ring short of brackets", second(R"({"type": "Polygon", "coordinates": )" + kRing + "}"), 0, kDropped},
      {"a corner of one number", second(replaced(kPolygon, "[500199, 4399801]", "[500199]")), 0, kDropped},
      {"a corner null", second(replaced(kPolygon, "[500199, 4399801]", "null")), 0, kDropped},
      {"a number in quotes", one(replaced(kPolygon, "500199", "\"500199\"")), 0, "reading its features failed"},
      {"NaN", one(replaced(kPolygon, "500199", "NaN")), 0, kNowhere},
      {"infinity", one(replaced(kPolygon, "500199", "1e999")), 0, kNowhere},
      {"far off any globe", one(replaced(kPolygon, "500199", "500199e9")), 0, kNowhere},
      {"metres that count as degrees", collection(whole, ""), 0, "name the system that it is in with"},
      {"latitude first",
       collection(
           feature(
               R"({"type": "Polygon", "coordinates": [[[39.7, -123], [39.7, -122.9], [39.8, -122.9], [39.7, -123]]]})"),
           ""),
       0, "if latitudes stand first"},
      {"a point", one(R"({"type": "Point", "coordinates": [500150, 4399850]})"), 0, "no polygon (Point)"},
      {"a point beside it", second(R"({"type": "Point", "coordinates": [500150, 4399850]})"), 0, "no polygon (Point)"},
      {"a line", one(R"({"type": "LineString", "coordinates": )" + kRing + "}"), 0, "no polygon"},
      {"another place",
       one(replaced(replaced(replaced(kPolygon, "[500101", "[600101"), "[500199", "[600199"), "[500101", "[600101")),
       -1},
      {"a trailing comma", replaced(one(kPolygon), "}]}", "},]}"), 0, "cannot be read"},
      {"the last bracket missing", one(kPolygon).substr(0, one(kPolygon).size() - 2), 0, "cannot be read"},
      {"no shapes", collection(""), 0, "a.geojson"},
      {"nothing", "", 0, "a.geojson"},
      {"a picture", "\x89PNG\r\n\x1a\n and more", 0, "a.geojson"},
  };
}

long cells_or(const fs::path& file, const MapGrid& grid, std::string& said) {
  long count = 0;
  said = input_error([&] {
    for (const std::uint8_t cell : cells_under(file, grid)) count += cell;
  });
  return count;
}

MapGrid grid_of(const TemporaryFolder& folder) {
  test::make_raster(folder / "grid.tif", {.columns = 40, .rows = 40});
  return RasterSource::open_as_it_lies(folder / "grid.tif").grid();
}

}  // namespace

TEST_CASE("forty files of GeoJSON mark the cells that they say, or are refused in a sentence") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of(folder);
  for (const Case& c : geojson_cases()) {
    INFO(c.name);
    write_file_atomically(folder / "a.geojson", c.text);
    std::string said;
    const long cells = cells_or(folder / "a.geojson", grid, said);
    if (c.said.empty()) {
      CHECK(said == "");
      if (c.cells >= 0) CHECK(cells == c.cells);
    } else {
      CHECK(contains(said, c.said));
      CHECK(contains(said, (folder / "a.geojson").string()));
      CHECK_FALSE(contains(said, "\n"));
    }
  }
}

TEST_CASE("a Shapefile without one of its files, in capitals, or in a .zip is read or refused in a sentence") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of(folder);
  const auto result = [&](const std::function<void(const fs::path&)>& change, const std::string& opened) {
    const TemporaryFolder place;
    test::make_squares(place / "a.shp", "ESRI Shapefile");
    change(place.path());
    std::string said;
    const long cells = cells_or(place / opened, grid, said);
    return said.empty() ? std::to_string(cells) : said;
  };
  const std::string whole = result([](const fs::path&) {}, "a.shp");
  CHECK(whole == "40");
  CHECK(contains(result([](const fs::path& p) { fs::remove(p / "a.prj"); }, "a.shp"), "names no coordinate system"));
  CHECK(contains(result([](const fs::path& p) { fs::remove(p / "a.shx"); }, "a.shp"), "a.shp: "));
  CHECK(result([](const fs::path& p) { fs::remove(p / "a.dbf"); }, "a.shp") == whole);
  CHECK(contains(result([](const fs::path& p) { fs::remove(p / "a.shp"); }, "a.shp"), "no such file"));
  CHECK(contains(result([](const fs::path& p) { fs::resize_file(p / "a.shp", 0); }, "a.shp"), "a.shp: "));
  CHECK(result(
            [](const fs::path& p) {
              for (const char* of : {"shp", "shx", "dbf", "prj"}) {
                std::string upper = of;
                for (char& c : upper) c = char(std::toupper(c));
                fs::rename(p / ("a." + std::string(of)), p / ("a." + upper));
              }
            },
            "a.SHP") == whole);
}
