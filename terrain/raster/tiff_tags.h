// The tags that describe a layer: place, coordinate system, colours, nodata, names, metadata. GDAL writes them into a
// GeoTIFF in memory, and they are copied from there, so that the encoding is GDAL's.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "terrain/raster/geotiff.h"

namespace gonogo::terrain {

struct TiffTag {
  std::uint16_t tag = 0, type = 0;
  std::uint64_t count = 0;
  std::string data;  // values in little-endian order
};

inline constexpr std::uint16_t kColourMap = 320, kGdalNoData = 42113;

std::vector<TiffTag> describing_tags(const MapGrid& grid, const LayerInfo& info);

}  // namespace gonogo::terrain
