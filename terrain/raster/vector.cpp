#include "terrain/raster/vector.h"

#include <cpl_string.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include "base/error.h"
#include "base/file.h"
#include "terrain/raster/gdal_support.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;
namespace {

struct Format {
  const char* driver;
  bool wgs84, attributes;
};

Format format_of(const fs::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".gpkg") return {"GPKG", false, true};
  if (extension == ".geojson" || extension == ".json") return {"GeoJSON", true, true};
  if (extension == ".gpx") return {"GPX", true, false};
  throw InputError(path.string() + ": \"" + extension + "\" is no format for lines; use .gpkg, .geojson or .gpx");
}

[[noreturn]] void fail(const fs::path& path, const GdalCall& call) {
  throw DeviceError(path.string() + ": cannot be written (" + call.message() + ")");
}

void add_line(OGRLayer& layer, const LineFeature& line, const Format& format, OGRCoordinateTransformation* turn,
              const fs::path& path, const GdalCall& call) {
  OGRFeature feature(layer.GetLayerDefn());
  feature.SetField("name", line.name.c_str());
  if (format.attributes)
    for (const auto& [name, value] : line.attribute) feature.SetField(name.c_str(), value);
  OGRLineString string;
  for (const auto& [x, y] : line.point) string.addPoint(x, y);
  if (turn && string.transform(turn) != OGRERR_NONE) fail(path, call);
  if (std::string(format.driver) == "GPX") {
    OGRMultiLineString track;
    track.addGeometry(&string);
    feature.SetGeometry(&track);
  } else {
    feature.SetGeometry(&string);
  }
  if (layer.CreateFeature(&feature) != OGRERR_NONE) fail(path, call);
}

void write_format(const fs::path& path, const Format& format, const MapGrid& grid, const std::string& name,
                  const std::vector<LineFeature>& lines) {
  GdalCall call;
  OGRSpatialReference from, wgs84;
  from.importFromWkt(grid.crs_wkt.c_str());
  wgs84.importFromEPSG(4326);
  for (OGRSpatialReference* crs : {&from, &wgs84}) crs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  std::unique_ptr<OGRCoordinateTransformation> turn(format.wgs84 ? OGRCreateCoordinateTransformation(&from, &wgs84)
                                                                 : nullptr);
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(format.driver);
  if (!driver) throw DeviceError("this GDAL has no " + std::string(format.driver) + " driver");
  DatasetHandle file(driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  if (!file) fail(path, call);
  CPLStringList options;
  if (std::string(format.driver) == "GeoJSON") options.SetNameValue("RFC7946", "YES");
  const bool gpx = std::string(format.driver) == "GPX";
  OGRLayer* layer = file->CreateLayer(gpx ? "tracks" : name.c_str(), format.wgs84 ? &wgs84 : &from,
                                      gpx ? wkbMultiLineString : wkbLineString, options.List());
  if (!layer) fail(path, call);
  if (format.attributes) {
    OGRFieldDefn title("name", OFTString);
    if (layer->CreateField(&title) != OGRERR_NONE) fail(path, call);
    for (const auto& [column, value] : lines.empty() ? LineFeature{}.attribute : lines.front().attribute) {
      OGRFieldDefn field(column.c_str(), OFTReal);
      if (layer->CreateField(&field) != OGRERR_NONE) fail(path, call);
    }
  }
  for (const LineFeature& line : lines) add_line(*layer, line, format, turn.get(), path, call);
}

}  // namespace

void write_lines(const fs::path& path, const MapGrid& grid, const std::string& layer,
                 const std::vector<LineFeature>& lines) {
  const Format format = format_of(path);
  replace_file_atomically(path, [&](const fs::path& temporary) {
    std::error_code ignored;
    fs::remove(temporary, ignored);  // drivers refuse to write over a file
    write_format(temporary, format, grid, layer, lines);
  });
}

}  // namespace gonogo::terrain
