#include "tests/fuzz/readers.h"

#include "base/error.h"
#include "base/files/csv.h"
#include "base/files/file.h"
#include "terrain/raster/raster_source.h"
#include "terrain/raster/vector/read_vector.h"
#include "tests/fuzz/ground.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"
#include "tests/terrain/vector_maker.h"

namespace gonogo::fuzz {
namespace {

namespace fs = std::filesystem;
using namespace gonogo::terrain;

MapGrid grid_of_ground() {
  static const MapGrid grid = [] {
    const TemporaryFolder folder;
    test::make_raster(folder / "grid.tif", ground());
    return RasterSource::open_as_it_lies(folder / "grid.tif").grid();
  }();
  return grid;
}

std::string text_of(const std::vector<float>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
}

std::string text_of(const RasterSource& source) {
  std::string text;
  for (const Window window : windows_of(source.grid(), source.grid().columns, 64))
    text += text_of(source.read(window).value);
  return text;
}

std::string read_heights(const fs::path& file) { return text_of(RasterSource::open_heights(file, {}, {})); }

std::string read_cone_index(const fs::path& file) {
  return text_of(
      RasterSource::open_on_grid(file, grid_of_ground(), RasterKind::continuous, ValueRange{0, 14504, "cone index"}));
}

/// A copy of the ground in another format.
std::function<void(const fs::path&)> in_format(const std::string& format, const std::string& file) {
  return [format, file](const fs::path& folder) {
    test::make_raster(folder / "source.tif", ground());
    GDALDataset* source = GDALDataset::Open((folder / "source.tif").c_str());
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(format.c_str());
    GDALDataset* copy = driver->CreateCopy((folder / file).c_str(), source, FALSE, nullptr, nullptr, nullptr);
    if (!copy) throw InputError("cannot make " + file);
    GDALClose(copy);
    GDALClose(source);
  };
}

Reader raster(const std::string& name, const std::string& format, const std::string& file) {
  return {name, file, file, in_format(format, file), read_heights};
}

/// Points of a grid; the coordinate system stands beside them, as the format has no place for it.
void make_points(const fs::path& folder) {
  in_format("XYZ", "a.xyz")(folder);
  write_file_atomically(folder / "a.xyz.aux.xml", "<PAMDataset><SRS>EPSG:32610</SRS></PAMDataset>");
}

std::string read_shapes(const fs::path& file) {
  const auto cells = cells_under(file, grid_of_ground());
  ShapeCells marked(grid_of_ground());
  marked.add(file, "", [](const FeatureNumbers&) { return ShapeMark{.value = 1}; });
  return std::string(cells.begin(), cells.end()) + text_of(marked.read({0, 0, kSide, kSide}).value);
}

Reader shapes(const std::string& name, const std::string& format, const std::string& opened, const std::string& damaged,
              bool degrees = false) {
  return {name,
          damaged,
          opened,
          [format, opened, degrees](const fs::path& folder) {
            test::make_squares(folder / opened, format.c_str(), kSide, degrees);
          },
          read_shapes,
          format == "GeoJSONSeq"};
}

std::string read_table(const fs::path& file) {
  std::string text;
  for (const CsvLine& line : read_csv_lines(file, "rows")) text += csv_row(line.cell) + "\n";
  return text;
}

}  // namespace

const std::vector<Reader>& file_readers() {
  static const std::vector<Reader> list = {
      {"raster_geotiff", "a.tif", "a.tif",
       [](const fs::path& folder) { test::make_raster(folder / "a.tif", ground()); }, read_heights},
      {"raster_cone_index", "a.tif", "a.tif",
       [](const fs::path& folder) { test::make_raster(folder / "a.tif", ground()); }, read_cone_index},
      raster("raster_ascii", "AAIGrid", "a.asc"),
      raster("raster_netcdf", "netCDF", "a.nc"),
      raster("raster_imagine", "HFA", "a.img"),
      raster("raster_ehdr", "EHdr", "a.bil"),
      raster("raster_envi", "ENVI", "a.dat"),
      raster("raster_saga", "SAGA", "a.sdat"),
      raster("raster_pcraster", "PCRaster", "a.map"),
      raster("raster_grib", "GRIB", "a.grb2"),
      raster("raster_virtual", "VRT", "a.vrt"),
      {"raster_xyz", "a.xyz", "a.xyz", make_points, read_heights, true},
      shapes("shapes_shp", "ESRI Shapefile", "a.shp", "a.shp"),
      shapes("shapes_shx", "ESRI Shapefile", "a.shp", "a.shx"),
      shapes("shapes_dbf", "ESRI Shapefile", "a.shp", "a.dbf"),
      shapes("shapes_geojson", "GeoJSON", "a.geojson", "a.geojson", true),
      shapes("shapes_geojson_lines", "GeoJSONSeq", "a.geojsonl", "a.geojsonl", true),
      shapes("shapes_geopackage", "GPKG", "a.gpkg", "a.gpkg"),
      shapes("shapes_flatgeobuf", "FlatGeobuf", "a.fgb", "a.fgb"),
      shapes("shapes_kml", "KML", "a.kml", "a.kml", true),
      shapes("shapes_gml", "GML", "a.gml", "a.gml"),
      {"table", "a.csv", "a.csv",
       writing("a.csv", "\"a\",\"b c\",d\n1,\"2, \"\"3\"\"\",4\n\n# remark\n5,\"6\n7\",NA\n"), read_table, true},
  };
  return list;
}

}  // namespace gonogo::fuzz
