// Rasters put on another grid while they are read. For the .cpp files of this folder only.
#pragma once
#include <array>
#include <optional>

#include "terrain/raster/raster_open.h"
#include "terrain/raster/raster_source.h"

namespace gonogo::terrain {

/// Extent of a raster in another coordinate system: {west, south, east, north}, or nothing when it cannot be carried
/// over.
std::optional<std::array<double, 4>> extent_on(GDALDataset& dataset, const GeoTransform& t,
                                               const OGRSpatialReference& from, const OGRSpatialReference& to);

/// The grid on which the elevation becomes a map, or nothing when its own will do. Throws InputError for what neither
/// can be.
std::optional<MapGrid> grid_for(const OpenRaster& raster, const OGRSpatialReference& crs, const GeoTransform& t,
                                const GridWish& wish);

/// Refuses rasters between whose coordinate systems only a guess of up to some hundred metres is known.
void require_known_shift(const OGRSpatialReference& from, const OGRSpatialReference& to, const std::string& name);

/// `resampling` as gdalwarp names it.
void warp_to(OpenRaster& raster, const MapGrid& grid, const std::string& resampling);

}  // namespace gonogo::terrain
