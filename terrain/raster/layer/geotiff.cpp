#include "terrain/raster/layer/geotiff.h"

#include <cpl_string.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <mutex>

#include "base/error.h"
#include "base/files/file.h"
#include "base/files/record_log.h"
#include "base/format.h"
#include "base/parallel/host_loop.h"
#include "terrain/raster/gdal_support.h"
#include "terrain/raster/layer/cog.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;

std::string xml_escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (static_cast<unsigned char>(c) < 32 && c != '\n' && c != '\t')
      out += ' ';
    else
      out += c;
  }
  return out;
}

namespace {

std::string shortest(double x) { return line("%g", x); }

std::string paletted_renderer(const LayerInfo& info) {
  std::string xml = "    <rasterrenderer type=\"paletted\" band=\"1\" opacity=\"1\">\n      <colorPalette>\n";
  for (const LegendEntry& entry : info.legend)
    xml += "        <paletteEntry value=\"" + shortest(entry.value) + "\" color=\"" + entry.colour + "\" label=\"" +
           xml_escaped(entry.label) + "\" alpha=\"255\"/>\n";
  return xml + "      </colorPalette>\n    </rasterrenderer>\n";
}

std::string ramp_renderer(const LayerInfo& info) {
  const std::string low = shortest(info.legend.front().value), high = shortest(info.legend.back().value);
  std::string xml = "    <rasterrenderer type=\"singlebandpseudocolor\" band=\"1\" opacity=\"1\" classificationMin=\"" +
                    low + "\" classificationMax=\"" + high +
                    "\">\n      <rastershader>\n        <colorrampshader "
                    "colorRampType=\"INTERPOLATED\" classificationMode=\"1\" clip=\"0\" minimumValue=\"" +
                    low + "\" maximumValue=\"" + high + "\">\n";
  for (const LegendEntry& entry : info.legend)
    xml += "          <item value=\"" + shortest(entry.value) + "\" color=\"" + entry.colour + "\" label=\"" +
           xml_escaped(entry.label) + "\" alpha=\"255\"/>\n";
  const std::string unit = info.unit.empty() || info.unit == "1" ? "" : " " + info.unit;
  xml += "          <rampLegendSettings minimumLabel=\"\" maximumLabel=\"\" prefix=\"\" suffix=\"" + xml_escaped(unit) +
         "\" direction=\"0\" orientation=\"2\" useContinuousLegend=\"1\"/>\n";
  return xml + "        </colorrampshader>\n      </rastershader>\n    </rasterrenderer>\n";
}

/// Columns of the attribute table: value, class name, cells, colour. Types and usages as GDAL numbers them.
std::string attribute_table(const LayerInfo& info, const std::array<std::uint64_t, 256>& cells) {
  constexpr std::array<std::array<const char*, 3>, 6> kColumns = {{{"Value", "0", "5"},
                                                                   {"Class", "2", "2"},
                                                                   {"Count", "1", "1"},
                                                                   {"Red", "0", "6"},
                                                                   {"Green", "0", "7"},
                                                                   {"Blue", "0", "8"}}};
  std::string xml = "    <GDALRasterAttributeTable tableType=\"thematic\">\n";
  for (std::size_t c = 0; c < kColumns.size(); ++c)
    xml += line("      <FieldDefn index=\"%zu\"><Name>%s</Name><Type>%s</Type><Usage>%s</Usage></FieldDefn>\n", c,
                kColumns[c][0], kColumns[c][1], kColumns[c][2]);
  for (std::size_t r = 0; r < info.legend.size(); ++r) {
    const LegendEntry& entry = info.legend[r];
    unsigned red = 0, green = 0, blue = 0;
    std::sscanf(entry.colour.c_str(), "#%2x%2x%2x", &red, &green, &blue);
    xml += line("      <Row index=\"%zu\"><F>%d</F><F>", r, int(entry.value)) + xml_escaped(entry.label) +
           line("</F><F>%llu</F><F>%u</F><F>%u</F><F>%u</F></Row>\n",
                static_cast<unsigned long long>(cells[std::size_t(entry.value)]), red, green, blue);
  }
  return xml + "    </GDALRasterAttributeTable>\n";
}

/// Text of `<name>.tif.aux.xml`: class names by value and the attribute table. cells[value]: number of cells.
std::string side_file(const LayerInfo& info, const std::array<std::uint64_t, 256>& cells) {
  std::vector<std::string> names;
  for (const LegendEntry& entry : info.legend) {
    if (names.size() <= std::size_t(entry.value)) names.resize(std::size_t(entry.value) + 1);
    names[std::size_t(entry.value)] = entry.label;
  }
  std::string xml = "<PAMDataset>\n  <PAMRasterBand band=\"1\">\n    <CategoryNames>\n";
  for (const std::string& name : names) xml += "      <Category>" + xml_escaped(name) + "</Category>\n";
  return xml + "    </CategoryNames>\n" + attribute_table(info, cells) + "  </PAMRasterBand>\n</PAMDataset>\n";
}

}  // namespace

