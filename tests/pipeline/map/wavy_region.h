// A made region of smooth waves, for tests that need a map but not a certain ground.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "base/files/file.h"
#include "pipeline/map/write/make_map.h"
#include "tests/pipeline/map/analytic_model.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"

namespace gonogo::test {

/// Square ground of `side` cells; lengths of waves in cells over 2 pi, their height in m.
struct Waves {
  int side;
  double height, along, across;
};

/// Writes dem.tif and region.json into the folder; `name` is the region's.
inline void make_wavy_region(const TemporaryFolder& folder, const std::string& name, const Waves& w) {
  std::vector<float> height;
  for (int row = 0; row < w.side; ++row)
    for (int column = 0; column < w.side; ++column)
      height.push_back(float(1000 + w.height * std::sin(column / w.along) * std::cos(row / w.across)));
  make_raster(folder / "dem.tif", {.columns = w.side, .rows = w.side, .value = height});
  write_file_atomically(folder / "region.json", R"({"schema": "gonogo/region/1", "region": ")" + name + R"(",
    "rasters": [{"role": "elevation", "file": "dem.tif", "source": "made", "licence": "none"}]})");
}

/// A map of the folder's region by the analytic model.
inline map::MapRequest request_of_region(const TemporaryFolder& folder, const std::string& out) {
  map::MapRequest request;
  request.model = AnalyticModel{}.outcome_model();
  request.region = map::read_region(folder / "region.json");
  request.out = folder / out;
  return request;
}

}  // namespace gonogo::test
