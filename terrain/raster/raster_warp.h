// Warps rasters to another grid while they are read. Only for the .cpp files of this folder.
#pragma once
#include <array>
#include <optional>

#include "terrain/raster/raster_open.h"
#include "terrain/raster/raster_source.h"

namespace gonogo::terrain {

/// Extent {west, south, east, north} of a raster in another coordinate system; empty when it has none there.
std::optional<std::array<double, 4>> extent_on(GDALDataset& dataset, const GeoTransform& t,
                                               const OGRSpatialReference& from, const OGRSpatialReference& to);

/// Ground size of the cell in the middle [m]: {eastward, southward}; nothing when it has no place on the ground.
std::optional<std::array<double, 2>> middle_cell_size(GDALDataset& dataset, const GeoTransform& t,
                                                      const OGRSpatialReference& crs);

/// Grid that the elevation must be warped to; empty when its own grid serves. Throws InputError when neither is
/// possible, and when the metres of a wished system are more than 3 % off those of the ground, because it belongs to
/// another part of the globe.
std::optional<MapGrid> grid_for(const OpenRaster& raster, const OGRSpatialReference& crs, const GeoTransform& t,
                                const GridWish& wish);

/// Throws InputError when PROJ knows only a ballpark transformation, off by up to some hundred metres.
void require_known_shift(const OGRSpatialReference& from, const OGRSpatialReference& to, const std::string& name);

/// `resampling`: a name of gdalwarp's -r.
void warp_to(OpenRaster& raster, const MapGrid& grid, const std::string& resampling);

}  // namespace gonogo::terrain
