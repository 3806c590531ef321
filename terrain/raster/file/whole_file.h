// Files that are shorter than they say, and that their libraries read as if zeros followed.
#pragma once
#include <gdal_priv.h>

#include <filesystem>

namespace gonogo::terrain {

/// Throws InputError for a classic NetCDF file (versions 1, 2 and 5) that is shorter than its header says; of other
/// files, nothing.
void require_whole_netcdf(const std::filesystem::path& file);

/// Throws InputError for a raster of raw bytes beside or behind a header (ENVI, EHdr, PCRaster, ...) whose largest file
/// has less bytes than its cells; of other formats, nothing.
void require_whole_raw(const std::filesystem::path& file, GDALDataset& dataset);

/// Throws InputError for points of a grid (XYZ) whose last line has no end where points are missing; of other formats,
/// nothing.
void require_whole_points(const std::filesystem::path& file, GDALDataset& dataset);

}  // namespace gonogo::terrain
