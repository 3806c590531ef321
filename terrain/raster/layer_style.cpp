#include "terrain/raster/layer_style.h"

#include <cstdio>

#include "base/line.h"
#include "terrain/raster/overlay.h"

namespace gonogo::terrain {
namespace {

std::string shortest(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", x);
  return text;
}

std::string paletted_renderer(const LayerInfo& info) {
  std::string xml = "    <rasterrenderer type=\"paletted\" band=\"1\" opacity=\"1\">\n      <colorPalette>\n";
  for (const LegendEntry& entry : info.legend)
    xml += "        <paletteEntry value=\"" + shortest(entry.value) + "\" color=\"" + entry.colour + "\" label=\"" +
           xml_escaped(entry.label) + "\" alpha=\"255\"/>\n";
  return xml + "      </colorPalette>\n    </rasterrenderer>\n";
}

std::string ramp_renderer(const LayerInfo& info) {
  const std::string low = shortest(info.legend.front().value), high = shortest(info.legend.back().value);
  std::string xml = "    <rasterrenderer type=\"singlebandpseudocolor\" band=\"1\" opacity=\"1\" classificationMin=\"" +
                    low + "\" classificationMax=\"" + high +
                    "\">\n      <rastershader>\n        <colorrampshader "
                    "colorRampType=\"INTERPOLATED\" classificationMode=\"1\" clip=\"0\" minimumValue=\"" +
                    low + "\" maximumValue=\"" + high + "\">\n";
  for (const LegendEntry& entry : info.legend)
    xml += "          <item value=\"" + shortest(entry.value) + "\" color=\"" + entry.colour + "\" label=\"" +
           xml_escaped(entry.label) + "\" alpha=\"255\"/>\n";
  const std::string unit = info.unit.empty() || info.unit == "1" ? "" : " " + info.unit;
  xml += "          <rampLegendSettings minimumLabel=\"\" maximumLabel=\"\" prefix=\"\" suffix=\"" + xml_escaped(unit) +
         "\" direction=\"0\" orientation=\"2\" useContinuousLegend=\"1\"/>\n";
  return xml + "        </colorrampshader>\n      </rastershader>\n    </rasterrenderer>\n";
}

/// Columns of the attribute table: value, class name, cells, colour. Types and usages as GDAL numbers them.
std::string attribute_table(const LayerInfo& info, const std::array<std::uint64_t, 256>& cells) {
  constexpr std::array<std::array<const char*, 3>, 6> kColumns = {{{"Value", "0", "5"},
                                                                   {"Class", "2", "2"},
                                                                   {"Count", "1", "1"},
                                                                   {"Red", "0", "6"},
                                                                   {"Green", "0", "7"},
                                                                   {"Blue", "0", "8"}}};
  std::string xml = "    <GDALRasterAttributeTable tableType=\"thematic\">\n";
  for (std::size_t c = 0; c < kColumns.size(); ++c)
    xml += line("      <FieldDefn index=\"%zu\"><Name>%s</Name><Type>%s</Type><Usage>%s</Usage></FieldDefn>\n", c,
                kColumns[c][0], kColumns[c][1], kColumns[c][2]);
  for (std::size_t r = 0; r < info.legend.size(); ++r) {
    const LegendEntry& entry = info.legend[r];
    unsigned red = 0, green = 0, blue = 0;
    std::sscanf(entry.colour.c_str(), "#%2x%2x%2x", &red, &green, &blue);
    xml += line("      <Row index=\"%zu\"><F>%d</F><F>", r, int(entry.value)) + xml_escaped(entry.label) +
           line("</F><F>%llu</F><F>%u</F><F>%u</F><F>%u</F></Row>\n",
                static_cast<unsigned long long>(cells[std::size_t(entry.value)]), red, green, blue);
  }
  return xml + "    </GDALRasterAttributeTable>\n";
}

}  // namespace

std::string side_file(const LayerInfo& info, const std::array<std::uint64_t, 256>& cells) {
  std::vector<std::string> names;
  for (const LegendEntry& entry : info.legend) {
    if (names.size() <= std::size_t(entry.value)) names.resize(std::size_t(entry.value) + 1);
    names[std::size_t(entry.value)] = entry.label;
  }
  std::string xml = "<PAMDataset>\n  <PAMRasterBand band=\"1\">\n    <CategoryNames>\n";
  for (const std::string& name : names) xml += "      <Category>" + xml_escaped(name) + "</Category>\n";
  return xml + "    </CategoryNames>\n" + attribute_table(info, cells) + "  </PAMRasterBand>\n</PAMDataset>\n";
}

std::string qgis_style(const LayerInfo& info) {
  return "<!DOCTYPE qgis>\n<qgis version=\"3.22\">\n  <pipe>\n" +
         (info.classes ? paletted_renderer(info) : ramp_renderer(info)) + "  </pipe>\n</qgis>\n";
}

}  // namespace gonogo::terrain
