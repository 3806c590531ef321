// Ways from a grid to longitude and latitude. Only for the .cpp files of this folder.
#pragma once
#include <ogr_spatialref.h>

#include <filesystem>
#include <memory>

#include "terrain/raster/grid.h"

namespace gonogo::terrain {

/// Throws InputError that `path` cannot be written in longitude and latitude where no way to WGS 84 is known.
std::unique_ptr<OGRCoordinateTransformation> to_wgs84(const MapGrid& grid, const std::filesystem::path& path);

}  // namespace gonogo::terrain
