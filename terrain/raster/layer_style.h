// GDAL's side file of a class layer.
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "terrain/raster/geotiff.h"

namespace gonogo::terrain {

/// Text of `<name>.tif.aux.xml`: class names by value and the attribute table. cells[value]: number of cells.
std::string side_file(const LayerInfo& info, const std::array<std::uint64_t, 256>& cells);

}  // namespace gonogo::terrain
