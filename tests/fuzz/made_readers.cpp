// Files of simulations, maps and soil tests that hold a hash of themselves, and tables of map units: they are made by
// what they are read by, which takes much of the program.
#include "base/files/file.h"
#include "base/hdf5/hdf5.h"
#include "pipeline/map/soil_grids/soil_cells.h"
#include "sim/io/checkpoint.h"
#include "terrain/soil_test/calibrate.h"
#include "tests/fuzz/ground.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/texts.h"
#include "tests/pipeline/map/wavy_region.h"
#include "tests/support/scenes.h"

namespace gonogo::fuzz {
namespace {

namespace fs = std::filesystem;

const std::string kScene = "scene";

/// Some grains that fall.
void make_checkpoint(const fs::path& folder) {
  sim::SceneWorld world;
  world.size = {1, 1, 1};
  test::add_plane(world);
  for (int k = 0; k < 27; ++k)
    world.add_sphere(Vec3d{0.2 + 0.3 * (k % 3), 0.2 + 0.3 * (k / 3 % 3), 0.2 + 0.3 * (k / 9)}, 0.1f, 2600, 0);
  const auto simulation = test::simulate(sim::Backend::cpu, world, sim::StepSettings{});
  simulation->advance(100);
  sim::save_checkpoint(folder / "run.h5", simulation->snapshot(0), kScene);
}

std::string read_checkpoint(const fs::path& file) {
  Hdf5Writer out;
  sim::store_snapshot(out, sim::load_checkpoint(file, kScene), kScene);
  return out.image();
}

void make_map_folder(const fs::path& folder) {
  const TemporaryFolder ground_folder;
  test::make_wavy_region(ground_folder, "waves", {40, 60, 37, 53});
  map::MapRequest request = test::request_of_region(ground_folder, "map");
  request.threads = 1;
  map::make_map(request);
  for (const char* name : {"map.json", "go.tif"}) fs::copy_file(ground_folder / "map" / name, folder / name);
}

std::string read_map(const fs::path& file) {
  map::require_whole_map(file.parent_path(), {"go.tif"});
  return Json::read(file.parent_path() / "map.json").dump() + read_file(file.parent_path() / "go.tif");
}

void make_soil_journal(const fs::path& folder) {
  terrain::TestJournal journal(folder / "tests.json", "maker");
  for (const char* test : {"triaxial loose 0.1", "triaxial dense 0.1", "plate 30 mm"})
    journal.add(test, {0.125, 31.25, 1e-9, 4e5});
}

std::string read_soil_journal(const fs::path& file) {
  const terrain::TestJournal journal(file, "maker");
  std::string text;
  for (const char* test : {"triaxial loose 0.1", "triaxial dense 0.1", "plate 30 mm"})
    if (const auto numbers = journal.find(test)) text += bytes_of(*numbers);
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

}  // namespace

const std::vector<Reader>& made_readers() {
  static const std::vector<Reader> list = {
      sealed("checkpoint", "run.h5", make_checkpoint, read_checkpoint),
      sealed("map_record", "map.json", make_map_folder, read_map),
      sealed("map_layer", "go.tif", make_map_folder, read_map),
      sealed("soil_journal", "tests.json", make_soil_journal, read_soil_journal),
      {"table_map_units", "mukey.csv", "mukey.csv", make_map_units, read_map_units, true},
  };
  return list;
}

}  // namespace gonogo::fuzz
