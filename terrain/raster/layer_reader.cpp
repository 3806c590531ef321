#include "terrain/raster/layer_reader.h"

#include <cpl_vsi.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "terrain/raster/gdal_support.h"
#include "terrain/raster/geotiff.h"
#include "terrain/raster/tile_codec.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;

struct LayerReader::State {
  DatasetHandle dataset;
  std::string name;
  std::vector<LegendEntry> legend;  // of the style: classes, or stops of a ramp
  bool classes = false;
  double nodata = 0;

  GDALRasterBand& band(int level) const {
    GDALRasterBand* first = dataset->GetRasterBand(1);
    return level == 0 ? *first : *first->GetOverview(level - 1);
  }
};

namespace {

/// Text of an attribute, entities undone.
std::string attribute(const std::string& element, const std::string& name) {
  const std::size_t at = element.find(" " + name + "=\"");
  if (at == std::string::npos) return "";
  const std::size_t from = at + name.size() + 3;
  std::string text = element.substr(from, element.find('"', from) - from);
  for (const auto& [entity, plain] :
       {std::pair<std::string, std::string>{"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&amp;", "&"}})
    for (std::size_t found = text.find(entity); found != std::string::npos; found = text.find(entity, found + 1))
      text.replace(found, entity.size(), plain);
  return text;
}

/// Values, colours and labels of a style written by qgis_style().
std::vector<LegendEntry> legend_of(const std::string& style) {
  std::vector<LegendEntry> legend;
  for (const char* tag : {"<paletteEntry ", "<item "})
    for (std::size_t at = style.find(tag); at != std::string::npos; at = style.find(tag, at + 1)) {
      const std::string element = style.substr(at, style.find("/>", at) - at);
      legend.push_back({std::strtod(attribute(element, "value").c_str(), nullptr), attribute(element, "label"),
                        attribute(element, "color")});
    }
  return legend;
}

struct Colour {
  double red = 0, green = 0, blue = 0, opacity = 0;
};

Colour colour_of(const std::string& text) {
  unsigned red = 0, green = 0, blue = 0;
  if (std::sscanf(text.c_str(), "#%2x%2x%2x", &red, &green, &blue) != 3) return {};
  return {double(red), double(green), double(blue), 255};
}

Colour class_colour(const std::vector<LegendEntry>& legend, double value) {
  for (const LegendEntry& entry : legend)
    if (entry.value == value) return colour_of(entry.colour);
  return {};
}

Colour ramp_colour(const std::vector<LegendEntry>& legend, double value) {
  std::size_t i = 1;
  while (i + 1 < legend.size() && value > legend[i].value) ++i;
  const LegendEntry &a = legend[i - 1], &b = legend[i];
  const double share = std::clamp((value - a.value) / (b.value - a.value), 0.0, 1.0);
  const Colour from = colour_of(a.colour), to = colour_of(b.colour);
  const auto mix = [share](double x, double y) { return x + (y - x) * share; };
  return {mix(from.red, to.red), mix(from.green, to.green), mix(from.blue, to.blue), 255};
}

/// `pixels`: four planes of kTileArea bytes.
std::string png_of(std::vector<unsigned char>& pixels, int columns, int rows, const std::string& name) {
  static std::atomic<unsigned> count = 0;
  const std::string file = "/vsimem/gonogo_tile_" + std::to_string(count++) + ".png";
  GdalCall call;
  GDALDriver *memory = GetGDALDriverManager()->GetDriverByName("MEM"),
             *png = GetGDALDriverManager()->GetDriverByName("PNG");
  if (!memory || !png) throw DeviceError("this GDAL has no PNG driver");
  const DatasetHandle picture(memory->Create("", columns, rows, 4, GDT_Byte, nullptr));
  for (int b = 0; b < 4; ++b)
    if (picture->GetRasterBand(b + 1)->RasterIO(GF_Write, 0, 0, columns, rows,
                                                pixels.data() + std::size_t(b) * kTileArea, columns, rows, GDT_Byte, 1,
                                                kTileCells, nullptr) != CE_None)
      throw DeviceError(name + ": a tile cannot be drawn (" + call.message() + ")");
  const DatasetHandle written(png->CreateCopy(file.c_str(), picture.get(), FALSE, nullptr, nullptr, nullptr));
  vsi_l_offset size = 0;
  const auto* bytes = VSIGetMemFileBuffer(file.c_str(), &size, FALSE);
  if (!written || !bytes) throw DeviceError(name + ": a tile cannot be drawn (" + call.message() + ")");
  std::string out(reinterpret_cast<const char*>(bytes), size);
  VSIUnlink(file.c_str());
  return out;
}

}  // namespace

