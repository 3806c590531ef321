#include "pipeline/outcome/prior/other_trials.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/json/config.h"
#include "pipeline/outcome/training_data.h"
#include "terrain/bed/bed.h"
#include "vehicle/family/numbers.h"
#include "vehicle/model/statics.h"

namespace gonogo::outcome {
namespace {

namespace fs = std::filesystem;

std::string rolling_text(double wheel_rolling) {
  if (wheel_rolling == 0) return ", which roll freely on it";
  return wheel_rolling == 1 ? ", which resist rolling on it"
                            : line(", which resist rolling on it %.3g-fold", wheel_rolling);
}

/// Of trials: their soil table's numerics, with the study's in their place.
bool solves_contacts(const campaign::Provenance& provenance, const Json& soil, const std::string& where) {
  constexpr int kManyUpdates = 100;  // of a step
  Json stated = soil.find("provenance") ? soil.at("provenance") : Json::object();
  if (!provenance.study.empty())
    if (const Json study = Json::parse(provenance.study, where + ": study"); const Json* trial = study.find("trial"))
      if (const Json* numerics = trial->find("numerics"))
        for (const auto& [key, value] : numerics->members()) stated[key] = value;
  if (!terrain::states_numerics(stated)) return false;
  const terrain::Numerics n = terrain::read_numerics(stated);
  return sim::is_penalty(n.contact) || n.give > 0 || n.tolerance > 0 || n.substeps * n.iterations >= kManyUpdates;
}

void require_pair(const TrialSource& a, const TrialSource& b) {
  if (a.gravity != b.gravity)
    throw InputError(b.where + line(": its trials had a gravity of %.4g m/s^2, those of ", b.gravity) + a.where +
                     line(" %.4g; train on each alone", a.gravity));
  if (a.vehicle != b.vehicle)
    throw InputError(b.where + ": its trials drove the vehicle " + b.vehicle + ", those of " + a.where + " " +
                     a.vehicle + "; another vehicle needs a model of its own: train on each alone");
}

/// Appends the rows with these inputs after their variables. Their groups are new ones.
void append(learning::TrainingTable& table, const learning::TrainingTable& rows, const std::vector<double>& inputs) {
  const std::uint64_t first_group =
      table.group.empty() ? 0 : 1 + *std::max_element(table.group.begin(), table.group.end());
  table.variable_count = rows.variable_count + inputs.size();
  for (std::size_t n = 0; n < rows.row_count(); ++n) {
    table.variables.insert(table.variables.end(), rows.row(n).begin(), rows.row(n).end());
    table.variables.insert(table.variables.end(), inputs.begin(), inputs.end());
    table.group.push_back(first_group + rows.group[n]);
  }
  table.outcome.insert(table.outcome.end(), rows.outcome.begin(), rows.outcome.end());
  table.weight.insert(table.weight.end(), rows.weight.begin(), rows.weight.end());
  std::vector<double> margin = rows.margin;
  margin.resize(rows.row_count(), NAN);
  table.margin.insert(table.margin.end(), margin.begin(), margin.end());
}

/// Of the wheels of a family [m].
double mean_width(const vehicle::Family& family) {
  const Range ratio = family.range.at("width_ratio");
  return (ratio.minimum + ratio.maximum) / 2 * family.diameter;
}

/// Distance in each variable within which points are near each other. Studies whose ranges differ a little share a
/// sequence of points.
std::vector<double> reach_of(const learning::TrainingTable& table, std::size_t variables) {
  constexpr double near = 0.05;  // of a variable's span
  std::vector<double> reach(variables, 0);
  for (std::size_t v = 0; v < variables && table.row_count() > 0; ++v) {
    double low = table.row(0)[v], high = low;
    for (std::size_t n = 1; n < table.row_count(); ++n) {
      low = std::min(low, table.row(n)[v]);
      high = std::max(high, table.row(n)[v]);
    }
    reach[v] = near * (high - low);
  }
  return reach;
}

}  // namespace

bool Fidelity::is_finer_than(const Fidelity& other) const {
  const auto rank = [](const Fidelity& f) {
    return std::tuple(f.is_whole, f.has_compliant_tyres, f.has_solved_contacts, -std::abs(f.wheel_rolling - 1),
                      f.grains_per_tyre);
  };
  return rank(*this) > rank(other);
}

std::string Fidelity::text() const {
  return std::string(is_whole ? "whole vehicle" : "quarter of a vehicle") +
         (has_compliant_tyres ? ", compliant tyres" : ", rigid tyres") +
         line(", %.1f grains across a wheel", grains_per_tyre) + rolling_text(wheel_rolling) +
         (has_solved_contacts ? ", contacts solved" : ", contacts left unsolved");
}

std::vector<double> Fidelity::inputs() const {
  return {double(is_whole), double(has_compliant_tyres), std::log2(grains_per_tyre), wheel_rolling,
          double(has_solved_contacts)};
}

TrialSource source_of(const campaign::Provenance& provenance, const std::string& where) {
  constexpr std::string_view kQuarter = "_quarter";
  const auto text_of = [&](const char* name) -> const std::string& {
    if (const std::string* text = campaign::input_text(provenance, name)) return *text;
    throw InputError(where + ": does not hold its " + name +
                     ", so its fidelity is unknown; train on it alone, or compute its trials anew");
  };
  const std::string &vehicle_text = text_of("vehicle"), &soil_text = text_of("calibration");
  const campaign::TrialSettings settings = campaign::settings_of(provenance, where);
  const Config file = Config::parse(vehicle_text, where + ": vehicle");
  const Json soil = Json::parse(soil_text, where + ": calibration");
  const bool is_family = vehicle::is_family(file);
  const double width =
      is_family ? mean_width(vehicle::read_family(file)) : vehicle::tread_width(vehicle::read_any_vehicle(file));
  TrialSource source{.where = where,
                     .vehicle = file.text("vehicle"),
                     .gravity = settings.gravity,
                     .fidelity = {.is_whole = file.text("kind") != "quarter",
                                  .has_compliant_tyres = is_family || settings.compliant_tyres,
                                  .grains_per_tyre = width / soil.at("grain_diameter_m").number(),
                                  .wheel_rolling = settings.wheel_rolling,
                                  .has_solved_contacts = solves_contacts(provenance, soil, where)}};
  if (source.vehicle.size() > kQuarter.size() && source.vehicle.ends_with(kQuarter))
    source.vehicle.resize(source.vehicle.size() - kQuarter.size());
  return source;
}

std::size_t OtherTrials::count() const {
  std::size_t sum = 0;
  for (const OtherDataset& dataset : datasets) sum += dataset.trials;
  return sum;
}

learning::TrainingTable OtherTrials::joined(const learning::TrainingTable& rows) const {
  if (empty()) return rows;
  learning::TrainingTable result;
  append(result, rows, own);
  append(result, table, {});
  return result;
}

OtherTrials OtherTrials::away_from(const learning::TrainingTable& rows) const {
  const std::vector<double> reach = reach_of(table, rows.variable_count);
  const auto is_near_any = [&](std::size_t n) {
    for (std::size_t unseen = 0; unseen < rows.row_count(); ++unseen) {
      std::size_t v = 0;
      while (v < reach.size() && std::fabs(table.row(n)[v] - rows.row(unseen)[v]) <= reach[v]) ++v;
      if (v == reach.size()) return true;
    }
    return false;
  };
  std::vector<std::size_t> kept;
  for (std::size_t n = 0; n < table.row_count(); ++n)
    if (!is_near_any(n)) kept.push_back(n);
  OtherTrials result = *this;
  if (kept.size() < table.row_count()) result.table = table.subset(kept);
  return result;
}

std::vector<double> OtherTrials::at_own(const std::vector<double>& points, std::size_t variables) const {
  if (own.empty()) return points;
  std::vector<double> result;
  for (auto point = points.begin(); point != points.end(); point += std::ptrdiff_t(variables)) {
    result.insert(result.end(), point, point + std::ptrdiff_t(variables));
    result.insert(result.end(), own.begin(), own.end());
  }
  return result;
}

namespace {

/// Of the wheels of the family that trials drove [m]. Throws InputError where they drove one vehicle.
double family_diameter(const campaign::Provenance& provenance, const std::string& where) {
  const Config file = Config::parse(*campaign::input_text(provenance, "vehicle"), where + ": vehicle");
  if (!vehicle::is_family(file))
    throw InputError(where + ": its trials drove one vehicle, which is not composed of a family's wheels; train alone");
  return vehicle::read_family(file).diameter;
}

/// Composes vehicles of these wheels, which must be of the family that the own trials drove.
void add_wheels(OtherTrials& others, const campaign::Dataset& wheels, const fs::path& file, const TrialSource& own,
                double own_diameter) {
  const TrialSource source = source_of(wheels.provenance, file.string());
  if (others.composed) throw InputError(file.string() + ": is a second dataset of wheels by themselves; give one");
  if (source.gravity != own.gravity || source.vehicle != own.vehicle) require_pair(own, source);
  others.composed = std::make_shared<const ComposedVehicle>(
      wheels.records, file.string(), family_diameter(wheels.provenance, file.string()), own_diameter, own.gravity);
  const auto valid = std::count_if(wheels.records.begin(), wheels.records.end(), [](const campaign::TrialRecord& r) {
    return r.verdict != campaign::Verdict::unknown;
  });
  others.datasets.push_back({file_hash(file), std::size_t(valid), "wheels by themselves, which compose vehicles"});
}

}  // namespace

OtherTrials read_other_trials(const campaign::Provenance& own, const std::string& where,
                              const std::vector<fs::path>& others) {
  OtherTrials result;
  if (others.empty()) return result;
  const TrialSource source = source_of(own, where);
  std::set<std::string> hashes;
  if (fs::is_regular_file(where)) hashes.insert(file_hash(where));
  for (const fs::path& file : others) {
    const std::string hash = file_hash(file);
    if (!hashes.insert(hash).second) throw InputError(file.string() + ": is given twice; name each dataset once");
    const campaign::Dataset dataset = campaign::read_dataset(file);
    if (are_of_wheels(dataset.records)) {
      add_wheels(result, dataset, file, source, family_diameter(own, where));
      continue;
    }
    result.own = source.fidelity.inputs();
    const TrialSource other = source_of(dataset.provenance, file.string());
    require_pair(source, other);
    const learning::TrainingTable rows = make_training_data(dataset.records, std::nullopt).table;
    append(result.table, rows, other.fidelity.inputs());
    result.datasets.push_back({hash, rows.row_count(), other.fidelity.text()});
  }
  return result;
}

std::vector<fs::path> finest_first(std::vector<fs::path> datasets) {
  if (datasets.size() < 2) return datasets;
  std::vector<std::pair<Fidelity, fs::path>> order;
  for (const fs::path& file : datasets) {
    const campaign::Dataset dataset = campaign::read_dataset(file);
    Fidelity fidelity = source_of(dataset.provenance, file.string()).fidelity;
    if (are_of_wheels(dataset.records)) fidelity.is_whole = false;
    order.emplace_back(fidelity, file);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first.is_finer_than(b.first); });
  for (std::size_t k = 0; k < order.size(); ++k) datasets[k] = order[k].second;
  return datasets;
}

void add_forecast(OtherTrials& known, std::shared_ptr<const Forecast> forecast) {
  constexpr std::size_t kSearchRows = 400;  // all 585 of the shipped family change a Brier score by 0.0001
  known.datasets.push_back({forecast->hash, forecast->trials, forecast->about});
  if (forecast->table.row_count() > 0 && SpeedShare::can_learn(forecast->table))
    known.family_speed =
        std::make_shared<const SpeedShare>(with_input(forecast->table, size_across), std::vector<double>(),
                                           learning::GaussianProcessSettings{.search_rows = kSearchRows});
  known.forecast = std::move(forecast);
}

}  // namespace gonogo::outcome
