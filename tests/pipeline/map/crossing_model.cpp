// Trials of ditches on a map: the least of both models' P(go), by closed forms, and where the ditches stay unknown.
#include "pipeline/map/evaluate/outcome_model.h"

#include <algorithm>
#include <cmath>

#include "base/math/random.h"
#include "pipeline/map/evaluate/soil_response.h"
#include "pipeline/map/write/make_map.h"
#include "terrain/raster/layer/slope.h"
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

constexpr double kBed = 0.9;  // of all trials of ditches [m]

std::size_t index(const char* name) { return contract().variable_index(name); }

/// P(go) of trials of ditches: falls with the ditch's section and with slope, rises with the friction angle.
double p_ditch(double width, double depth, double friction_angle, double slope) {
  return 1 / (1 + std::exp(6 * width * depth - 0.12 * friction_angle + 0.05 * slope));
}

OutcomeModel ditch_model() {
  OutcomeModel model;
  for (const Variable& v : contract().variables)  // a model of one vehicle has no numbers of a family
    model.sampled.push_back(v.prior == "family" ? Range{0, 0} : Range{v.minimum, v.maximum});
  model.sampled[index("slope_along")] = {-10, 10};
  model.sampled[index("slope_across")] = {-10, 10};
  model.sampled[index("friction_angle")] = {10, 40};
  model.sampled[index("bed_depth")] = {kBed, kBed};
  model.sampled[index("ditch_width")] = {0.5, 2};
  model.sampled[index("ditch_depth")] = {0.1, 0.4};
  model.sampled[index("step_height")] = {0, 0};
  model.hash = "ditches";
  model.probabilities = [](std::span<const double> points, std::span<double> result) {
    const std::size_t width = contract().variables.size(), outcomes = contract().outcomes.size();
    std::fill(result.begin(), result.end(), 0.0);
    for (std::size_t i = 0; i * width < points.size(); ++i) {
      const double* x = &points[i * width];
      // Asked with another bed than its trials had, it answers what no test expects.
      const bool known = std::isnan(x[index("bed_depth")]) || x[index("bed_depth")] >= kBed;
      const double p = known ? p_ditch(x[index("ditch_width")], x[index("ditch_depth")], x[index("friction_angle")],
                                       x[index("slope_along")])
                             : -1;
      result[i * outcomes + contract().outcome_index(Verdict::go, Reason::none)] = 0.75 * p;
      result[i * outcomes + contract().outcome_index(Verdict::slow_go, Reason::none)] = 0.25 * p;
      result[i * outcomes + contract().outcome_index(Verdict::no_go, Reason::traction)] = 1 - p;
    }
  };
  return model;
}

OutcomeModel soil_model() {
  OutcomeModel model = test::AnalyticModel{}.outcome_model();
  for (const char* size : {"ditch_width", "ditch_depth", "step_height"}) model.sampled[index(size)] = {0, 0};
  return model;
}

/// A region of one soil with a friction angle, its obstacles, and trials of ditches.
MapRequest request_of(const TemporaryFolder& folder, double friction_angle, const std::string& obstacles,
                      const std::string& out) {
  write_file_atomically(folder / "region.json", R"({"schema": "gonogo/region/1", "region": "crossed",
    "rasters": [{"role": "elevation", "file": "dem.tif", "source": "s", "licence": "l"}],
    "values": {"friction_angle": {"fixed": )" + std::to_string(friction_angle) +
                                                    R"(, "source": "s"}, "cohesion": {"fixed": 0, "source": "s"},
               "bed_depth": {"fixed": 0.2, "source": "s"}},
    "obstacles": [)" + obstacles + "]}");
  MapRequest request;
  request.model = soil_model();
  request.region = read_region(folder / "region.json");
  request.region.crossing = kTruck;
  request.region.crossing->ditch_width = {0.5, 2};
  request.region.crossing->ditch_depth = {0.1, 0.4};
  add_crossing_model(request.model, ditch_model());
  request.out = folder / out;
  return request;
}

struct Layers {
  MapSummary summary;
  terrain::Tile go, reason, p, slope;
};

Layers map_of(const MapRequest& request) {
  const MapSummary summary = make_map(request);
  const auto read = [&](const char* name) {
    return terrain::RasterSource::open_as_it_lies(request.out / name).read({0, 0, kSide, kSide});
  };
  const auto dem = terrain::RasterSource::open_elevation(request.region.elevation.files);
  return {summary, read("go.tif"), read("reason.tif"), read("p_go.tif"),
          terrain::slope_degrees(dem.read({-1, -1, kSide + 2, kSide + 2}), {10, 10})};
}

bool says(const std::vector<std::string>& remarks, const std::string& text) {
  return std::any_of(remarks.begin(), remarks.end(), [&](const std::string& r) { return contains(r, text); });
}

}  // namespace

