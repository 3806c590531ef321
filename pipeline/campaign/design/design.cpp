#include "pipeline/campaign/design/design.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <sstream>

#include "base/error.h"
#include "base/files/csv.h"
#include "base/format.h"
#include "base/math/random.h"
#include "base/units.h"
#include "pipeline/campaign/design/sobol.h"
#include "pipeline/campaign/study/contract.h"

namespace gonogo::campaign {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kBedStream = 0x6265640000000000;        // bed seeds, by index of the trial
constexpr std::uint64_t kReplicateStream = 0x7265706c00000000;  // which point of a block is repeated
constexpr std::uint64_t kCubeStream = 0x6c68730000000000;       // cells and places in them of Latin hypercubes

/// Position of a value in a random permutation of 0 .. size - 1 that belongs to `key`: rank of its random number.
std::vector<std::uint64_t> permutation(std::uint64_t seed, std::uint64_t stream, std::uint64_t first,
                                       std::uint64_t size) {
  std::vector<std::uint64_t> order(size);
  std::iota(order.begin(), order.end(), std::uint64_t(0));
  std::sort(order.begin(), order.end(), [&](std::uint64_t a, std::uint64_t b) {
    const std::uint64_t x = random_bits(seed, stream, first + a), y = random_bits(seed, stream, first + b);
    return x != y ? x < y : a < b;
  });
  return order;
}

/// Coordinates in (0, 1) of the points of one stratum, one after the other.
class UnitPoints {
 public:
  UnitPoints(const DesignSpec& spec, std::uint64_t stratum) : spec_(spec), seed_(spec.seed + (stratum << 32)) {}

  std::vector<double> next() {
    const std::uint64_t number = number_++;
    std::vector<double> unit(spec_.ranges.size());
    if (spec_.method == "latin_hypercube") {
      if (number % spec_.block == 0) begin_cube(number);
      for (std::size_t j = 0; j < unit.size(); ++j)
        unit[j] = (double(cells_[j][number % spec_.block]) + random_unit(seed_, kCubeStream + 2 * j + 1, number)) /
                  double(spec_.block);
    } else {
      for (std::size_t j = 0; j < unit.size(); ++j) unit[j] = scrambled_sobol(std::uint32_t(number), seed_, int(j));
    }
    return unit;
  }

 private:
  void begin_cube(std::uint64_t first) {
    cells_.clear();
    for (std::size_t j = 0; j < spec_.ranges.size(); ++j)
      cells_.push_back(permutation(seed_, kCubeStream + 2 * j, first, spec_.block));
  }

  const DesignSpec& spec_;
  std::uint64_t seed_, number_ = 0;
  std::vector<std::vector<std::uint64_t>> cells_;  // [variable][point of the cube]
};

/// The point of number `number` of all combinations, the last variable running fastest.
DesignPoint combination(const DesignSpec& spec, std::uint64_t number) {
  DesignPoint point;
  point.variables = spec.fixed;
  for (std::size_t j = spec.ranges.size(); j-- > 0;) {
    const SampledVariable& range = spec.ranges[j];
    const std::uint64_t level = number % spec.levels[j];
    number /= spec.levels[j];
    point.variables[range.variable] =
        range.minimum + (range.maximum - range.minimum) * double(level) / double(spec.levels[j] - 1);
  }
  return point;
}

/// Sampled ranges of a stratum: its own, or else the design's.
std::vector<SampledVariable> ranges_of(const DesignSpec& spec, const Stratum& stratum) {
  std::vector<SampledVariable> ranges = spec.ranges;
  for (SampledVariable& range : ranges)
    for (const SampledVariable& own : stratum.ranges)
      if (own.variable == range.variable) range = own;
  return ranges;
}

/// Base points of a design, replicates left out, in order.
class BasePoints {
 public:
  explicit BasePoints(const DesignSpec& spec) : spec_(spec), given_(std::max<std::size_t>(1, spec.strata.size()), 0) {
    for (std::size_t s = 0; s < given_.size(); ++s) units_.emplace_back(spec, s);
  }

