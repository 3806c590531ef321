// Places on the globe and overlays: the antimeridian, the poles, other bodies.
#include "terrain/raster/grid.h"

#include <algorithm>
#include <cmath>

#include "base/files/file.h"
#include "base/units.h"
#include "terrain/raster/layer/layer_picture.h"
#include "terrain/raster/raster_source.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"

using namespace gonogo;
using namespace gonogo::terrain;

namespace {

MapGrid grid_in(const TemporaryFolder& folder, const std::string& crs, double west, double north, double cell) {
  test::make_raster(folder / "grid.tif",
                    {.columns = 60, .rows = 40, .transform = {west, cell, 0, north, 0, -cell}, .crs = crs});
  return RasterSource::open_as_it_lies(folder / "grid.tif").grid();
}

GlobePlace place_of(const MapGrid& grid) {
  const GlobeAnswer answer = place_on_globe(grid);
  INFO(answer.why_not);
  REQUIRE(answer.place);
  return *answer.place;
}

const std::vector<LegendEntry> kHalves = {{1, "west", "#0a141e"}, {2, "east", "#c8e0f0"}};

/// The overlay o.kml of a class layer that is 1 in its western half and 2 in its eastern one.
OverlayAnswer overlay_of(const TemporaryFolder& folder, const MapGrid& grid, const GlobePlace& place) {
  GeoTiffWriter writer(folder / "halves.tif", grid,
                       {.name = "half", .unit = "", .classes = true, .legend = kHalves, .metadata = {}});
  Tile tile(grid.columns, grid.rows, 1);
  for (int row = 0; row < grid.rows; ++row)
    for (int column = grid.columns / 2; column < grid.columns; ++column) tile.at(column, row) = 2;
  writer.write({0, 0, grid.columns, grid.rows}, tile);
  writer.finish();
  return write_overlay(folder / "o.kml", folder / "o.png", folder / "halves.tif", place, "title", "about", kHalves);
}

struct Picture {
  int columns = 0, rows = 0;
  double west = 0, east = 0;  // shares of all pixels in the colour of either half
};

Picture picture_of(const std::filesystem::path& png) {
  GDALDataset* file = GDALDataset::Open(png.c_str());
  REQUIRE(file);
  Picture picture{file->GetRasterXSize(), file->GetRasterYSize()};
  std::vector<unsigned char> index(std::size_t(picture.columns) * std::size_t(picture.rows));
  GDALRasterBand& band = *file->GetRasterBand(1);
  REQUIRE(band.RasterIO(GF_Read, 0, 0, picture.columns, picture.rows, index.data(), picture.columns, picture.rows,
                        GDT_Byte, 0, 0, nullptr) == CE_None);
  const GDALColorTable* colours = band.GetColorTable();
  REQUIRE(colours);
  for (const unsigned char i : index) {
    const GDALColorEntry& colour = *colours->GetColorEntry(i);
    if (colour.c4 == 255) (colour.c1 == 10 ? picture.west : picture.east) += 1.0 / double(index.size());
  }
  GDALClose(file);
  return picture;
}

}  // namespace

TEST_CASE("a grid on the antimeridian has two pieces, an outline of two polygons, and two pictures") {
  const TemporaryFolder folder;
  // Zone 1 south, about 18 km on either side of the antimeridian at 17 degrees south.
  const MapGrid grid = grid_in(folder, "EPSG:32701", 162500, 8118000, 600);
  const GlobePlace place = place_of(grid);
  CHECK(place.is_wgs84);
  REQUIRE(place.pieces.size() == 2);
  CHECK(place.box.west > 179.5);
  CHECK(place.box.east < -179.5);
  CHECK(place.pieces[0].east == 180);
  CHECK(place.pieces[1].west == -180);
  REQUIRE(place.outline.size() == 2);
  for (const DegreeRing& ring : place.outline) CHECK(ring.front() == ring.back());
  for (const auto& [longitude, latitude] : place.outline[0]) CHECK((longitude > 179.5 && longitude <= 180));
  for (const auto& [longitude, latitude] : place.outline[1]) CHECK((longitude < -179.5 && longitude >= -180));
  REQUIRE(overlay_of(folder, grid, place).files.size() == 3);
  const std::string kml = read_file(folder / "o.kml");
  for (const char* part :
       {"<href>o.png</href>", "<href>o_2.png</href>", "<east>180.000000000</east>", "<west>-180.000000000</west>"})
    CHECK(contains(kml, part));
  const Picture first = picture_of(folder / "o.png"), second = picture_of(folder / "o_2.png");
  CHECK(first.west > 0.8);
  CHECK(second.east > 0.8);
  const double east_of_line = place.pieces[1].width() / place.box.width();  // a little more or less than one half
  CHECK(first.east + second.west == Approx(std::abs(2 * east_of_line - 1)).margin(0.05));
}

