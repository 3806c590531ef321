// GDAL handles, errors and coordinate systems. Only for the .cpp files of terrain/raster.
#pragma once
#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <filesystem>
#include <memory>
#include <string>

#include "terrain/raster/grid.h"

namespace gonogo::terrain {

struct CloseDataset {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using DatasetHandle = std::unique_ptr<GDALDataset, CloseDataset>;

/// Keep one alive around calls of GDAL. Registers the drivers once, and keeps GDAL's messages instead of printing them.
class GdalCall {
 public:
  GdalCall();
  ~GdalCall();
  GdalCall(const GdalCall&) = delete;
  GdalCall& operator=(const GdalCall&) = delete;
  /// GDAL's last message, in one line without a full stop; "no reason given" when there is none.
  std::string message() const;
  bool failed() const;
  bool warned() const;  // true also after a failure
};

/// Throws DeviceError that the file cannot be written, with GDAL's reason.
[[noreturn]] void refuse_to_write(const std::filesystem::path& path, const GdalCall& call);

/// While alive, GDAL writes a fixed date into this thread's GeoPackages, so that results do not depend on the clock.
class FixedDate {
 public:
  FixedDate();
  ~FixedDate();
  FixedDate(const FixedDate&) = delete;
  FixedDate& operator=(const FixedDate&) = delete;
  static constexpr const char* kDay = "2000-01-01T00:00:00.000Z";
};

/// The grid's coordinate system, with axes in the order x, y.
OGRSpatialReference system_of(const MapGrid& grid);

using Transformation = std::unique_ptr<OGRCoordinateTransformation>;

/// Longitude and latitude of the system's own datum, in this order.
OGRSpatialReference own_degrees(const OGRSpatialReference& crs);

/// Longitude and latitude on WGS 84, in this order.
OGRSpatialReference wgs84();

/// As WKT2 of 2019 in one line; empty where GDAL cannot.
std::string export_wkt(const OGRSpatialReference& crs);

/// The layer, or its largest overview of at most `max_cells` cells.
DatasetHandle open_reduced(const std::filesystem::path& layer, double max_cells);

/// Throws InputError that `path` cannot be written in longitude and latitude where no way to WGS 84 is known.
Transformation to_wgs84(const MapGrid& grid, const std::filesystem::path& path);

}  // namespace gonogo::terrain
