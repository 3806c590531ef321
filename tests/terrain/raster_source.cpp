// What the reader of rasters accepts, and the one sentence it refuses with.
#include "terrain/raster/raster_source.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "base/error.h"
#include "base/files/file.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"

using namespace gonogo;
using namespace gonogo::terrain;
using test::make_raster;

namespace {

std::string refusal(const std::filesystem::path& path) {
  return input_error([&] { RasterSource::open_elevation(path); });
}

}  // namespace

TEST_CASE("an elevation raster that cannot be used is refused with the file and what to do") {
  const TemporaryFolder folder;
  const auto file = folder / "dem.tif";

  CHECK(contains(refusal(folder / "absent.tif"), "absent.tif: no such file"));

  write_file_atomically(folder / "text.tif", "this is no raster");
  CHECK(contains(refusal(folder / "text.tif"), "text.tif: cannot be read as a raster"));

  make_raster(file, {.epsg = 0});
  CHECK(contains(refusal(file), "names no coordinate system"));
  CHECK(contains(refusal(file), "gdal_translate -a_srs"));

  make_raster(file, {.transform = {500000, 10, 2, 4400000, 2, -10}});
  CHECK(contains(refusal(file), "rotated geotransform"));
  make_raster(file, {.with_transform = false});
  CHECK(contains(refusal(file), "no geotransform"));

  make_raster(file, {.value = std::vector<float>(48, -9999.0f)});
  CHECK(contains(refusal(file), "every cell is nodata"));
  make_raster(file, {.nodata = {}, .value = std::vector<float>(48, std::nanf(""))});
  CHECK(contains(refusal(file), "every cell is nodata"));

  make_raster(file, {.unit = "fathom"});
  CHECK(contains(refusal(file), "\"fathom\""));
}

TEST_CASE("a truncated raster is refused when its cells are read, not taken as flat ground") {
  const TemporaryFolder folder;
  make_raster(folder / "dem.tif", {.columns = 300, .rows = 300});
  const auto size = std::filesystem::file_size(folder / "dem.tif");
  std::filesystem::resize_file(folder / "dem.tif", size / 2);
  const auto read_everything = [&] {
    const RasterSource source = RasterSource::open_elevation(folder / "dem.tif");
    source.read({0, 0, source.grid().columns, source.grid().rows});
  };
  CHECK_THROWS_AS(read_everything(), InputError);
}

TEST_CASE("nodata, NaN, infinity and everything outside read as NaN") {
  const TemporaryFolder folder;
  std::vector<float> value(48, 5);
  value[0] = -9999;
  value[1] = std::nanf("");
  value[2] = std::numeric_limits<float>::infinity();
  make_raster(folder / "dem.tif", {.value = value});
  const Tile tile = RasterSource::open_elevation(folder / "dem.tif").read({-1, -1, 10, 8});
  int values = 0;
  for (const float v : tile.value) values += !std::isnan(v);
  CHECK(values == 45);
  CHECK(std::isnan(tile.at(1, 1)));
  CHECK(tile.at(4, 1) == 5);
}

TEST_CASE("heights come in metres whatever the file's unit, scale and offset") {
  const TemporaryFolder folder;
  const std::vector<float> value(48, 100);
  make_raster(folder / "feet.tif", {.value = value, .unit = "ft"});
  CHECK(RasterSource::open_elevation(folder / "feet.tif").read({0, 0, 1, 1}).at(0, 0) == Approx(30.48));
  make_raster(folder / "scaled.tif", {.value = value, .scale = 0.1, .offset = 1000, .type = GDT_Int16});
  CHECK(RasterSource::open_elevation(folder / "scaled.tif").read({0, 0, 1, 1}).at(0, 0) == Approx(1010));
}

TEST_CASE("cells of a grid in feet have their size in metres") {
  const TemporaryFolder folder;
  make_raster(folder / "dem.tif", {.epsg = 2226, .transform = {6600000, 30, 0, 2000000, 0, -30}});  // California 2, ft
  const MapGrid grid = RasterSource::open_elevation(folder / "dem.tif").grid();
  CHECK(grid.cell_width_m() == Approx(30 * 1200.0 / 3937.0));
  CHECK(grid.crs_code == "EPSG:2226");
}

