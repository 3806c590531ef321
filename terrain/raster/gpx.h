// Writes ways as GPX 1.1: tracks with elevation and time, and waypoints.
#pragma once
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "terrain/raster/grid.h"

namespace gonogo::terrain {

struct TrackPoint {
  double x = 0, y = 0;                                        // in the grid's coordinate system
  double height = std::numeric_limits<double>::quiet_NaN();   // [m]; NaN: not written
  double seconds = std::numeric_limits<double>::quiet_NaN();  // since the departure [s]; NaN: not written
};

struct Track {
  std::string name;
  std::vector<TrackPoint> point;
};

/// A named place on the way.
struct Stop {
  std::string name;
  TrackPoint at;
};

/// `departure`: seconds since 1970-01-01T00:00:00Z. The file is whole or absent. Throws InputError where no way to WGS
/// 84 is known, DeviceError when writing fails.
void write_gpx(const std::filesystem::path& path, const MapGrid& grid, const std::vector<Stop>& stops,
               const std::vector<Track>& tracks, std::int64_t departure);

}  // namespace gonogo::terrain
