// Looks through a raster for values that cannot be: undeclared voids, and in elevations large areas that are exactly
// flat; and reads it without them. Only for the .cpp files of terrain/raster.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "terrain/raster/raster_open.h"

namespace gonogo::terrain {

/// What stored values mean.
struct HeightScale {
  double scale = 1, offset = 0;            // height [m] = scale stored + offset
  bool is_plain = true;                    // the file names neither scale nor offset
  double cell_width = 1, cell_height = 1;  // on the ground [m]
  bool on_earth = true;
};

/// A stored value that means "no value" without being declared as such.
struct FoundVoid {
  double value = 0;
  std::uint64_t cells = 0;
};

/// Cells by row: ascending, disjoint runs [begin, end).
using CellRuns = std::vector<std::vector<std::pair<int, int>>>;

/// What in an elevation raster must not count as ground.
struct HeightDoubt {
  std::vector<FoundVoid> voids;
  std::shared_ptr<const CellRuns> flat;  // null: no flat area, or they are ground
};

/// `scale` and `offset` turn stored values into metres.
HeightScale height_scale(GDALDataset& dataset, const GeoTransform& t, const OGRSpatialReference& crs, double scale,
                         double offset);

/// Looks at every cell. Adds a remark for each kind of void, and one for the flat areas.
HeightDoubt doubt_heights(GDALDataset& dataset, const std::string& name, const HeightScale& scale,
                          const HeightWish& wish, std::vector<std::string>& remarks);

/// The stored values in a window of the raster that its range does not allow, that are the declared nodata but for
/// their last digits, or -9999 or an end of the type's whole numbers far from all others, with a remark for each.
/// Throws InputError when there are more than three kinds, and for a damaged file.
std::vector<FoundVoid> doubt_values(GDALDataset& dataset, const std::string& name, Window window,
                                    const ValueRange& range, std::vector<std::string>& remarks);

/// Replaces the dataset by one that reads as Float32 with NaN as nodata, and NaN where the stored value is one of
/// `voids`. Scale and offset stay.
void leave_out_voids(OpenRaster& raster, const std::vector<FoundVoid>& voids);

/// Replaces the dataset by one of bytes on the same grid: 1 in the runs, 0 elsewhere.
void mark_runs(OpenRaster& raster, const std::shared_ptr<const CellRuns>& runs);

}  // namespace gonogo::terrain
