#include "terrain/raster/to_wgs84.h"

#include "base/error.h"
#include "terrain/raster/gdal_support.h"

namespace gonogo::terrain {

std::unique_ptr<OGRCoordinateTransformation> to_wgs84(const MapGrid& grid, const std::filesystem::path& path) {
  const GdalCall call;
  const OGRSpatialReference from = system_of(grid), to = wgs84();
  std::unique_ptr<OGRCoordinateTransformation> turn(OGRCreateCoordinateTransformation(&from, &to));
  if (!turn)
    throw InputError(path.string() +
                     ": this format holds longitude and latitude on WGS 84, to which no way is known from \"" +
                     grid.crs_name + "\"; write a GeoPackage (.gpkg)");
  return turn;
}

}  // namespace gonogo::terrain
