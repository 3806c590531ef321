#include "pipeline/map/write/page_tables.h"

#include <algorithm>
#include <cmath>

#include "base/line.h"
#include "base/units.h"
#include "pipeline/campaign/study/task_variables.h"

namespace gonogo::map {
namespace {

constexpr std::uint16_t kNone = 65535;
constexpr double kMinShown = 0.002;  // a reason whose probability never reaches this is left out

std::uint16_t stored(double p) {
  return std::isnan(p) ? kNone : std::uint16_t(std::lround(std::clamp(p, 0.0, 1.0) * 65534));
}

/// In steps of 0.01 km/h.
std::uint16_t stored_speed(double metres_per_second) {
  if (std::isnan(metres_per_second)) return kNone;
  return std::uint16_t(std::lround(std::min(650.0, kKmPerHour * metres_per_second) * 100));
}

/// "cohesion 1.04 kPa", "cohesion 1 to 5 kPa".
std::string value_text(const campaign::Variable& variable, const Spread& spread) {
  std::string text = variable.label + line(" %g", spread.low);
  if (spread.kind == Spread::Kind::range) text += line(" to %g", spread.high);
  return variable.unit == "-" ? text : text + " " + variable.unit;
}

const campaign::Variable& variable_named(const std::string& name) {
  return campaign::contract().variables[campaign::contract().variable_index(name)];
}

/// "friction angle 28 deg, cohesion 1.04 kPa: Wong, ..." for each sample.
std::vector<std::string> inputs_of(const Soil& soil) {
  if (!soil.given) return {line("nobody said what the soil is: %zu states of USDA textures", soil.samples.size())};
  std::vector<std::string> lines;
  for (const SoilSample& sample : soil.samples) {
    std::string text;
    for (const auto& [name, spread] : sample.values)
      text += (text.empty() ? "" : ", ") + value_text(variable_named(name), spread);
    lines.push_back(text + ". " + sample.source);
  }
  if (!soil.texture.empty()) lines.push_back("USDA texture " + soil.texture);
  if (soil.samples.empty()) lines.push_back("no sample; see the values of the region");
  return lines;
}

/// Values of the mission that a map by name leaves to the trials.
std::vector<std::string> open_values_of(const MapRequest& request, const Soil& soil) {
  std::vector<std::string> lines;
  for (const auto& [name, spread] : request.region.values) {
    const bool in_sample = std::any_of(soil.samples.begin(), soil.samples.end(),
                                       [&n = name](const SoilSample& sample) { return sample.values.count(n) > 0; });
    if (spread.kind == Spread::Kind::range && request.rules.values.count(name) == 0 && !in_sample)
      lines.push_back(value_text(variable_named(name), spread) + ", every value as likely");
  }
  return lines;
}

/// Variables that the points leave open and those held fixed in all trials.
std::vector<std::string> unknown_of(const MapRequest& request, const Soil& soil, const SoilResponse& response) {
  std::vector<std::string> lines = open_values_of(request, soil);
  const auto& variables = campaign::contract().variables;
  for (std::size_t v = 0; v < variables.size(); ++v) {
    if (variables[v].name == "slope_along" || variables[v].name == "slope_across") continue;
    const Range sampled = request.model.sampled[v];
    if (campaign::is_task_variable(variables[v]) && sampled.maximum == 0) continue;
    if (sampled.minimum == sampled.maximum)
      lines.push_back(
          line("%s: all trials had %g %s", variables[v].label.c_str(), sampled.minimum, variables[v].unit.c_str()));
    else if (std::any_of(response.points().all().begin(), response.points().all().end(),
                         [v](const std::vector<double>& point) { return std::isnan(point[v]); }))
      lines.push_back(line("%s: not known, summed out over %g to %g %s", variables[v].label.c_str(), sampled.minimum,
                           sampled.maximum, variables[v].unit.c_str()));
  }
  return lines;
}

Json measure_json(const SlopeMeasure& m) {
  Json json = Json::object();
  json["base"] = m.base;
  json["along"] = m.along;
  json["along2"] = m.along2;
  json["across"] = m.across;
  json["across2"] = m.across2;
  json["lowest"] = m.lowest;
  json["highest"] = m.highest;
  return json;
}

double p_slow(const Prospect& prospect) {
  double sum = 0;
  for (std::size_t o = 0; o < prospect.outcome.size(); ++o)
    if (campaign::contract().outcomes[o].verdict == campaign::Verdict::slow_go) sum += prospect.outcome[o];
  return sum;
}

/// One array for each no-go reason that ever matters: [entries] from `outcome_at`.
template <class OutcomeAt>
void add_reasons(const std::string& table, int index, std::size_t count, std::size_t width, OutcomeAt outcome_at,
                 std::vector<Blob>& blobs) {
  const std::string prefix = table + "_" + std::to_string(index) + "_";
  for (std::size_t o = 0; o < campaign::contract().outcomes.size(); ++o) {
    if (campaign::contract().outcomes[o].verdict != campaign::Verdict::no_go) continue;
    Blob blob{prefix + campaign::contract().info(campaign::contract().outcomes[o].reason).name, 8, width, {}};
    double most = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double p = outcome_at(i, o);
      most = std::max(most, p);
      blob.value.push_back(std::uint16_t(std::lround(std::clamp(p, 0.0, 1.0) * 255)));
    }
    if (most >= kMinShown) blobs.push_back(std::move(blob));
  }
}

void add_heading_blobs(const SoilResponse& response, int index, std::vector<Blob>& blobs) {
  const HeadingTable& table = response.headings();
  const std::size_t width = std::size_t(std::max(1, table.across_count()));
  const std::size_t count = std::size_t(table.along_count()) * std::size_t(table.across_count());
  const auto node = [&](std::size_t i) -> const HeadingAnswer& { return table.node(int(i / width), int(i % width)); };
  Blob go{"heading_go_" + std::to_string(index), 16, width, {}};
  Blob slow{"heading_slow_" + std::to_string(index), 16, width, {}};
  Blob speed{"heading_speed_" + std::to_string(index), 16, width, {}};
  for (std::size_t i = 0; i < count; ++i) {
    go.value.push_back(stored(node(i).p_go));
    slow.value.push_back(stored(std::isnan(node(i).p_go) ? NAN : p_slow(node(i).prospect)));
    if (response.has_speed())
      speed.value.push_back(stored_speed(response.heading_speed(int(i / width), int(i % width))));
  }
  blobs.push_back(std::move(go));
  blobs.push_back(std::move(slow));
  if (response.has_speed()) blobs.push_back(std::move(speed));
  add_reasons(
      "heading", index, count, width,
      [&](std::size_t i, std::size_t o) {
        return node(i).prospect.outcome.empty() ? 0.0 : node(i).prospect.outcome[o];
      },
      blobs);
}

}  // namespace

