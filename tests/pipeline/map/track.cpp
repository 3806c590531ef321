// Tracks of ways: places, heights and times against closed forms, what may be left out against brute force, and files
// read back with GDAL.
#include "pipeline/map/route/way_files.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "tests/pipeline/map/made_ground.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"

using namespace gonogo;
using namespace gonogo::map;
using terrain::TrackPoint;

namespace {

constexpr double kWest = 500000, kNorth = 4400000;

/// A surface that bilinear interpolation gives back exactly.
double twisted(double x, double y) {
  return 900 + 0.3 * (x - kWest) - 0.2 * (kNorth - y) + 1e-3 * (x - kWest) * (kNorth - y);
}

/// Cells of 10 by 12, as made_cells() has.
terrain::RasterSource twisted_elevation(const TemporaryFolder& folder, int columns, int rows) {
  std::vector<float> height;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      height.push_back(float(twisted(kWest + 10 * (column + 0.5), kNorth - 12 * (row + 0.5))));
  test::make_raster(folder / "dem.tif",
                    {.columns = columns, .rows = rows, .transform = {kWest, 10, 0, kNorth, 0, -12}, .value = height});
  return terrain::RasterSource::open_elevation(folder / "dem.tif");
}

/// What a point says at its share of the way from `a` to `b`.
TrackPoint between(const TrackPoint& a, const TrackPoint& b, double t) {
  const auto mean = [t](double from, double to) { return from + t * (to - from); };
  return {mean(a.x, b.x), mean(a.y, b.y), mean(a.height, b.height), mean(a.seconds, b.seconds)};
}

double apart(const TrackPoint& a, const TrackPoint& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// Whether both say the same; what neither knows counts as that.
bool same(const TrackPoint& a, const TrackPoint& b) {
  const auto alike = [](double u, double v) { return u == v || (std::isnan(u) && std::isnan(v)); };
  return a.x == b.x && a.y == b.y && alike(a.height, b.height) && alike(a.seconds, b.seconds);
}

struct Worst {
  double distance = 0, height = 0, seconds = 0, piece = 0;
};

/// Of all points of the whole track beside the lines between those that stay.
Worst worst_of(const std::vector<TrackPoint>& all, const std::vector<TrackPoint>& kept) {
  Worst worst;
  std::size_t first = 0;
  REQUIRE(same(all.front(), kept.front()));
  for (std::size_t k = 1; k < kept.size(); ++k) {
    std::size_t last = first + 1;
    while (last < all.size() && !same(all[last], kept[k])) ++last;
    REQUIRE(last < all.size());
    double length = 0, way = 0;
    for (std::size_t i = first; i < last; ++i) length += apart(all[i], all[i + 1]);
    for (std::size_t i = first + 1; i < last; ++i) {
      way += apart(all[i - 1], all[i]);
      const TrackPoint told = between(kept[k - 1], kept[k], way / length);
      worst.distance = std::max(worst.distance, apart(told, all[i]));
      if (!std::isnan(all[i].height)) worst.height = std::max(worst.height, std::abs(told.height - all[i].height));
      if (!std::isnan(all[i].seconds)) worst.seconds = std::max(worst.seconds, std::abs(told.seconds - all[i].seconds));
    }
    worst.piece = std::max(worst.piece, length);
    first = last;
  }
  CHECK(first + 1 == all.size());
  return worst;
}

/// Points 10 apart along x, on level ground, at 2 per second.
std::vector<TrackPoint> even_track(int points) {
  std::vector<TrackPoint> track;
  for (int i = 0; i < points; ++i) track.push_back({kWest + 10.0 * i, kNorth, 100, 5.0 * i});
  return track;
}

/// Bends, climbs and stops at random.
std::vector<TrackPoint> winding_track(std::uint64_t seed, bool timed) {
  std::vector<TrackPoint> track;
  double heading = 0, slope = 0;
  TrackPoint at{kWest, kNorth, 500, timed ? 0 : std::nan("")};
  for (std::uint64_t i = 0; i < 3000; ++i) {
    track.push_back(at);
    heading += 0.2 * (random_unit(seed, 0, i) - 0.5);
    slope = 0.98 * slope + 0.05 * (random_unit(seed, 1, i) - 0.5);
    const double step = 2 + 10 * random_unit(seed, 2, i);
    at = {at.x + step * std::sin(heading), at.y + step * std::cos(heading), at.height + step * slope,
          at.seconds + step * (0.1 + random_unit(seed, 3, i / 40))};
  }
  return track;
}

}  // namespace

TEST_CASE("a track holds corners and borders of cells, with the height of the ground and the time of the way so far") {
  const TemporaryFolder folder;
  const auto elevation = twisted_elevation(folder, 40, 30);
  const SoilTable table = test::made_table();
  const RouteCosts costs(table, RouteCost::length, 100);  // stands for the time: some cost per metre
  const RouteCells cells = test::gentle_cells(40, 30, 7);
  const FoundRoute route{0, {2 * 40 + 3, 9 * 40 + 30, 27 * 40 + 30, 20 * 40 + 12}};
  const std::vector<TrackPoint> track = track_of(route, cells, &costs, elevation);
  double worst = 0, seconds = 0;
  std::size_t at = 0;
  for (std::size_t leg = 1; leg < route.cell.size(); ++leg) {
    const TrackPoint a = centre_of(route.cell[leg - 1], elevation.grid()),
                     b = centre_of(route.cell[leg], elevation.grid());
    const int heading = (int(std::lround(std::atan2(b.x - a.x, b.y - a.y) / kDegree)) + 360) % 360;
    CHECK(same(track[at], {a.x, a.y, track[at].height, track[at].seconds}));
    constexpr int samples = 100'000;
    for (int i = 0; i < samples; ++i) {
      const TrackPoint p = between(a, b, (i + 0.5) / samples);
      const auto cell = std::size_t((kNorth - p.y) / 12) * 40 + std::size_t((p.x - kWest) / 10);
      if (apart(a, p) > apart(a, track[at + 1])) ++at;
      // Every border lies at a point: between two points the samples are in one cell.
      const TrackPoint middle = between(track[at], track[at + 1], 0.5);
      CHECK_FALSE(cell != std::size_t((kNorth - middle.y) / 12) * 40 + std::size_t((middle.x - kWest) / 10));
      seconds += apart(a, b) / samples * test::made_per_metre(cells, cell, heading, RouteCost::length);
    }
    ++at;
    CHECK(track[at].seconds == Approx(seconds).epsilon(1e-4));
    CHECK(same(track[at], {b.x, b.y, track[at].height, track[at].seconds}));
  }
  CHECK(at + 1 == track.size());
  for (const TrackPoint& p : track) worst = std::max(worst, std::abs(p.height - twisted(p.x, p.y)));
  CHECK(worst < 1e-3);  // single precision of the raster
  CHECK(std::isnan(track_of(route, cells, nullptr, elevation).back().seconds));
}

TEST_CASE("what a track leaves out lies within the tolerances of the lines between the points that stay") {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u})
    for (const TrackTolerance most : {TrackTolerance{.distance = 2.5}, TrackTolerance{.distance = 30, .height = 4},
                                      TrackTolerance{.distance = 1e3, .height = 1e3, .seconds = 9, .piece = 300}}) {
      const std::vector<TrackPoint> all = winding_track(seed, seed != 4);
      const std::vector<TrackPoint> kept = simplified(all, most);
      const Worst worst = worst_of(all, kept);
      CAPTURE(seed, most.distance, kept.size());
      CHECK(worst.distance <= most.distance);
      CHECK(worst.height <= most.height);
      CHECK(worst.seconds <= most.seconds);
      CHECK(worst.piece <= most.piece);
      CHECK(kept.size() < all.size() / 3);
      CHECK(std::max({worst.distance / most.distance, worst.height / most.height, worst.seconds / most.seconds,
                      worst.piece / most.piece}) > 0.9);  // no less is left out than may be
    }
}