  DesignPoint next() {
    const std::uint64_t number = number_++;
    if (!spec_.given.empty()) return spec_.given[number];
    if (spec_.method == "factorial") return combination(spec_, number);
    const std::size_t stratum = next_stratum();
    const std::vector<SampledVariable> ranges =
        spec_.strata.empty() ? spec_.ranges : ranges_of(spec_, spec_.strata[stratum]);
    const std::vector<double> unit = units_[stratum].next();
    DesignPoint point;
    point.variables = spec_.fixed;
    for (std::size_t j = 0; j < ranges.size(); ++j)
      point.variables[ranges[j].variable] = ranges[j].minimum + (ranges[j].maximum - ranges[j].minimum) * unit[j];
    point.proposal_density = stratified_density(spec_, point.variables);
    return point;
  }

 private:
  /// The one that is furthest behind its share: after every point each has its share within one.
  std::size_t next_stratum() {
    if (spec_.strata.empty()) return 0;
    std::size_t best = 0;
    double largest = -1e300;
    for (std::size_t s = 0; s < given_.size(); ++s) {
      const double behind = spec_.strata[s].share * double(number_) - double(given_[s]);
      if (behind > largest) {
        largest = behind;
        best = s;
      }
    }
    ++given_[best];
    return best;
  }

  const DesignSpec& spec_;
  std::uint64_t number_ = 0;
  std::vector<std::uint64_t> given_;  // [strata]
  std::vector<UnitPoints> units_;     // [strata]
};

}  // namespace

double stratified_density(const DesignSpec& spec, const std::vector<double>& variables) {
  if (spec.strata.empty()) return 1;
  double density = 0;
  for (const Stratum& stratum : spec.strata) {
    double part = stratum.share;
    for (const SampledVariable& own : stratum.ranges) {
      const auto whole = std::find_if(spec.ranges.begin(), spec.ranges.end(),
                                      [&](const SampledVariable& r) { return r.variable == own.variable; });
      const double x = variables[own.variable];
      const bool inside = x >= own.minimum && x <= own.maximum;
      part *= inside ? (whole->maximum - whole->minimum) / (own.maximum - own.minimum) : 0;
    }
    density += part;
  }
  return density;
}

std::uint64_t trial_count(const DesignSpec& spec) {
  return spec.points + (spec.replicate_every > 0 ? spec.points / spec.replicate_every : 0);
}

std::vector<DesignPoint> make_design(const DesignSpec& spec) {
  std::vector<DesignPoint> design;
  design.reserve(trial_count(spec));
  const auto add = [&](DesignPoint point) {
    point.index = design.size();
    point.seed = random_bits(spec.seed, kBedStream, point.index);
    design.push_back(std::move(point));
  };
  BasePoints base(spec);
  std::vector<std::uint64_t> block;  // indices of the points since the last replicate
  for (std::uint64_t number = 0; number < spec.points; ++number) {
    block.push_back(design.size());
    add(base.next());
    if (block.size() != spec.replicate_every) continue;
    DesignPoint replicate = design[block[random_bits(spec.seed, kReplicateStream, number) % block.size()]];
    replicate.replicate_of = std::int64_t(replicate.index);
    add(std::move(replicate));
    block.clear();
  }
  return design;
}