Json page_soil(const MapRequest& request, const Soil& soil, const SoilResponse& response) {
  Json json = Json::object(), measures = Json::object(), outcomes = Json::array();
  json["name"] = soil.name;
  json["note"] = soil.note;
  json["given"] = soil.given;
  json["inputs"] = Json(inputs_of(soil));
  json["unknown"] = Json(unknown_of(request, soil, response));
  json["outside_because"] = Json(response.outside_because());
  json["stronger_because"] = Json(response.points().stronger_because());
  json["soft_because"] = Json(response.points().soft_because());
  json["soft_share"] = response.points().soft_share();
  json["outside_share"] = 1 - double(response.points().sampled_count()) / double(response.points().all().size());
  json["first_along"] = response.headings().first_along();
  json["first_across"] = response.headings().first_across();
  json["along_count"] = response.headings().along_count();
  json["across_count"] = response.headings().across_count();
  for (const auto& [name, measure] : response.measures()) measures[name] = measure_json(measure);
  json["measures"] = measures;
  for (const campaign::Outcome& outcome : campaign::contract().outcomes) {
    if (outcome.verdict != campaign::Verdict::no_go) continue;
    Json entry = Json::object();
    entry["reason"] = campaign::contract().info(outcome.reason).name;
    outcomes.push_back(entry);
  }
  json["no_go_outcomes"] = outcomes;
  return json;
}

