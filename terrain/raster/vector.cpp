#include "terrain/raster/vector.h"

#include <cpl_string.h>
#include <ogrsf_frmts.h>

#include "base/error.h"
#include "base/file.h"
#include "terrain/raster/gdal_support.h"
#include "terrain/raster/to_wgs84.h"
#include "terrain/raster/vector_style.h"

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

void add_line(OGRLayer& layer, const LineFeature& line, const Format& format, OGRCoordinateTransformation* turn,
              const fs::path& path, const GdalCall& call) {
  OGRFeature feature(layer.GetLayerDefn());
  feature.SetField("name", line.name.c_str());
  if (format.attributes)
    for (const auto& [name, value] : line.attribute) feature.SetField(name.c_str(), value);
  OGRLineString string;
  for (const auto& [x, y] : line.point) string.addPoint(x, y);
  if (turn && string.transform(turn) != OGRERR_NONE) refuse_to_write(path, call);
  if (std::string(format.driver) == "GPX") {
    OGRMultiLineString track;
    track.addGeometry(&string);
    feature.SetGeometry(&track);
  } else {
    feature.SetGeometry(&string);
  }
  if (layer.CreateFeature(&feature) != OGRERR_NONE) refuse_to_write(path, call);
}

VectorStyle style_of(const std::vector<LineFeature>& lines) {
  VectorStyle style{.column = "name", .polygons = false, .legend = {}};
  for (const LineFeature& line : lines) style.legend.push_back({0, line.name, line.colour});
  return style;
}

void write_format(const fs::path& path, const Format& format, const MapGrid& grid, const std::string& name,
                  const std::vector<LineFeature>& lines) {
  GdalCall call;
  OGRSpatialReference from = system_of(grid), degrees = wgs84();
  std::unique_ptr<OGRCoordinateTransformation> turn;
  if (format.wgs84) turn = to_wgs84(grid, path);
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(format.driver);
  if (!driver) throw DeviceError("this GDAL has no " + std::string(format.driver) + " driver");
  DatasetHandle file(driver->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  if (!file) refuse_to_write(path, call);
  CPLStringList options;
  if (std::string(format.driver) == "GeoJSON") options.SetNameValue("RFC7946", "YES");
  const bool gpx = std::string(format.driver) == "GPX";
  OGRLayer* layer = file->CreateLayer(gpx ? "tracks" : name.c_str(), format.wgs84 ? &degrees : &from,
                                      gpx ? wkbMultiLineString : wkbLineString, options.List());
  if (!layer) refuse_to_write(path, call);
  if (format.attributes) {
    OGRFieldDefn title("name", OFTString);
    if (layer->CreateField(&title) != OGRERR_NONE) refuse_to_write(path, call);
    for (const auto& [column, value] : lines.empty() ? LineFeature{}.attribute : lines.front().attribute) {
      OGRFieldDefn field(column.c_str(), OFTReal);
      if (layer->CreateField(&field) != OGRERR_NONE) refuse_to_write(path, call);
    }
  }
  for (const LineFeature& line : lines) add_line(*layer, line, format, turn.get(), path, call);
  if (std::string(format.driver) == "GPKG") embed_style(*file, name, style_of(lines), path);
}

}  // namespace

void write_lines(const fs::path& path, const MapGrid& grid, const std::string& layer,
                 const std::vector<LineFeature>& lines) {
  const Format format = format_of(path);
  const FixedDate fixed;
  replace_file_atomically(path, [&](const fs::path& temporary) {
    std::error_code ignored;
    fs::remove(temporary, ignored);  // drivers refuse to write over a file
    write_format(temporary, format, grid, layer, lines);
  });
}

}  // namespace gonogo::terrain
