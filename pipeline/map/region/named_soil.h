// Soils by name, for maps and region files that hold no table of their own: a USDA texture of configs/soils/usda.json,
// a soil of configs/soils, or a soil file. Every value of a range is as likely.
#pragma once
#include <string>
#include <vector>

#include "pipeline/map/region/region.h"

namespace gonogo::map {

/// `text`: a USDA texture ("sandy loam"), the name of a soil in configs/soils ("lete_sand"), or a soil file; a moisture
/// may follow ("sandy loam, wet"), or be asked for beside it. Each of the soil's states is one sample; with a moisture
/// ("dry", "moist" or "wet") only the states of that moisture are. Throws InputError for an unknown name, with the
/// nearest ones, and for a soil without a state of that moisture.
Soil named_soil(const std::string& text, const std::string& asked);

/// What a soil may be that nobody named: every USDA texture, at this moisture or at any if it is empty.
Soil soil_not_given(const std::string& moisture);

/// The soils of a raster of USDA textures. `class_names` are the names that the raster gives its codes, from code 0 on;
/// without any the codes are 1 to 12 of terrain::usda_texture_codes(). Names that are no texture are left out.
/// Throws InputError, with `where` first, if the raster names no texture.
std::vector<Soil> texture_soils(const std::vector<std::string>& class_names, const std::string& moisture,
                                const std::string& where);

/// Hash of the soil files behind such a text, for the record of a map.
std::string soil_hash(const std::string& text);

}  // namespace gonogo::map
