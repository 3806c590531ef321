#include "terrain/raster/float_layers.h"

#include <cpl_string.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/file.h"
#include "terrain/raster/gdal_support.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;
namespace {

using Metadata = std::vector<std::pair<std::string, std::string>>;

GDALDriver& driver_named(const char* name) {
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(name);
  if (!driver) throw DeviceError("this GDAL has no " + std::string(name) + " driver");
  return *driver;
}

void fill(GDALDataset& file, const MapGrid& grid, const std::vector<FloatLayer>& layers, const RowOfLayer& row_of,
          const fs::path& path, const GdalCall& call) {
  for (int row = 0; row < grid.rows; ++row)
    for (std::size_t l = 0; l < layers.size(); ++l) {
      std::vector<float> value = row_of(l, row);
      if (file.GetRasterBand(int(l) + 1)
              ->RasterIO(GF_Write, 0, row, grid.columns, 1, value.data(), grid.columns, 1, GDT_Float32, 0, 0,
                         nullptr) != CE_None)
        refuse_to_write(path, call);
    }
}

/// The GeoTIFF, still open.
DatasetHandle make_tiff(const fs::path& path, const MapGrid& grid, const std::vector<FloatLayer>& layers,
                        const Metadata& metadata, const RowOfLayer& row_of, const GdalCall& call) {
  CPLStringList options;
  for (const char* option : {"COMPRESS=DEFLATE", "PREDICTOR=3", "INTERLEAVE=BAND", "BIGTIFF=IF_SAFER"})
    options.AddString(option);
  DatasetHandle file(driver_named("GTiff").Create(path.c_str(), grid.columns, grid.rows, int(layers.size()),
                                                  GDT_Float32, options.List()));
  if (!file) refuse_to_write(path, call);
  const OGRSpatialReference crs = system_of(grid);
  double transform[6] = {grid.west, grid.cell_width, 0, grid.north, 0, -grid.cell_height};
  file->SetSpatialRef(&crs);
  file->SetGeoTransform(transform);
  for (const auto& [key, value] : metadata) file->SetMetadataItem(key.c_str(), value.c_str());
  for (std::size_t l = 0; l < layers.size(); ++l) {
    GDALRasterBand& band = *file->GetRasterBand(int(l) + 1);
    band.SetDescription(layers[l].name.c_str());
    band.SetUnitType(layers[l].unit.c_str());
    band.SetMetadataItem("NETCDF_VARNAME", layers[l].name.c_str());
    band.SetMetadataItem("units", layers[l].unit.c_str());
    band.SetMetadataItem("long_name", layers[l].name.c_str());
    band.SetNoDataValue(std::numeric_limits<double>::quiet_NaN());
  }
  fill(*file, grid, layers, row_of, path, call);
  return file;
}

}  // namespace

void write_float_layers(const fs::path& path, const MapGrid& grid, const std::vector<FloatLayer>& layers,
                        const Metadata& metadata, const RowOfLayer& row_of) {
  const std::string extension = path.extension().string();
  if (extension != ".tif" && extension != ".nc")
    throw InputError(path.string() + ": \"" + extension + "\" is no format for layers; use .tif or .nc");
  const GdalCall call;
  replace_file_atomically(path, [&](const fs::path& temporary) {
    if (extension == ".tif") {
      make_tiff(temporary, grid, layers, metadata, row_of, call);
      return;
    }
    fs::path tiff = temporary;
    tiff += ".tif";
    {
      const DatasetHandle source = make_tiff(tiff, grid, layers, metadata, row_of, call);
      CPLStringList options;
      for (const char* option : {"FORMAT=NC4C", "COMPRESS=DEFLATE", "WRITE_GDAL_HISTORY=NO", "WRITE_GDAL_VERSION=NO"})
        options.AddString(option);
      const DatasetHandle copy(
          driver_named("netCDF").CreateCopy(temporary.c_str(), source.get(), FALSE, options.List(), nullptr, nullptr));
      if (!copy) refuse_to_write(path, call);
    }
    std::error_code ignored;
    fs::remove(tiff, ignored);
  });
  if (call.failed()) refuse_to_write(path, call);
}

}  // namespace gonogo::terrain