std::string qgis_style(const LayerInfo& info) {
  return "<!DOCTYPE qgis>\n<qgis version=\"3.22\">\n  <pipe>\n" +
         (info.classes ? paletted_renderer(info) : ramp_renderer(info)) + "  </pipe>\n</qgis>\n";
}

using ClassCounts = std::array<std::uint64_t, 256>;

struct GeoTiffWriter::State {
  fs::path path;
  MapGrid grid;
  LayerInfo info;
  std::vector<CogLevel> levels;
  bool keep = false;
  RecordLog tiles;
};

namespace {

/// Mean of the valid ones of four cells.
float together(const std::array<float, 4>& cells) {
  float sum = 0;
  int count = 0;
  for (const float v : cells)
    if (v != float(kFloatNoData)) {
      sum += v;
      ++count;
    }
  return count > 0 ? sum / float(count) : float(kFloatNoData);
}

/// The most frequent valid one of four cells; of equally frequent ones the higher code, which is the more cautious.
std::uint8_t together(const std::array<std::uint8_t, 4>& cells) {
  int best = 0;
  auto frequent = std::uint8_t(kClassNoData);
  for (const std::uint8_t v : cells) {
    if (v == std::uint8_t(kClassNoData)) continue;
    const int count = int(std::count(cells.begin(), cells.end(), v));
    if (count > best || (count == best && v > frequent)) {
      best = count;
      frequent = v;
    }
  }
  return frequent;
}

double nodata_of(const LayerInfo& info) { return info.classes ? kClassNoData : kFloatNoData; }

/// Fills one quarter of a tile from the tile of the next larger level that lies there.
template <class Cell>
void halve(const std::vector<Cell>& from, std::vector<Cell>& to, int right, int below) {
  constexpr int half = kTileCells / 2;
  for (int row = 0; row < half; ++row)
    for (int column = 0; column < half; ++column) {
      const std::size_t i = std::size_t(2 * row) * kTileCells + std::size_t(2 * column);
      to[std::size_t(row + below * half) * kTileCells + std::size_t(column + right * half)] =
          together(std::array<Cell, 4>{from[i], from[i + 1], from[i + kTileCells], from[i + kTileCells + 1]});
    }
}

void count_classes(const std::vector<std::uint8_t>& cells, ClassCounts& counts) {
  for (const std::uint8_t v : cells) ++counts[v];
}
void count_classes(const std::vector<float>&, ClassCounts&) {}

/// One tile of an overview. Cells beyond the level's edge are nodata in every tile, so they need no rule.
template <class Cell>
std::string overview_tile(const RecordLog& tiles, const std::vector<CogLevel>& levels, std::size_t level,
                          std::uint32_t tile, const LayerInfo& info, ClassCounts* counts) {
  const CogLevel &here = levels[level], &finer = levels[level - 1];
  const int across = int(tile) % here.tiles_across(), down = int(tile) / here.tiles_across();
  std::vector<Cell> cells(kTileArea, Cell(nodata_of(info))), from;
  for (int below = 0; below < 2; ++below)
    for (int right = 0; right < 2; ++right) {
      const int x = 2 * across + right, y = 2 * down + below;
      if (x >= finer.tiles_across() || y >= finer.tiles_down()) continue;
      const std::uint32_t number = first_tile(levels, level - 1) + std::uint32_t(y * finer.tiles_across() + x);
      decode_tile(tiles.read(number), from, info.smooth, tiles.path().string());
      if (counts) count_classes(from, *counts);
      halve(from, cells, right, below);
    }
  return encode_tile(cells, info.smooth);
}

template <class Cell>
ClassCounts make_overviews(RecordLog& tiles, const std::vector<CogLevel>& levels, const LayerInfo& info, int threads) {
  ClassCounts counts{};
  std::mutex counting;
  for (std::size_t level = 1; level < levels.size(); ++level)
    for_each_on_host(
        levels[level].tiles(), 1,
        [&](std::size_t t) {
          ClassCounts own{};
          const auto tile = std::uint32_t(t);
          tiles.append(first_tile(levels, level) + tile,
                       overview_tile<Cell>(tiles, levels, level, tile, info, level == 1 ? &own : nullptr));
          const std::lock_guard lock(counting);
          for (std::size_t i = 0; i < own.size(); ++i) counts[i] += own[i];
        },
        threads);
  if (levels.size() == 1) {
    std::vector<Cell> cells;
    decode_tile(tiles.read(0), cells, info.smooth, tiles.path().string());
    count_classes(cells, counts);
  }
  return counts;
}

fs::path scratch_of(const fs::path& path) { return path.parent_path() / ("." + path.stem().string() + ".scratch"); }

template <class Cell>
std::string encode_window(const Tile& tile, int left, int top, const LayerInfo& info) {
  std::vector<Cell> cells(kTileArea, Cell(nodata_of(info)));
  for (int row = 0; row < std::min(kTileCells, tile.rows - top); ++row)
    for (int column = 0; column < std::min(kTileCells, tile.columns - left); ++column) {
      const float v = tile.at(left + column, top + row);
      if (!std::isnan(v)) cells[std::size_t(row) * kTileCells + std::size_t(column)] = Cell(v);
    }
  return encode_tile(cells, info.smooth);
}

}  // namespace

