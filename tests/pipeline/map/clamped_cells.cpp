// Cells of a map beside the annealing problem that is clamped to them, by exact rows and by the emulator.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/math/random.h"
#include "base/units.h"
#include "learning/score/score.h"
#include "pipeline/map/evaluate/soil_response.h"
#include "pipeline/map/map_request.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/qubo/qubo_exchange.h"
#include "pipeline/outcome/training_data.h"
#include "terrain/raster/layer/slope.h"
#include "terrain/raster/raster_source.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;
using terrain::RasterSource;
using terrain::Tile;

namespace {

/// A shipped model with the ground that its map is made of.
struct World {
  std::string model, crs;
  std::array<double, 6> transform;  // cells of 10 m
  std::vector<std::string> set;     // of the mission and of the bed
  double steepest;                  // slope of the last column [deg]
};

const World kHmmwv = {
    "hmmwv",
    "EPSG:32610",
    {500000, 10, 0, 4400000, 0, -10},
    {"relative_density=0.55", "payload=700", "tyre_friction=0.7", "bed_depth=0.2", "commanded_speed=2.1"},
    33};
const World kViper = {"viper",
                      "IAU_2015:30135",
                      {30000, 10, 0, 20000, 0, -10},
                      {"relative_density=0.5", "payload=40", "tyre_friction=0.6", "bed_depth=0.2"},
                      28};
const World kQuarter = {
    "quarter_wheel_90mm",
    "EPSG:32610",
    {500000, 10, 0, 4400000, 0, -10},
    {"relative_density=0.5", "payload=500", "tyre_friction=0.8", "bed_depth=0.3", "commanded_speed=1.5"},
    33};

constexpr int kColumns = 42, kStrip = 6;
constexpr double kHeading = 60;  // [deg] on ground that rises eastward: uphill, and across by half as much
/// Friction angle [deg] and cohesion [kPa], a strip of rows of each.
const std::vector<std::array<double, 2>> kSoils = {{27, 0.2}, {30, 0.6}, {33, 1.1}, {37, 0.4}, {42, 1.8}};
const int kRows = kStrip * int(kSoils.size());

struct Cell {
  std::map<std::string, double> known;  // every variable that the trials varied
  double p_go = 0;                      // of the map
};

/// Rises eastward, the steeper the farther.
void make_ground(const World& world, const TemporaryFolder& folder) {
  std::vector<float> row, height, code;
  double z = 2000;
  for (int column = 0; column < kColumns; ++column) {
    row.push_back(float(z));
    z += 10 * std::tan(to_radians(world.steepest * (column + 0.5) / kColumns));
  }
  std::string soils;
  for (int r = 0; r < kRows; ++r) {
    height.insert(height.end(), row.begin(), row.end());
    code.insert(code.end(), kColumns, float(1 + r / kStrip));
  }
  for (std::size_t s = 0; s < kSoils.size(); ++s)
    soils += (s > 0 ? ", " : "") + line(R"({"code": %zu, "name": "soil %zu", "texture": "sand",
                      "samples": [{"friction_angle": %g, "cohesion": %g, "source": "made"}]})",
                                        s + 1, s + 1, kSoils[s][0], kSoils[s][1]);
  const test::RasterRecipe shape = {.columns = kColumns, .rows = kRows, .transform = world.transform, .crs = world.crs};
  test::RasterRecipe elevation = shape, soil = shape;
  elevation.value = height;
  soil.value = code;
  soil.nodata = 255;
  soil.type = GDT_Byte;
  test::make_raster(folder / "dem.tif", elevation);
  test::make_raster(folder / "soil.tif", soil);
  write_file_atomically(folder / "region.json", R"({"schema": "gonogo/region/1", "region": "made ground",
    "rasters": [{"role": "elevation", "file": "dem.tif", "source": "made", "licence": "none"},
                {"role": "soil_class", "file": "soil.tif", "source": "made", "licence": "none"}],
    "soils": [)" + soils + "]}");
}

/// A slope [deg] as the map takes it in a set heading.
double tabulated(double slope) { return std::round(slope * kHeadingSteps) / kHeadingSteps; }

