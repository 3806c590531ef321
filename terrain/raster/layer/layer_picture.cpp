#include "terrain/raster/layer/layer_picture.h"

#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_utils.h>
#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/units.h"
#include "terrain/raster/gdal_support.h"
#include "terrain/raster/layer/cog.h"

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

namespace {

struct PictureSize {
  int columns = 1, rows = 1;
};

/// Pixels as wide as high on the ground at the middle latitude; around a pole, where that has no meaning, 4 : 1.
PictureSize picture_size(const DegreeBox& box, int longest) {
  const double wide = box.width() * std::cos((box.south + box.north) / 2 * kDegree), high = box.north - box.south;
  const double ratio = box.width() >= 360 ? 4 : wide / high;
  const auto pixels = [&](double share) { return std::clamp(int(std::lround(longest * share)), 1, longest); };
  return {pixels(std::min(1.0, ratio)), pixels(std::min(1.0, 1 / ratio))};
}

/// Warped to degrees, in the layer's own colours; nodata is clear. Nothing if GDAL cannot do that.
DatasetHandle warped(GDALDataset& source, const GlobePlace& place, const DegreeBox& box, PictureSize size) {
  CPLStringList words;
  for (const char* word : {"-of", "MEM", "-r", "near", "-dstnodata", "255", "-t_srs", place.wkt.c_str(), "-te"})
    words.AddString(word);
  for (const double edge : {box.west, box.south, box.east, box.north}) words.AddString(line("%.15g", edge).c_str());
  words.AddString("-ts");
  words.AddString(std::to_string(size.columns).c_str());
  words.AddString(std::to_string(size.rows).c_str());
  GDALWarpAppOptions* options = GDALWarpAppOptionsNew(words.List(), nullptr);
  GDALDatasetH handle = &source;
  int usage_error = 0;
  DatasetHandle result(GDALDataset::FromHandle(GDALWarp("", nullptr, 1, &handle, options, &usage_error)));
  GDALWarpAppOptionsFree(options);
  return result;
}

std::string overlay_text(const DegreeBox& box, const std::string& picture, const std::string& title,
                         const std::string& description) {
  return "<GroundOverlay>\n  <name>" + xml_escaped(title) + "</name>\n  <description>" + xml_escaped(description) +
         "</description>\n  <Icon><href>" + xml_escaped(picture) + "</href></Icon>\n" +
         line("  <LatLonBox><north>%.9f</north><south>%.9f</south><east>%.9f</east><west>%.9f</west></LatLonBox>\n",
              box.north, box.south, box.east, box.west) +
         "</GroundOverlay>\n";
}

/// The hint names the globe on which to draw (Google's KML reference, element kml).
std::string kml_text(const GlobePlace& place, const std::vector<std::string>& overlays) {
  std::string hint, text;
  if (!place.is_wgs84 && place.body == "Moon") hint = " hint=\"target=moon\"";
  if (!place.is_wgs84 && place.body == "Mars") hint = " hint=\"target=mars\"";
  for (const std::string& overlay : overlays) text += overlay;
  if (overlays.size() > 1) text = "<Folder>\n" + text + "</Folder>\n";
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\"" + hint + ">\n" +
         text + "</kml>\n";
}

void write_png(const fs::path& png, GDALDataset& picture, const GdalCall& call) {
  replace_file_atomically(png, [&](const fs::path& temporary) {
    CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", "NO");
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("PNG");
    const DatasetHandle written(
        driver ? driver->CreateCopy(temporary.c_str(), &picture, FALSE, nullptr, nullptr, nullptr) : nullptr);
    CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", nullptr);
    if (!written) refuse_to_write(png, call);
  });
}

fs::path piece_file(const fs::path& png, std::size_t piece) {
  if (piece == 0) return png;
  return png.parent_path() / (png.stem().string() + "_" + std::to_string(piece + 1) + png.extension().string());
}

}  // namespace

OverlayAnswer write_overlay(const fs::path& kml, const fs::path& png, const fs::path& layer, const GlobePlace& place,
                            const std::string& title, const std::string& description,
                            const std::vector<LegendEntry>& legend, int longest) {
  GdalCall call;
  const DatasetHandle source = open_reduced(layer, 4.0 * longest * longest);
  const int side = std::min(longest, std::max(source->GetRasterXSize(), source->GetRasterYSize()));
  std::vector<DatasetHandle> pictures;
  for (const DegreeBox& box : place.pieces) {
    pictures.push_back(warped(*source, place, box, picture_size(box, side)));
    if (!pictures.back()) return {{}, "the map cannot be turned to degrees (" + call.message() + ")"};
  }
  std::string list = description + "\n";
  for (const LegendEntry& entry : legend) list += entry.label + ": " + entry.colour + "\n";
  OverlayAnswer answer;
  std::vector<std::string> overlays;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const fs::path file = piece_file(png, i);
    write_png(file, *pictures[i], call);
    answer.files.push_back(file);
    overlays.push_back(overlay_text(place.pieces[i], file.filename().string(), title, list));
  }
  write_file_atomically(kml, kml_text(place, overlays));
  answer.files.insert(answer.files.begin(), kml);
  return answer;
}

}  // namespace gonogo::terrain
