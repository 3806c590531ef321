#include "pipeline/map/layers.h"

#include "pipeline/study/contract.h"

namespace gonogo::pipeline {

using terrain::LayerInfo;
using terrain::LegendEntry;

LayerInfo class_layer(bool colour_blind_safe, Metadata metadata) {
  LayerInfo layer{.name = "mobility class, uphill heading, quarter vehicle",
                  .unit = "",
                  .classes = true,
                  .legend = {},
                  .metadata = std::move(metadata)};
  for (const VerdictInfo& verdict : contract().verdicts)
    layer.legend.push_back(
        {double(verdict.code), verdict.label, colour_blind_safe ? verdict.colour_blind_safe : verdict.colour});
  return layer;
}

LayerInfo reason_layer(Metadata metadata) {
  LayerInfo layer{.name = "likeliest reason of the class",
                  .unit = "",
                  .classes = true,
                  .legend = {},
                  .metadata = std::move(metadata)};
  for (const ReasonInfo& reason : contract().reasons)
    layer.legend.push_back({double(reason.code), reason.label, reason.colour});
  return layer;
}

// Viridis (van der Walt and Smith, matplotlib; CC0): even steps in lightness, readable without colour vision, no red.
LayerInfo p_go_layer(Metadata metadata) {
  return {.name = "P(go), uphill heading, quarter vehicle",
          .unit = "1",
          .classes = false,
          .legend = {{0, "0", "#440154"},
                     {0.25, "0.25", "#3b528b"},
                     {0.5, "0.5", "#21918c"},
                     {0.75, "0.75", "#5ec962"},
                     {1, "1", "#fde725"}},
          .metadata = std::move(metadata)};
}

LayerInfo outside_share_layer(Metadata metadata) {
  return {.name = "share of the soil's possible values outside what was sampled",
          .unit = "1",
          .classes = false,
          .legend = {{0, "0: all sampled", "#ffffff"}, {1, "1: nothing sampled", "#4d4d66"}},
          .metadata = std::move(metadata)};
}

}  // namespace gonogo::pipeline
