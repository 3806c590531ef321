// Elevation that is not on a grid of ground metres: warped, and its slopes those of the ground.
#include <ogr_spatialref.h>

#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "base/units.h"
#include "terrain/raster/layer/slope.h"
#include "terrain/raster/raster_open.h"
#include "terrain/raster/raster_source.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"

using namespace gonogo;
using namespace gonogo::terrain;
using test::make_raster;
using test::RasterRecipe;

namespace {

constexpr double kEastRise = 0.2, kNorthRise = 0.1;  // of the plane, per ground metre
const std::string kGolden = GONOGO_SOURCE_DIR "/tests/golden/terrain/";

/// Heights of a plane over the raster's own middle, in metres of a local frame on the sphere that touches there; good
/// to 1e-3 of the rise over the few kilometres of these rasters.
std::vector<float> plane(const RasterRecipe& recipe, double metres_east, double metres_north) {
  std::vector<float> value;
  const int middle_row = recipe.rows / 2, middle_column = recipe.columns / 2;
  for (int row = 0; row < recipe.rows; ++row)
    for (int column = 0; column < recipe.columns; ++column)
      value.push_back(float(1000 + kEastRise * metres_east * (column - middle_column) -
                            kNorthRise * metres_north * (row - middle_row)));
  return value;
}

/// Cells of 0.0002 degrees around a place, holding the plane.
RasterRecipe plane_in_degrees(double longitude, double latitude, double east_step = 2e-4) {
  RasterRecipe recipe = {.columns = 120, .rows = 100, .epsg = 4326};
  recipe.transform = {longitude - 60 * east_step, east_step, 0, latitude + 50 * 2e-4, 0, -2e-4};
  const double east = ground_distance({longitude, latitude}, {longitude + east_step, latitude}, 6378137, 298.257223563);
  const double north =
      ground_distance({longitude, latitude - 1e-4}, {longitude, latitude + 1e-4}, 6378137, 298.257223563);
  recipe.value = plane(recipe, east, north);
  return recipe;
}

struct Slopes {
  double min = 90, max = 0;
  int cells = 0;
};

Slopes slopes_of(const RasterSource& source) {
  const MapGrid& grid = source.grid();
  const Tile slope = slope_degrees(source.read({-1, -1, grid.columns + 2, grid.rows + 2}),
                                   {grid.cell_width_m(), grid.cell_height_m()});
  // Beside edges and holes the interpolation shares out the weights of missing cells; there a plane is none.
  const auto is_inner = [&](int column, int row) {
    for (const int down : {-6, 0, 6})
      for (const int right : {-6, 0, 6})
        if (std::isnan(slope.at(column + right, row + down))) return false;
    return true;
  };
  Slopes found;
  for (int row = 8; row < grid.rows - 8; ++row)
    for (int column = 8; column < grid.columns - 8; ++column) {
      if (!is_inner(column, row)) continue;
      const double v = slope.at(column, row);
      found.min = std::min(found.min, v);
      found.max = std::max(found.max, v);
      ++found.cells;
    }
  return found;
}

void check_plane(const RasterSource& source, double margin = 0.05) {
  const double expected = std::atan(std::hypot(kEastRise, kNorthRise)) * kDegreesPerRadian;
  const Slopes found = slopes_of(source);
  CHECK(found.min == Approx(expected).margin(margin));
  CHECK(found.max == Approx(expected).margin(margin));
  CHECK(found.cells > 3000);
}

}  // namespace

TEST_CASE("a degree on the ellipsoid is as long as tables say") {
  // Snyder, Map Projections - A Working Manual, USGS PP 1395, table 11 (Clarke 1866: a 6378206.4 m, 1/f 294.98).
  CHECK(ground_distance({0, -0.5}, {0, 0.5}, 6378206.4, 294.9787) == Approx(110567).margin(2));
  CHECK(ground_distance({0, 44.5}, {0, 45.5}, 6378206.4, 294.9787) == Approx(111132).margin(3));
  CHECK(ground_distance({10, 60}, {11, 60}, 6378206.4, 294.9787) == Approx(55802).margin(2));
  CHECK(ground_distance({179.9, 0}, {-179.9, 0}, 6378137, 298.257) == Approx(0.2 * 111319.5).epsilon(1e-5));
}

