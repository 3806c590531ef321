#include "pipeline/campaign/design/design.h"

#include <boost/random/sobol.hpp>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <set>

#include "base/files/file.h"
#include "base/math/random.h"
#include "pipeline/campaign/design/sobol.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo::campaign {

namespace {

Config section(const std::string& text) { return Config::parse(text, "study.json"); }

const std::string kFixed = R"("fixed": {"payload": 0, "tyre_friction": 0.8, "bed_depth": 0.3, "commanded_speed": 1})";
const std::string kRanges =
    R"("ranges": {"slope_along": [0, 35], "slope_across": [-10, 10], "friction_angle": [25, 45],
                  "cohesion": [0, 5], "relative_density": [0, 1]})";

std::string with_points(int points, int replicate_every = 10) {
  return R"({"method": "sobol", "points": )" + std::to_string(points) + R"(, "replicate_every": )" +
         std::to_string(replicate_every) + ", " + kRanges + ", " + kFixed + "}";
}

double unit(std::uint32_t fraction) { return double(fraction) * 0x1.0p-32; }

TEST_CASE("Sobol' points before scrambling are the ones Joe and Kuo publish") {
  // First ten points in three dimensions, from the example on the authors' page.
  const double published[10][3] = {{0, 0, 0},
                                   {0.5, 0.5, 0.5},
                                   {0.75, 0.25, 0.25},
                                   {0.25, 0.75, 0.75},
                                   {0.375, 0.375, 0.625},
                                   {0.875, 0.875, 0.125},
                                   {0.625, 0.125, 0.875},
                                   {0.125, 0.625, 0.375},
                                   {0.1875, 0.3125, 0.9375},
                                   {0.6875, 0.8125, 0.4375}};
  for (std::uint32_t i = 0; i < 10; ++i)
    for (int j = 0; j < 3; ++j) CHECK(unit(sobol(i, j)) == published[i][j]);
}

TEST_CASE("Sobol' points equal those of Boost.Random in every dimension") {
  boost::random::sobol boost_sobol(kSobolDimensions);  // 64-bit fractions; starts at the point after zero
  for (std::uint32_t i = 1; i < 3000; ++i)
    for (int j = 0; j < kSobolDimensions; ++j) {
      const double expected = double(boost_sobol()) * 0x1.0p-64;
      if (unit(sobol(i, j)) != expected) FAIL("point " << i << " dimension " << j);
    }
}

TEST_CASE("the first 2^k scrambled points lie one in each interval of width 1/2^k, in every dimension") {
  for (const int k : {3, 6, 10}) {
    for (int dimension = 0; dimension < kSobolDimensions; ++dimension) {
      std::set<std::uint32_t> hit;
      for (std::uint32_t i = 0; i < (1u << k); ++i)
        hit.insert(std::uint32_t(scrambled_sobol(i, 7, dimension) * (1 << k)));
      CHECK(hit.size() == std::size_t(1) << k);
    }
  }
}

TEST_CASE("the first two dimensions hit every elementary interval once") {
  constexpr int k = 8;
  for (int across = 0; across <= k; ++across) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> hit;
    for (std::uint32_t i = 0; i < (1u << k); ++i)
      hit.emplace(std::uint32_t(scrambled_sobol(i, 3, 0) * (1 << across)),
                  std::uint32_t(scrambled_sobol(i, 3, 1) * (1 << (k - across))));
    CHECK(hit.size() == std::size_t(1) << k);
  }
}

TEST_CASE("scrambling is unbiased: every coordinate of one point is uniform over seeds") {
  constexpr int seeds = 4000;
  for (const std::uint32_t index : {0u, 5u}) {
    double sum = 0, squares = 0;
    for (int seed = 0; seed < seeds; ++seed) {
      const double u = scrambled_sobol(index, std::uint64_t(seed), 2);
      sum += u;
      squares += u * u;
    }
    CHECK(sum / seeds == Approx(0.5).margin(4 * std::sqrt(1.0 / 12 / seeds)));
    CHECK(squares / seeds == Approx(1.0 / 3).margin(4 * std::sqrt(4.0 / 45 / seeds)));
  }
}

