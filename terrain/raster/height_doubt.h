// What in an elevation raster must not count as ground, and what is said about it. Only for the .cpp files of this
// folder.
#pragma once
#include <memory>

#include "terrain/raster/height_scan.h"
#include "terrain/raster/raster_open.h"

namespace gonogo::terrain {

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

}  // namespace gonogo::terrain
