#include "pipeline/map/evaluate/soil_table.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/format.h"
#include "base/progress.h"
#include "pipeline/map/evaluate/cell.h"

namespace gonogo::map {
namespace {

constexpr std::size_t kMostSoils = 250;  // entries of the table that page and routes tell apart

/// A soil in one moisture state; nothing if it has no sample in that state.
std::optional<Soil> soil_in(const Soil& soil, const MoistureState& state) {
  Soil part = soil;
  part.name = soil.name + ", " + state.name;
  part.samples = samples_in(soil, state);
  if (part.samples.empty() && !soil.samples.empty()) return std::nullopt;
  return part;
}

/// Points that are too soft in an entry of the table.
SoftPoints soft_in(const OutcomeModel& model, const Region& region, const Soil& soil, Measured measured,
                   const std::vector<std::vector<double>>& points) {
  if (measured == Measured::firm) return {};
  if (measured == Measured::soft) return measured_soft(points.size(), *model.cone_index);
  return soft_points(region, soil, points, model.cone_index);
}

/// Points of a soil with their alternatives.
struct SoilDraws {
  std::vector<std::vector<double>> points;
  std::vector<int> alternative;  // empty: all belong to one
};

/// Where a high cone index was measured, those whose estimated one does not contradict it; all, where every one does.
SoilDraws consistent(const OutcomeModel& model, const Region& region, const Soil& soil, Measured measured,
                     const SoilDraws& all) {
  if (measured != Measured::firm) return all;
  const SoftPoints soft = soft_points(region, soil, all.points, model.cone_index);
  SoilDraws kept;
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    if (soft.is_soft[i]) continue;
    kept.points.push_back(all.points[i]);
    if (!all.alternative.empty()) kept.alternative.push_back(all.alternative[i]);
  }
  return kept.points.empty() ? all : kept;
}

/// Adds a soil with softness by cohesion and friction angle. If the region has measured cone indices, adds it twice
/// more: for cells whose index is high enough, and for those below VCI50.
void add_soil(const OutcomeModel& model, const Region& region, const MapRules& rules, double error_of_gradient,
              const Soil& soil, int state, SoilTable& table) {
  MapRules own = rules;
  own.max_speed = std::min(rules.max_speed, soil.max_speed);
  const auto points = soil_points(region, soil, rules.values, rules.draws);
  const bool may_be_soft = is_fine_grained(region, soil).value_or(true);
  const auto add = [&](Measured measured, const char* name) {
    Soil entry = soil;
    entry.name += name;
    const SoilDraws draws =
        consistent(model, region, soil, measured, {points, point_alternatives(soil, points.size())});
    SoftPoints soft = soft_in(model, region, soil, measured, draws.points);
    table.add(std::move(entry), state, may_be_soft, measured,
              SoilResponse(model, own, draws.points, error_of_gradient, std::move(soft), draws.alternative));
  };
  add(Measured::nothing, "");
  if (!has_cone_index(region) || !may_be_soft) return;
  add(Measured::firm, ", measured firm");
  add(Measured::soft, ", measured soft");
}

Spread fixed_size(double metres) { return {Spread::Kind::fixed, metres, metres, "obstacles of the region"}; }

/// Adds a ditch in the soil at a position of the table, measured firm or not as that is.
void add_ditch(const OutcomeModel& model, const Region& region, const MapRules& rules, double error_of_gradient,
               DitchSize size, std::size_t position, std::size_t ditch, SoilTable& table) {
  const Soil ground = table.soils[position];
  Soil soil = ground;
  soil.name += line(", ditch %.3g m wide, %.3g m deep", size.width, size.depth);
  MapRules own = rules;
  own.values["ditch_width"] = fixed_size(size.width);
  own.values["ditch_depth"] = fixed_size(size.depth);
  const Range speed = model.crossing_sampled[campaign::contract().variable_index("commanded_speed")];
  own.max_speed = std::min({rules.max_speed, soil.max_speed, speed.maximum});
  soil.max_speed = own.max_speed;
  const auto points = soil_points(region, soil, own.values, rules.draws);
  const SoftPoints soft = soft_in(model, region, soil, table.measured[position], points);
  table.add_ditch(position, ditch, std::move(soil),
                  SoilResponse(model, own, points, error_of_gradient, soft, point_alternatives(ground, points.size())));
}

/// Adds an entry for every ditch in every soil of the table in which one of its cells lies.
void add_ditches(const OutcomeModel& model, const Region& region, const MapRules& rules, double error_of_gradient,
                 const MapSources& sources, SoilTable& table) {
  const terrain::MapGrid& grid = sources.elevation.grid();
  std::set<std::pair<std::size_t, std::size_t>> occurring;  // (soil, ditch)
  for (const terrain::Window window : windows_of(grid, grid.columns, 256)) {
    const Readings readings(sources, window);
    for (std::size_t i = 0; i < readings.size(); ++i)
      if (const CellInputs cell = decide(region, rules, table, readings, i); cell.soil && cell.ditch && !cell.rule)
        occurring.emplace(*cell.soil, *cell.ditch);
  }
  if (table.soils.size() + occurring.size() > kMostSoils)
    throw InputError(region.file.string() + ": obstacles: its ditches lie in " + std::to_string(occurring.size()) +
                     " pairs of size and soil, and " + std::to_string(kMostSoils - table.soils.size()) +
                     " can be told apart; give widths and depths in fewer classes");
  for (const auto& [soil, ditch] : occurring)
    add_ditch(model, region, rules, error_of_gradient, sources.ditches[ditch], soil, ditch, table);
}

/// Which states of moisture a map needs: 0 is "any".
std::vector<int> states_of(const Region& region, const MapRules& rules) {
  std::vector<int> states;
  for (std::size_t k = 0; k < region.moistures.size(); ++k)
    if (rules.moisture.empty() ? region.moisture.has_value() : region.moistures[k].name == rules.moisture)
      states.push_back(int(k) + 1);
  if (!rules.moisture.empty() && states.empty())
    throw InputError(region.file.string() + ": moisture: does not say what \"" + rules.moisture +
                     "\" is; add its range of water content, or leave the moisture open");
  if (rules.moisture.empty()) states.push_back(0);
  return states;
}

/// The region without soils by name whose code does not occur on the map. Their tables would cost time and answer
/// nothing.
Region with_occurring_soils(const Region& region, const MapSources& sources) {
  if (!sources.soil_class) return region;
  const std::set<int> codes = soil_codes(sources);
  Region occurring = region;
  std::erase_if(occurring.soils, [&](const Soil& soil) {
    return soil.draws > 0 && soil.code < kRoadCode && codes.count(soil.code) == 0;
  });
  return occurring.soils.empty() ? region : occurring;
}

}  // namespace