TEST_CASE("a point stays if its place, height or time says something, and not otherwise") {
  const TrackTolerance most{.distance = 2.5, .height = 1, .seconds = 5};
  const auto points_with = [&](auto change) {
    std::vector<TrackPoint> track = even_track(41);
    change(track[20]);
    return simplified(track, most).size();
  };
  CHECK(simplified(even_track(41), most).size() == 2);
  CHECK(points_with([](TrackPoint& p) { p.y += 2.4; }) == 2);
  CHECK(points_with([](TrackPoint& p) { p.y += 2.6; }) > 2);
  CHECK(points_with([](TrackPoint& p) { p.height -= 0.99; }) == 2);
  CHECK(points_with([](TrackPoint& p) { p.height -= 1.01; }) > 2);
  CHECK(points_with([](TrackPoint& p) { p.seconds += 4.9; }) == 2);
  CHECK(points_with([](TrackPoint& p) { p.seconds += 5.1; }) > 2);
  CHECK(points_with([](TrackPoint& p) { p.height = std::nan(""); }) == 2);
  CHECK(simplified(even_track(2), most).size() == 2);
}

TEST_CASE("a long straight way is straight in longitude and latitude too") {
  const TemporaryFolder folder;
  const std::vector<TrackPoint> all = even_track(3001);  // 30 km to the east, at 39.7 degrees of latitude
  OGRSpatialReference grid, degrees;
  grid.importFromEPSG(32610);
  degrees.importFromEPSG(4326);
  for (OGRSpatialReference* crs : {&grid, &degrees}) crs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> out(OGRCreateCoordinateTransformation(&grid, &degrees)),
      back(OGRCreateCoordinateTransformation(&degrees, &grid));
  /// How far the middle of a line that is straight in degrees lies from the way.
  const auto aside = [&](const std::vector<TrackPoint>& track) {
    double worst = 0;
    for (std::size_t i = 1; i < track.size(); ++i) {
      double x[] = {track[i - 1].x, track[i].x}, y[] = {track[i - 1].y, track[i].y};
      REQUIRE(out->Transform(2, x, y));
      double middle_x = (x[0] + x[1]) / 2, middle_y = (y[0] + y[1]) / 2;
      REQUIRE(back->Transform(1, &middle_x, &middle_y));
      worst = std::max(worst, std::abs(middle_y - kNorth));
    }
    return worst;
  };
  const std::vector<TrackPoint> kept = simplified(all, {.distance = 2.5});
  CHECK(aside({all.front(), all.back()}) > 10);
  CHECK(aside(kept) < 0.02);
  CHECK(kept.size() == 33);  // 30 km halved five times
}