GeoTiffWriter::GeoTiffWriter(const fs::path& path, const MapGrid& grid, const LayerInfo& info, const std::string& key)
    : state_(new State{.path = path,
                       .grid = grid,
                       .info = info,
                       .levels = cog_levels(grid.columns, grid.rows),
                       .keep = !key.empty(),
                       .tiles = RecordLog(scratch_of(path), key)}) {
  GONOGO_ASSERT(!info.legend.empty());
}

GeoTiffWriter::~GeoTiffWriter() {
  if (!state_->keep) state_->tiles.remove();
}

void GeoTiffWriter::write(Window window, const Tile& tile) {
  GONOGO_ASSERT(tile.columns == window.columns && tile.rows == window.rows);
  GONOGO_ASSERT(window.column % kTileCells == 0 && window.row % kTileCells == 0);
  const int across = state_->levels.front().tiles_across();
  for (int top = 0; top < window.rows; top += kTileCells)
    for (int left = 0; left < window.columns; left += kTileCells) {
      const int number = (window.row + top) / kTileCells * across + (window.column + left) / kTileCells;
      state_->tiles.append(std::uint32_t(number), state_->info.classes
                                                      ? encode_window<std::uint8_t>(tile, left, top, state_->info)
                                                      : encode_window<float>(tile, left, top, state_->info));
    }
}

bool GeoTiffWriter::has_tile(int column, int row) const {
  return state_->tiles.has(
      std::uint32_t(row / kTileCells * state_->levels.front().tiles_across() + column / kTileCells));
}

void GeoTiffWriter::forget() { state_->tiles.remove(); }

void GeoTiffWriter::finish(int threads) {
  State& s = *state_;
  const ClassCounts counts = s.info.classes ? make_overviews<std::uint8_t>(s.tiles, s.levels, s.info, threads)
                                            : make_overviews<float>(s.tiles, s.levels, s.info, threads);
  const CogTiles tiles = {[&](std::uint32_t t) { return s.tiles.size_of(t); },
                          [&](std::uint32_t t) { return s.tiles.read(t); }};
  replace_file_atomically(s.path, [&](const fs::path& file) { write_cog(file, s.grid, s.info, s.levels, tiles); });
  if (s.info.classes) write_file_atomically(s.path.string() + ".aux.xml", side_file(s.info, counts));
  write_file_atomically(fs::path(s.path).replace_extension(".qml"), qgis_style(s.info));
}

