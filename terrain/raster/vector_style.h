// How QGIS draws the layers of a GeoPackage: the style lies inside the file, in the table layer_styles that QGIS reads
// by itself ("Save Style > In Database" writes the same). For the .cpp files of this folder only.
#pragma once
#include <gdal_priv.h>

#include <filesystem>
#include <string>
#include <vector>

#include "terrain/raster/geotiff.h"

namespace gonogo::terrain {

/// Features drawn by the label that stands in `column`; polygons filled, lines in colour over a wider white one.
struct VectorStyle {
  std::string column;
  bool polygons = false;
  std::vector<LegendEntry> legend;
};

/// QGIS's own format for the style (qgis.dtd: qgis/renderer-v2 of type categorizedSymbol).
std::string qgis_style(const VectorStyle& style);

/// Makes it the layer's default style. The geometry's column is the driver's "geom". Throws DeviceError.
void embed_style(GDALDataset& geopackage, const std::string& layer, const VectorStyle& style,
                 const std::filesystem::path& path);

}  // namespace gonogo::terrain