namespace {

constexpr double kMaxPoints = 4e9;        // below 2^32, the length of the sequence
constexpr double kMaxCombinations = 1e7;  // of a factorial

std::string interval_text(const Variable& variable) {
  return line("[%g, %g] %s", variable.minimum, variable.maximum, variable.unit.c_str());
}

SampledVariable read_range(const Config& ranges, std::size_t index, double minimum, double maximum) {
  const Variable& variable = contract().variables[index];
  const std::vector<double> ends = ranges.numbers(variable.name, {minimum, maximum});
  if (ends.size() != 2 || !(ends[0] < ends[1]))
    ranges.fail(variable.name, "expected [minimum, maximum] with minimum < maximum inside " + interval_text(variable) +
                                   ", found " + ranges.json().at(variable.name).dump() +
                                   "; a single value belongs under \"fixed\"");
  return {index, ends[0], ends[1]};
}

bool is_point_file(const DesignSpec& spec) { return spec.method == "csv" || spec.method == "original"; }

/// What the section says of each variable, or else its preset.
void read_variables(const Config& section, DesignSpec& spec) {
  const std::optional<Config> ranges = spec.method == "original" ? std::nullopt : section.object_if("ranges");
  const std::optional<Config> fixed = section.object_if("fixed");
  const DesignPreset preset = design_preset(section.has("preset") ? section.choice("preset", preset_names()) : "");
  for (std::size_t i = 0; i < contract().variables.size(); ++i) {
    const Variable& variable = contract().variables[i];
    const bool is_ranged = ranges && ranges->has(variable.name), is_fixed = fixed && fixed->has(variable.name);
    spec.fixed.push_back(std::numeric_limits<double>::quiet_NaN());
    if (is_ranged) spec.ranges.push_back(read_range(*ranges, i, variable.minimum, variable.maximum));
    if (is_fixed) spec.fixed.back() = read_value(*fixed, variable.name, variable);
    if (is_ranged && is_fixed) fixed->fail(variable.name, "is under \"ranges\" too; keep one of the two");
    if (is_ranged || is_fixed) continue;
    if (const auto value = preset.fixed.find(variable.name); value != preset.fixed.end())
      spec.fixed.back() = value->second;
    if (const auto range = preset.ranges.find(variable.name); range != preset.ranges.end() && !is_point_file(spec))
      spec.ranges.push_back({i, range->second.first, range->second.second});
  }
  if (ranges) ranges->finish();
  if (fixed) fixed->finish();
}

/// Trials that no size of an obstacle is given for cross none of that kind.
void leave_out_obstacles(DesignSpec& spec) {
  std::vector<bool> ranged(spec.fixed.size(), false);
  for (const SampledVariable& range : spec.ranges) ranged[range.variable] = true;
  for (std::size_t i = 0; i < spec.fixed.size(); ++i)
    if (is_task_variable(contract().variables[i]) && !ranged[i] && std::isnan(spec.fixed[i])) spec.fixed[i] = 0;
}

void require_all_variables(const Config& section, DesignSpec& spec) {
  leave_out_obstacles(spec);
  for (std::size_t i = 0; i < contract().variables.size(); ++i) {
    const Variable& variable = contract().variables[i];
    const bool ranged =
        std::any_of(spec.ranges.begin(), spec.ranges.end(), [i](const auto& r) { return r.variable == i; });
    if (!ranged && std::isnan(spec.fixed[i]))
      section.fail("", "variable \"" + variable.name +
                           "\" is neither under \"ranges\" nor under \"fixed\"; give it a " +
                           "range or a value inside " + interval_text(variable));
  }
  if (spec.ranges.empty()) section.fail("ranges", "no variable is sampled; give at least one a range");
  if (spec.ranges.size() > std::size_t(kSobolDimensions))
    section.fail("ranges", "at most " + std::to_string(kSobolDimensions) + " variables can be sampled; fix some");
}

Stratum read_stratum(const Config& config, const DesignSpec& spec) {
  Stratum stratum{.name = config.text("name"), .share = config.number("share", {0, 1}), .ranges = {}};
  const Config ranges = config.object("ranges");
  for (const SampledVariable& whole : spec.ranges)
    if (ranges.has(contract().variables[whole.variable].name))
      stratum.ranges.push_back(read_range(ranges, whole.variable, whole.minimum, whole.maximum));
  ranges.finish();
  config.finish();
  return stratum;
}

void read_strata(const Config& section, DesignSpec& spec) {
  if (!section.has("strata")) return;
  double sum = 0;
  for (const Config& config : section.objects("strata")) {
    spec.strata.push_back(read_stratum(config, spec));
    sum += spec.strata.back().share;
  }
  if (std::abs(sum - 1) > 1e-9) section.fail("strata", line("the shares add up to %g; they must add up to 1", sum));
}

void read_levels(const Config& section, DesignSpec& spec) {
  const Config levels = section.object("levels");
  double combinations = 1;
  for (const SampledVariable& range : spec.ranges) {
    const std::string& name = contract().variables[range.variable].name;
    spec.levels.push_back(std::uint64_t(levels.integer(name, {2, 1000})));
    combinations *= double(spec.levels.back());
  }
  levels.finish();
  if (combinations > kMaxCombinations)
    section.fail("levels", line("make %.3g points; at most %.0e are possible", combinations, kMaxCombinations));
  spec.points = std::uint64_t(combinations);
}

/// The box that the points of a file span; variables with one value alone are fixed at it.
void span_points(DesignSpec& spec) {
  for (std::size_t i = 0; i < contract().variables.size(); ++i) {
    const auto less = [i](const auto& a, const auto& b) { return a.variables[i] < b.variables[i]; };
    const auto [low, high] = std::minmax_element(spec.given.begin(), spec.given.end(), less);
    spec.fixed[i] = low->variables[i];
    if (low->variables[i] == high->variables[i]) continue;
    spec.ranges.push_back({i, low->variables[i], high->variables[i]});
    spec.fixed[i] = std::numeric_limits<double>::quiet_NaN();
  }
}

void read_points(const Config& section, DesignSpec& spec) {
  const std::filesystem::path file = section.path("file");
  spec.given = spec.method == "csv"
                   ? read_point_csv(file, spec.fixed)
                   : read_original_points(file, spec.fixed, section.number_or("cohesion_scale", 1, {1e-6, 1e6}));
  spec.points =
      std::uint64_t(section.integer_or("points", std::int64_t(spec.given.size()), {1, double(spec.given.size())}));
  spec.given.resize(spec.points);
  if (spec.ranges.empty()) return span_points(spec);
  require_all_variables(section, spec);
  for (const DesignPoint& point : spec.given)
    for (const SampledVariable& range : spec.ranges)
      if (point.variables[range.variable] < range.minimum || point.variables[range.variable] > range.maximum)
        section.fail("file", file.string() + line(" holds a point with %s %g, outside its range",
                                                  contract().variables[range.variable].name.c_str(),
                                                  point.variables[range.variable]));
}

}  // namespace

