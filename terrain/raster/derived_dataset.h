// Rasters computed from others while GDAL reads them. Only for the .cpp files of this folder.
#pragma once
#include <memory>

#include "terrain/raster/height_scan.h"
#include "terrain/raster/raster_open.h"

namespace gonogo::terrain {

/// Replaces the dataset by one that reads as Float32 with NaN as nodata, and NaN where the stored value is one of
/// `voids`. Scale and offset stay.
void leave_out_voids(OpenRaster& raster, const std::vector<FoundVoid>& voids);

/// Replaces the dataset by one of bytes on the same grid: 1 in the runs, 0 elsewhere.
void mark_runs(OpenRaster& raster, const std::shared_ptr<const CellRuns>& runs);

}  // namespace gonogo::terrain
