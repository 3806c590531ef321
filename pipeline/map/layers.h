// The layers of a map and their legends, derived from the contract.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "terrain/raster/geotiff.h"

namespace gonogo::pipeline {

using Metadata = std::vector<std::pair<std::string, std::string>>;

terrain::LayerInfo class_layer(bool colour_blind_safe, Metadata metadata);
terrain::LayerInfo reason_layer(Metadata metadata);
terrain::LayerInfo p_go_layer(Metadata metadata);
terrain::LayerInfo outside_share_layer(Metadata metadata);

}  // namespace gonogo::pipeline
