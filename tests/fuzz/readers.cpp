#include "tests/fuzz/readers.h"

#include "base/error.h"
#include "base/files/csv.h"
#include "base/files/file.h"
#include "base/json/json.h"
#include "pipeline/map/region/region.h"
#include "pipeline/map/soil_grids/soil_cells.h"
#include "terrain/raster/raster_source.h"
#include "terrain/raster/vector/read_vector.h"
#include "terrain/soil/soil.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"
#include "tests/terrain/vector_maker.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::fuzz {
namespace {

namespace fs = std::filesystem;
using namespace gonogo::terrain;

constexpr int kSide = 40;  // cells

/// 40 x 40 cells of 10 m in UTM zone 10, a plain with waves.
test::RasterRecipe ground() {
  test::RasterRecipe recipe{.columns = kSide, .rows = kSide};
  for (int i = 0; i < kSide * kSide; ++i) recipe.value.push_back(float(100 + i % 7 + 0.25 * (i / kSide)));
  return recipe;
}

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
  return text_of(RasterSource::open_on_grid(file, grid_of_ground(), RasterKind::continuous,
                                            ValueRange{0, 14504, "cone index"}));
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

std::string read_shapes(const fs::path& file) {
  const auto cells = cells_under(file, grid_of_ground());
  ShapeCells marked(grid_of_ground());
  marked.add(file, "", [](const FeatureNumbers&) { return ShapeMark{.value = 1}; });
  return std::string(cells.begin(), cells.end()) + text_of(marked.read({0, 0, kSide, kSide}).value);
}

Reader shapes(const std::string& name, const std::string& format, const std::string& opened,
              const std::string& damaged, bool degrees = false) {
  return {name, damaged, opened,
          [format, opened, degrees](const fs::path& folder) {
            test::make_squares(folder / opened, format.c_str(), kSide, degrees);
          },
          read_shapes};
}

std::function<void(const fs::path&)> writing(const std::string& file, const std::string& text) {
  return [file, text](const fs::path& folder) { write_file_atomically(folder / file, text); };
}

std::function<void(const fs::path&)> copying(const std::string& file, const std::string& shipped) {
  return writing(file, read_file(fs::path(GONOGO_SOURCE_DIR) / shipped));
}

std::string read_table(const fs::path& file) {
  std::string text;
  for (const CsvLine& line : read_csv_lines(file, "rows")) text += csv_row(line.cell) + "\n";
  return text;
}

std::string read_map_units(const fs::path& file) {
  const map::SoilFolder folder = map::read_soil_folder(file.parent_path());
  const map::SoilCells cells(folder, 0, std::nullopt);
  map::SoilFindings findings;
  const auto window = cells.read({0, 0, cells.grid().columns, cells.grid().rows}, findings);
  std::string text;
  for (const auto& share : window.shares) text += share ? std::to_string(share->sand) + " " : "- ";
  return text;
}

void make_map_units(const fs::path& folder) {
  test::make_raster(folder / "elevation.tif", ground());
  test::RasterRecipe units = ground();
  for (int i = 0; i < kSide * kSide; ++i) units.value[std::size_t(i)] = float(464399 + i % 3);
  test::make_raster(folder / "mukey.tif", units);
  write_file_atomically(folder / "mukey.csv",
                        "\"mukey\",\"muname\",\"sandtotal_r\",\"claytotal_r\"\n"
                        "464399,\"Example, complex\",40,20\n464400,\"Other \"\"two\"\"\",92,3\n464401,Water,NA,NA\n");
}

std::string read_region_file(const fs::path& file) {
  const map::Region region = map::read_region(file);
  return std::to_string(region.values.size()) + region.elevation.files.name();
}

}  // namespace

const std::vector<Reader>& readers() {
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
       writing("a.csv", "\"a\",\"b c\",d\n1,\"2, \"\"3\"\"\",4\n\n# remark\n5,\"6\n7\",NA\n"), read_table,
       true},
      {"table_map_units", "mukey.csv", "mukey.csv", make_map_units, read_map_units, true},
      {"region", "region.json", "region.json",
       [](const fs::path& folder) {
         test::make_raster(folder / "elevation.tif", ground());
         write_file_atomically(folder / "region.json",
                               R"({"schema": "gonogo/region/1", "region": "r", "rasters": [{"role": "elevation",)"
                               R"( "file": "elevation.tif", "source": "s", "licence": "l"}],)"
                               R"( "values": {"friction_angle": {"range": [25, 35], "source": "s"}}})");
       },
       read_region_file},
      {"soil", "sand.json", "sand.json", copying("sand.json", "configs/soils/lete_sand.json"),
       [](const fs::path& file) { return std::to_string(terrain::read_soil(file).states.size()); }},
      {"vehicle", "v.json", "v.json", copying("v.json", "configs/vehicles/hmmwv.json"),
       [](const fs::path& file) { return std::to_string(vehicle::read_any_vehicle(file).wheel.size()); }},
  };
  return list;
}

const Reader& reader_named(const std::string& name) {
  for (const Reader& reader : readers())
    if (reader.name == name) return reader;
  throw InputError("no reader is named \"" + name + "\"");
}

}  // namespace gonogo::fuzz
