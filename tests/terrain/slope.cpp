// Slope against closed form on planes and against gdaldem (tests/golden/terrain/README.md).
#include "terrain/raster/layer/slope.h"

#include <gdal_utils.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "base/math/random.h"
#include "base/units.h"
#include "terrain/raster/raster_source.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::terrain;

namespace {

const std::string kGolden = GONOGO_SOURCE_DIR "/tests/golden/terrain/";

Tile read_all(const std::string& path, int border = 0) {
  const RasterSource source = RasterSource::open_elevation(path);
  return source.read({-border, -border, source.grid().columns + 2 * border, source.grid().rows + 2 * border});
}

Tile plane(double east_rise, double north_rise, CellSize cell) {
  Tile tile(9, 7, 0);
  for (int row = 0; row < tile.rows; ++row)
    for (int column = 0; column < tile.columns; ++column)
      tile.at(column, row) = float(512 + east_rise * cell.width * column - north_rise * cell.height * row);
  return tile;
}

struct Comparison {
  int hole_mismatches = 0, compared = 0;
  double worst = 0;
};

template <class Difference, class Wanted>
Comparison compare(const Tile& ours, const Tile& theirs, const Difference& difference, const Wanted& wanted) {
  REQUIRE(ours.columns == theirs.columns);
  REQUIRE(ours.rows == theirs.rows);
  Comparison result;
  for (std::size_t i = 0; i < ours.value.size(); ++i) {
    if (std::isnan(ours.value[i]) != std::isnan(theirs.value[i])) {
      ++result.hole_mismatches;
    } else if (!std::isnan(ours.value[i]) && wanted(i)) {
      ++result.compared;
      result.worst = std::max(result.worst, difference(ours.value[i], theirs.value[i]));
    }
  }
  return result;
}

double distance(double a, double b) { return std::abs(a - b); }
double on_circle(double a, double b) { return std::abs(std::remainder(a - b, 360.0)); }
bool always(std::size_t) { return true; }

/// Aspect is compared where the slope exceeds 1 degree: on flatter ground single precision decides gdaldem's answer.
void check_against_gdaldem(const std::string& elevation, const std::string& slope, const std::string& aspect) {
  const RasterSource source = RasterSource::open_elevation(elevation);
  const CellSize cell = {source.grid().cell_width_m(), source.grid().cell_height_m()};
  const Tile z = read_all(elevation, 1), ours = slope_degrees(z, cell), ours_aspect = aspect_degrees(z, cell);
  const Tile theirs_aspect = read_all(aspect);
  const Comparison steepness = compare(ours, read_all(slope), distance, always);
  CHECK(steepness.hole_mismatches == 0);
  CHECK(steepness.compared > 1000);
  CHECK(steepness.worst < 2e-3);
  const auto steep = [&](std::size_t i) { return ours.value[i] > 1; };
  CHECK(compare(ours_aspect, theirs_aspect, on_circle, steep).worst < 0.05);
  CHECK(compare(ours_aspect, theirs_aspect, on_circle, steep).compared > 1000);
  for (std::size_t i = 0; i < ours.value.size(); ++i)
    if (std::isnan(ours.value[i]) || ours.value[i] > 1)
      REQUIRE(std::isnan(ours_aspect.value[i]) == std::isnan(theirs_aspect.value[i]));
}

using Dataset = std::unique_ptr<void, decltype(&GDALClose)>;

/// What the program gdaldem writes, by the library behind it.
void write_by_gdaldem(GDALDatasetH ground, const char* what, const std::string& file) {
  const char* horn[] = {"-alg", "Horn", nullptr};
  GDALDEMProcessingOptions* options = GDALDEMProcessingOptionsNew(const_cast<char**>(horn), nullptr);
  GDALDatasetH written = GDALDEMProcessing(file.c_str(), ground, what, nullptr, options, nullptr);
  GDALDEMProcessingOptionsFree(options);
  REQUIRE(written);
  GDALClose(written);
}

}  // namespace

TEST_CASE("the slope of a plane is the angle of the plane, on square and oblong cells") {
  const CellSize cell = GENERATE(CellSize{8, 8}, CellSize{4, 16});
  const double east = GENERATE(0.0, 0.25, -0.5, 1.0), north = GENERATE(0.0, 0.5, -0.125);
  const Tile z = plane(east, north, cell);
  const double slope = std::atan(std::hypot(east, north)) * kDegreesPerRadian;
  for (const float value : slope_degrees(z, cell).value) CHECK(value == float(slope));
  for (const float value : aspect_degrees(z, cell).value) {
    if (east == 0 && north == 0) {
      CHECK(std::isnan(value));
      continue;
    }
    double downhill =
        std::atan2(-east, -north) * kDegreesPerRadian;  // azimuth of the direction (east, north) = (-rise, -rise)
    if (downhill < 0) downhill += 360;
    CHECK(on_circle(value, downhill) < 1e-4);
  }
}