TEST_CASE("an overlay lies in one piece elsewhere, and its pixels are square on the ground") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_in(folder, "EPSG:32633", 500000, 6700000, 100);  // 60 degrees north
  const GlobePlace place = place_of(grid);
  REQUIRE(place.pieces.size() == 1);
  CHECK(place.outline.front().front()[0] == Approx(15).margin(1e-6));  // central meridian of zone 33
  CHECK(overlay_of(folder, grid, place).files.size() == 2);
  const Picture picture = picture_of(folder / "o.png");
  CHECK(picture.west == Approx(0.5).margin(0.04));
  CHECK(picture.east == Approx(0.5).margin(0.04));
  CHECK(picture.columns == 60);
  CHECK(picture.rows == Approx(40).margin(1));
}

TEST_CASE("a grid that holds a pole goes around the globe") {
  const TemporaryFolder folder;
  const bool north = GENERATE(true, false);
  const MapGrid grid = grid_in(folder, north ? "EPSG:32661" : "EPSG:32761", 2e6 - 6000, 2e6 + 4000, 200);
  const GlobePlace place = place_of(grid);
  CHECK(place.box.width() == Approx(360));
  CHECK((north ? place.box.north : -place.box.south) == Approx(90));
  // 111,694 m for a degree of latitude at a pole, 0.994 of it on this map.
  CHECK((north ? place.box.south : -place.box.north) ==
        Approx(90 - std::hypot(6000, 4000) / (0.994 * 111694)).margin(1e-4));
  REQUIRE(place.outline.size() == 1);
  REQUIRE(overlay_of(folder, grid, place).files.size() == 2);
  const Picture picture = picture_of(folder / "o.png");
  CHECK(picture.west == Approx(picture.east).margin(0.02));  // half of the plane is half of all longitudes
  CHECK(picture.west > 0.2);
}

TEST_CASE("on other bodies degrees are the body's own") {
  const TemporaryFolder folder;
  struct Body {
    std::string crs, name, hint;
    double radius;
  };
  const Body body =
      GENERATE(Body{"+proj=stere +lat_0=-20 +lon_0=30 +R=1737400 +units=m", "Moon", "target=moon", 1737400},
               Body{"+proj=laea +lat_0=-20 +lon_0=30 +R=3396190 +units=m", "Mars", "target=mars", 3396190},
               Body{"+proj=laea +lat_0=-20 +lon_0=30 +R=2439700 +units=m", "Mercury", "<kml", 2439700});
  INFO(body.crs);
  const MapGrid grid = grid_in(folder, body.crs, -3000, 2000, 100);
  const GlobePlace place = place_of(grid);
  CHECK_FALSE(place.is_wgs84);
  CHECK(place.body == body.name);
  // The grid's middle is the projection's, where its metres are the sphere's.
  CHECK((place.box.south + place.box.north) / 2 == Approx(-20).margin(2e-3));
  CHECK(place.box.north - place.box.south == Approx(4000 / body.radius / kDegree).epsilon(3e-3));
  CHECK(place.box.width() == Approx(6000 / body.radius / std::cos(20 * kDegree) / kDegree).epsilon(3e-3));
  CHECK(contains(remark_on(place), "WGS 84"));
  REQUIRE(overlay_of(folder, grid, place).files.size() == 2);
  CHECK(contains(read_file(folder / "o.kml"), body.hint));
  CHECK(picture_of(folder / "o.png").west == Approx(0.5).margin(0.05));
}
