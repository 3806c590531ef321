#include "terrain/raster/height_doubt.h"

#include <cmath>

#include "base/line.h"
#include "terrain/raster/raster_warp.h"

namespace gonogo::terrain {

HeightScale height_scale(GDALDataset& dataset, const GeoTransform& t, const OGRSpatialReference& crs, double scale,
                         double offset) {
  constexpr double earth = 6378137, tolerance = 0.01;
  const auto cell = middle_cell_size(dataset, t, crs);
  return {.scale = scale,
          .offset = offset,
          .cell_width = cell ? (*cell)[0] : 1,
          .cell_height = cell ? (*cell)[1] : 1,
          .on_earth = std::abs(crs.GetSemiMajor() / earth - 1) < tolerance};
}

HeightDoubt doubt_heights(GDALDataset& dataset, const std::string& name, const HeightScale& scale,
                          const HeightWish& wish, std::vector<std::string>& remarks) {
  HeightScan scan = scan_heights(dataset, name, scale);
  HeightDoubt doubt;
  for (const FoundVoid& found : scan.voids)
    remarks.push_back(
        line("%llu cells of the elevation hold %g, which is no height there; they count as without "
             "elevation. Declare it with gdal_edit.py -a_nodata %g",
             static_cast<unsigned long long>(found.cells), found.value, found.value));
  doubt.voids = std::move(scan.voids);
  if (scan.flat_cells == 0 || wish.flat_is_ground) return doubt;
  remarks.push_back(line(
      "exactly one height on %d %s of the elevation, %.3g km2 in all, as water and voids have; unknown unless land "
      "cover tells what it is. If it is ground, say \"flat\": \"ground\" in the region, or --flat-is-ground",
      scan.flat_areas, scan.flat_areas == 1 ? "area" : "areas",
      double(scan.flat_cells) * scale.cell_width * scale.cell_height * 1e-6));
  doubt.flat = std::make_shared<const CellRuns>(std::move(scan.flat));
  return doubt;
}

}  // namespace gonogo::terrain