std::optional<std::size_t> SoilTable::find(int code, int state, Measured what) const {
  const auto found = index_.find(key(code, state, what));
  return found == index_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::size_t> SoilTable::find_ditch(std::size_t soil, std::size_t ditch) const {
  const auto found = ditch_.find({soil, ditch});
  return found == ditch_.end() ? std::nullopt : std::optional(found->second);
}

void SoilTable::add(Soil soil, int state, bool soft_allowed, Measured what, SoilResponse response) {
  index_[key(soil.code, state, what)] = soils.size();
  measured.push_back(what);
  append(std::move(soil), state, soft_allowed, std::move(response), false);
}

void SoilTable::add_ditch(std::size_t soil, std::size_t ditch, Soil with_ditch, SoilResponse response) {
  ditch_[{soil, ditch}] = soils.size();
  measured.push_back(measured[soil]);
  append(std::move(with_ditch), moisture[soil], may_be_soft[soil], std::move(response), true);
}

void SoilTable::append(Soil soil, int state, bool soft_allowed, SoilResponse response, bool ditch) {
  may_be_soft.push_back(soft_allowed);
  has_ditch.push_back(ditch);
  soils.push_back(std::move(soil));
  responses.push_back(std::move(response));
  moisture.push_back(state);
  cells.push_back(0);
}

double gradient_error(const RegionRaster& elevation, const terrain::MapGrid& grid) {
  const double cell = std::sqrt(grid.cell_area_m2());
  return elevation.error * std::sqrt(1 - elevation.error_correlation) * std::sqrt(12.0) / (8 * cell);
}

SoilTable make_soil_table(const OutcomeModel& model, const Region& region, const MapRules& rules,
                          double error_of_gradient) {
  SoilTable table;
  std::vector<Soil> soils = region.soils;
  if (soils.empty())
    soils.push_back({.code = 0, .name = "all soils", .note = "", .texture = "", .samples = {}, .values = {}});
  if (has_cone_index(region) && !model.cone_index)
    throw InputError(region.file.string() +
                     ": a cone index tells nothing without a vehicle; name one "
                     "by --vehicle, or by \"cone_index_of\" in the section map of the study");
  if (model.cone_index) table.need = *model.cone_index;
  const auto states = states_of(region, rules);
  Progress progress("map", "soils", states.size() * soils.size());
  std::size_t done = 0;
  for (const int state : states)
    for (const Soil& soil : soils) {
      if (done == 0) progress.announce(soil.name);
      progress.update(done++, soil.name);
      const auto part = state == 0 ? std::optional(soil) : soil_in(soil, region.moistures[std::size_t(state) - 1]);
      if (!part) {
        table.without_samples.push_back(region.moistures[std::size_t(state) - 1].name + " " + soil.name);
        continue;
      }
      add_soil(model, region, rules, error_of_gradient, *part, state, table);
    }
  progress.update(done);
  if (table.soils.empty())
    throw InputError(region.file.string() + ": soils: no sample of any soil is " + rules.moisture +
                     "; give samples with such a water_percent, or leave the moisture open");
  return table;
}

SoilTable make_soil_table(const OutcomeModel& model, const Region& region, const MapRules& rules,
                          double error_of_gradient, const MapSources& sources) {
  const Region occurring = with_occurring_soils(region, sources);
  SoilTable table = make_soil_table(model, occurring, rules, error_of_gradient);
  if (!sources.ditches.empty()) add_ditches(model, occurring, rules, error_of_gradient, sources, table);
  return table;
}

}  // namespace gonogo::map