Json add_drive_table(const OutcomeModel& model, const SoilResponse& response, int index, std::vector<Blob>& blobs) {
  constexpr std::size_t most_points = 16;
  constexpr int stride = 2 * kHeadingSteps;
  const HeadingTable& headings = response.headings();
  const SoilPoints& points = response.points();
  const std::size_t count = points.sampled_count(),
                    skip = std::max<std::size_t>(1, (count + most_points - 1) / most_points);
  const int along = (headings.along_count() - 1) / stride + 1, across = (headings.across_count() - 1) / stride + 1;
  const std::size_t nodes = std::size_t(along) * std::size_t(across), kept = (count + skip - 1) / skip;
  OutcomeModel alone = model;
  alone.members.clear();
  Blob blob{"drive_" + std::to_string(index), 16, std::size_t(across), std::vector<std::uint16_t>(kept * nodes, kNone)};
#pragma omp parallel for schedule(dynamic, 8)
  for (int node = 0; node < along * across; ++node) {
    std::vector<double> p_go;
    const BedSlopes slopes = headings.slopes(stride * (node / across), stride * (node % across));
    points.at(alone, slopes.along, slopes.across, p_go);
    for (std::size_t k = 0; k < kept && !p_go.empty(); ++k)
      blob.value[k * nodes + std::size_t(node)] = stored(p_go[k * skip]);
  }
  if (kept > 0) blobs.push_back(std::move(blob));
  Json json = Json::object(), rows = Json::array();
  json["stride"] = stride;
  json["along"] = along;
  json["across"] = across;
  for (std::size_t k = 0; k < kept; ++k) {
    Json row = Json::array();
    const auto x = points.sampled().subspan(k * skip * model.sampled.size(), model.sampled.size());
    for (std::size_t v = 0; v < x.size(); ++v) {
      if (campaign::contract().variables[v].name.rfind("slope", 0) == 0) continue;
      const double width = model.sampled[v].maximum - model.sampled[v].minimum;
      row.push_back(width > 0 && !std::isnan(x[v]) ? (x[v] - model.sampled[v].minimum) / width : 0.0);
    }
    rows.push_back(row);
  }
  json["points"] = rows;
  return json;
}

void add_soil_blobs(const SoilResponse& response, int index, std::vector<Blob>& blobs) {
  add_heading_blobs(response, index, blobs);
  const std::size_t count = std::size_t(90 * kSlopeSteps) + 1;
  const std::string end = "_" + std::to_string(index);
  Blob go{"uphill_go" + end, 16, count, {}}, slow{"uphill_slow" + end, 16, count, {}};
  Blob speed{"uphill_speed" + end, 16, count, {}};
  Blob low{"low" + end, 16, count, {}}, high{"high" + end, 16, count, {}}, novelty{"novelty" + end, 16, count, {}};
  for (std::size_t i = 0; i < count; ++i) {
    const CellAnswer& answer = response.at(double(i) / kSlopeSteps);
    go.value.push_back(stored(answer.p_go));
    slow.value.push_back(stored(answer.p_slow));
    speed.value.push_back(stored_speed(answer.speed));
    low.value.push_back(stored(answer.p_low));
    high.value.push_back(stored(answer.p_high));
    novelty.value.push_back(
        std::isnan(answer.novelty) ? kNone : std::uint16_t(std::lround(std::min(60.0, double(answer.novelty)) * 1000)));
  }
  for (Blob* blob : {&go, &slow, &low, &high, &novelty}) blobs.push_back(std::move(*blob));
  if (response.has_speed()) blobs.push_back(std::move(speed));
  add_reasons(
      "uphill", index, count, count, [&](std::size_t i, std::size_t o) { return response.uphill_outcome(i, o); },
      blobs);
}

}  // namespace gonogo::map
