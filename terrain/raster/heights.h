// What a raster must be to be read as heights, and their unit. Only for the .cpp files of this folder.
#pragma once
#include <string>
#include <vector>

#include "terrain/raster/raster_open.h"

namespace gonogo::terrain {

/// Throws InputError for complex values, for a colour table, and for three or more bands, which are a picture.
void require_heights(GDALDataset& dataset, const std::string& name);
/// Throws InputError for complex values and for bands of red, green and blue.
void require_one_value(GDALDataset& dataset, const std::string& name);

/// Factor from heights to metres: `told` ("m", "ft", "us-ft") wins, with a remark if the raster says something else;
/// then the band's unit or the vertical part of the coordinate system. Metres if nothing is said and the grid is not in
/// feet. Throws InputError for an unknown unit, for band and system that differ, and for a grid in feet whose heights
/// have no unit.
double height_unit(GDALDataset& dataset, const OGRSpatialReference& crs, const std::string& name,
                   const std::string& told, std::vector<std::string>& remarks);

}  // namespace gonogo::terrain
