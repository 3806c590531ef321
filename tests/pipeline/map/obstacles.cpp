// Lines and polygons of a region: what crosses them by geometry, which cells they mark, and what is refused.
#include "pipeline/map/region/obstacle.h"

#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "pipeline/map/write/make_map.h"
#include "terrain/raster/raster_source.h"
#include "tests/pipeline/map/analytic_model.h"
#include "tests/pipeline/map/made_shapes.h"
#include "tests/pipeline/map/strips.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;
using test::kSide;
using test::kTruck;

namespace {

const CrossingLimits kTank{.vehicle = "carrier",
                           .tracked = true,
                           .radius = 0.3,
                           .friction = 0.8,
                           .width = 2.7,
                           .length = 4.9,
                           .clearance = 0.41,
                           .contact_length = 2.7};

/// Depth to which a wheel sinks between two edges, by lowering it until an edge lies on it.
double sag_by_search(double radius, double width, double depth) {
  double sag = 0;
  while (sag < depth) {
    const double axle = radius - sag - 1e-6;
    if (std::hypot(width / 2, axle) < radius && axle > 0) break;
    sag += 1e-6;
  }
  return sag;
}

MapRequest request_of(const TemporaryFolder& folder, const std::string& obstacles, const std::string& out) {
  write_file_atomically(folder / "region.json", R"({"schema": "gonogo/region/1", "region": "crossed",
    "rasters": [{"role": "elevation", "file": "dem.tif", "source": "s", "licence": "l"}],
    "values": {"friction_angle": {"fixed": 12, "source": "s"}, "cohesion": {"fixed": 0, "source": "s"}},
    "obstacles": [)" + obstacles + "]}");
  MapRequest request;
  request.model = test::AnalyticModel{}.outcome_model();
  request.region = read_region(folder / "region.json");
  request.region.crossing = kTruck;
  request.out = folder / out;
  return request;
}

struct Layers {
  terrain::Tile go, reason, p;
};

Layers map_of(const MapRequest& request) {
  make_map(request);
  const auto read = [&](const char* name) {
    return terrain::RasterSource::open_as_it_lies(request.out / name).read({0, 0, kSide, kSide});
  };
  return {read("go.tif"), read("reason.tif"), read("p_go.tif")};
}

std::string refusal(const TemporaryFolder& folder, const std::string& obstacles) {
  return input_error([&] { make_map(request_of(folder, obstacles, "refused")); });
}

}  // namespace

TEST_CASE("a ditch is the step that a wheel has to climb out of it") {
  for (double width = 0.05; width < 1.2; width += 0.05)
    for (const double depth : {0.02, 0.1, 0.3, 2.0}) {
      INFO(width << " m wide, " << depth << " m deep");
      const double sag = sag_by_search(kTruck.radius, width, depth);
      // The normal of the far edge leans by the angle whose cosine is 1 - sag / R; friction carries up to atan(mu).
      const double lean = std::acos(std::max(-1.0, 1 - sag / kTruck.radius));
      const Crossing crossing = cross_ditch(kTruck, width, depth);
      if (std::abs(std::tan(lean) - 0.8) > 1e-3 || sag > kTruck.radius)
        CHECK((crossing == Crossing::passes) == (sag < kTruck.radius && std::tan(lean) <= 0.8));
      CHECK((crossing == Crossing::no_go) == (sag >= kTruck.radius - 1e-5));
    }
  CHECK(cross_ditch(kTank, 1.3, 5) == Crossing::passes);  // bridges half of its 2.7 m
  CHECK(cross_ditch(kTank, 1.4, 5) == Crossing::no_go);
  CHECK(cross_ditch(kTank, 1.4, 0.05) == Crossing::passes);
  CHECK(cross_ditch(kTank, 1.4, 0.4) == Crossing::unknown);
  CHECK(cross_river(kTruck, 0.4) == Crossing::passes);
  CHECK(cross_river(kTruck, 0.7) == Crossing::unknown);
  CHECK(cross_river(kTruck, 0.95) == Crossing::no_go);
  CHECK(pass_between(kTruck, 2.1) == Crossing::no_go);
  CHECK(pass_between(kTruck, 3) == Crossing::unknown);
  CHECK(pass_between(kTruck, 4.8) == Crossing::passes);
}