TEST_CASE("a scrambled design integrates with far less error than random points") {
  // Product of 1 + (x_j - 1/2) over five dimensions: integral 1.
  constexpr std::uint32_t points = 256;
  constexpr int repeats = 20;
  double sobol_error = 0, random_error = 0;
  for (std::uint64_t seed = 0; seed < repeats; ++seed) {
    double sobol_sum = 0, random_sum = 0;
    for (std::uint32_t i = 0; i < points; ++i) {
      double a = 1, b = 1;
      for (int j = 0; j < 5; ++j) {
        a *= 0.5 + scrambled_sobol(i, seed, j);
        b *= 0.5 + random_unit(seed, std::uint64_t(j), i);
      }
      sobol_sum += a;
      random_sum += b;
    }
    sobol_error += std::pow(sobol_sum / points - 1, 2);
    random_error += std::pow(random_sum / points - 1, 2);
  }
  CHECK(sobol_error * 20 < random_error);
}

TEST_CASE("a design stays inside its ranges, keeps fixed values and repeats one point in ten") {
  const DesignSpec spec = read_design(section(with_points(96)), 11);
  const std::vector<DesignPoint> design = make_design(spec);
  REQUIRE(design.size() == 105);
  CHECK(trial_count(spec) == 105);
  std::set<std::uint64_t> seeds;
  int replicates = 0;
  for (std::size_t i = 0; i < design.size(); ++i) {
    const DesignPoint& point = design[i];
    CHECK(point.index == i);
    CHECK(point.proposal_density == 1);
    seeds.insert(point.seed);
    CHECK((point.variables[0] > 0 && point.variables[0] < 35));
    CHECK((point.variables[1] > -10 && point.variables[1] < 10));
    CHECK(point.variables[6] == 0.8);
    if (point.replicate_of < 0) continue;
    ++replicates;
    const DesignPoint& original = design[std::size_t(point.replicate_of)];
    CHECK(original.replicate_of == -1);
    CHECK((original.index < point.index && point.index - original.index <= 10));
    CHECK(original.variables == point.variables);
  }
  CHECK(replicates == 9);
  CHECK(seeds.size() == design.size());
}

TEST_CASE("a longer design begins with the same trials; another seed gives other points") {
  const auto longer = make_design(read_design(section(with_points(300)), 11));
  const auto shorter = make_design(read_design(section(with_points(128)), 11));
  const auto other = make_design(read_design(section(with_points(128)), 12));
  for (std::size_t i = 0; i < shorter.size(); ++i) {
    CHECK(shorter[i].seed == longer[i].seed);
    CHECK(shorter[i].variables == longer[i].variables);
    CHECK(shorter[i].replicate_of == longer[i].replicate_of);
    CHECK(shorter[i].seed != other[i].seed);
    CHECK(shorter[i].variables[0] != other[i].variables[0]);
  }
}

TEST_CASE("coverage: Warnock's formula against a sum over a fine grid, and better than random") {
  const DesignSpec small = read_design(section(R"({"method": "sobol", "points": 6, "replicate_every": 3,
                  "ranges": {"slope_along": [0, 1], "slope_across": [0, 1]}, "fixed": {"friction_angle": 30,
                  "cohesion": 0, "relative_density": 0.5, "payload": 0, "tyre_friction": 0.8, "bed_depth": 0.3,
                  "commanded_speed": 1}})"),
                                       4);
  const auto design = make_design(small);
  constexpr int cells = 700;
  double sum = 0;
  for (int a = 0; a < cells; ++a)
    for (int b = 0; b < cells; ++b) {
      const double x = (a + 0.5) / cells, y = (b + 0.5) / cells;
      int below = 0;
      for (const auto& p : design) below += p.replicate_of < 0 && p.variables[0] < x && p.variables[1] < y;
      sum += std::pow(below / 6.0 - x * y, 2);
    }
  CHECK(coverage(small, design).discrepancy == Approx(std::sqrt(sum / cells / cells)).epsilon(2e-3));

  const DesignSpec spec = read_design(section(with_points(256)), 1);
  const Coverage found = coverage(spec, make_design(spec));
  CHECK(found.discrepancy < 0.5 * found.expected_random);
  CHECK(found.largest_gap < 2.0 / 256);
}