TEST_CASE("a point with a ditch gets the least of both models' P(go), and one without the soil's answer alone") {
  OutcomeModel model = soil_model();
  const OutcomeModel soil = model, ditches = ditch_model();
  model.members = {model.probabilities};
  add_crossing_model(model, ditches);
  const std::size_t width = contract().variables.size(), outcomes = contract().outcomes.size(), count = 1000;
  std::vector<double> points, result(count * outcomes), member(count * outcomes);
  const auto within = [](std::uint64_t i, std::uint64_t stream, double low, double high) {
    return low + (high - low) * random_unit(3, stream, i);
  };
  for (std::uint64_t i = 0; i < count; ++i) {
    std::vector<double> x(width, 0);
    x[index("friction_angle")] = within(i, 0, 10, 40);
    x[index("slope_along")] = within(i, 1, 0, 20);
    x[index("bed_depth")] = i % 3 == 0 ? NAN : 0.2;
    if (i % 2 == 1) x[index("ditch_width")] = within(i, 2, 0.5, 2);
    if (i % 2 == 1) x[index("ditch_depth")] = within(i, 3, 0.1, 0.4);
    points.insert(points.end(), x.begin(), x.end());
  }
  model.probabilities(points, result);
  model.members[0](points, member);
  CHECK(result == member);
  int lower = 0, higher = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double* x = &points[i * width];
    const double angle = x[index("friction_angle")], slope = x[index("slope_along")];
    const double on_soil = test::AnalyticModel{}.p_go(slope, angle, 0);
    const double in_ditch = i % 2 == 1 ? p_ditch(x[index("ditch_width")], x[index("ditch_depth")], angle, slope) : 1;
    const auto at = [&](Verdict v, Reason r) { return result[i * outcomes + contract().outcome_index(v, r)]; };
    const double p = at(Verdict::go, Reason::none) + at(Verdict::slow_go, Reason::none);
    CHECK(p == Approx(std::min(on_soil, in_ditch)).margin(1e-12));
    double sum = 0;
    for (std::size_t o = 0; o < outcomes; ++o) sum += result[i * outcomes + o];
    CHECK(sum == Approx(1));
    // Where the ditch is what stops the vehicle, the reason is the obstacle; else it is the soil's.
    CHECK(at(Verdict::no_go, Reason::obstacle) == Approx(in_ditch < on_soil ? 1 - p : 0).margin(1e-12));
    (in_ditch < on_soil ? lower : higher) += i % 2 == 1;
  }
  CHECK(lower > 10);
  CHECK(higher > 10);
  CHECK(model.crossing_hash == "ditches");
  CHECK(model.crossing_sampled[index("slope_along")].minimum == 0);  // the soil's trials drove uphill only
  CHECK(model.crossing_sampled[index("slope_along")].maximum == 10);
  CHECK(model.crossing_sampled[index("bed_depth")].minimum == soil.sampled[index("bed_depth")].minimum);
  CHECK(model.crossing_sampled[index("ditch_width")].maximum == 2);
}

TEST_CASE("ditches between the bounds get P(go) from trials of ditches, of other sizes they stay unknown") {
  const TemporaryFolder folder;
  test::make_flat_ground(folder);
  test::write_shapes(folder, "ditches.geojson",
                     test::column_line(3.5, R"("w": 1.0, "d": 0.3)") + "," +        // both bounds passed: trials
                         test::column_line(6.5, R"("w": 1.83, "d": 0.37)") + "," +  // the same, rounded up
                         test::column_line(9.5, R"("w": 2.5, "d": 0.3)") + "," +    // wider than trials
                         test::column_line(12.5, R"("w": 1.5, "d": 0.6)") + "," +   // no-go by geometry
                         test::column_line(15.5, R"("w": 0.3, "d": 0.3)"));         // passed by geometry
  test::write_shapes(folder, "beds.geojson", test::column_line(18.5, ""));
  test::write_shapes(folder, "road.geojson", test::row_line(12.5, ""));
  const std::string all =
      test::obstacle_entry("ditch", "ditches.geojson", R"(, "width_m": "w", "depth_m": "d")") + "," +
      test::obstacle_entry("dry_river", "beds.geojson", R"(, "width_m": 0.9, "depth_m": 0.25)") + "," +
      test::obstacle_entry("road", "road.geojson", R"(, "width_m": 6, "soil": "paved", "speed_km_h": 50)");
  const double angle = 22;
  const Layers map = map_of(request_of(folder, angle, all, "map"));
  for (int row = 1; row < kSide - 1; ++row)
    for (int column = 1; column < kSide - 1; ++column) {
      INFO(column << " " << row);
      const auto go = Verdict(int(map.go.at(column, row)));
      const double p = map.p.at(column, row), slope = rounded_slope(map.slope.at(column, row));
      const double on_soil = test::AnalyticModel{}.p_go(slope, angle, 0);
      const auto ditch = [&](double w, double d) { return std::min(on_soil, p_ditch(w, d, angle, slope)); };
      if (row == 12) {
        CHECK(go == Verdict::go);
      } else if (column == 3) {
        CHECK(p == Approx(ditch(1, 0.3)).margin(1e-6));
      } else if (column == 6) {
        CHECK(p == Approx(ditch(1.85, 0.4)).margin(1e-6));
        CHECK(go == Verdict::no_go);
        CHECK(Reason(int(map.reason.at(column, row))) == Reason::obstacle);
      } else if (column == 9) {
        CHECK((go == Verdict::unknown && std::isnan(p)));
      } else if (column == 12) {
        CHECK((go == Verdict::no_go && Reason(int(map.reason.at(column, row))) == Reason::obstacle));
      } else if (column == 18) {
        CHECK(p == Approx(ditch(0.9, 0.25)).margin(1e-6));
      } else {
        CHECK(p == Approx(on_soil).margin(1e-6));
      }
    }
  // 484 cells have a slope: 22 columns of 22, one row of which is the road.
  CHECK(says(map.summary.remarks, "trials of ditches decide on 13.0 % of the area"));
  CHECK(says(map.summary.remarks,
             "ditches on 4.3 % of the area are unknown: their trials sampled widths of 0.5 to 2 m and depths of 0.1 to "
             "0.4 m"));
  CHECK_FALSE(says(map.summary.remarks, "no such soil or slope"));
  CHECK_FALSE(says(map.summary.remarks, "rounded up"));
  CHECK(contains(read_file(folder / "map/index.html"), "ditch 1.85 m wide, 0.4 m deep"));
  CHECK(Json::read(folder / "map/map.json").at("inputs").at("crossing_model_hash").string() == "ditches");

  test::check_strips(request_of(folder, angle, all, "strips"), 5);
}

