#include "terrain/raster/vector/write_vector.h"

#include <cpl_string.h>
#include <gdal_alg.h>
#include <ogrsf_frmts.h>
#include <chrono>
#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "terrain/raster/gdal_support.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;

namespace {

/// Colours features by the label in `column`. Polygons are filled; lines lie over a wider white line.
struct VectorStyle {
  std::string column;
  bool polygons = false;
  std::vector<LegendEntry> legend;
};

constexpr double kFill = 0.6;              // opacity of polygons, so that a background shows
constexpr double kHalo = 1.5, kWay = 0.8;  // width of lines [mm]

/// "#rrggbb" as QGIS writes it.
std::string colour_numbers(const std::string& colour) {
  unsigned red = 0, green = 0, blue = 0;
  std::sscanf(colour.c_str(), "#%2x%2x%2x", &red, &green, &blue);
  return line("%u,%u,%u,255", red, green, blue);
}

std::string option(const char* name, const std::string& value) {
  return line("<Option type=\"QString\" name=\"%s\" value=\"%s\"/>", name, value.c_str());
}

std::string symbol_layer(const char* kind, const std::string& options) {
  return line("<layer class=\"%s\" enabled=\"1\" locked=\"0\" pass=\"0\"><Option type=\"Map\">", kind) + options +
         "</Option></layer>";
}

std::string stroke(const std::string& colour, double width) {
  return symbol_layer("SimpleLine", option("line_color", colour_numbers(colour)) +
                                        option("line_width", line("%g", width)) + option("line_width_unit", "MM") +
                                        option("joinstyle", "round") + option("capstyle", "round"));
}

std::string symbol(const LegendEntry& entry, bool polygon, std::size_t number) {
  const std::string layers =
      polygon ? symbol_layer("SimpleFill", option("color", colour_numbers(entry.colour)) + option("style", "solid") +
                                               option("outline_color", colour_numbers(entry.colour)) +
                                               option("outline_style", "solid") + option("outline_width", "0.1") +
                                               option("outline_width_unit", "MM"))
              : stroke("#ffffff", kHalo) + stroke(entry.colour, kWay);
  return line("      <symbol type=\"%s\" name=\"%zu\" alpha=\"%g\" clip_to_extent=\"1\" force_rhr=\"0\">",
              polygon ? "fill" : "line", number, polygon ? kFill : 1.0) +
         layers + "</symbol>\n";
}

void set(OGRFeature& feature, const char* field, const std::string& value) { feature.SetField(field, value.c_str()); }

/// The style in QGIS's XML (qgis.dtd: qgis/renderer-v2 of type categorizedSymbol).
std::string categorized_style(const VectorStyle& style) {
  std::string categories, symbols;
  for (std::size_t i = 0; i < style.legend.size(); ++i) {
    const std::string label = xml_escaped(style.legend[i].label);
    categories += "      <category value=\"" + label + "\" label=\"";
    categories += label + line("\" symbol=\"%zu\" type=\"string\" render=\"true\"/>\n", i);
    symbols += symbol(style.legend[i], style.polygons, i);
  }
  return "<!DOCTYPE qgis>\n<qgis version=\"3.22\" styleCategories=\"Symbology\">\n  <renderer-v2 "
         "type=\"categorizedSymbol\" attr=\"" +
         xml_escaped(style.column) +
         "\" symbollevels=\"1\" enableorderby=\"0\" forceraster=\"0\">\n    <categories>\n" + categories +
         "    </categories>\n    <symbols>\n" + symbols + "    </symbols>\n  </renderer-v2>\n</qgis>\n";
}

/// Makes `style` the layer's default, in the table layer_styles that QGIS reads by itself ("Save Style > In Database"
/// writes the same). The geometry column is "geom", the driver's default.
void embed_style(GDALDataset& geopackage, const std::string& layer, const VectorStyle& style,
                 const std::filesystem::path& path) {
  const GdalCall call;
  CPLStringList options;
  options.SetNameValue("FID", "id");
  OGRLayer* styles = geopackage.CreateLayer("layer_styles", nullptr, wkbNone, options.List());
  if (!styles) refuse_to_write(path, call);
  OGRFieldDefn is_default("useAsDefault", OFTInteger), time("update_time", OFTDateTime);
  is_default.SetSubType(OFSTBoolean);
  for (const char* name : {"f_table_catalog", "f_table_schema", "f_table_name", "f_geometry_column", "styleName",
                           "styleQML", "styleSLD", "description", "owner", "ui"}) {
    OGRFieldDefn field(name, OFTString);
    if (styles->CreateField(&field) != OGRERR_NONE) refuse_to_write(path, call);
  }
  for (OGRFieldDefn* field : {&is_default, &time})
    if (styles->CreateField(field) != OGRERR_NONE) refuse_to_write(path, call);
  OGRFeature feature(styles->GetLayerDefn());
  for (const char* empty : {"f_table_catalog", "f_table_schema", "styleSLD", "owner"}) set(feature, empty, "");
  set(feature, "f_table_name", layer);
  set(feature, "f_geometry_column", "geom");
  set(feature, "styleName", layer);
  set(feature, "styleQML", categorized_style(style));
  set(feature, "description", "colours of gonogo");
  set(feature, "update_time", FixedDate::kDay);
  feature.SetField("useAsDefault", 1);
  if (styles->CreateFeature(&feature) != OGRERR_NONE) refuse_to_write(path, call);
}

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

void add_field(OGRLayer& layer, const char* name, OGRFieldType type, const fs::path& path, const GdalCall& call) {
  OGRFieldDefn field(name, type);
  if (layer.CreateField(&field) != OGRERR_NONE) refuse_to_write(path, call);
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
  Transformation turn;
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
    add_field(*layer, "name", OFTString, path, call);
    for (const auto& [column, value] : lines.empty() ? LineFeature{}.attribute : lines.front().attribute)
      add_field(*layer, column.c_str(), OFTReal, path, call);
  }
  for (const LineFeature& line : lines) add_line(*layer, line, format, turn.get(), path, call);
  if (std::string(format.driver) == "GPKG") embed_style(*file, name, style_of(lines), path);
}

