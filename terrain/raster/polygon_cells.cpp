#include "terrain/raster/polygon_cells.h"

#include <cpl_string.h>
#include <gdal_alg.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <memory>

#include "base/error.h"
#include "terrain/raster/gdal_support.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;
namespace {

DatasetHandle open_vector(const fs::path& file, const GdalCall& call) {
  std::error_code ec;
  if (!fs::exists(file, ec)) throw InputError(file.string() + ": no such file; check the path");
  DatasetHandle dataset(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
  if (!dataset)
    throw InputError(file.string() + ": cannot be read as polygons (" + call.message() +
                     "); give a vector format that ogrinfo opens, for example GeoJSON");
  return dataset;
}

/// Polygons of a layer in the grid's system.
void take_polygons(OGRLayer& layer, const OGRSpatialReference& grid, const fs::path& file,
                   std::vector<std::unique_ptr<OGRGeometry>>& polygons) {
  const OGRSpatialReference* from = layer.GetSpatialRef();
  if (!from) throw InputError(file.string() + ": names no coordinate system; give one, for example as GeoPackage");
  const std::unique_ptr<OGRCoordinateTransformation> turn(OGRCreateCoordinateTransformation(from, &grid));
  if (!turn) throw InputError(file.string() + ": no way is known from its coordinate system to the map's");
  for (const auto& feature : layer) {
    if (!feature->GetGeometryRef()) continue;
    std::unique_ptr<OGRGeometry> shape(feature->GetGeometryRef()->clone());
    const OGRwkbGeometryType type = wkbFlatten(shape->getGeometryType());
    if (type != wkbPolygon && type != wkbMultiPolygon)
      throw InputError(file.string() + ": holds a shape that is no polygon (" + OGRGeometryTypeToName(type) +
                       "); draw the area to avoid as a polygon");
    if (shape->transform(turn.get()) != OGRERR_NONE)
      throw InputError(file.string() + ": a polygon has no place in the map's coordinate system");
    polygons.push_back(std::move(shape));
  }
}

}  // namespace

std::vector<std::uint8_t> cells_under(const fs::path& file, const MapGrid& grid) {
  const GdalCall call;
  const DatasetHandle vector = open_vector(file, call);
  const OGRSpatialReference crs = system_of(grid);
  std::vector<std::unique_ptr<OGRGeometry>> polygons;
  for (OGRLayer* layer : vector->GetLayers()) take_polygons(*layer, crs, file, polygons);
  std::vector<std::uint8_t> cells(std::size_t(grid.columns) * std::size_t(grid.rows), 0);
  DatasetHandle raster(
      GetGDALDriverManager()->GetDriverByName("MEM")->Create("", grid.columns, grid.rows, 1, GDT_Byte, nullptr));
  double transform[6] = {grid.west, grid.cell_width, 0, grid.north, 0, -grid.cell_height};
  raster->SetGeoTransform(transform);
  std::vector<OGRGeometryH> shapes;
  for (const auto& polygon : polygons) shapes.push_back(OGRGeometry::ToHandle(polygon.get()));
  int band = 1;
  const std::vector<double> burn(shapes.size(), 1.0);
  CPLStringList options;
  options.SetNameValue("ALL_TOUCHED", "TRUE");
  if (!shapes.empty() &&
      (GDALRasterizeGeometries(raster.get(), 1, &band, int(shapes.size()), shapes.data(), nullptr, nullptr, burn.data(),
                               options.List(), nullptr, nullptr) != CE_None ||
       raster->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, grid.columns, grid.rows, cells.data(), grid.columns, grid.rows,
                                          GDT_Byte, 0, 0, nullptr) != CE_None))
    throw DeviceError(file.string() + ": its polygons cannot be put on the grid (" + call.message() + ")");
  if (std::find(cells.begin(), cells.end(), 1) == cells.end())
    throw InputError(file.string() + ": no polygon of it touches the map; check its coordinate system");
  return cells;
}

}  // namespace gonogo::terrain