TEST_CASE("in soil or on slopes that trials of ditches did not sample, their cells are unknown and the map says so") {
  const TemporaryFolder folder;
  test::make_flat_ground(folder);
  test::write_shapes(folder, "d.geojson", test::column_line(3.5, ""));
  const std::string ditch = test::obstacle_entry("ditch", "d.geojson", R"(, "width_m": 1, "depth_m": 0.3)");
  MapRequest request = request_of(folder, 22, ditch, "weak");
  request.model.crossing_sampled[index("friction_angle")] = {25, 40};
  const Layers weak = map_of(request);
  CHECK(Verdict(int(weak.go.at(3, 10))) == Verdict::unknown);
  CHECK(passes(Verdict(int(weak.go.at(4, 10)))));
  CHECK(says(weak.summary.remarks, "ditches on 4.5 % of the area are unknown: their trials sampled no such soil"));

  // A plane of 12 degrees, beyond the 10 of the trials of ditches and within the 35 of those on soil.
  std::vector<float> value;
  for (int row = 0; row < kSide; ++row) value.insert(value.end(), kSide, float(500 + 10 * std::tan(0.2094395) * row));
  test::make_raster(folder / "dem.tif", {.columns = kSide, .rows = kSide, .value = value});
  const Layers steep = map_of(request_of(folder, 30, ditch, "steep"));
  CHECK(Verdict(int(steep.go.at(3, 10))) == Verdict::unknown);
  CHECK(passes(Verdict(int(steep.go.at(4, 10)))));
  CHECK(says(steep.summary.remarks, "no such soil or slope"));
}

TEST_CASE("many sizes of ditches are rounded up to few, no larger than what trials sampled, and the map says to what") {
  const TemporaryFolder folder;
  test::make_flat_ground(folder);
  std::string lines;
  for (int k = 0; k < 20; ++k)
    lines += (k > 0 ? "," : "") + test::column_line(1.5 + k, R"("w": )" + std::to_string(0.95 + 0.05 * k) +
                                                                 R"(, "d": )" + std::to_string(0.2 + 0.01 * k));
  test::write_shapes(folder, "d.geojson", lines);
  const std::string ditch = test::obstacle_entry("ditch", "d.geojson", R"(, "width_m": "w", "depth_m": "d")");
  const Layers map = map_of(request_of(folder, 22, ditch, "map"));
  CHECK(says(map.summary.remarks, "widths and depths of ditches are rounded up to 0.1 m"));
  for (int k = 0; k < 20; ++k) {
    const double width = std::ceil((0.95 + 0.05 * k) / 0.1 - 1e-6) * 0.1;
    const double depth = std::ceil((0.2 + 0.01 * k) / 0.1 - 1e-6) * 0.1;
    const double slope = rounded_slope(map.slope.at(1 + k, 10));
    const double expected =
        std::min(test::AnalyticModel{}.p_go(slope, 22, 0), p_ditch(std::min(width, 2.0), depth, 22, slope));
    INFO(k);
    CHECK(map.p.at(1 + k, 10) == Approx(expected).margin(1e-6));
  }
}