template <class Write>
void replace_vector(const fs::path& path, const Write& write) {
  const FixedDate fixed;
  replace_file_atomically(path, [&](const fs::path& temporary) {
    std::error_code ignored;
    fs::remove(temporary, ignored);  // drivers refuse to write over a file
    write(temporary);
  });
}

}  // namespace

void write_lines(const fs::path& path, const MapGrid& grid, const std::string& layer,
                 const std::vector<LineFeature>& lines) {
  const Format format = format_of(path);
  replace_vector(path, [&](const fs::path& temporary) { write_format(temporary, format, grid, layer, lines); });
}

namespace {

/// Polygons of equal cells in memory, with the field "code" alone.
DatasetHandle polygons_of(GDALDataset& source, const fs::path& path, const GdalCall& call) {
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("Memory");
  if (!driver) driver = GetGDALDriverManager()->GetDriverByName("MEM");  // both in one from GDAL 3.11 on
  if (!driver) throw DeviceError("this GDAL has no MEM driver");
  DatasetHandle memory(driver->Create("", 0, 0, 0, GDT_Unknown, nullptr));
  OGRLayer* layer = memory ? memory->CreateLayer("polygons", nullptr, wkbPolygon, nullptr) : nullptr;
  if (!layer) refuse_to_write(path, call);
  add_field(*layer, "code", OFTInteger, path, call);
  GDALRasterBand& band = *source.GetRasterBand(1);
  if (GDALPolygonize(&band, band.GetMaskBand(), layer, 0, nullptr, nullptr, nullptr) != CE_None)
    refuse_to_write(path, call);
  return memory;
}

/// Adds the polygon, its code, class and area, and the width of its cells [m].
void add_polygon(OGRLayer& layer, OGRFeature& polygon, const MapGrid& grid, double cell_m,
                 const std::vector<LegendEntry>& legend, const fs::path& path, const GdalCall& call) {
  OGRFeature feature(layer.GetLayerDefn());
  const int code = polygon.GetFieldAsInteger("code");
  feature.SetField("code", code);
  for (const LegendEntry& entry : legend)
    if (int(entry.value) == code) feature.SetField("class", entry.label.c_str());
  if (const OGRGeometry* shape = polygon.GetGeometryRef())
    feature.SetField("area_km2", shape->toPolygon()->get_Area() * grid.metres_per_unit * grid.metres_per_unit * 1e-6);
  feature.SetField("cell_m", cell_m);
  feature.SetGeometryDirectly(polygon.StealGeometry());
  if (layer.CreateFeature(&feature) != OGRERR_NONE) refuse_to_write(path, call);
}

void polygonize(const fs::path& path, const std::string& name, GDALDataset& source, const MapGrid& grid,
                const std::vector<LegendEntry>& legend) {
  const GdalCall call;
  const DatasetHandle polygons = polygons_of(source, path, call);
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
  if (file->StartTransaction() != OGRERR_NONE) refuse_to_write(path, call);
  const double cell_m = grid.cell_width_m() * grid.columns / source.GetRasterXSize();
  for (const auto& polygon : polygons->GetLayer(0)) add_polygon(*layer, *polygon, grid, cell_m, legend, path, call);
  embed_style(*file, name, {.column = "class", .polygons = true, .legend = legend}, path);
  if (file->CommitTransaction() != OGRERR_NONE) refuse_to_write(path, call);
}

void write_polygons(const fs::path& path, const std::string& name, GDALDataset& source, const MapGrid& grid,
                    const std::vector<LegendEntry>& legend) {
  replace_vector(path, [&](const fs::path& temporary) { polygonize(temporary, name, source, grid, legend); });
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

namespace {

/// "2026-05-01T06:00:12Z"; milliseconds only where there are any.
std::string time_text(std::int64_t departure, double seconds) {
  const std::int64_t all = departure * 1000 + std::llround(seconds * 1000);
  const std::chrono::sys_time<std::chrono::milliseconds> moment{std::chrono::milliseconds(all)};
  const auto day = std::chrono::floor<std::chrono::days>(moment);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss clock(moment - day);
  const auto rest = int(clock.subseconds().count());
  return line("%04d-%02u-%02uT%02d:%02d:%02d", int(date.year()), unsigned(date.month()), unsigned(date.day()),
              int(clock.hours().count()), int(clock.minutes().count()), int(clock.seconds().count())) +
         (rest ? line(".%03dZ", rest) : "Z");
}

class GpxText {
 public:
  GpxText(const MapGrid& grid, const std::filesystem::path& path, std::int64_t departure)
      : turn_(to_wgs84(grid, path)), path_(path), departure_(departure) {}

  std::string point(const char* element, const TrackPoint& point, const std::string& name) const {
    double x = point.x, y = point.y;
    if (!turn_->Transform(1, &x, &y))
      throw InputError(path_.string() +
                       line(": the place %.10g,%.10g has no longitude and latitude", point.x, point.y));
    std::string text = line("<%s lat=\"%.8f\" lon=\"%.8f\">", element, y, x);
    if (!std::isnan(point.height)) text += line("<ele>%.2f</ele>", point.height);
    if (!std::isnan(point.seconds)) text += "<time>" + time_text(departure_, point.seconds) + "</time>";
    if (!name.empty()) text += "<name>" + xml_escaped(name) + "</name>";
    return text + "</" + element + ">\n";
  }

 private:
  Transformation turn_;
  std::filesystem::path path_;
  std::int64_t departure_;
};

}  // namespace

void write_gpx(const std::filesystem::path& path, const MapGrid& grid, const std::vector<Stop>& stops,
               const std::vector<Track>& tracks, std::int64_t departure) {
  const GdalCall call;
  const GpxText gpx(grid, path, departure);
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<gpx version=\"1.1\" creator=\"gonogo\" "
      "xmlns=\"http://www.topografix.com/GPX/1/1\">\n";
  for (const Stop& stop : stops) text += gpx.point("wpt", stop.at, stop.name);
  for (const Track& track : tracks) {
    text += "<trk><name>" + xml_escaped(track.name) + "</name><trkseg>\n";
    for (const TrackPoint& point : track.point) text += gpx.point("trkpt", point, "");
    text += "</trkseg></trk>\n";
  }
  write_file_atomically(path, text + "</gpx>\n");
}

}  // namespace gonogo::terrain
