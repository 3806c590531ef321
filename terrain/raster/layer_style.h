// What stands beside a layer: GDAL's side file and the QGIS style.
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "terrain/raster/geotiff.h"

namespace gonogo::terrain {

/// `<name>.tif.aux.xml` of a class layer: class names by value and the attribute table; `cells` [by value].
std::string side_file(const LayerInfo& info, const std::array<std::uint64_t, 256>& cells);

}  // namespace gonogo::terrain