LayerReader::LayerReader(const fs::path& path) : state_(std::make_unique<State>()) {
  GdalCall call;
  state_->name = path.string();
  state_->dataset.reset(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
  if (!state_->dataset)
    throw InputError(path.string() + ": cannot be read (" + call.message() + "); make the map again with gonogo map");
  state_->legend = legend_of(read_file(fs::path(path).replace_extension(".qml")));
  state_->classes = state_->band(0).GetRasterDataType() == GDT_Byte;
  state_->nodata = state_->band(0).GetNoDataValue();
  if (state_->legend.size() < 2 && !state_->classes)
    throw InputError(path.string() + ": its .qml style holds no colours; make the map again with gonogo map");
}

LayerReader::LayerReader(LayerReader&&) noexcept = default;
LayerReader::~LayerReader() = default;

int LayerReader::columns() const { return state_->dataset->GetRasterXSize(); }
int LayerReader::rows() const { return state_->dataset->GetRasterYSize(); }
int LayerReader::levels() const { return 1 + state_->band(0).GetOverviewCount(); }
std::string LayerReader::title() const { return state_->band(0).GetDescription(); }
std::string LayerReader::unit() const { return state_->band(0).GetUnitType(); }

std::optional<double> LayerReader::value(int column, int row) const {
  if (column < 0 || row < 0 || column >= columns() || row >= rows()) return std::nullopt;
  float value = 0;
  GdalCall call;
  if (state_->band(0).RasterIO(GF_Read, column, row, 1, 1, &value, 1, 1, GDT_Float32, 0, 0, nullptr) != CE_None)
    throw DeviceError(state_->name + ": cannot be read (" + call.message() + ")");
  if (double(value) == state_->nodata) return std::nullopt;
  return value;
}

std::string LayerReader::label(double value) const {
  for (const LegendEntry& entry : state_->legend)
    if (state_->classes && entry.value == value) return entry.label;
  return "";
}

std::optional<std::string> LayerReader::tile_png(int level, int across, int down) const {
  if (level < 0 || level >= levels() || across < 0 || down < 0 || across > (1 << 20) || down > (1 << 20))
    return std::nullopt;
  GDALRasterBand& band = state_->band(level);
  const int left = across * kTileCells, top = down * kTileCells;
  const int width = std::min(kTileCells, band.GetXSize() - left), height = std::min(kTileCells, band.GetYSize() - top);
  if (width <= 0 || height <= 0) return std::nullopt;
  std::vector<float> cells(kTileArea);
  GdalCall call;
  if (band.RasterIO(GF_Read, left, top, width, height, cells.data(), width, height, GDT_Float32, 4, 4 * kTileCells,
                    nullptr) != CE_None)
    throw DeviceError(state_->name + ": cannot be read (" + call.message() + ")");
  std::vector<unsigned char> pixels(4 * kTileArea, 0);
  for (std::size_t i = 0; i < kTileArea; ++i) {
    if (double(cells[i]) == state_->nodata || std::isnan(cells[i])) continue;
    const Colour c = state_->classes ? class_colour(state_->legend, cells[i]) : ramp_colour(state_->legend, cells[i]);
    const double planes[4] = {c.red, c.green, c.blue, c.opacity};
    for (std::size_t b = 0; b < 4; ++b) pixels[b * kTileArea + i] = static_cast<unsigned char>(std::lround(planes[b]));
  }
  return png_of(pixels, width, height, state_->name);
}

}  // namespace gonogo::terrain
