#include "pipeline/campaign/design.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/random.h"
#include "pipeline/campaign/sobol.h"

namespace gonogo::pipeline {
namespace {

constexpr std::uint64_t kBedStream = 0x6265640000000000;        // bed seeds, by index of the trial
constexpr std::uint64_t kReplicateStream = 0x7265706c00000000;  // which point of a block is repeated
constexpr double kMostPoints = 4e9;                             // below 2^32, the length of the sequence
constexpr std::size_t kMostCompared = 8192;                     // points of a coverage, which compares all pairs

std::string interval_text(const Variable& variable) {
  char text[80];
  std::snprintf(text, sizeof text, "[%g, %g] %s", variable.minimum, variable.maximum, variable.unit.c_str());
  return text;
}

SampledVariable read_range(const Config& ranges, std::size_t index) {
  const Variable& variable = contract().variables[index];
  const std::vector<double> ends = ranges.numbers(variable.name, {variable.minimum, variable.maximum});
  if (ends.size() != 2 || !(ends[0] < ends[1]))
    ranges.fail(variable.name, "expected [minimum, maximum] with minimum < maximum inside " + interval_text(variable) +
                                   ", found " + ranges.json().at(variable.name).dump() +
                                   "; a single value belongs under \"fixed\"");
  return {index, ends[0], ends[1]};
}

void read_variables(const Config& section, DesignSpec& spec) {
  const Config ranges = section.object("ranges");
  const std::optional<Config> fixed = section.object_if("fixed");
  for (std::size_t i = 0; i < contract().variables.size(); ++i) {
    const Variable& variable = contract().variables[i];
    const bool is_ranged = ranges.has(variable.name), is_fixed = fixed && fixed->has(variable.name);
    spec.fixed.push_back(std::numeric_limits<double>::quiet_NaN());
    if (is_ranged) spec.ranges.push_back(read_range(ranges, i));
    if (is_fixed) spec.fixed.back() = fixed->number(variable.name, {variable.minimum, variable.maximum});
    if (is_ranged && is_fixed) fixed->fail(variable.name, "is under \"ranges\" too; keep one of the two");
  }
  ranges.finish();
  if (fixed) fixed->finish();
  for (std::size_t i = 0; i < contract().variables.size(); ++i) {
    const Variable& variable = contract().variables[i];
    if (!ranges.has(variable.name) && std::isnan(spec.fixed[i]))
      section.fail("", "variable \"" + variable.name +
                           "\" is neither under \"ranges\" nor under \"fixed\"; give it a " +
                           "range or a value inside " + interval_text(variable));
  }
  if (spec.ranges.empty()) section.fail("ranges", "no variable is sampled; give at least one a range");
}

DesignPoint base_point(const DesignSpec& spec, std::uint64_t number) {
  DesignPoint point;
  point.variables = spec.fixed;
  for (std::size_t j = 0; j < spec.ranges.size(); ++j) {
    const SampledVariable& range = spec.ranges[j];
    const double unit = scrambled_sobol(std::uint32_t(number), spec.seed, int(j));
    point.variables[range.variable] = range.minimum + (range.maximum - range.minimum) * unit;
  }
  return point;
}

/// Coordinates of the first points in the unit cube of the sampled box, replicates left out: [points][sampled
/// variables].
std::vector<std::vector<double>> unit_points(const DesignSpec& spec, const std::vector<DesignPoint>& design) {
  std::vector<std::vector<double>> points;
  for (const DesignPoint& point : design) {
    if (point.replicate_of >= 0) continue;
    if (points.size() == kMostCompared) break;
    std::vector<double>& unit = points.emplace_back();
    for (const SampledVariable& range : spec.ranges)
      unit.push_back((point.variables[range.variable] - range.minimum) / (range.maximum - range.minimum));
  }
  return points;
}

double largest_gap(const std::vector<std::vector<double>>& points, std::size_t dimension) {
  std::vector<double> values{0, 1};
  for (const auto& point : points) values.push_back(point[dimension]);
  std::sort(values.begin(), values.end());
  double gap = 0;
  for (std::size_t i = 1; i < values.size(); ++i) gap = std::max(gap, values[i] - values[i - 1]);
  return gap;
}

/// T. T. Warnock, "Computational investigations of low-discrepancy point sets" (1972): the square of the L2 norm.
double squared_discrepancy(const std::vector<std::vector<double>>& points, std::size_t dimensions) {
  double single = 0, pairs = 0;
  for (const auto& a : points) {
    double product = 1;
    for (const double x : a) product *= (1 - x * x) / 2;
    single += product;
    for (const auto& b : points) {
      double pair = 1;
      for (std::size_t j = 0; j < dimensions; ++j) pair *= 1 - std::max(a[j], b[j]);
      pairs += pair;
    }
  }
  const double n = double(points.size());
  return std::pow(3.0, -double(dimensions)) - 2 * single / n + pairs / (n * n);
}

}  // namespace

DesignSpec read_design(const Config& section, std::uint64_t seed) {
  DesignSpec spec;
  spec.seed = seed;
  spec.method = section.choice("method", {"sobol"});
  spec.points = std::uint64_t(section.integer("points", {1, kMostPoints}));
  spec.replicate_every = std::uint64_t(section.integer_or("replicate_every", 10, {0, kMostPoints}));
  read_variables(section, spec);
  if (spec.ranges.size() > std::size_t(kSobolDimensions))
    section.fail("ranges", "at most " + std::to_string(kSobolDimensions) + " variables can be sampled; fix some");
  section.finish();
  return spec;
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
  std::vector<std::uint64_t> block;  // indices of the points since the last replicate
  for (std::uint64_t number = 0; number < spec.points; ++number) {
    block.push_back(design.size());
    add(base_point(spec, number));
    if (block.size() != spec.replicate_every) continue;
    DesignPoint replicate = design[block[random_bits(spec.seed, kReplicateStream, number) % block.size()]];
    replicate.replicate_of = std::int64_t(replicate.index);
    add(std::move(replicate));
    block.clear();
  }
  return design;
}

Coverage coverage(const DesignSpec& spec, const std::vector<DesignPoint>& design) {
  const std::vector<std::vector<double>> points = unit_points(spec, design);
  const std::size_t dimensions = spec.ranges.size();
  Coverage result;
  result.discrepancy = std::sqrt(std::max(0.0, squared_discrepancy(points, dimensions)));
  // For independent uniform points the mean of the square is (2^-d - 3^-d) / n.
  result.expected_random =
      std::sqrt((std::pow(2.0, -double(dimensions)) - std::pow(3.0, -double(dimensions))) / double(points.size()));
  for (std::size_t j = 0; j < dimensions; ++j)
    result.largest_gap = std::max(result.largest_gap, largest_gap(points, j));
  return result;
}

}  // namespace gonogo::pipeline