TEST_CASE(
    "a plane in degrees keeps its slope in ground metres, at any latitude and on both sides of the antimeridian") {
  const TemporaryFolder folder;
  const auto [longitude, latitude, zone] = GENERATE(table<double, double, std::string>({{-120.3, 39.4, "10N"},
                                                                                        {-73.2, -46.5, "18S"},
                                                                                        {25.1, 69.5, "35N"},
                                                                                        {180.0, -17.0, "1S"},
                                                                                        {-180.0, 65.0, "1N"},
                                                                                        {0.5, 0.01, "31N"}}));
  INFO(longitude << " " << latitude);
  make_raster(folder / "dem.tif", plane_in_degrees(longitude, latitude));
  const RasterSource source = RasterSource::open_elevation(folder / "dem.tif");
  check_plane(source);
  CHECK(contains(source.grid().crs_name, "UTM zone " + zone));
  CHECK(contains(source.how_warped(), "cubic"));
}

TEST_CASE("near a pole the grid is polar stereographic, and slopes stay those of the ground") {
  const TemporaryFolder folder;
  const double latitude = GENERATE(87.0, -88.5);
  make_raster(folder / "dem.tif", plane_in_degrees(30, latitude, 2e-3));
  const RasterSource source = RasterSource::open_elevation(folder / "dem.tif");
  CHECK(contains(source.grid().crs_name, "polar stereographic"));
  check_plane(source, 0.2);  // columns of degrees narrow towards the pole: the recipe is a plane to that much
}

TEST_CASE("Web Mercator is no grid of ground metres and is warped; UTM is and is left alone") {
  const TemporaryFolder folder;
  RasterRecipe mercator = {.columns = 120, .rows = 100, .epsg = 3857, .transform = {1000000, 20, 0, 8400000, 0, -20}};
  const double latitude = std::atan(std::sinh((8400000 - 1000) / 6378137.0));  // 60 degrees: 20 m are about 10 m
  mercator.value = plane(mercator, 20 * std::cos(latitude), 20 * std::cos(latitude));
  make_raster(folder / "mercator.tif", mercator);
  const RasterSource source = RasterSource::open_elevation(folder / "mercator.tif");
  check_plane(source, 0.08);
  CHECK(source.grid().cell_width_m() == Approx(20 * std::cos(latitude)).epsilon(0.01));
  make_raster(folder / "utm.tif", {});
  CHECK(RasterSource::open_elevation(folder / "utm.tif").how_warped().empty());
}

TEST_CASE("the golden window in degrees gives back the slopes of the window") {
  const RasterSource window = RasterSource::open_elevation(kGolden + "window.tif");
  const RasterSource degrees = RasterSource::open_elevation(kGolden + "degrees.tif", {"EPSG:26911", 10});
  const MapGrid &a = window.grid(), &b = degrees.grid();
  REQUIRE(std::fmod(a.west - b.west, 10) == 0);
  const int right = int((a.west - b.west) / 10), down = int((b.north - a.north) / 10);
  const Tile ours = slope_degrees(degrees.read({right - 1, down - 1, a.columns + 2, a.rows + 2}), {10, 10});
  const Tile theirs = slope_degrees(window.read({-1, -1, a.columns + 2, a.rows + 2}), {10, 10});
  double sum = 0;
  int count = 0;
  for (int row = 5; row < a.rows - 5; ++row)
    for (int column = 5; column < a.columns - 5; ++column) {
      const double difference = std::abs(ours.at(column, row) - theirs.at(column, row));
      sum += difference;
      ++count;
    }
  CHECK(sum / count < 0.25);  // warped twice: what two cubic interpolations smooth away
  CHECK(count > 15000);
}

