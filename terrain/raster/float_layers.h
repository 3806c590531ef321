// Writes layers of numbers that share a grid into one file: GeoTIFF or NetCDF.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "terrain/raster/grid.h"

namespace gonogo::terrain {

struct FloatLayer {
  std::string name, unit;  // the name becomes the band's description, or the variable of the NetCDF file
};

/// Values of a row of a layer [columns]; NaN: nodata.
using RowOfLayer = std::function<std::vector<float>(std::size_t layer, int row)>;

/// .tif: one band a layer, DEFLATE, nodata NaN. .nc: one float variable a layer, y from south to north as CF asks, NaN
/// as _FillValue. `metadata` goes into both. Rows are asked for in the order of rows, layer by layer. Throws InputError
/// for other extensions, DeviceError when writing fails. The file is whole or absent.
void write_float_layers(const std::filesystem::path& path, const MapGrid& grid, const std::vector<FloatLayer>& layers,
                        const std::vector<std::pair<std::string, std::string>>& metadata, const RowOfLayer& row_of);

}  // namespace gonogo::terrain
