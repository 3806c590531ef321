#include "terrain/raster/overlay.h"

#include <cpl_string.h>
#include <gdal_alg.h>
#include <gdal_utils.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/file.h"
#include "base/line.h"
#include "terrain/raster/gdal_support.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;
namespace {

OGRSpatialReference wgs84() {
  OGRSpatialReference crs;
  crs.importFromEPSG(4326);
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

OGRSpatialReference system_of(const MapGrid& grid) {
  OGRSpatialReference crs;
  crs.importFromWkt(grid.crs_wkt.c_str());
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

[[noreturn]] void fail(const fs::path& path, const GdalCall& call) {
  throw DeviceError(path.string() + ": cannot be written (" + call.message() + ")");
}

/// The layer, or the first overview of it that is small enough.
DatasetHandle open_reduced(const fs::path& layer, double most_cells, const GdalCall& call) {
  DatasetHandle dataset(GDALDataset::Open(layer.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
  if (!dataset) fail(layer, call);
  const int overviews = dataset->GetRasterBand(1)->GetOverviewCount();
  for (int o = 0; o < overviews; ++o) {
    if (double(dataset->GetRasterXSize()) * dataset->GetRasterYSize() <= most_cells) break;
    CPLStringList options;
    options.SetNameValue("OVERVIEW_LEVEL", std::to_string(o).c_str());
    dataset.reset(GDALDataset::Open(layer.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, nullptr, options.List()));
    if (!dataset) fail(layer, call);
  }
  return dataset;
}

void add_field(OGRLayer& layer, const char* name, OGRFieldType type, const fs::path& path, const GdalCall& call) {
  OGRFieldDefn field(name, type);
  if (layer.CreateField(&field) != OGRERR_NONE) fail(path, call);
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
    if (layer.SetFeature(feature.get()) != OGRERR_NONE) fail(path, call);
  }
}

void polygonize(const fs::path& path, GDALDataset& source, const MapGrid& grid,
                const std::vector<LegendEntry>& legend) {
  GdalCall call;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
  if (!driver) throw DeviceError("this GDAL has no GPKG driver");
  DatasetHandle file(driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  if (!file) fail(path, call);
  OGRSpatialReference crs = system_of(grid);
  OGRLayer* layer = file->CreateLayer("classes", &crs, wkbPolygon, nullptr);
  if (!layer) fail(path, call);
  add_field(*layer, "code", OFTInteger, path, call);
  add_field(*layer, "class", OFTString, path, call);
  add_field(*layer, "area_km2", OFTReal, path, call);
  add_field(*layer, "cell_m", OFTReal, path, call);
  GDALRasterBand& band = *source.GetRasterBand(1);
  if (file->StartTransaction() != OGRERR_NONE ||
      GDALPolygonize(&band, band.GetMaskBand(), layer, 0, nullptr, nullptr, nullptr) != CE_None)
    fail(path, call);
  describe_polygons(*layer, grid, grid.cell_width_m() * grid.columns / source.GetRasterXSize(), legend, path, call);
  if (file->CommitTransaction() != OGRERR_NONE) fail(path, call);
}

/// Warped to degrees and turned into red, green, blue and opacity.
DatasetHandle picture_in_degrees(GDALDataset& source, int longest, const fs::path& path, const GdalCall& call) {
  const std::string size = std::to_string(longest);
  const bool wide = source.GetRasterXSize() >= source.GetRasterYSize();
  const char* warp_words[] = {"-of",
                              "VRT",
                              "-t_srs",
                              "EPSG:4326",
                              "-r",
                              "near",
                              "-dstnodata",
                              "255",
                              "-ts",
                              wide ? size.c_str() : "0",
                              wide ? "0" : size.c_str(),
                              nullptr};
  GDALWarpAppOptions* warp = GDALWarpAppOptionsNew(const_cast<char**>(warp_words), nullptr);
  GDALDatasetH handle = &source;
  int usage_error = 0;
  DatasetHandle turned(GDALDataset::FromHandle(GDALWarp("", nullptr, 1, &handle, warp, &usage_error)));
  GDALWarpAppOptionsFree(warp);
  if (!turned) fail(path, call);
  const char* words[] = {"-of", "MEM", "-expand", "rgba", nullptr};
  GDALTranslateOptions* translate = GDALTranslateOptionsNew(const_cast<char**>(words), nullptr);
  DatasetHandle coloured(GDALDataset::FromHandle(GDALTranslate("", turned.get(), translate, &usage_error)));
  GDALTranslateOptionsFree(translate);
  if (!coloured) fail(path, call);
  return coloured;
}

std::string kml_text(const DegreeBox& box, const std::string& picture, const std::string& title,
                     const std::string& description, const std::vector<LegendEntry>& legend) {
  std::string list;
  for (const LegendEntry& entry : legend) list += entry.label + ": " + entry.colour + "\n";
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml "
         "xmlns=\"http://www.opengis.net/kml/2.2\">\n<GroundOverlay>\n  <name>" +
         xml_escaped(title) + "</name>\n  <description>" + xml_escaped(description + "\n" + list) +
         "</description>\n  <Icon><href>" + xml_escaped(picture) + "</href></Icon>\n" +
         line("  <LatLonBox><north>%.9f</north><south>%.9f</south><east>%.9f</east><west>%.9f</west></LatLonBox>\n",
              box.north, box.south, box.east, box.west) +
         "</GroundOverlay>\n</kml>\n";
}

}  // namespace

std::string xml_escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (static_cast<unsigned char>(c) < 32 && c != '\n' && c != '\t')
      out += ' ';
    else
      out += c;
  }
  return out;
}

std::array<std::array<double, 2>, 4> degree_corners(const MapGrid& grid) {
  GdalCall call;
  OGRSpatialReference from = system_of(grid), to = wgs84();
  const std::unique_ptr<OGRCoordinateTransformation> turn(OGRCreateCoordinateTransformation(&from, &to));
  const double east = grid.west + grid.columns * grid.cell_width, south = grid.north - grid.rows * grid.cell_height;
  std::array<std::array<double, 2>, 4> corners = {
      {{grid.west, south}, {east, south}, {east, grid.north}, {grid.west, grid.north}}};
  for (auto& [x, y] : corners)
    if (!turn || !turn->Transform(1, &x, &y))
      throw DeviceError("the map's place in degrees cannot be told (" + call.message() + ")");
  return corners;
}

DegreeBox degree_box(const MapGrid& grid) {
  GdalCall call;
  OGRSpatialReference from = system_of(grid), to = wgs84();
  const std::unique_ptr<OGRCoordinateTransformation> turn(OGRCreateCoordinateTransformation(&from, &to));
  const double east = grid.west + grid.columns * grid.cell_width, south = grid.north - grid.rows * grid.cell_height;
  DegreeBox box;
  if (!turn ||
      !turn->TransformBounds(grid.west, south, east, grid.north, &box.west, &box.south, &box.east, &box.north, 21))
    throw DeviceError("the map's place in degrees cannot be told (" + call.message() + ")");
  return box;
}

void write_class_polygons(const fs::path& path, const fs::path& layer, const MapGrid& grid,
                          const std::vector<LegendEntry>& legend, double most_cells) {
  GdalCall call;
  const DatasetHandle source = open_reduced(layer, most_cells, call);
  // GDAL writes the day into a GeoPackage; results hold no clock times.
  CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z");
  replace_file_atomically(path, [&](const fs::path& temporary) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    polygonize(temporary, *source, grid, legend);
  });
  CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", nullptr);
}

void write_overlay(const fs::path& kml, const fs::path& png, const fs::path& layer, const std::string& title,
                   const std::string& description, const std::vector<LegendEntry>& legend, int longest) {
  GdalCall call;
  const DatasetHandle source = open_reduced(layer, 4.0 * longest * longest, call);
  const int side = std::min(longest, std::max(source->GetRasterXSize(), source->GetRasterYSize()));
  const DatasetHandle picture = picture_in_degrees(*source, side, png, call);
  double t[6];
  picture->GetGeoTransform(t);
  const DegreeBox box = {t[0], t[3] + t[5] * picture->GetRasterYSize(), t[0] + t[1] * picture->GetRasterXSize(), t[3]};
  replace_file_atomically(png, [&](const fs::path& temporary) {
    CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", "NO");
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("PNG");
    DatasetHandle written(
        driver ? driver->CreateCopy(temporary.c_str(), picture.get(), FALSE, nullptr, nullptr, nullptr) : nullptr);
    CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", nullptr);
    if (!written) fail(png, call);
  });
  write_file_atomically(kml, kml_text(box, png.filename().string(), title, description, legend));
}

}  // namespace gonogo::terrain
