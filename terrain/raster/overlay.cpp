#include "terrain/raster/overlay.h"

#include <cpl_string.h>
#include <gdal_utils.h>

#include <algorithm>
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
  if (!turned) refuse_to_write(path, call);
  const char* words[] = {"-of", "MEM", "-expand", "rgba", nullptr};
  GDALTranslateOptions* translate = GDALTranslateOptionsNew(const_cast<char**>(words), nullptr);
  DatasetHandle coloured(GDALDataset::FromHandle(GDALTranslate("", turned.get(), translate, &usage_error)));
  GDALTranslateOptionsFree(translate);
  if (!coloured) refuse_to_write(path, call);
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

void write_overlay(const fs::path& kml, const fs::path& png, const fs::path& layer, const std::string& title,
                   const std::string& description, const std::vector<LegendEntry>& legend, int longest) {
  GdalCall call;
  const DatasetHandle source = open_reduced(layer, 4.0 * longest * longest);
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
    if (!written) refuse_to_write(png, call);
  });
  write_file_atomically(kml, kml_text(box, png.filename().string(), title, description, legend));
}

}  // namespace gonogo::terrain