/// 50 cells of the map that the model makes of this ground: ten slopes on each of five soils.
std::vector<Cell> mapped_cells(const World& world, const outcome::Predictor& predictor) {
  const TemporaryFolder folder;
  make_ground(world, folder);
  MapFiles files;
  files.model = world.model;
  files.region = folder / "region.json";
  files.set = world.set;
  files.heading = number_text(kHeading);
  files.out = folder / "map";
  const MapRequest request = read_map_request(files);
  make_map(request);
  const RasterSource dem = RasterSource::open_elevation(folder / "dem.tif");
  const terrain::MapGrid& grid = dem.grid();
  const Tile elevation = dem.read({-1, -1, kColumns + 2, kRows + 2});
  const terrain::CellSize size = {grid.cell_width_m(), grid.cell_height_m()};
  const Tile slope = terrain::slope_degrees(elevation, size), aspect = terrain::aspect_degrees(elevation, size);
  const Tile p_go = RasterSource::open_on_grid(folder / "map/p_go.tif", grid, terrain::RasterKind::classes)
                        .read({0, 0, kColumns, kRows});
  std::vector<Cell> cells;
  for (std::size_t s = 0; s < kSoils.size(); ++s) {
    const auto points = soil_points(request.region, request.region.soils[s], request.rules.values, request.rules.draws);
    REQUIRE(points.size() == 1);
    REQUIRE(grid.columns == kColumns);
    for (int column = 3; column < kColumns - 1; column += 4) {
      const int row = int(s) * kStrip + kStrip / 2;
      const BedSlopes bed = bed_slopes(rounded_slope(slope.at(column, row)),
                                       fall_line_angle(kHeading, rounded_aspect(aspect.at(column, row))));
      std::vector<double> point = points.front();
      point[contract().variable_index("slope_along")] = tabulated(bed.along);
      point[contract().variable_index("slope_across")] = tabulated(bed.across);
      Cell cell{{}, p_go.at(column, row)};
      for (const std::size_t v : outcome::varying_inputs(predictor.model().layout))
        cell.known[contract().variables[v].name] = point[v];
      INFO("soil " << s + 1 << ", column " << column << ", slopes " << bed.along << " and " << bed.across << " deg");
      REQUIRE(cell.p_go == Approx(predictor.p_go(point)).margin(1e-6));
      cells.push_back(std::move(cell));
    }
  }
  return cells;
}

/// 50 points of the sampled box, for models whose maps take more than ground: a ditch, or a vehicle.
std::vector<Cell> points_of_box(const outcome::Predictor& predictor) {
  const learning::Model& model = predictor.model();
  std::vector<Cell> cells;
  for (std::size_t n = 0; n < 50; ++n) {
    std::vector<double> point = model.sampled_lower;
    Cell cell;
    for (const std::size_t v : outcome::varying_inputs(model.layout)) {
      point[v] += random_unit(56, v, n) * (model.sampled_upper[v] - model.sampled_lower[v]);
      cell.known[contract().variables[v].name] = point[v];
    }
    cell.p_go = predictor.p_go(point);
    cells.push_back(std::move(cell));
  }
  return cells;
}

/// P(go) of an answer's outcomes, with the model's calibration, which maps have and rows do not.
double passing(const outcome::AnswerSummary& summary, double power) {
  std::vector<double> share;
  for (const auto& outcome : summary.outcomes) share.push_back(outcome.frequency.mean);
  learning::sharpen(share, power);
  double sum = 0;
  for (std::size_t y = 0; y < share.size(); ++y)
    if (summary.outcomes[y].name == "go" || summary.outcomes[y].name == "slow_go") sum += share[y];
  return sum;
}

/// How far sampled P(go) of the cells is from the map's.
struct Compared {
  double worst = 0, mean = 0;  // differences
  int taken = 0, biased = 0, refused = 0;

  void add(double apart) {
    worst = std::max(worst, apart);
    mean = (taken * mean + apart) / (taken + 1);
    ++taken;
  }
};

learning::SampleSet exact_rows(const outcome::MachineProblem& problem, std::uint64_t seed) {
  return learning::make_sampler("exact")->sample(problem.problem, {.reads = 10000, .seed = seed, .sweeps = 1});
}

