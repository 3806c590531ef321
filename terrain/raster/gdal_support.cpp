#include "terrain/raster/gdal_support.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <algorithm>
#include <cstdint>

#include "base/error.h"

namespace gonogo::terrain {

GdalCall::GdalCall() {
  static const bool registered = [] {
    GDALAllRegister();
    // GDAL keeps decoded blocks; by default up to 5 % of the machine's memory, which maps do not need.
    if (!CPLGetConfigOption("GDAL_CACHEMAX", nullptr)) GDALSetCacheMax64(std::int64_t(128) << 20);
    return true;
  }();
  (void)registered;
  CPLPushErrorHandler(CPLQuietErrorHandler);
  CPLErrorReset();
}

GdalCall::~GdalCall() { CPLPopErrorHandler(); }

std::string GdalCall::message() const {
  std::string text = CPLGetLastErrorMsg();
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text.empty() ? "no reason given" : text;
}

bool GdalCall::warned() const { return CPLGetLastErrorType() >= CE_Warning; }

bool GdalCall::failed() const { return CPLGetLastErrorType() >= CE_Failure; }

void refuse_to_write(const std::filesystem::path& path, const GdalCall& call) {
  throw DeviceError(path.string() + ": cannot be written (" + call.message() + ")");
}

FixedDate::FixedDate() { CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", kDay); }
FixedDate::~FixedDate() { CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", nullptr); }

OGRSpatialReference system_of(const MapGrid& grid) {
  OGRSpatialReference crs;
  crs.importFromWkt(grid.crs_wkt.c_str());
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

OGRSpatialReference own_degrees(const OGRSpatialReference& crs) {
  OGRSpatialReference degrees;
  degrees.CopyGeogCSFrom(&crs);
  degrees.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return degrees;
}

OGRSpatialReference wgs84() {
  OGRSpatialReference crs;
  crs.importFromEPSG(4326);
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

std::string export_wkt(const OGRSpatialReference& crs) {
  char* text = nullptr;
  const char* const options[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
  crs.exportToWkt(&text, options);
  std::string wkt = text ? text : "";
  CPLFree(text);
  return wkt;
}

DatasetHandle open_reduced(const std::filesystem::path& layer, double max_cells) {
  const GdalCall call;
  const auto open = [&](const char* const* options) {
    DatasetHandle dataset(GDALDataset::Open(layer.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, nullptr, options));
    if (!dataset) throw DeviceError(layer.string() + ": cannot be read back (" + call.message() + ")");
    return dataset;
  };
  DatasetHandle dataset = open(nullptr);
  const int overviews = dataset->GetRasterBand(1)->GetOverviewCount();
  for (int o = 0; o < overviews; ++o) {
    if (double(dataset->GetRasterXSize()) * dataset->GetRasterYSize() <= max_cells) break;
    CPLStringList options;
    options.SetNameValue("OVERVIEW_LEVEL", std::to_string(o).c_str());
    dataset = open(options.List());
  }
  return dataset;
}

Transformation to_wgs84(const MapGrid& grid, const std::filesystem::path& path) {
  const GdalCall call;
  const OGRSpatialReference from = system_of(grid), to = wgs84();
  Transformation turn(OGRCreateCoordinateTransformation(&from, &to));
  if (!turn)
    throw InputError(path.string() +
                     ": this format holds longitude and latitude on WGS 84, to which no way is known from \"" +
                     grid.crs_name + "\"; write a GeoPackage (.gpkg)");
  return turn;
}

}  // namespace gonogo::terrain
