// GDAL handles, errors and coordinate systems. Only for the .cpp files of terrain/raster.
#pragma once
#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "terrain/raster/grid.h"

namespace gonogo::terrain {

struct CloseDataset {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using DatasetHandle = std::unique_ptr<GDALDataset, CloseDataset>;

/// Keep one alive around calls of GDAL. Registers the drivers once, keeps GDAL's messages instead of printing them, and
/// refuses requests to other hosts on this thread unless network_allowed().
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

 private:
  bool is_offline_ = false;
  std::optional<std::string> curl_names_;  // the thread's setting before
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

/// Ground distance [m] between two near points {longitude, latitude} [deg] on the ellipsoid with semi-major axis a [m]
/// and inverse flattening 1/f. Radii of curvature at the middle latitude: M = a (1 - e2) / (1 - e2 sin2)^(3/2)
/// northward and N cos(lat), N = a / sqrt(1 - e2 sin2), eastward (Snyder, Map Projections, USGS PP 1395, eq. 4-18 to
/// 4-21).
double ground_distance(std::array<double, 2> from, std::array<double, 2> to, double semi_major,
                       double inverse_flattening);

/// Horizontal distance [m] that two datums of the Earth's centre may lie apart: NAD83 by 2.2 m from the ITRF's centre
/// (Snay and Soler, J. Surveying Eng. 134:95, 2008), others by a few decades of plate motion.
inline constexpr double kGeocentricShift = 2.5;

/// Refuses two systems whose datums may lie more than half a cell of `cell` metres apart. Empty where PROJ knows how
/// they lie to each other, otherwise a remark without a full stop: both are datums of the Earth's centre, told by their
/// ellipsoid, and so at most kGeocentricShift apart. Throws InputError for other datums, off by up to some hundred
/// metres.
std::string check_shift(const OGRSpatialReference& from, const OGRSpatialReference& to, const std::string& name,
                        double cell);

/// As WKT2 of 2019 in one line; empty where GDAL cannot.
std::string export_wkt(const OGRSpatialReference& crs);

/// The layer, or its largest overview of at most `max_cells` cells.
DatasetHandle open_reduced(const std::filesystem::path& layer, double max_cells);

/// Throws InputError that `path` cannot be written in longitude and latitude where no way to WGS 84 is known.
Transformation to_wgs84(const MapGrid& grid, const std::filesystem::path& path);

}  // namespace gonogo::terrain
