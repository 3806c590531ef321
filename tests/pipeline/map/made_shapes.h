// Nearly flat ground with straight lines and squares on it, as files of a region, and a truck that crosses them.
#pragma once
#include <string>
#include <vector>

#include "base/files/file.h"
#include "pipeline/map/region/obstacle.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"

namespace gonogo::test {

inline constexpr int kSide = 24;  // cells of 10 m

inline const map::CrossingLimits kTruck{
    .vehicle = "truck", .radius = 0.47, .friction = 0.8, .width = 2.2, .length = 4.8, .clearance = 0.41};

inline void make_flat_ground(const TemporaryFolder& folder) {
  std::vector<float> value;
  for (int i = 0; i < kSide * kSide; ++i) value.push_back(float(500 + 0.01 * (i % kSide) + 0.003 * (i % 7)));
  make_raster(folder / "dem.tif", {.columns = kSide, .rows = kSide, .value = value});
}

/// GeoJSON in the ground's system; `features` without the frame of the collection.
inline void write_shapes(const TemporaryFolder& folder, const std::string& name, const std::string& features) {
  write_file_atomically(folder / name,
                        R"({"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name":
    "urn:ogc:def:crs:EPSG::32610"}}, "features": [)" +
                            features + "]}");
}

/// From north to south through a column of cells.
inline std::string column_line(double column, const std::string& properties) {
  const std::string x = std::to_string(500000 + 10 * column);
  return R"({"type": "Feature", "properties": {)" + properties + R"(}, "geometry": {"type": "LineString",
    "coordinates": [[)" +
         x + ", 4399700], [" + x + ", 4400100]]}}";
}

inline std::string row_line(double row, const std::string& properties) {
  const std::string y = std::to_string(4400000 - 10 * row);
  return R"({"type": "Feature", "properties": {)" + properties + R"(}, "geometry": {"type": "LineString",
    "coordinates": [[499900, )" +
         y + "], [500400, " + y + "]]}}";
}

/// Entry of the region's obstacles.
inline std::string obstacle_entry(const std::string& kind, const std::string& file, const std::string& keys) {
  return R"({"kind": ")" + kind + R"(", "file": ")" + file + R"(", "source": "s", "licence": "l")" + keys + "}";
}

}  // namespace gonogo::test