TEST_CASE("coarse classes are put on the fine grid by position, and uncovered cells are nodata") {
  const TemporaryFolder folder;
  make_raster(folder / "dem.tif", {});  // 8 x 6 cells of 10 m
  // 3 x 2 cells of 30 m that start 10 m east and 10 m south of the corner; class 0 is a class, 255 is nodata.
  make_raster(folder / "soil.tif", {.columns = 2,
                                    .rows = 1,
                                    .transform = {500010, 30, 0, 4399990, 0, -30},
                                    .nodata = 255,
                                    .value = {0, 7},
                                    .type = GDT_Byte});
  const RasterSource dem = RasterSource::open_elevation(folder / "dem.tif");
  const RasterSource soil = RasterSource::open_on_grid(folder / "soil.tif", dem.grid(), RasterKind::classes);
  const Tile tile = soil.read({0, 0, 8, 6});
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 8; ++column) {
      const bool inside = column >= 1 && column < 7 && row >= 1 && row < 4;
      if (inside)
        CHECK(tile.at(column, row) == (column < 4 ? 0 : 7));
      else
        CHECK(std::isnan(tile.at(column, row)));
    }
}

TEST_CASE("fine classes on a coarse grid give the most frequent one") {
  const TemporaryFolder folder;
  make_raster(folder / "dem.tif",
              {.columns = 2, .rows = 1, .transform = {500000, 30, 0, 4400000, 0, -30}, .value = {1, 2}});
  make_raster(folder / "soil.tif", {.columns = 6,
                                    .rows = 3,
                                    .value = {3, 3, 3, 4, 4, 4,  //
                                              3, 9, 3, 4, 8, 4,  //
                                              3, 3, 3, 4, 4, 4}});
  const RasterSource dem = RasterSource::open_elevation(folder / "dem.tif");
  const Tile tile = RasterSource::open_on_grid(folder / "soil.tif", dem.grid(), RasterKind::classes).read({0, 0, 2, 1});
  CHECK(tile.value == std::vector<float>{3, 4});  // the centre cells say 9 and 8
}

TEST_CASE("quantities are interpolated, and read the same through any window") {
  const TemporaryFolder folder;
  make_raster(folder / "dem.tif", {.columns = 40, .rows = 40});
  std::vector<float> ramp;
  for (int i = 0; i < 400; ++i) ramp.push_back(float(i % 20));
  make_raster(folder / "moisture.tif",
              {.columns = 20, .rows = 20, .transform = {500000, 20, 0, 4400000, 0, -20}, .value = ramp});
  const RasterSource dem = RasterSource::open_elevation(folder / "dem.tif");
  const RasterSource moisture = RasterSource::open_on_grid(folder / "moisture.tif", dem.grid(), RasterKind::continuous);
  const Tile whole = moisture.read({0, 0, 40, 40});
  CHECK(whole.at(10, 10) == Approx(4.75));  // 105 m east; cell centres at 10 + 20 k
  const Tile part = moisture.read({7, 9, 5, 4});
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 5; ++column) CHECK(part.at(column, row) == whole.at(column + 7, row + 9));
}

TEST_CASE("a raster of another place, or without a coordinate system, is refused on the grid") {
  const TemporaryFolder folder;
  make_raster(folder / "dem.tif", {});
  const MapGrid grid = RasterSource::open_elevation(folder / "dem.tif").grid();
  make_raster(folder / "far.tif", {.transform = {600000, 10, 0, 4400000, 0, -10}});
  make_raster(folder / "nowhere.tif", {.epsg = 0});
  const auto open = [&](const std::string& name) {
    return input_error([&] { RasterSource::open_on_grid(folder / name, grid, RasterKind::classes); });
  };
  CHECK(contains(open("far.tif"), "does not overlap"));
  CHECK(contains(open("nowhere.tif"), "names no coordinate system"));
}
