// Maps an elevation raster with a trained model: map_raster <model> <elevation.tif> <soil> <folder>. The model is a
// file, or the name of one that ships ("hmmwv"); the soil is a USDA texture or a soil of configs/soils.
#include <gonogo/map.h>

#include <cstdio>
#include <exception>

using namespace gonogo;

int main(int argc, char** argv) try {
  if (argc != 5) throw InputError("usage: map_raster <model> <elevation.tif> <soil> <folder>");
  map::MapFiles files;
  files.model = argv[1];
  files.dem = argv[2];
  files.soil = argv[3];
  files.out = argv[4];
  const map::MapSummary map = map::make_map(map::read_map_request(files));

  std::printf("%.2f km2:", map.area_km2);
  using campaign::Verdict;
  for (const Verdict verdict : {Verdict::go, Verdict::slow_go, Verdict::no_go, Verdict::unknown})
    std::printf("  %s %.1f %%", campaign::contract().info(verdict).label.c_str(), 100 * map.area.share(verdict));
  std::printf("\n");
  for (const std::string& remark : map.remarks) std::printf("%s\n", remark.c_str());
  for (const auto& file : map.files) std::printf("%s\n", file.c_str());
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