DesignSpec read_design_box(const Config& section, std::uint64_t seed) {
  DesignSpec spec;
  spec.seed = seed;
  spec.method = section.choice("method", {"sobol", "latin_hypercube", "factorial", "csv"});
  read_variables(section, spec);
  require_all_variables(section, spec);
  return spec;
}

DesignSpec read_design(const Config& section, std::uint64_t seed) {
  DesignSpec spec;
  spec.seed = seed;
  spec.method = section.choice("method", {"sobol", "latin_hypercube", "factorial", "csv", "original"});
  spec.replicate_every = std::uint64_t(section.integer_or("replicate_every", 10, {0, kMaxPoints}));
  const bool counted = spec.method == "sobol" || spec.method == "latin_hypercube";
  if (counted) spec.points = std::uint64_t(section.integer("points", {1, kMaxPoints}));
  read_variables(section, spec);
  if (is_point_file(spec)) {
    read_points(section, spec);
  } else {
    require_all_variables(section, spec);
    if (spec.method == "factorial") read_levels(section, spec);
    if (spec.method == "latin_hypercube") spec.block = std::uint64_t(section.integer_or("block", 64, {2, 1e6}));
    if (counted) read_strata(section, spec);
  }
  section.finish();
  return spec;
}

std::vector<std::string> preset_names() { return {"study_reproduction", "realistic_soil"}; }

DesignPreset design_preset(const std::string& name) {
  if (name == "study_reproduction")
    return {.ranges = {{"slope_along", {0, 30}}, {"friction_angle", {11.3, 45}}, {"cohesion", {0, 100}}},
            .fixed = {{"slope_across", 0},
                      {"relative_density", 0.5},
                      {"payload", 0},
                      {"tyre_friction", 0.8},
                      {"bed_depth", 0.1},
                      {"commanded_speed", 1.1}}};
  if (name == "realistic_soil")
    return {.ranges = {{"slope_along", {-35, 35}},
                       {"slope_across", {-15, 15}},
                       {"friction_angle", {20, 42}},
                       {"cohesion", {0, 25}},
                       {"relative_density", {0, 1}}},
            .fixed = {{"payload", 0}, {"tyre_friction", 0.8}, {"bed_depth", 0.3}, {"commanded_speed", 1.5}}};
  return {};
}

