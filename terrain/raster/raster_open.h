// Opens rasters and rejects unusable ones with one sentence each. Only for the .cpp files of this folder.
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

/// A dataset and its sources, which must outlive it. The destructor closes the dataset first.
struct OpenRaster {
  std::vector<DatasetHandle> sources;
  DatasetHandle dataset;
  std::string name;  // for messages

  OpenRaster() = default;
  OpenRaster(OpenRaster&&) = default;
  OpenRaster& operator=(OpenRaster&&) = default;
  ~OpenRaster() { dataset.reset(); }
};

/// Opens one file, or a mosaic of tiles; where tiles overlap the later one counts.
OpenRaster open_raster(const RasterFiles& files);
const OGRSpatialReference& require_crs(GDALDataset& dataset, const std::string& name);
GeoTransform require_north_up(GDALDataset& dataset, const std::string& name);
/// Factor from the band's stated unit of height to metres.
double vertical_metres(GDALRasterBand& band, const std::string& name);
MapGrid describe_grid(int columns, int rows, const OGRSpatialReference& crs, const GeoTransform& t);

}  // namespace gonogo::terrain
