// Soils as region files describe them.
#pragma once
#include "pipeline/map/region/region.h"

namespace gonogo::map {

/// Key "texture"; empty when the file does not give it.
std::string read_texture(const Config& config);

/// Samples, draws and texture of a soil whose name stands under `key`. Throws InputError.
void take_named(const Config& config, const std::string& key, Soil& soil);

/// An entry of "soils". Throws InputError.
Soil read_soil(const Config& config);

/// A road's soil: "paved", or as "like" of a soil. Paved ground is stronger than any that trials sampled.
Soil read_road_soil(const Config& config, int code, const std::string& name);

}  // namespace gonogo::map
