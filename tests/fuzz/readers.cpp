#include "tests/fuzz/readers.h"

#include "base/error.h"
#include "base/files/file.h"
#include "pipeline/map/region/region.h"
#include "pipeline/map/soil_grids/soil_cells.h"
#include "terrain/soil/soil.h"
#include "tests/fuzz/ground.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::fuzz {
namespace {

namespace fs = std::filesystem;

std::function<void(const fs::path&)> copying(const std::string& file, const std::string& shipped) {
  return writing(file, read_file(fs::path(GONOGO_SOURCE_DIR) / shipped));
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
  static const std::vector<Reader> list = [] {
    std::vector<Reader> all = file_readers();
    const std::vector<Reader> ours = {
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
    all.insert(all.end(), ours.begin(), ours.end());
    all.insert(all.end(), sealed_readers().begin(), sealed_readers().end());
    return all;
  }();
  return list;
}

}  // namespace gonogo::fuzz
