// Polygons and lines in GeoPackages: areas, and the style that QGIS reads from inside the file.
#include "terrain/raster/vector/write_vector.h"

#include <cpl_minixml.h>

#include <map>

#include "terrain/raster/raster_source.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/line_reader.h"
#include "tests/terrain/raster_maker.h"

using namespace gonogo;
using namespace gonogo::terrain;

namespace {

using File = std::unique_ptr<GDALDataset>;

File open_vector(const std::filesystem::path& path) {
  GDALAllRegister();
  File file(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
  REQUIRE(file);
  return file;
}

/// Label and colour of each category of a layer's default style, as QGIS finds it: by the names of layer and column.
std::map<std::string, std::string> style_of(GDALDataset& file, OGRLayer& layer, const char* colour_option) {
  OGRLayer* styles = file.GetLayerByName("layer_styles");
  REQUIRE(styles);
  REQUIRE(styles->GetFeatureCount() == 1);
  const OGRFeatureUniquePtr row(styles->GetNextFeature());
  CHECK(row->GetFieldAsString("f_table_name") == std::string(layer.GetName()));
  CHECK(row->GetFieldAsString("f_geometry_column") == std::string(layer.GetGeometryColumn()));
  CHECK(row->GetFieldAsInteger("useAsDefault") == 1);
  CPLXMLNode* root = CPLParseXMLString(row->GetFieldAsString("styleQML"));
  REQUIRE(root);
  CPLXMLNode* renderer = CPLGetXMLNode(root, "=qgis.renderer-v2");
  REQUIRE(renderer);
  CHECK(layer.GetLayerDefn()->GetFieldIndex(CPLGetXMLValue(renderer, "attr", "")) >= 0);
  std::map<std::string, std::string> colour_of_symbol, result;
  for (CPLXMLNode* symbol = CPLGetXMLNode(renderer, "symbols")->psChild; symbol; symbol = symbol->psNext)
    for (CPLXMLNode* drawn = symbol->psChild; drawn; drawn = drawn->psNext)
      if (std::string(drawn->pszValue) == "layer")
        for (CPLXMLNode* option = CPLGetXMLNode(drawn, "Option")->psChild; option; option = option->psNext)
          if (CPLGetXMLValue(option, "name", std::string("").c_str()) == std::string(colour_option))
            colour_of_symbol[CPLGetXMLValue(symbol, "name", "")] = CPLGetXMLValue(option, "value", "");  // the topmost
  for (CPLXMLNode* category = CPLGetXMLNode(renderer, "categories")->psChild; category; category = category->psNext)
    result[CPLGetXMLValue(category, "value", "")] = colour_of_symbol[CPLGetXMLValue(category, "symbol", "")];
  CPLDestroyXMLNode(root);
  return result;
}

std::string day_of(GDALDataset& file, const char* layer) {
  OGRLayer* rows =
      file.ExecuteSQL(("SELECT last_change FROM gpkg_contents WHERE table_name = '" + std::string(layer) + "'").c_str(),
                      nullptr, nullptr);
  REQUIRE(rows);
  const OGRFeatureUniquePtr row(rows->GetNextFeature());
  REQUIRE(row);
  std::string day = row->GetFieldAsString(0);
  file.ReleaseResultSet(rows);
  return day;
}

MapGrid made_grid(const TemporaryFolder& folder) {
  test::make_raster(folder / "dem.tif", {.columns = 4, .rows = 3});
  return RasterSource::open_elevation(folder / "dem.tif").grid();
}

}  // namespace

TEST_CASE("cells become polygons of their area, drawn by QGIS in the legend's colours, hostile names as text") {
  const TemporaryFolder folder;
  const MapGrid grid = made_grid(folder);  // cells of 10 m
  const std::vector<LegendEntry> legend = {{0, "near", "#0a141e"}, {7, "<b>\"far\" & away</b>", "#d0e0f0"}};
  write_cell_polygons(folder / "bands.gpkg", "bands", grid, {0, 0, 7, 255, 0, 0, 7, 255, 7, 7, 7, 255}, legend);
  const File file = open_vector(folder / "bands.gpkg");
  OGRLayer* layer = file->GetLayerByName("bands");
  REQUIRE(layer);
  std::map<std::string, double> area;
  for (const auto& feature : layer) {
    area[feature->GetFieldAsString("class")] += feature->GetFieldAsDouble("area_km2");
    CHECK(feature->GetFieldAsDouble("cell_m") == Approx(10));
  }
  CHECK(area.size() == 2);
  CHECK(area["near"] == Approx(4e-4));
  CHECK(area[legend[1].label] == Approx(5e-4));
  const auto style = style_of(*file, *layer, "color");
  CHECK(style == std::map<std::string, std::string>{{"near", "10,20,30,255"}, {legend[1].label, "208,224,240,255"}});
  CHECK(contains(day_of(*file, "bands"), "2000/01/01"));
}

TEST_CASE("lines keep their colours as a style of QGIS, and a GeoPackage holds no clock time") {
  const TemporaryFolder folder;
  const MapGrid grid = made_grid(folder);
  const auto line = [&](const char* name, const char* colour) {
    return LineFeature{
        name, colour, {{grid.west + 5, grid.north - 5}, {grid.west + 25, grid.north - 15}}, {{"length_m", 1}}};
  };
  write_lines(folder / "ways.gpkg", grid, "ways", {line("fastest", "#c2188f"), line("safest", "#1f4fbf")});
  const File file = open_vector(folder / "ways.gpkg");
  OGRLayer* layer = file->GetLayerByName("ways");
  REQUIRE(layer);
  CHECK(layer->GetFeatureCount() == 2);
  CHECK(style_of(*file, *layer, "line_color") ==
        std::map<std::string, std::string>{{"fastest", "194,24,143,255"}, {"safest", "31,79,191,255"}});
  CHECK(contains(day_of(*file, "ways"), "2000/01/01"));
}
