// Opening rasters and refusing, in one sentence each, what cannot be used. For the .cpp files of this folder only.
#pragma once
#include <ogr_spatialref.h>

#include <memory>
#include <string>
#include <vector>

#include "terrain/raster/gdal_support.h"
#include "terrain/raster/grid.h"

namespace gonogo::terrain {

struct GeoTransform {
  double value[6];  // x = v0 + v1 column + v2 row, y = v3 + v4 column + v5 row
};

/// A dataset and what it reads from, which must outlive it: closed in this order.
struct OpenRaster {
  std::vector<DatasetHandle> sources;
  DatasetHandle dataset;
  std::string name;  // for messages

  OpenRaster() = default;
  OpenRaster(OpenRaster&&) = default;
  OpenRaster& operator=(OpenRaster&&) = default;
  ~OpenRaster() { dataset.reset(); }
};

/// One file, or its tiles put together (of overlapping ones the later).
OpenRaster open_raster(const RasterFiles& files);
const OGRSpatialReference& require_crs(GDALDataset& dataset, const std::string& name);
GeoTransform require_north_up(GDALDataset& dataset, const std::string& name);
/// Factor from the band's stated unit of height to metres.
double vertical_metres(GDALRasterBand& band, const std::string& name);
MapGrid describe_grid(int columns, int rows, const OGRSpatialReference& crs, const GeoTransform& t);

}  // namespace gonogo::terrain