TEST_CASE("holes in degrees stay holes") {
  const TemporaryFolder folder;
  RasterRecipe recipe = plane_in_degrees(-120.3, 39.4);
  for (std::size_t row = 40; row < 60; ++row)
    for (std::size_t column = 50; column < 70; ++column) recipe.value[row * 120 + column] = -9999;
  make_raster(folder / "dem.tif", recipe);
  const RasterSource source = RasterSource::open_elevation(folder / "dem.tif");
  const MapGrid& grid = source.grid();
  const Tile tile = source.read({0, 0, grid.columns, grid.rows});
  CHECK(std::isnan(tile.at(grid.columns / 2, grid.rows / 2)));
  for (const float v : tile.value)
    if (!std::isnan(v)) REQUIRE(v > 500);  // -9999 mixes into nothing
  check_plane(source, 0.1);
}

TEST_CASE("a warped raster reads the same through any window and any handle") {
  const TemporaryFolder folder;
  make_raster(folder / "dem.tif", plane_in_degrees(-120.3, 39.4));
  const RasterSource source = RasterSource::open_elevation(folder / "dem.tif"), other = source.again();
  const MapGrid& grid = source.grid();
  const Tile whole = source.read({0, 0, grid.columns, grid.rows}), part = other.read({17, 23, 31, 29});
  for (int row = 0; row < part.rows; ++row)
    for (int column = 0; column < part.columns; ++column)
      REQUIRE(part.at(column, row) == whole.at(column + 17, row + 23));
}

TEST_CASE("tiles of one raster read as the whole, and a missing one is a hole") {
  const TemporaryFolder folder;
  std::vector<float> value;
  for (int i = 0; i < 40 * 30; ++i) value.push_back(float(i));
  make_raster(folder / "whole.tif", {.columns = 40, .rows = 30, .value = value});
  const auto cut = [&](const std::string& name, int left, int top, int columns, int rows) {
    RasterRecipe recipe = {.columns = columns, .rows = rows};
    recipe.transform = {500000 + 10.0 * left, 10, 0, 4400000 - 10.0 * top, 0, -10};
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) recipe.value.push_back(float((top + row) * 40 + left + column));
    make_raster(folder / name, recipe);
    return folder / name;
  };
  const RasterFiles tiles = std::vector{cut("a.tif", 0, 0, 25, 10), cut("b.tif", 25, 0, 15, 20),
                                        cut("c.tif", 15, 20, 25, 10), cut("d.tif", 0, 10, 15, 20)};
  const RasterSource joined = RasterSource::open_elevation(tiles),
                     whole = RasterSource::open_elevation(folder / "whole.tif");
  REQUIRE(joined.grid().columns == 40);
  REQUIRE(joined.grid().rows == 30);
  const Tile ours = joined.read({0, 0, 40, 30}), theirs = whole.read({0, 0, 40, 30});
  int holes = 0;
  for (int row = 0; row < 30; ++row)
    for (int column = 0; column < 40; ++column) {
      const bool hole = column >= 15 && column < 25 && row >= 10 && row < 20;
      holes += hole;
      REQUIRE(std::isnan(ours.at(column, row)) == hole);
      if (!hole) REQUIRE(ours.at(column, row) == theirs.at(column, row));
    }
  CHECK(holes == 100);
  CHECK(files_behind(tiles).size() == 4);
}

