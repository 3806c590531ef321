#include "terrain/raster/vector_style.h"

#include <cpl_string.h>
#include <ogrsf_frmts.h>

#include <cstdio>

#include "base/line.h"
#include "terrain/raster/gdal_support.h"
#include "terrain/raster/overlay.h"

namespace gonogo::terrain {
namespace {

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

}  // namespace

std::string qgis_style(const VectorStyle& style) {
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
  set(feature, "styleQML", qgis_style(style));
  set(feature, "description", "colours of gonogo");
  set(feature, "update_time", FixedDate::kDay);
  feature.SetField("useAsDefault", 1);
  if (styles->CreateFeature(&feature) != OGRERR_NONE) refuse_to_write(path, call);
}

}  // namespace gonogo::terrain
