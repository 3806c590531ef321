#include "pipeline/map/evaluate/layers.h"

#include <limits>

#include "base/units.h"
#include "pipeline/campaign/study/contract.h"

namespace gonogo::map {

using terrain::LayerInfo;
using terrain::LegendEntry;
namespace {

constexpr float kNoData = std::numeric_limits<float>::quiet_NaN();

LayerInfo classes(std::string name, std::vector<LegendEntry> legend, const Metadata& metadata) {
  return {.name = std::move(name), .unit = "", .classes = true, .legend = std::move(legend), .metadata = metadata};
}

LayerInfo numbers(std::string name, std::string unit, std::vector<LegendEntry> legend, const Metadata& metadata) {
  return {.name = std::move(name),
          .unit = std::move(unit),
          .classes = false,
          .legend = std::move(legend),
          .metadata = metadata};
}

/// A single-hue ramp, light to dark; no red.
std::vector<LegendEntry> ramp(double low, double high, const char* low_label, const char* high_label,
                              const char* light = "#f1f6f5", const char* dark = "#243f77") {
  return {{low, low_label, light}, {(low + high) / 2, "", "#69abc2"}, {high, high_label, dark}};
}

/// A member of a cell's answer, where there is one.
template <class Member>
std::function<float(const CellState&)> of_answer(Member member) {
  return [member](const CellState& cell) { return cell.answer ? float(cell.answer->*member) : kNoData; };
}

std::function<float(const CellState&)> of_headings(float HeadingRange::*member) {
  return [member](const CellState& cell) { return cell.answer ? cell.answer->headings.*member : kNoData; };
}

/// Class over all headings; what decides without a model decides for every heading.
std::function<float(const CellState&)> class_over(CellClass HeadingRange::*member) {
  return [member](const CellState& cell) {
    return float(int(cell.answer ? (cell.answer->headings.*member).verdict : cell.result.verdict));
  };
}

}  // namespace

std::vector<LegendEntry> class_legend(bool colour_blind_safe) {
  std::vector<LegendEntry> legend;
  for (const campaign::VerdictInfo& verdict : campaign::contract().verdicts)
    legend.push_back(
        {double(verdict.code), verdict.label, colour_blind_safe ? verdict.colour_blind_safe : verdict.colour});
  return legend;
}

std::vector<LegendEntry> reason_legend() {
  std::vector<LegendEntry> legend;
  for (const campaign::ReasonInfo& reason : campaign::contract().reasons)
    legend.push_back({double(reason.code), reason.label, reason.colour});
  return legend;
}

// Viridis (van der Walt and Smith, matplotlib; CC0): even steps in lightness, readable without colour vision, no red.
std::vector<LegendEntry> p_go_legend() {
  return {{0, "0", "#440154"},
          {0.25, "0.25", "#3b528b"},
          {0.5, "0.5", "#21918c"},
          {0.75, "0.75", "#5ec962"},
          {1, "1", "#fde725"}};
}

std::vector<MapLayer> map_layers(const MapRules& rules, const OutcomeModel& model, bool colour_blind_safe,
                                 const Metadata& metadata) {
  const bool has_measures = !model.measures.empty(), has_speed = bool(model.speed), has_novelty = bool(model.novelty);
  const std::string heading = heading_text(rules);
  const auto go = class_legend(colour_blind_safe), p = p_go_legend();
  std::vector<MapLayer> layers = {
      {"go", classes("mobility class, " + heading, go, metadata),
       [](const CellState& cell) { return float(int(cell.result.verdict)); }},
      {"p_go", numbers("P(go), " + heading, "1", p, metadata), [](const CellState& cell) { return cell.p_go; }},
      {"reason", classes("likeliest reason of the class", reason_legend(), metadata),
       [](const CellState& cell) { return float(int(cell.result.reason)); }},
      {"outside_share",
       numbers("share of what the soil may be that no trial answers for: not sampled, or too soft", "1",
               ramp(0, 1, "0: none", "1: all", "#ffffff", "#4d4d66"), metadata),
       [](const CellState& cell) { return cell.answer ? cell.answer->outside_share : 1.0f; }},
      {"go_worst", classes("mobility class, worst heading", go, metadata), class_over(&HeadingRange::worst)},
      {"go_best", classes("mobility class, best heading", go, metadata), class_over(&HeadingRange::best)},
      {"p_go_worst", numbers("P(go), worst of the sampled headings", "1", p, metadata),
       of_headings(&HeadingRange::p_worst)},
      {"p_go_best", numbers("P(go), best of the sampled headings", "1", p, metadata),
       of_headings(&HeadingRange::p_best)},
      {"headings_sampled",
       numbers("share of the headings whose slopes were sampled", "1",
               ramp(0, 1, "0: none", "1: all", "#4d4d66", "#ffffff"), metadata),
       of_headings(&HeadingRange::sampled_share)},
      {"p_go_low", numbers("P(go), 5 % point, uphill heading", "1", p, metadata), of_answer(&CellAnswer::p_low)},
      {"p_go_high", numbers("P(go), 95 % point, uphill heading", "1", p, metadata), of_answer(&CellAnswer::p_high)}};
  if (has_novelty)
    layers.push_back({"novelty",
                      numbers("distance to the nearest trial, 1 as near as trials are to one another", "1",
                              ramp(0, 4, "0: on a trial", "4: far from every trial"), metadata),
                      of_answer(&CellAnswer::novelty)});
  if (has_speed)
    layers.push_back(
        {"speed", numbers("top speed, uphill", "km/h", ramp(0, 60, "0 km/h", "60 km/h"), metadata),
         [](const CellState& cell) { return cell.answer ? float(kKmPerHour) * cell.answer->speed : kNoData; }});
  if (!has_measures) return layers;
  layers.push_back({"slip", numbers("expected slip of trials that pass, uphill", "1", ramp(0, 1, "0", "1"), metadata),
                    of_answer(&CellAnswer::slip)});
  layers.push_back(
      {"sinkage", numbers("expected sinkage of trials that pass, uphill", "m", ramp(0, 0.3, "0 m", "0.3 m"), metadata),
       of_answer(&CellAnswer::sinkage)});
  return layers;
}

}  // namespace gonogo::map