TEST_CASE("tiles that do not belong together, and grids that cannot be, are refused in one sentence") {
  const TemporaryFolder folder;
  make_raster(folder / "a.tif", {});
  make_raster(folder / "b.tif", {.epsg = 32611});
  const auto refusal = [](const RasterFiles& files, const GridWish& wish = {}) {
    return input_error([&] { RasterSource::open_elevation(files, wish); });
  };
  CHECK(
      contains(refusal(std::vector{folder / "a.tif", folder / "b.tif"}), "b.tif: is not in the coordinate system of"));
  CHECK(contains(refusal(folder / "a.tif", {"EPSG:4326", 0}), "no projected coordinate system"));
  CHECK(contains(refusal(folder / "a.tif", {"nonsense", 0}), "no projected coordinate system"));
  make_raster(folder / "wide.tif", {.columns = 40, .rows = 4, .epsg = 4326, .transform = {0, 1, 0, 40, 0, -1}});
  CHECK(contains(refusal(folder / "wide.tif"), "degrees of longitude wide"));
  make_raster(folder / "beyond.tif", {.epsg = 4326, .transform = {0, 1e-4, 0, 95, 0, -1e-4}});
  CHECK(contains(refusal(folder / "beyond.tif"), "latitudes must lie between"));
}

TEST_CASE("a shift between datums that is only guessed at is refused") {
  const TemporaryFolder folder;
  make_raster(folder / "dem.tif", {});
  const MapGrid grid = RasterSource::open_elevation(folder / "dem.tif").grid();
  // A local system on a datum of its own that nothing relates to WGS 84, at the same numbers.
  GDALDataset* raster = GetGDALDriverManager()->GetDriverByName("GTiff")->Create((folder / "local.tif").c_str(), 8, 6,
                                                                                 1, GDT_Byte, nullptr);
  OGRSpatialReference crs;
  REQUIRE(crs.importFromWkt(R"(PROJCS["local",GEOGCS["local",DATUM["nobody knows",SPHEROID["Bessel 1841",6377397.155,
      299.1528128]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],
      PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",-123],PARAMETER["scale_factor",0.9996],
      PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1]])") == OGRERR_NONE);
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  raster->SetSpatialRef(&crs);
  double transform[6] = {500000, 10, 0, 4400000, 0, -10};
  raster->SetGeoTransform(transform);
  GDALClose(raster);
  CHECK(contains(input_error([&] { RasterSource::open_on_grid(folder / "local.tif", grid, RasterKind::classes); }),
                 "is not known here"));
}

TEST_CASE("a raster of one pixel reads as its value and has no slope") {
  const TemporaryFolder folder;
  make_raster(folder / "one.tif", {.columns = 1, .rows = 1, .value = {7}});
  const RasterSource source = RasterSource::open_elevation(folder / "one.tif");
  CHECK(source.read({0, 0, 1, 1}).at(0, 0) == 7);
  CHECK(std::isnan(slope_degrees(source.read({-1, -1, 3, 3}), {10, 10}).at(0, 0)));
}

TEST_CASE("a corrupted tile is refused, not read as ground") {
  const TemporaryFolder folder;
  GDALAllRegister();
  const char* options[] = {"TILED=YES", "COMPRESS=DEFLATE", nullptr};
  GDALDataset* raster = GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      (folder / "dem.tif").c_str(), 512, 512, 1, GDT_Float32, const_cast<char**>(options));
  OGRSpatialReference crs;
  crs.importFromEPSG(32610);
  raster->SetSpatialRef(&crs);
  double transform[6] = {500000, 10, 0, 4400000, 0, -10};
  raster->SetGeoTransform(transform);
  std::vector<float> value(512 * 512);
  for (std::size_t i = 0; i < value.size(); ++i) value[i] = float(i % 977) * 1.37f;
  REQUIRE(raster->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, 512, 512, value.data(), 512, 512, GDT_Float32, 0, 0,
                                             nullptr) == CE_None);
  GDALClose(raster);
  std::string bytes = read_file(folder / "dem.tif");
  for (std::size_t i = bytes.size() / 2; i < bytes.size() / 2 + 4000; ++i) bytes[i] = char(0x5a);
  write_file_atomically(folder / "dem.tif", bytes);
  const auto read_everything = [&] { RasterSource::open_elevation(folder / "dem.tif").read({0, 0, 512, 512}); };
  CHECK(contains(input_error(read_everything), "damaged or incomplete"));
}
