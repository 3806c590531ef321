// Pictures written by gonogo, read again by GDAL's driver, which is libpng's.
#include "terrain/raster/layer/png.h"

#include <gdal_priv.h>

#include "base/math/random.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::terrain;

TEST_CASE("libpng reads back every pixel of a picture of noise and of flat areas") {
  const TemporaryFolder folder;
  GDALAllRegister();
  for (const auto& [columns, rows] : {std::pair(1, 1), std::pair(7, 3), std::pair(301, 200)}) {
    RgbPicture picture{columns, rows, {}};
    for (int i = 0; i < 3 * columns * rows; ++i) {
      const bool flat = i / 3 / columns % 20 < 10;
      picture.value.push_back(flat ? std::uint8_t(17 * (i % 3))
                                   : std::uint8_t(256 * random_unit(1, 2, std::uint64_t(i))));
    }
    const auto file = folder / "picture.png";
    write_png(file, picture);
    GDALDataset* found = GDALDataset::Open(file.c_str());
    REQUIRE(found);
    CHECK(std::string(found->GetDriver()->GetDescription()) == "PNG");
    REQUIRE(found->GetRasterXSize() == columns);
    REQUIRE(found->GetRasterYSize() == rows);
    REQUIRE(found->GetRasterCount() == 3);
    std::vector<std::uint8_t> value(picture.value.size());
    CHECK(found->RasterIO(GF_Read, 0, 0, columns, rows, value.data(), columns, rows, GDT_Byte, 3, nullptr, 3,
                          3 * columns, 1, nullptr) == CE_None);
    CHECK(value == picture.value);
    GDALClose(found);
  }
}
