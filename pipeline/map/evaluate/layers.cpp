#include "pipeline/map/evaluate/layers.h"

#include <algorithm>

#include "base/units.h"
#include "pipeline/campaign/study/contract.h"

namespace gonogo::map {

using terrain::LegendEntry;
namespace {

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

namespace {

/// A layer that maps may have. Adding one is one entry of layer_kinds(): writers, styles, catalogue, record and viewer
/// take what they need from there.
struct LayerKind {
  const char* file;   // without extension
  const char* title;  // description of the band; ends with ", " where the heading of the map follows
  const char* unit;   // empty: classes, which are bytes; "1": a pure number
  std::function<std::vector<LegendEntry>(bool colour_blind_safe)> legend;
  std::function<float(const CellState&)> value;            // kNoData: none
  std::function<bool(const OutcomeModel&)> is_given = {};  // whether a map of this model has it; empty: always
};

std::vector<LegendEntry> p_go_colours(bool) { return p_go_legend(); }

/// A single-hue ramp, light to dark; no red.
auto ramp(double low, double high, const char* low_label, const char* high_label, const char* light = "#f1f6f5",
          const char* dark = "#243f77") {
  return [=](bool) -> std::vector<LegendEntry> {
    return {{low, low_label, light}, {(low + high) / 2, "", "#69abc2"}, {high, high_label, dark}};
  };
}

bool has_measures(const OutcomeModel& model) { return !model.measures.empty(); }

/// In the order of the files.
const std::vector<LayerKind>& layer_kinds() {
  static const std::vector<LayerKind> kinds = {
      {"go", "mobility class, ", "", class_legend,
       [](const CellState& cell) { return float(int(cell.result.verdict)); }},
      {"p_go", "P(go), ", "1", p_go_colours, [](const CellState& cell) { return cell.p_go; }},
      {"reason", "likeliest reason of the class", "", [](bool) { return reason_legend(); },
       [](const CellState& cell) { return float(int(cell.result.reason)); }},
      {"outside_share", "share of what the soil may be that no trial answers for: not sampled, or too soft", "1",
       ramp(0, 1, "0: none", "1: all", "#ffffff", "#4d4d66"),
       [](const CellState& cell) { return cell.answer ? cell.answer->outside_share : 1.0f; }},
      {"go_worst", "mobility class, worst heading", "", class_legend, class_over(&HeadingRange::worst)},
      {"go_best", "mobility class, best heading", "", class_legend, class_over(&HeadingRange::best)},
      {"p_go_worst", "P(go), worst of the sampled headings", "1", p_go_colours, of_headings(&HeadingRange::p_worst)},
      {"p_go_best", "P(go), best of the sampled headings", "1", p_go_colours, of_headings(&HeadingRange::p_best)},
      {"headings_sampled", "share of the headings whose slopes were sampled", "1",
       ramp(0, 1, "0: none", "1: all", "#4d4d66", "#ffffff"), of_headings(&HeadingRange::sampled_share)},
      {"p_go_low", "P(go), 5 % point, uphill heading", "1", p_go_colours, of_answer(&CellAnswer::p_low)},
      {"p_go_high", "P(go), 95 % point, uphill heading", "1", p_go_colours, of_answer(&CellAnswer::p_high)},
      {"novelty", "distance to the nearest trial, 1 as near as trials are to one another", "1",
       ramp(0, 4, "0: on a trial", "4: far from every trial"), of_answer(&CellAnswer::novelty),
       [](const OutcomeModel& model) { return bool(model.novelty); }},
      {"speed", "top speed, uphill", "km/h", ramp(0, 60, "0 km/h", "60 km/h"),
       [](const CellState& cell) { return cell.answer ? float(kKmPerHour) * cell.answer->speed : kNoData; },
       [](const OutcomeModel& model) { return bool(model.speed); }},
      {"slip", "expected slip of trials that pass, uphill", "1", ramp(0, 1, "0", "1"), of_answer(&CellAnswer::slip),
       has_measures},
      {"sinkage", "expected sinkage of trials that pass, uphill", "m", ramp(0, 0.3, "0 m", "0.3 m"),
       of_answer(&CellAnswer::sinkage), has_measures},
  };
  return kinds;
}

}  // namespace

std::vector<MapLayer> map_layers(const MapRules& rules, const OutcomeModel& model, bool colour_blind_safe,
                                 const Metadata& metadata) {
  std::vector<MapLayer> layers;
  for (const LayerKind& kind : layer_kinds()) {
    if (kind.is_given && !kind.is_given(model)) continue;
    const std::string title = kind.title, unit = kind.unit;
    layers.push_back({kind.file,
                      {.name = title.ends_with(", ") ? title + heading_text(rules) : title,
                       .unit = unit,
                       .classes = unit.empty(),
                       .legend = kind.legend(colour_blind_safe),
                       .metadata = metadata},
                      kind.value});
  }
  return layers;
}

std::optional<std::size_t> find_layer(const std::vector<MapLayer>& layers, const std::string& file) {
  const auto found = std::find_if(layers.begin(), layers.end(), [&](const MapLayer& l) { return l.file == file; });
  return found == layers.end() ? std::nullopt : std::optional(std::size_t(found - layers.begin()));
}

}  // namespace gonogo::map
