// Layers written by gonogo, opened again with GDAL itself.
#include "terrain/raster/layer/geotiff.h"

#include <gdal_priv.h>

#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "base/files/file.h"
#include "terrain/raster/raster_source.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"

using namespace gonogo;
using namespace gonogo::terrain;

namespace {

LayerInfo class_layer() {
  return {.name = "mobility class",
          .unit = "",
          .classes = true,
          .legend = {{1, "go", "#1a9641"}, {3, "no-go <&> \"red\"", "#d7191c"}},
          .metadata = {{"GONOGO_MODEL", "abc"}}};
}

LayerInfo probability_layer() {
  return {.name = "P(go)",
          .unit = "1",
          .classes = false,
          .legend = {{0, "0", "#440154"}, {1, "1", "#fde725"}},
          .metadata = {}};
}

MapGrid grid_of(int columns, int rows, const TemporaryFolder& folder) {
  test::make_raster(folder / "grid.tif", {.columns = columns, .rows = rows});
  return RasterSource::open_elevation(folder / "grid.tif").grid();
}

}  // namespace

TEST_CASE("a class layer keeps its place, colours, names, nodata and metadata") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of(700, 600, folder);
  Tile tile(700, 600, 1);
  tile.at(3, 2) = 3;
  tile.at(4, 2) = std::nanf("");
  GeoTiffWriter writer(folder / "go.tif", grid, class_layer());
  writer.write({0, 0, 700, 600}, tile);
  CHECK_FALSE(std::filesystem::exists(folder / "go.tif"));
  writer.finish();

  GDALDataset* raster = GDALDataset::Open((folder / "go.tif").c_str());
  REQUIRE(raster);
  GDALRasterBand& band = *raster->GetRasterBand(1);
  CHECK(std::string(raster->GetSpatialRef()->GetAuthorityCode(nullptr)) == "32610");
  double transform[6];
  raster->GetGeoTransform(transform);
  CHECK(std::vector<double>(transform, transform + 6) == std::vector<double>{500000, 10, 0, 4400000, 0, -10});
  CHECK(band.GetRasterDataType() == GDT_Byte);
  CHECK(band.GetNoDataValue() == 255);
  CHECK(std::string(band.GetDescription()) == "mobility class");
  CHECK(std::string(raster->GetMetadataItem("AREA_OR_POINT")) == "Area");
  CHECK(std::string(raster->GetMetadataItem("GONOGO_MODEL")) == "abc");
  CHECK(std::string(raster->GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE")) == "COG");
  CHECK(std::string(raster->GetMetadataItem("COMPRESSION", "IMAGE_STRUCTURE")) == "DEFLATE");
  CHECK(band.GetOverviewCount() >= 1);
  REQUIRE(band.GetColorTable());
  const GDALColorEntry red = *band.GetColorTable()->GetColorEntry(3);
  CHECK((red.c1 == 0xd7 && red.c2 == 0x19 && red.c3 == 0x1c));
  char** names = band.GetCategoryNames();
  REQUIRE(names);
  CHECK(std::string(names[1]) == "go");
  CHECK(std::string(names[3]) == "no-go <&> \"red\"");
  unsigned char cells[3];
  REQUIRE(band.RasterIO(GF_Read, 2, 2, 3, 1, cells, 3, 1, GDT_Byte, 0, 0, nullptr) == CE_None);
  CHECK((cells[0] == 1 && cells[1] == 3 && cells[2] == 255));
  GDALClose(raster);
  const std::string style = read_file(folder / "go.qml");
  CHECK(style.find("color=\"#d7191c\" label=\"no-go &lt;&amp;&gt; &quot;red&quot;\"") != std::string::npos);
}

TEST_CASE("a probability layer is float32 with nodata -9999") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of(20, 10, folder);
  Tile tile(20, 10, 0.25f);
  tile.at(0, 0) = std::nanf("");
  GeoTiffWriter writer(folder / "p.tif", grid, probability_layer());
  writer.write({0, 0, 20, 10}, tile);
  writer.finish();
  GDALDataset* raster = GDALDataset::Open((folder / "p.tif").c_str());
  REQUIRE(raster);
  GDALRasterBand& band = *raster->GetRasterBand(1);
  CHECK(band.GetRasterDataType() == GDT_Float32);
  CHECK(band.GetNoDataValue() == -9999);
  CHECK(std::string(band.GetUnitType()) == "1");
  float cells[2];
  REQUIRE(band.RasterIO(GF_Read, 0, 0, 2, 1, cells, 2, 1, GDT_Float32, 0, 0, nullptr) == CE_None);
  CHECK((cells[0] == -9999 && cells[1] == 0.25f));
  GDALClose(raster);
}

TEST_CASE("a layer has the same bytes for any number of threads and order of windows") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of(1100, 700, folder);
  Tile north(1100, 512, 0), south(1100, 188, 0);
  for (std::size_t i = 0; i < north.value.size(); ++i) north.value[i] = float(i % 97) / 97;
  for (std::size_t i = 0; i < south.value.size(); ++i) south.value[i] = float(i % 89) / 89;
  const auto write = [&](const std::string& name, bool north_first, int threads) {
    GeoTiffWriter writer(folder / name, grid, probability_layer());
    if (north_first) writer.write({0, 0, 1100, 512}, north);
    writer.write({0, 512, 1100, 188}, south);
    if (!north_first) writer.write({0, 0, 1100, 512}, north);
    writer.finish(threads);
    return read_file(folder / name);
  };
  const std::string one = write("a.tif", true, 1);
  CHECK(one == write("b.tif", false, 2));
}

TEST_CASE("an abandoned layer leaves nothing behind and keeps the earlier file") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of(20, 10, folder);
  write_file_atomically(folder / "out/go.tif", "earlier");
  {
    GeoTiffWriter writer(folder / "out/go.tif", grid, class_layer());
    writer.write({0, 0, 20, 10}, Tile(20, 10, 1));
  }
  CHECK(read_file(folder / "out/go.tif") == "earlier");
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "out")) files += entry.is_regular_file();
  CHECK(files == 1);
}

TEST_CASE("a folder that cannot be made is refused before any work") {
  const TemporaryFolder folder;
  const MapGrid grid = grid_of(20, 10, folder);
  write_file_atomically(folder / "file", "in the way");
  CHECK_THROWS_AS(GeoTiffWriter(folder / "file/go.tif", grid, class_layer()), InputError);
}