TEST_CASE("the largest empty ball: known for a square with its corners and for a single point") {
  CHECK(largest_empty_ball({{0, 0}, {0, 1}, {1, 0}, {1, 1}}, 2) == Approx(std::sqrt(0.5)).epsilon(2e-3));
  CHECK(largest_empty_ball({{0.2, 0.3}}, 2) == Approx(std::hypot(0.8, 0.7)).epsilon(2e-3));
  CHECK(largest_empty_ball({{0.5, 0.5, 0.5}}, 3) == Approx(std::sqrt(0.75)).epsilon(2e-3));
}

std::string design_text(const std::string& method, const std::string& more) {
  return R"({"method": ")" + method + R"(", )" + more + ", " + kRanges + ", " + kFixed + "}";
}

TEST_CASE("Latin hypercubes: each block has one point in each of its intervals, in every variable; extendable") {
  const auto read = [](int points) {
    return read_design(section(design_text("latin_hypercube", "\"block\": 25, \"replicate_every\": 0, \"points\": " +
                                                                  std::to_string(points))),
                       5);
  };
  const DesignSpec spec = read(100);
  const auto design = make_design(spec);
  for (std::size_t first = 0; first < 100; first += 25)
    for (const SampledVariable& range : spec.ranges) {
      std::set<int> hit;
      for (std::size_t i = first; i < first + 25; ++i)
        hit.insert(int(25 * (design[i].variables[range.variable] - range.minimum) / (range.maximum - range.minimum)));
      CHECK(hit.size() == 25);
    }
  const auto longer = make_design(read(130));
  for (std::size_t i = 0; i < 100; ++i) CHECK(longer[i].variables == design[i].variables);
  CHECK(design[0].variables != design[25].variables);
}

TEST_CASE("a factorial holds every combination of its levels once, ends included") {
  const DesignSpec spec = read_design(
      section(design_text("factorial", R"("replicate_every": 0, "levels": {"slope_along": 3, "slope_across": 2,
              "friction_angle": 2, "cohesion": 2, "relative_density": 4})")),
      5);
  const auto design = make_design(spec);
  REQUIRE(design.size() == 96);
  std::set<std::vector<double>> different;
  std::set<double> slopes;
  for (const DesignPoint& point : design) {
    different.insert(point.variables);
    slopes.insert(point.variables[contract().variable_index("slope_along")]);
  }
  CHECK(different.size() == 96);
  CHECK(slopes == std::set<double>{0, 17.5, 35});
}