TEST_CASE("ditches and rivers close their cells by width and depth, and a road carries over them") {
  const TemporaryFolder folder;
  test::make_flat_ground(folder);
  test::write_shapes(folder, "ditches.geojson",
                     test::column_line(5.5, R"("w": 1.5, "d": 1.0)") + "," +
                         test::column_line(8.5, R"("w": 0.3, "d": 1.0)") + "," +
                         test::column_line(11.5, R"("w": 0.8, "d": 0.3)"));
  test::write_shapes(folder, "river.geojson", test::column_line(18.5, R"("depth": 2)"));
  test::write_shapes(folder, "road.geojson", test::row_line(12.5, ""));
  const std::string all =
      test::obstacle_entry("ditch", "ditches.geojson", R"(, "width_m": "w", "depth_m": "d")") + "," +
      test::obstacle_entry("road", "road.geojson", R"(, "width_m": 6, "soil": "paved", "speed_km_h": 50)") + "," +
      test::obstacle_entry("river", "river.geojson", R"(, "width_m": 28, "depth_m": "depth")");
  const Layers map = map_of(request_of(folder, all, "map"));
  for (int row = 1; row < kSide - 1; ++row)
    for (int column = 1; column < kSide - 1; ++column) {
      INFO(column << " " << row);
      const int go = int(map.go.at(column, row)), reason = int(map.reason.at(column, row));
      if (row == 12) {
        CHECK(go == int(Verdict::go));
        CHECK(map.p.at(column, row) > 0.99);
      } else if (column == 5) {
        CHECK((go == int(Verdict::no_go) && reason == int(Reason::obstacle)));
      } else if (column == 11) {
        CHECK((go == int(Verdict::unknown) && reason == int(Reason::outside_sampled)));
      } else if (column >= 17 && column <= 19) {  // 28 m about the middle of column 18
        CHECK((go == int(Verdict::no_go) && reason == int(Reason::water)));
      } else {
        CHECK(map.p.at(column, row) == Approx(0.982).margin(0.01));  // 1 / (1 + exp(-12 / 3)), the narrow ditch as well
      }
    }
  test::check_strips(request_of(folder, all, "strips"), 5);
}

