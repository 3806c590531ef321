#include "terrain/raster/raster_open.h"

#include <gdal_utils.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;
namespace {

DatasetHandle open_dataset(const fs::path& path) {
  const bool virtual_file = path.string().rfind("/vsi", 0) == 0;
  std::error_code ec;
  if (!virtual_file && !fs::exists(path, ec)) throw InputError(path.string() + ": no such file; check the path");
  GdalCall call;
  DatasetHandle dataset(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
  if (!dataset)
    throw InputError(path.string() + ": cannot be read as a raster (" + call.message() +
                     "); give a format that gdalinfo opens, for example GeoTIFF");
  if (dataset->GetRasterCount() < 1)
    throw InputError(path.string() + ": holds no raster band; name one raster of it, as gdalinfo lists them");
  return dataset;
}

bool same_place_system(GDALDataset& a, GDALDataset& b) {
  const OGRSpatialReference *first = a.GetSpatialRef(), *second = b.GetSpatialRef();
  if (!first || !second) return first == second;
  return first->IsSame(second);
}

/// Puts tiles together. GDAL leaves out tiles that do not fit, with a warning; here they are refused.
void join_tiles(OpenRaster& raster, const RasterFiles& files) {
  std::vector<GDALDatasetH> handles;
  for (std::size_t i = 0; i < raster.sources.size(); ++i) {
    if (!same_place_system(*raster.sources.front(), *raster.sources[i]))
      throw InputError(files.file[i].string() + ": is not in the coordinate system of " + files.file[0].string() +
                       ", and tiles of one raster must share it; bring it there with gdalwarp -t_srs");
    require_north_up(*raster.sources[i], files.file[i].string());
    handles.push_back(raster.sources[i].get());
  }
  const char* arguments[] = {"-resolution", "highest", nullptr};
  GdalCall call;
  GDALBuildVRTOptions* options = GDALBuildVRTOptionsNew(const_cast<char**>(arguments), nullptr);
  int usage_error = 0;
  raster.dataset.reset(
      GDALDataset::FromHandle(GDALBuildVRT("", int(handles.size()), handles.data(), nullptr, options, &usage_error)));
  GDALBuildVRTOptionsFree(options);
  if (!raster.dataset) throw InputError(raster.name + ": cannot be put together (" + call.message() + ")");
  if (call.warned())
    throw InputError(raster.name + ": do not fit together (" + call.message() +
                     "); give tiles of one raster, alike in type and bands");
}

}  // namespace

OpenRaster open_raster(const RasterFiles& files) {
  OpenRaster raster;
  raster.name = files.name();
  if (files.file.empty()) throw InputError("a raster without a file; name one");
  for (const fs::path& file : files.file) raster.sources.push_back(open_dataset(file));
  if (files.file.size() == 1) {
    raster.dataset = std::move(raster.sources.front());
    raster.sources.clear();
  } else {
    join_tiles(raster, files);
  }
  return raster;
}

const OGRSpatialReference& require_crs(GDALDataset& dataset, const std::string& name) {
  const OGRSpatialReference* crs = dataset.GetSpatialRef();
  if (!crs || crs->IsEmpty())
    throw InputError(name +
                     ": names no coordinate system; find out which one it is in and write it in with: gdal_edit.py "
                     "-a_srs EPSG:<code> " +
                     name);
  return *crs;
}

GeoTransform require_north_up(GDALDataset& dataset, const std::string& name) {
  GeoTransform t;
  if (dataset.GetGeoTransform(t.value) != CE_None)
    throw InputError(name +
                     ": does not say where its cells lie (no geotransform); georeference it first, for "
                     "example with gdal_translate -a_ullr");
  const std::string repair = "; straighten it with: gdalwarp -r bilinear " + name + " north_up.tif";
  const double turned = 1e-9 * std::hypot(t.value[1], t.value[5]);
  if (std::abs(t.value[2]) > turned || std::abs(t.value[4]) > turned)
    throw InputError(name + ": its rows do not run west to east (rotated geotransform)" + repair);
  if (!(t.value[1] > 0) || !(t.value[5] < 0))
    throw InputError(name + ": its first row is not the northernmost or its columns do not run eastward" + repair);
  return t;
}

double vertical_metres(GDALRasterBand& band, const std::string& name) {
  std::string unit = band.GetUnitType();
  std::transform(unit.begin(), unit.end(), unit.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  for (const char* known : {"", "m", "metre", "meter", "metres", "meters"})
    if (unit == known) return 1;
  for (const char* known : {"ft", "foot", "feet", "international foot"})
    if (unit == known) return 0.3048;
  for (const char* known : {"us survey foot", "us_survey_foot", "us-ft", "ftus", "us survey feet"})
    if (unit == known) return 1200.0 / 3937.0;
  throw InputError(name + ": heights are in \"" + unit +
                   "\"; metres and feet are understood, convert it with gdal_calc.py");
}

MapGrid describe_grid(int columns, int rows, const OGRSpatialReference& crs, const GeoTransform& t) {
  MapGrid grid;
  grid.columns = columns;
  grid.rows = rows;
  grid.west = t.value[0];
  grid.north = t.value[3];
  grid.cell_width = t.value[1];
  grid.cell_height = -t.value[5];
  const char* unit = nullptr;
  grid.metres_per_unit = crs.GetLinearUnits(&unit);
  if (unit) grid.unit_name = unit;
  grid.crs_wkt = export_wkt(crs);
  grid.body_radius = crs.GetSemiMajor();
  if (const char* name = crs.GetName()) grid.crs_name = name;
  const char *authority = crs.GetAuthorityName(nullptr), *code = crs.GetAuthorityCode(nullptr);
  if (authority && code) grid.crs_code = std::string(authority) + ":" + code;
  return grid;
}

}  // namespace gonogo::terrain
