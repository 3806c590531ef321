// Small rasters written with GDAL directly, for tests of the code that reads them.
#pragma once
#include <cpl_error.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <gdal_rat.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gonogo::test {

struct RasterRecipe {
  int columns = 8, rows = 6;
  int epsg = 32610;  // 0: no coordinate system
  std::array<double, 6> transform = {500000, 10, 0, 4400000, 0, -10};
  bool with_transform = true;
  std::optional<double> nodata = -9999;
  std::vector<float> value = {};  // row by row; empty: column + 10 row
  std::string unit = {};
  double scale = 1, offset = 0;
  GDALDataType type = GDT_Float32;
  std::string crs = {};  // any form that PROJ reads; wins over epsg
  int bands = 1;         // further ones are copies
};

inline void make_raster(const std::filesystem::path& path, const RasterRecipe& recipe) {
  GDALAllRegister();
  GDALDataset* raster = GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      path.c_str(), recipe.columns, recipe.rows, recipe.bands, recipe.type, nullptr);
  if (recipe.epsg != 0 || !recipe.crs.empty()) {
    OGRSpatialReference crs;
    if (recipe.crs.empty())
      crs.importFromEPSG(recipe.epsg);
    else
      crs.SetFromUserInput(recipe.crs.c_str());
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    raster->SetSpatialRef(&crs);
  }
  auto transform = recipe.transform;
  if (recipe.with_transform) raster->SetGeoTransform(transform.data());
  GDALRasterBand& band = *raster->GetRasterBand(1);
  if (recipe.nodata) band.SetNoDataValue(*recipe.nodata);
  if (!recipe.unit.empty()) band.SetUnitType(recipe.unit.c_str());
  if (recipe.scale != 1) band.SetScale(recipe.scale);
  if (recipe.offset != 0) band.SetOffset(recipe.offset);
  std::vector<float> value = recipe.value;
  for (int i = int(value.size()); i < recipe.columns * recipe.rows; ++i) {
    const int row = i / recipe.columns;
    value.push_back(float(i % recipe.columns + 10 * row));
  }
  for (int b = 1; b <= recipe.bands; ++b)
    if (raster->GetRasterBand(b)->RasterIO(GF_Write, 0, 0, recipe.columns, recipe.rows, value.data(), recipe.columns,
                                           recipe.rows, GDT_Float32, 0, 0, nullptr) != CE_None)
      throw std::runtime_error("cannot make " + path.string());
  GDALClose(raster);
}

/// Every entry of the attribute table of a raster's band, as text; empty when there is none.
inline std::string attribute_table(const std::filesystem::path& path) {
  GDALAllRegister();
  GDALDataset* raster = GDALDataset::Open(path.c_str());
  const GDALRasterAttributeTable* table = raster ? raster->GetRasterBand(1)->GetDefaultRAT() : nullptr;
  std::string text;
  for (int row = 0; table && row < table->GetRowCount(); ++row)
    for (int column = 0; column < table->GetColumnCount(); ++column)
      text += std::string(table->GetValueAsString(row, column)) + "\n";
  if (raster) GDALClose(raster);
  return text;
}

}  // namespace gonogo::test