TEST_CASE("strata get their shares at every length, and weighing by their density gives back the uniform box") {
  const DesignSpec spec = read_design(section(design_text("sobol", R"("points": 4096, "replicate_every": 0, "strata": [
          {"name": "sand", "share": 0.25, "ranges": {"friction_angle": [35, 45], "cohesion": [0, 1]}},
          {"name": "loam", "share": 0.25, "ranges": {"friction_angle": [25, 40]}},
          {"name": "anything", "share": 0.5, "ranges": {}}])")),
                                      5);
  const auto design = make_design(spec);
  const std::size_t angle = contract().variable_index("friction_angle"),
                    cohesion = contract().variable_index("cohesion");
  const auto is_sand = [&](const DesignPoint& p) { return p.variables[angle] > 35 && p.variables[cohesion] < 1; };
  int sand = 0;
  double weight = 0, weighted_sand = 0;
  for (std::size_t i = 0; i < design.size(); ++i) {
    weight += 1 / design[i].proposal_density;
    sand += is_sand(design[i]);
    weighted_sand += is_sand(design[i]) / design[i].proposal_density;
  }
  // Half of the friction angles and a fifth of the cohesions are sand: a tenth of the box.
  const double n = double(design.size());
  CHECK(sand / n == Approx(0.25 + 0.25 * (1.0 / 3) * 0.2 + 0.5 * 0.1).margin(0.01));
  CHECK(weight / n == Approx(1).margin(0.02));
  CHECK(weighted_sand / weight == Approx(0.1).margin(0.01));
  const auto shorter =
      make_design(read_design(section(design_text("sobol", R"("points": 100, "replicate_every": 0, "strata": [
          {"name": "sand", "share": 0.25, "ranges": {"friction_angle": [35, 45], "cohesion": [0, 1]}},
          {"name": "loam", "share": 0.25, "ranges": {"friction_angle": [25, 40]}},
          {"name": "anything", "share": 0.5, "ranges": {}}])")),
                              5));
  for (std::size_t i = 0; i < 100; ++i) CHECK(shorter[i].variables == design[i].variables);
}

struct PointFile {
  TemporaryFolder folder;
  std::string write(const std::string& text) const {
    write_file_atomically(folder / "points.txt", text);
    return (folder / "points.txt").string();
  }
  DesignSpec read(const std::string& method, const std::string& text, const std::string& fixed) const {
    return read_design(section(R"({"method": ")" + method + R"(", "replicate_every": 0, "file": ")" + write(text) +
                               R"(", "fixed": {)" + fixed + "}}"),
                       1);
  }
  std::string refusal(const std::string& method, const std::string& text, const std::string& fixed) const {
    return input_error([&] { read(method, text, fixed); });
  }
};

const std::string kOthers = R"("slope_across": 0, "relative_density": 0.5, "payload": 0, "tyre_friction": 0.8,
                               "bed_depth": 0.1, "commanded_speed": 1.1)";

TEST_CASE("points from a CSV: columns in any order, densities, ranges and fixed values found in them") {
  const PointFile place;
  const DesignSpec spec = place.read("csv", "# two\ncohesion, slope_along,proposal_density\r\n1,10,0.5\n\n2,20,1.5\n",
                                     kOthers + R"(, "friction_angle": 30)");
  const auto design = make_design(spec);
  REQUIRE(design.size() == 2);
  CHECK(design[1].variables[contract().variable_index("slope_along")] == 20);
  CHECK(design[1].variables[contract().variable_index("cohesion")] == 2);
  CHECK(design[1].variables[contract().variable_index("friction_angle")] == 30);
  CHECK(design[0].proposal_density == 0.5);
  CHECK(spec.ranges.size() == 2);
  const std::string angle = kOthers + R"(, "friction_angle": 30)";
  CHECK(contains(place.refusal("csv", "slope_allong\n1\n", angle), "line 1: \"slope_allong\" is no variable"));
  CHECK(contains(place.refusal("csv", "slope_along,cohesion\n1,2\n1\n", angle), "line 3: has 1 columns, the header 2"));
  CHECK(contains(place.refusal("csv", "slope_along,cohesion\n1,x\n", angle), "line 2: \"x\" is no number"));
  CHECK(contains(place.refusal("csv", "slope_along,cohesion\n60,1\n", angle),
                 "slope_along is 60 deg, allowed is [-45, 45]"));
  CHECK(contains(place.refusal("csv", "slope_along\n10\n", angle), "\"cohesion\" is neither a column"));
  CHECK(contains(place.refusal("csv", "", angle), "holds no points"));
  CHECK(contains(place.refusal("csv", "slope_along,cohesion\n", angle), "a header and no points"));
}

