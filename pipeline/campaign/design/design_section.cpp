#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/line.h"
#include "pipeline/campaign/design/design.h"
#include "pipeline/campaign/design/design_preset.h"
#include "pipeline/campaign/design/point_file.h"
#include "pipeline/campaign/design/sobol.h"
#include "pipeline/campaign/study/task_variables.h"

namespace gonogo::campaign {
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
    if (is_fixed) spec.fixed.back() = fixed->number(variable.name, {variable.minimum, variable.maximum});
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

}  // namespace gonogo::campaign