namespace {

constexpr const char* kDensity = "proposal_density";

void check_range(const fs::path& file, std::size_t line_number, const Variable& variable, double value) {
  if (!admits(variable, value))
    refuse_csv_line(file, line_number,
                    line("%s is %g %s, allowed is [%g, %g]", variable.name.c_str(), value, variable.unit.c_str(),
                         variable.minimum, variable.maximum));
}

/// Sizes of obstacles may be left out: 0, there is none.
void complete(const fs::path& file, DesignPoint& point) {
  for (std::size_t i = 0; i < point.variables.size(); ++i)
    if (std::isnan(point.variables[i]) && is_task_variable(contract().variables[i]))
      point.variables[i] = 0;
    else if (std::isnan(point.variables[i]))
      throw InputError(file.string() + ": variable \"" + contract().variables[i].name +
                       "\" is neither a column nor under \"fixed\" of the study's design");
}

}  // namespace

std::vector<DesignPoint> read_point_csv(const fs::path& file, const std::vector<double>& fixed) {
  const auto lines = read_csv_lines(file, "points");
  std::vector<std::optional<std::size_t>> columns;  // variable of each; nothing: the density
  for (const std::string& name : lines.front().cell) {
    if (name == kDensity) {
      columns.emplace_back();
      continue;
    }
    try {
      columns.emplace_back(contract().variable_index(name));
    } catch (const InputError& error) {
      refuse_csv_line(file, lines.front().number, error.what());
    }
    if (!std::isnan(fixed[*columns.back()]))
      refuse_csv_line(file, lines.front().number, "\"" + name + "\" is fixed by the study");
  }
  std::vector<DesignPoint> points;
  for (std::size_t row = 1; row < lines.size(); ++row) {
    const std::size_t number = lines[row].number;
    const std::vector<std::string>& cells = lines[row].cell;
    if (cells.size() != columns.size())
      refuse_csv_line(file, number,
                      "has " + std::to_string(cells.size()) + " columns, the header " + std::to_string(columns.size()));
    DesignPoint& point = points.emplace_back();
    point.variables = fixed;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const double value = csv_number(file, number, cells[i]);
      if (!columns[i] && value <= 0) refuse_csv_line(file, number, "a proposal density is above 0");
      if (columns[i]) check_range(file, number, contract().variables[*columns[i]], value);
      (columns[i] ? point.variables[*columns[i]] : point.proposal_density) = value;
    }
    complete(file, point);
  }
  if (points.empty()) throw InputError(file.string() + ": holds a header and no points");
  return points;
}

std::vector<DesignPoint> read_original_points(const fs::path& file, const std::vector<double>& fixed,
                                              double cohesion_scale) {
  const std::size_t slope = contract().variable_index("slope_along"),
                    angle = contract().variable_index("friction_angle"),
                    cohesion = contract().variable_index("cohesion");
  std::vector<DesignPoint> points;
  std::array<double, 2> grains{};
  for (const auto& [number, text] : read_data_lines(file, "points")) {
    std::istringstream in(text);
    std::array<double, 5> values{};
    std::string cell;
    for (double& value : values) {
      if (!(in >> cell))
        refuse_csv_line(file, number, "five numbers are needed: slope, radius, density, friction, cohesion");
      value = csv_number(file, number, cell);
    }
    if (in >> cell) refuse_csv_line(file, number, "holds more than five numbers");
    const std::array<double, 2> these{values[1], values[2]};
    if (points.empty()) grains = these;
    if (these != grains)
      refuse_csv_line(file, number,
                      line("grains of %g mm and %g kg/m^3, above %g mm and %g kg/m^3: one study has one kind of "
                           "grains; make a file for each",
                           these[0], these[1], grains[0], grains[1]));
    DesignPoint& point = points.emplace_back();
    point.variables = fixed;
    point.variables[slope] = values[0];
    point.variables[angle] = std::atan(values[3]) / kDegree;
    point.variables[cohesion] = values[4] * cohesion_scale;
    for (const std::size_t i : {slope, angle, cohesion})
      check_range(file, number, contract().variables[i], point.variables[i]);
    complete(file, point);
  }
  return points;
}

}  // namespace gonogo::campaign