TEST_CASE("lines of the original study: slope, friction as an angle, cohesion by its scale") {
  const PointFile place;
  const auto design = make_design(place.read("original", "30 8 2500 1 50\n0 8 2500 0.2 0\n", kOthers));
  REQUIRE(design.size() == 2);
  CHECK(design[0].variables[contract().variable_index("slope_along")] == 30);
  CHECK(design[0].variables[contract().variable_index("friction_angle")] == Approx(45));
  CHECK(design[0].variables[contract().variable_index("cohesion")] == 50);
  CHECK(design[1].variables[contract().variable_index("friction_angle")] == Approx(11.309932));
  CHECK(contains(place.refusal("original", "30 8 2500 1\n", kOthers), "line 1: five numbers"));
  CHECK(contains(place.refusal("original", "30 8 2500 1 50 1\n", kOthers), "more than five"));
  CHECK(contains(place.refusal("original", "30 8 2500 1 50\n30 4 2500 1 50\n", kOthers), "line 2: grains of 4 mm"));
  CHECK(contains(place.refusal("original", "30 8 2500 1 500\n", kOthers), "cohesion is 500 kPa"));
}

TEST_CASE("presets name variables of the contract inside its ranges, and a study says what it wants otherwise") {
  for (const std::string& name : preset_names()) {
    const DesignPreset preset = design_preset(name);
    for (const auto& [variable, range] : preset.ranges) {
      const Variable& known = contract().variables[contract().variable_index(variable)];
      CHECK((range.first >= known.minimum && range.second <= known.maximum && range.first < range.second));
    }
    for (const auto& [variable, value] : preset.fixed) {
      const Variable& known = contract().variables[contract().variable_index(variable)];
      CHECK((value >= known.minimum && value <= known.maximum));
      CHECK(preset.ranges.count(variable) == 0);
    }
    const DesignSpec spec = read_design(section(R"({"method": "sobol", "points": 8, "preset": ")" + name +
                                                R"(", "ranges": {"payload": [0, 500]}, "fixed": {"cohesion": 2}})"),
                                        1);
    CHECK(spec.fixed[contract().variable_index("cohesion")] == 2);
    CHECK(std::isnan(spec.fixed[contract().variable_index("payload")]));
    CHECK(spec.ranges.size() == preset.ranges.size());
  }
}

TEST_CASE("bad design sections: one sentence with file, place and what to do") {
  const auto refusal = [](const std::string& text) { return input_error([&] { read_design(section(text), 1); }); };
  const std::string head = R"({"method": "sobol", "points": 8, )";
  const std::string typo = refusal(head + R"("ranges": {"slope_allong": [0, 35]}, )" + kFixed + "}");
  CHECK(contains(typo, "study.json: ranges.slope_allong"));
  CHECK(contains(typo, "did you mean \"slope_along\""));
  const std::string missing = refusal(head + R"("ranges": {"slope_along": [0, 35]}, )" + kFixed + "}");
  CHECK(contains(missing, "\"slope_across\" is neither"));
  CHECK(contains(missing, "[-45, 45] deg"));
  const std::string wide = refusal(head + R"("ranges": {"slope_along": [0, 60]}, )" + kFixed + "}");
  CHECK(contains(wide, "ranges.slope_along[1]"));
  CHECK(contains(wide, "60"));
  CHECK(contains(refusal(head + R"("ranges": {"slope_along": [30, 10]}, )" + kFixed + "}"), "minimum < maximum"));
  CHECK(contains(refusal(head + R"("ranges": {"slope_along": [3]}, )" + kFixed + "}"), "minimum < maximum"));
  CHECK(contains(refusal(head + R"("ranges": {"payload": [0, 1]}, )" + kFixed + "}"), "keep one of the two"));
  CHECK(contains(refusal(with_points(0)), "points"));
  CHECK(contains(refusal(R"({"method": "sobool", "points": 8})"), "\"sobool\" is not one of: sobol"));
  CHECK(contains(refusal(R"({"method": "sobol", "point": 8})"), "points"));
}

}  // namespace
}  // namespace gonogo::campaign