namespace {

using Metadata = std::vector<std::pair<std::string, std::string>>;

GDALDriver& driver_named(const char* name) {
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(name);
  if (!driver) throw DeviceError("this GDAL has no " + std::string(name) + " driver");
  return *driver;
}

void fill(GDALDataset& file, const MapGrid& grid, const std::vector<FloatLayer>& layers, const RowOfLayer& row_of,
          const fs::path& path, const GdalCall& call) {
  for (int row = 0; row < grid.rows; ++row)
    for (std::size_t l = 0; l < layers.size(); ++l) {
      std::vector<float> value = row_of(l, row);
      if (file.GetRasterBand(int(l) + 1)
              ->RasterIO(GF_Write, 0, row, grid.columns, 1, value.data(), grid.columns, 1, GDT_Float32, 0, 0,
                         nullptr) != CE_None)
        refuse_to_write(path, call);
    }
}

/// The GeoTIFF, still open.
DatasetHandle make_tiff(const fs::path& path, const MapGrid& grid, const std::vector<FloatLayer>& layers,
                        const Metadata& metadata, const RowOfLayer& row_of, const GdalCall& call) {
  CPLStringList options;
  for (const char* option : {"COMPRESS=DEFLATE", "PREDICTOR=3", "INTERLEAVE=BAND", "BIGTIFF=IF_SAFER"})
    options.AddString(option);
  DatasetHandle file(driver_named("GTiff").Create(path.c_str(), grid.columns, grid.rows, int(layers.size()),
                                                  GDT_Float32, options.List()));
  if (!file) refuse_to_write(path, call);
  const OGRSpatialReference crs = system_of(grid);
  double transform[6] = {grid.west, grid.cell_width, 0, grid.north, 0, -grid.cell_height};
  file->SetSpatialRef(&crs);
  file->SetGeoTransform(transform);
  for (const auto& [key, value] : metadata) file->SetMetadataItem(key.c_str(), value.c_str());
  for (std::size_t l = 0; l < layers.size(); ++l) {
    GDALRasterBand& band = *file->GetRasterBand(int(l) + 1);
    band.SetDescription(layers[l].name.c_str());
    band.SetUnitType(layers[l].unit.c_str());
    band.SetMetadataItem("NETCDF_VARNAME", layers[l].name.c_str());
    band.SetMetadataItem("units", layers[l].unit.c_str());
    band.SetMetadataItem("long_name", layers[l].name.c_str());
    band.SetNoDataValue(std::numeric_limits<double>::quiet_NaN());
  }
  fill(*file, grid, layers, row_of, path, call);
  return file;
}

}  // namespace

void write_float_layers(const fs::path& path, const MapGrid& grid, const std::vector<FloatLayer>& layers,
                        const Metadata& metadata, const RowOfLayer& row_of) {
  const std::string extension = path.extension().string();
  if (extension != ".tif" && extension != ".nc")
    throw InputError(path.string() + ": \"" + extension + "\" is no format for layers; use .tif or .nc");
  const GdalCall call;
  replace_file_atomically(path, [&](const fs::path& temporary) {
    if (extension == ".tif") {
      make_tiff(temporary, grid, layers, metadata, row_of, call);
      return;
    }
    fs::path tiff = temporary;
    tiff += ".tif";
    {
      const DatasetHandle source = make_tiff(tiff, grid, layers, metadata, row_of, call);
      CPLStringList options;
      for (const char* option : {"FORMAT=NC4C", "COMPRESS=DEFLATE", "WRITE_GDAL_HISTORY=NO", "WRITE_GDAL_VERSION=NO"})
        options.AddString(option);
      const DatasetHandle copy(
          driver_named("netCDF").CreateCopy(temporary.c_str(), source.get(), FALSE, options.List(), nullptr, nullptr));
      if (!copy) refuse_to_write(path, call);
    }
    std::error_code ignored;
    fs::remove(tiff, ignored);
  });
  if (call.failed()) refuse_to_write(path, call);
}

void write_values(const fs::path& path, const Tile& values, const ValuesPlace& place, const std::string& crs,
                  const std::string& unit) {
  const GdalCall call;
  OGRSpatialReference system;
  if (system.SetFromUserInput(crs.c_str(), OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get()) != OGRERR_NONE)
    throw InputError("crs: \"" + crs + "\" is no coordinate system that PROJ knows; give for example EPSG:32611");
  MapGrid grid;
  grid.columns = values.columns;
  grid.rows = values.rows;
  grid.west = place.west;
  grid.north = place.north;
  grid.cell_width = place.cell_width;
  grid.cell_height = place.cell_height;
  grid.crs_wkt = export_wkt(system);
  write_float_layers(path, grid, {{"elevation", unit}}, {}, [&](std::size_t, int row) {
    const auto from = values.value.begin() + std::ptrdiff_t(row) * values.columns;
    return std::vector<float>(from, from + values.columns);
  });
}

}  // namespace gonogo::terrain