TEST_CASE("a north-facing slope has aspect 0, an east-facing one 90") {
  CHECK(aspect_degrees(plane(0, -0.5, {10, 10}), {10, 10}).at(3, 3) == 0);
  CHECK(aspect_degrees(plane(-0.5, 0, {10, 10}), {10, 10}).at(3, 3) == 90);
}

TEST_CASE("relief is brightest facing the light, and flat ground has the sine of its altitude") {
  const CellSize cell = {10, 10};
  CHECK(hillshade(plane(0, 0, cell), cell, 315, 30).at(2, 2) == Approx(0.5));
  // A plane whose normal points to azimuth 315, 45 degrees up: falls towards the north-west with slope 1.
  const double rise = 1 / std::numbers::sqrt2;
  CHECK(hillshade(plane(rise, -rise, cell), cell, 315, 45).at(2, 2) == Approx(1.0));
  CHECK(hillshade(plane(-rise, rise, cell), cell, 315, 45).at(2, 2) == Approx(0.0).margin(1e-6));
}

TEST_CASE("one nodata cell takes its eight neighbours with it, and the centre counts although Horn skips it") {
  Tile z = plane(0.5, 0.25, {10, 10});
  z.at(4, 3) = std::nanf("");
  const Tile slope = slope_degrees(z, {10, 10});
  for (int row = 0; row < slope.rows; ++row)
    for (int column = 0; column < slope.columns; ++column) {
      const bool near = std::abs(column + 1 - 4) <= 1 && std::abs(row + 1 - 3) <= 1;
      CHECK(std::isnan(slope.at(column, row)) == near);
    }
}

TEST_CASE("slope and aspect agree with gdaldem on real ground, holes included") {
  for (const std::string name : {"window", "holes"})
    check_against_gdaldem(kGolden + name + ".tif", kGolden + name + "_slope.tif", kGolden + name + "_aspect.tif");
}

TEST_CASE("relief agrees with gdaldem") {
  const Tile ours = hillshade(read_all(kGolden + "window.tif", 1), {10, 10}, 315, 45);
  Tile bytes = ours;
  for (float& v : bytes.value) v = 1 + 254 * v;
  const Comparison shade = compare(bytes, read_all(kGolden + "window_hillshade.tif"), distance, always);
  CHECK(shade.hole_mismatches == 0);
  CHECK(shade.worst <= 1.0);
}

TEST_CASE("slope and aspect of the whole sample region agree with GDAL's own") {
  const TemporaryFolder folder;
  const std::string dem = GONOGO_SOURCE_DIR "/configs/regions/sagehen/elevation_10m.tif";
  const std::string slope = (folder / "slope.tif").string(), aspect = (folder / "aspect.tif").string();
  GDALAllRegister();
  const Dataset ground(GDALOpen(dem.c_str(), GA_ReadOnly), &GDALClose);
  REQUIRE(ground);
  write_by_gdaldem(ground.get(), "slope", slope);
  // Aspect does not depend on the height's zero; 2048 m lower, gdaldem's single precision has two more bits for it.
  const char* lower[] = {"-scale", "2048", "4096", "0", "2048", nullptr};
  GDALTranslateOptions* options = GDALTranslateOptionsNew(const_cast<char**>(lower), nullptr);
  const Dataset lowered(GDALTranslate((folder / "lowered.tif").c_str(), ground.get(), options, nullptr), &GDALClose);
  GDALTranslateOptionsFree(options);
  REQUIRE(lowered);
  write_by_gdaldem(lowered.get(), "aspect", aspect);
  check_against_gdaldem(dem, slope, aspect);
}

TEST_CASE("slope has the same bits for any number of threads and any tiling") {
  Tile z(203, 101, 0);
  for (std::size_t i = 0; i < z.value.size(); ++i) z.value[i] = float(100 * random_unit(7, 0, i));
  const Tile whole = slope_degrees(z, {10, 10}, 1);
  CHECK(slope_degrees(z, {10, 10}, 2).value == whole.value);
  CHECK(slope_degrees(z, {10, 10}, 7).value == whole.value);
  Tile part(53, 33, 0);
  for (int row = 0; row < part.rows; ++row)
    for (int column = 0; column < part.columns; ++column) part.at(column, row) = z.at(column + 40, row + 20);
  const Tile window = slope_degrees(part, {10, 10}, 3);
  for (int row = 0; row < window.rows; ++row)
    for (int column = 0; column < window.columns; ++column)
      REQUIRE(window.at(column, row) == whole.at(column + 40, row + 20));
}
