// Maps an elevation raster with a trained model: map_raster <model> <elevation.tif> <soil> <folder>. The model is a
// file, or the name of one that ships ("hmmwv"); the soil is a USDA texture or a soil of configs/soils.
#include <gonogo/map.h>

#include <cstdio>
#include <exception>

using namespace gonogo::api;

int main(int argc, char** argv) try {
  if (argc != 5) throw InputError("usage: map_raster <model> <elevation.tif> <soil> <folder>");
  const MapSummary map = make_map({.model = argv[1], .dem = argv[2], .soil = argv[3], .out = argv[4]});

  std::printf("%.2f km2:", map.area_km2);
  for (const auto& [verdict, share] : map.share) std::printf("  %s %.1f %%", label_of(verdict).c_str(), 100 * share);
  std::printf("\n");
  for (const std::string& remark : map.remarks) std::printf("%s\n", remark.c_str());
  for (const auto& file : map.files) std::printf("%s\n", file.c_str());
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
