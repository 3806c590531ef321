// Shared by the .cpp files of this folder only: GDAL handles and its last error.
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

/// Drivers registered once; GDAL's messages kept for ours instead of printed. Alive while GDAL is called.
class GdalCall {
 public:
  GdalCall();
  ~GdalCall();
  GdalCall(const GdalCall&) = delete;
  GdalCall& operator=(const GdalCall&) = delete;
  /// What GDAL said last, in one line without a full stop; "no reason given" when it said nothing.
  std::string message() const;
  bool failed() const;
  bool warned() const;  // or failed
};

/// Throws DeviceError: the file cannot be written, and what GDAL says about it.
[[noreturn]] void refuse_to_write(const std::filesystem::path& path, const GdalCall& call);

/// While alive, GDAL writes a fixed day into GeoPackages of this thread instead of today's: results hold no clock
/// times.
class FixedDate {
 public:
  FixedDate();
  ~FixedDate();
  FixedDate(const FixedDate&) = delete;
  FixedDate& operator=(const FixedDate&) = delete;
  static constexpr const char* kDay = "2000-01-01T00:00:00.000Z";
};

/// The grid's coordinate system, x before y.
OGRSpatialReference system_of(const MapGrid& grid);

/// The layer, or the first overview of it with at most `max_cells` cells.
DatasetHandle open_reduced(const std::filesystem::path& layer, double max_cells);

}  // namespace gonogo::terrain