learning::SampleSet emulated_rows(const outcome::MachineProblem& problem, std::uint64_t seed) {
  outcome::DeviceChoice device;
  device.graph.name = "pegasus:16";
  device.graph.dead_share = 0.02;
  std::optional<learning::Correction> correction;
  return outcome::emulated_rows({problem.problem, problem.sidecar}, device,
                                {.reads = 4000, .seed = seed, .sweeps = 1000}, correction);
}

/// An answer that import names biased, or refuses, counts as such and not by its difference.
void add_emulated(Compared& emulated, const outcome::MachineProblem& problem, double p_go, double power,
                  std::uint64_t seed) {
  try {
    const auto answer =
        outcome::decode_answer_to(problem.problem, problem.sidecar, emulated_rows(problem, seed), {}, "answer");
    if (answer.summary->bias.verdict == "biased")
      ++emulated.biased;
    else
      emulated.add(std::abs(passing(*answer.summary, power) - p_go));
  } catch (const InputError& error) {
    std::printf("%s\n", error.what());
    ++emulated.refused;
  }
}

void print(const char* rows, const Compared& found) {
  std::printf("%s rows: P(go) of %d cells %.4f apart at most, %.4f in the mean; %d biased, %d refused\n", rows,
              found.taken, found.worst, found.mean, found.biased, found.refused);
}

/// Exact and emulated rows of every step-th cell.
void check_cells(const std::string& name, const outcome::Predictor& predictor, const std::vector<Cell>& cells,
                 std::size_t step) {
  REQUIRE(cells.size() == 50);
  const double power = predictor.model().calibration_power;
  Compared exact, emulated;
  for (std::size_t k = 0; k < cells.size(); k += step) {
    const outcome::MachineProblem problem =
        outcome::machine_problem(predictor.model(), cells[k].known, learning::Vartype::binary);
    const auto answer =
        outcome::decode_answer_to(problem.problem, problem.sidecar, exact_rows(problem, k + 1), {}, "answer");
    exact.add(std::abs(passing(*answer.summary, power) - cells[k].p_go));
    add_emulated(emulated, problem, cells[k].p_go, power, k + 1);
  }
  std::printf("%s, ", name.c_str());
  print("exact", exact);
  print("emulated", emulated);
  CHECK(exact.worst < 0.03);
  CHECK(emulated.worst < 0.05);
  CHECK(emulated.taken > exact.taken / 3);
}

void check_map(const World& world, std::size_t step) {
  const TrainedModel model = read_trained_model(find_model(world.model));
  const std::vector<Cell> cells = mapped_cells(world, *model.predictor);
  const auto [least, most] =
      std::minmax_element(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) { return a.p_go < b.p_go; });
  CHECK(least->p_go < 0.1);
  CHECK(most->p_go > 0.9);
  check_cells(world.model, *model.predictor, cells, step);
}

/// folder: of the shipped model.
void check_box(const std::string& folder) {
  const TrainedModel model = read_trained_model(std::filesystem::path("data") / folder / "model.h5");
  check_cells(folder, *model.predictor, points_of_box(*model.predictor), 1);
}

}  // namespace

TEST_CASE("cells of the HMMWV's map have the P(go) of the problem clamped to them, or the answer is named biased") {
  check_map(kHmmwv, 5);
}

TEST_CASE("cells of the rover's map have the P(go) of the problem clamped to them, or the answer is named biased") {
  check_map(kViper, 5);
}

// By hand: some five minutes each on one quiet core.
TEST_CASE("all 50 cells of the HMMWV's map", "[.table]") { check_map(kHmmwv, 1); }

TEST_CASE("all 50 cells of the rover's map", "[.table]") { check_map(kViper, 1); }

TEST_CASE("all 50 cells of the quarter wheel's map", "[.table]") { check_map(kQuarter, 1); }

TEST_CASE("50 ditches", "[.table]") { check_box("hmmwv_ditch_32mm"); }

TEST_CASE("50 vehicles and grounds of the family", "[.table]") { check_box("wheeled_family_32mm"); }
