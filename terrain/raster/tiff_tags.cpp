#include "terrain/raster/tiff_tags.h"

#include <cpl_string.h>
#include <cpl_vsi.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>

#include "base/error.h"
#include "terrain/raster/gdal_support.h"

namespace gonogo::terrain {
namespace {

// Software, colour map, GeoTIFF (OGC 19-008) and GDAL's own.
constexpr std::array<std::uint16_t, 10> kDescribing = {305,   kColourMap, 33550, 33922, 34264,
                                                       34735, 34736,      34737, 42112, kGdalNoData};

/// A setting of GDAL for this thread, put back when it leaves.
class ThreadOption {
 public:
  ThreadOption(const char* key, const char* value) : key_(key) {
    if (const char* old = CPLGetThreadLocalConfigOption(key, nullptr)) {
      old_ = old;
      had_ = true;
    }
    CPLSetThreadLocalConfigOption(key, value);
  }
  ~ThreadOption() { CPLSetThreadLocalConfigOption(key_, had_ ? old_.c_str() : nullptr); }

 private:
  const char* key_;
  std::string old_;
  bool had_ = false;
};

GDALColorEntry colour_entry(const std::string& colour) {
  unsigned red = 0, green = 0, blue = 0;
  std::sscanf(colour.c_str(), "#%2x%2x%2x", &red, &green, &blue);
  return {short(red), short(green), short(blue), 255};
}

void describe_band(GDALDataset& dataset, const LayerInfo& info) {
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  band.SetDescription(info.name.c_str());
  band.SetNoDataValue(info.classes ? kClassNoData : kFloatNoData);
  if (!info.unit.empty()) band.SetUnitType(info.unit.c_str());
  for (const auto& [key, value] : info.metadata) dataset.SetMetadataItem(key.c_str(), value.c_str());
  if (!info.classes) return;
  GDALColorTable table;
  for (int value = 0; value < 256; ++value) {
    const GDALColorEntry clear = {0, 0, 0, 0};
    table.SetColorEntry(value, &clear);
  }
  std::string legend;
  for (const LegendEntry& entry : info.legend) {
    const GDALColorEntry colour = colour_entry(entry.colour);
    table.SetColorEntry(int(entry.value), &colour);
    legend += (legend.empty() ? "" : "; ") + std::to_string(int(entry.value)) + " " + entry.label;
  }
  band.SetColorTable(&table);
  band.SetColorInterpretation(GCI_PaletteIndex);
  dataset.SetMetadataItem("LEGEND", legend.c_str());
}

void make_template(const std::string& name, const MapGrid& grid, const LayerInfo& info) {
  GdalCall call;
  const ThreadOption no_sidecar("GDAL_PAM_ENABLED", "NO");
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  DatasetHandle dataset(driver->Create(name.c_str(), 1, 1, 1, info.classes ? GDT_Byte : GDT_Float32, nullptr));
  if (!dataset) throw DeviceError("GDAL cannot describe a layer (" + call.message() + ")");
  double transform[6] = {grid.west, grid.cell_width, 0, grid.north, 0, -grid.cell_height};
  dataset->SetGeoTransform(transform);
  OGRSpatialReference crs;
  crs.importFromWkt(grid.crs_wkt.c_str());
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  dataset->SetSpatialRef(&crs);
  dataset->SetMetadataItem("AREA_OR_POINT", "Area");
  describe_band(*dataset, info);
}

std::size_t bytes_of(std::uint16_t type) {
  constexpr std::array<std::size_t, 13> kBytes = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8};  // TIFF 6.0, section 2
  return type < kBytes.size() ? kBytes[type] : 0;
}

template <class T>
T get(const std::string& file, std::size_t at) {
  T value{};
  if (at + sizeof value > file.size()) throw DeviceError("GDAL made a GeoTIFF that cannot be understood");
  std::memcpy(&value, file.data() + at, sizeof value);
  return value;
}

std::vector<TiffTag> first_directory(const std::string& file) {
  if (file.substr(0, 2) != "II" || get<std::uint16_t>(file, 2) != 42)
    throw DeviceError("GDAL made a GeoTIFF that is no classic little-endian one");
  const std::size_t at = get<std::uint32_t>(file, 4);
  std::vector<TiffTag> tags;
  for (std::size_t i = 0; i < get<std::uint16_t>(file, at); ++i) {
    const std::size_t entry = at + 2 + 12 * i;
    TiffTag tag{get<std::uint16_t>(file, entry), get<std::uint16_t>(file, entry + 2),
                get<std::uint32_t>(file, entry + 4), ""};
    const std::size_t size = bytes_of(tag.type) * tag.count;
    const std::size_t where = size <= 4 ? entry + 8 : get<std::uint32_t>(file, entry + 8);
    if (where + size > file.size()) throw DeviceError("GDAL made a GeoTIFF that cannot be understood");
    tag.data = file.substr(where, size);
    tags.push_back(std::move(tag));
  }
  return tags;
}

}  // namespace

std::vector<TiffTag> describing_tags(const MapGrid& grid, const LayerInfo& info) {
  static std::atomic<unsigned> count = 0;
  const std::string name = "/vsimem/gonogo_layer_" + std::to_string(count++) + ".tif";
  make_template(name, grid, info);
  vsi_l_offset size = 0;
  const auto* bytes = VSIGetMemFileBuffer(name.c_str(), &size, FALSE);
  if (!bytes) throw DeviceError("GDAL cannot describe a layer");
  const std::string file(reinterpret_cast<const char*>(bytes), size);
  VSIUnlink(name.c_str());
  std::vector<TiffTag> tags;
  for (TiffTag& tag : first_directory(file))
    if (std::find(kDescribing.begin(), kDescribing.end(), tag.tag) != kDescribing.end()) tags.push_back(std::move(tag));
  return tags;
}

}  // namespace gonogo::terrain