TEST_CASE("stems, boulders and buildings decide by their gaps, and without a vehicle only buildings do") {
  const TemporaryFolder folder;
  test::make_flat_ground(folder);
  const auto square = [](int column, const std::string& properties) {
    const std::string west = std::to_string(500001 + 10 * column), east = std::to_string(500009 + 10 * column);
    return R"({"type": "Feature", "properties": {)" + properties +
           R"(}, "geometry": {"type": "Polygon", "coordinates": [[[)" + west + ", 4399800], [" + east +
           ", 4399800], [" + east + ", 4399950], [" + west + ", 4399950], [" + west + ", 4399800]]]}}";
  };
  test::write_shapes(folder, "stems.geojson",
                     square(3, R"("s": 2, "d": 0.3)") + "," + square(5, R"("s": 4, "d": 0.3)") + "," +
                         square(7, R"("s": 9, "d": 0.3)"));
  test::write_shapes(folder, "boulders.geojson", square(9, R"("h": 0.05)") + "," + square(11, R"("h": 0.6)"));
  test::write_shapes(folder, "houses.geojson", square(13, ""));
  const std::string all =
      test::obstacle_entry("stems", "stems.geojson", R"(, "spacing_m": "s", "diameter_m": "d")") + "," +
      test::obstacle_entry("boulders", "boulders.geojson", R"(, "spacing_m": 2, "diameter_m": 0.5, "height_m": "h")") +
      "," + test::obstacle_entry("buildings", "houses.geojson", "");
  const MapRequest request = request_of(folder, all, "map");
  const Layers map = map_of(request);
  const auto verdict = [](const Layers& of, int column) { return Verdict(int(of.go.at(column, 10))); };
  CHECK(verdict(map, 3) == Verdict::no_go);
  CHECK(Reason(int(map.reason.at(3, 10))) == Reason::vegetation);
  CHECK(verdict(map, 5) == Verdict::unknown);
  CHECK(passes(verdict(map, 7)));
  CHECK(passes(verdict(map, 9)));
  CHECK(verdict(map, 11) == Verdict::no_go);
  CHECK(Reason(int(map.reason.at(11, 10))) == Reason::obstacle);
  CHECK(verdict(map, 13) == Verdict::no_go);
  CHECK(Reason(int(map.reason.at(13, 10))) == Reason::built_up);
  CHECK(contains(read_file(request.out / "index.html"), "stems of stems.geojson"));
  MapRequest nobody = request_of(folder, all, "nobody");
  nobody.region.crossing.reset();
  const Layers open = map_of(nobody);
  for (const int column : {3, 5, 7, 9, 11}) CHECK(verdict(open, column) == Verdict::unknown);
  CHECK(verdict(open, 13) == Verdict::no_go);
}

TEST_CASE("obstacles that cannot be meant are refused with file and feature") {
  const TemporaryFolder folder;
  test::make_flat_ground(folder);
  test::write_shapes(folder, "d.geojson", test::column_line(5.5, R"("w": 1.5, "t": "wide", "n": -2, "none": null)"));
  const auto ditch = [&](const std::string& keys) {
    return refusal(folder, test::obstacle_entry("ditch", "d.geojson", keys));
  };
  CHECK(contains(ditch(R"(, "width_m": 1)"), "depth_m"));
  CHECK(contains(ditch(R"(, "width_m": "breadth", "depth_m": 1)"), "d.geojson: feature 0: breadth: no such attribute"));
  CHECK(contains(ditch(R"(, "width_m": "t", "depth_m": 1)"), "t: is \"wide\", and a number is needed"));
  CHECK(contains(ditch(R"(, "width_m": "none", "depth_m": 1)"), "a number is needed"));
  CHECK(contains(ditch(R"(, "width_m": "n", "depth_m": 1)"), "n: is -2 m, allowed are 0 to 10000"));
  CHECK(contains(ditch(R"(, "width_m": -1, "depth_m": 1)"), "width_m: value -1 is outside"));
  CHECK(contains(ditch(R"(, "width_m": 1, "depth_m": 1, "layer": "x")"), "has no layer \"x\""));
  CHECK(contains(ditch(R"(, "width_m": 1, "depth_m": 1, "depht": 2)"), "depht: unknown key"));
  CHECK(contains(refusal(folder, test::obstacle_entry("dich", "d.geojson", "")), "kind"));
  CHECK(contains(refusal(folder, test::obstacle_entry("buildings", "gone.geojson", "")), "gone.geojson: no such file"));
  CHECK(contains(refusal(folder, test::obstacle_entry("buildings", "dem.tif", "")),
                 "cannot be read as lines or polygons"));
  CHECK(contains(refusal(folder, test::obstacle_entry("road", "d.geojson", R"(, "width_m": 4, "soil": "tarmack")")),
                 "tarmack"));
  test::write_shapes(folder, "far.geojson", test::column_line(50000, ""));
  CHECK(contains(refusal(folder, test::obstacle_entry("buildings", "far.geojson", "")),
                 "no shape of it touches the map"));
  test::write_shapes(
      folder, "points.geojson",
      R"({"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [500055, 4399950]}})");
  CHECK(contains(refusal(folder, test::obstacle_entry("buildings", "points.geojson", "")), "neither line nor polygon"));
}
