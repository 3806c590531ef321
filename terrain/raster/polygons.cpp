#include "terrain/raster/polygons.h"

#include <gdal_alg.h>
#include <ogrsf_frmts.h>

#include "base/error.h"
#include "base/file.h"
#include "terrain/raster/gdal_support.h"
#include "terrain/raster/vector_style.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;
namespace {

void add_field(OGRLayer& layer, const char* name, OGRFieldType type, const fs::path& path, const GdalCall& call) {
  OGRFieldDefn field(name, type);
  if (layer.CreateField(&field) != OGRERR_NONE) refuse_to_write(path, call);
}

/// Fills in what GDALPolygonize leaves open.
void describe_polygons(OGRLayer& layer, const MapGrid& grid, double cell_m, const std::vector<LegendEntry>& legend,
                       const fs::path& path, const GdalCall& call) {
  layer.ResetReading();
  std::vector<GIntBig> numbers;
  for (const auto& feature : layer) numbers.push_back(feature->GetFID());
  for (const GIntBig number : numbers) {
    const OGRFeatureUniquePtr feature(layer.GetFeature(number));
    for (const LegendEntry& entry : legend)
      if (int(entry.value) == feature->GetFieldAsInteger("code")) feature->SetField("class", entry.label.c_str());
    const auto* polygon = feature->GetGeometryRef() ? feature->GetGeometryRef()->toPolygon() : nullptr;
    if (polygon)
      feature->SetField("area_km2", polygon->get_Area() * grid.metres_per_unit * grid.metres_per_unit * 1e-6);
    feature->SetField("cell_m", cell_m);
    if (layer.SetFeature(feature.get()) != OGRERR_NONE) refuse_to_write(path, call);
  }
}

void polygonize(const fs::path& path, const std::string& name, GDALDataset& source, const MapGrid& grid,
                const std::vector<LegendEntry>& legend) {
  const GdalCall call;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
  if (!driver) throw DeviceError("this GDAL has no GPKG driver");
  DatasetHandle file(driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  if (!file) refuse_to_write(path, call);
  OGRSpatialReference crs = system_of(grid);
  OGRLayer* layer = file->CreateLayer(name.c_str(), &crs, wkbPolygon, nullptr);
  if (!layer) refuse_to_write(path, call);
  add_field(*layer, "code", OFTInteger, path, call);
  add_field(*layer, "class", OFTString, path, call);
  add_field(*layer, "area_km2", OFTReal, path, call);
  add_field(*layer, "cell_m", OFTReal, path, call);
  GDALRasterBand& band = *source.GetRasterBand(1);
  if (file->StartTransaction() != OGRERR_NONE ||
      GDALPolygonize(&band, band.GetMaskBand(), layer, 0, nullptr, nullptr, nullptr) != CE_None)
    refuse_to_write(path, call);
  describe_polygons(*layer, grid, grid.cell_width_m() * grid.columns / source.GetRasterXSize(), legend, path, call);
  embed_style(*file, name, {.column = "class", .polygons = true, .legend = legend}, path);
  if (file->CommitTransaction() != OGRERR_NONE) refuse_to_write(path, call);
}

void write_polygons(const fs::path& path, const std::string& name, GDALDataset& source, const MapGrid& grid,
                    const std::vector<LegendEntry>& legend) {
  const FixedDate fixed;
  replace_file_atomically(path, [&](const fs::path& temporary) {
    std::error_code ignored;
    fs::remove(temporary, ignored);  // drivers refuse to write over a file
    polygonize(temporary, name, source, grid, legend);
  });
}

}  // namespace

void write_class_polygons(const fs::path& path, const fs::path& layer, const MapGrid& grid,
                          const std::vector<LegendEntry>& legend, double max_cells) {
  const DatasetHandle source = open_reduced(layer, max_cells);
  write_polygons(path, "classes", *source, grid, legend);
}

void write_cell_polygons(const fs::path& path, const std::string& name, const MapGrid& grid,
                         const std::vector<std::uint8_t>& code, const std::vector<LegendEntry>& legend) {
  GONOGO_ASSERT(code.size() == std::size_t(grid.columns) * std::size_t(grid.rows));
  const GdalCall call;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("MEM");
  const DatasetHandle source(driver ? driver->Create("", grid.columns, grid.rows, 1, GDT_Byte, nullptr) : nullptr);
  double transform[6] = {grid.west, grid.cell_width, 0, grid.north, 0, -grid.cell_height};
  if (!source || source->SetGeoTransform(transform) != CE_None ||
      source->GetRasterBand(1)->SetNoDataValue(kClassNoData) != CE_None ||
      source->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, grid.columns, grid.rows,
                                         const_cast<std::uint8_t*>(code.data()), grid.columns, grid.rows, GDT_Byte, 0,
                                         0, nullptr) != CE_None)
    refuse_to_write(path, call);
  write_polygons(path, name, *source, grid, legend);
}

}  // namespace gonogo::terrain
