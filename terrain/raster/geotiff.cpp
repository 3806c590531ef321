#include "terrain/raster/geotiff.h"

#include <cpl_string.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/file.h"
#include "terrain/raster/gdal_support.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;

struct GeoTiffWriter::State {
  fs::path path, scratch;
  MapGrid grid;
  LayerInfo info;
  DatasetHandle dataset;
};

namespace {

constexpr double kFloatNoData = -9999;
constexpr double kClassNoData = 255;

/// A layer's own settings of GDAL, put back when it leaves.
class ThreadOption {
 public:
  ThreadOption(const char* key, const char* value) : key_(key) {
    if (const char* old = CPLGetThreadLocalConfigOption(key, nullptr)) old_ = old, had_ = true;
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

DatasetHandle create_scratch(const fs::path& scratch, const MapGrid& grid, const LayerInfo& info) {
  GdalCall call;
  const ThreadOption no_sidecar("GDAL_PAM_ENABLED", "NO");
  CPLStringList options;
  options.SetNameValue("TILED", "YES");
  options.SetNameValue("BIGTIFF", "IF_SAFER");
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  DatasetHandle dataset(driver->Create(scratch.c_str(), grid.columns, grid.rows, 1,
                                       info.classes ? GDT_Byte : GDT_Float32, options.List()));
  if (!dataset) throw DeviceError(scratch.string() + ": cannot be written (" + call.message() + ")");
  double transform[6] = {grid.west, grid.cell_width, 0, grid.north, 0, -grid.cell_height};
  dataset->SetGeoTransform(transform);
  OGRSpatialReference crs;
  crs.importFromWkt(grid.crs_wkt.c_str());
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  dataset->SetSpatialRef(&crs);
  dataset->SetMetadataItem("AREA_OR_POINT", "Area");
  describe_band(*dataset, info);
  return dataset;
}

void copy_to_cog(GDALDataset& scratch, const fs::path& target, const LayerInfo& info, int threads) {
  GdalCall call;
  const ThreadOption no_sidecar("GDAL_PAM_ENABLED", "NO");
  CPLStringList options;
  options.SetNameValue("COMPRESS", "DEFLATE");
  options.SetNameValue("PREDICTOR", "YES");
  options.SetNameValue("OVERVIEW_RESAMPLING", info.classes ? "MODE" : "AVERAGE");
  options.SetNameValue("NUM_THREADS", threads > 0 ? std::to_string(threads).c_str() : "ALL_CPUS");
  options.SetNameValue("BIGTIFF", "IF_SAFER");
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("COG");
  if (!driver) throw DeviceError("this GDAL has no COG driver; GDAL 3.1 or newer is needed");
  GDALDataset* copy = driver->CreateCopy(target.c_str(), &scratch, FALSE, options.List(), nullptr, nullptr);
  if (copy) GDALClose(copy);
  if (!copy || call.failed()) throw DeviceError(target.string() + ": cannot be written (" + call.message() + ")");
}

std::string xml_text(const std::string& text) {
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
    else
      out += c;
  }
  return out;
}

/// GDAL's side file with the class names: a list by value, empty for values that are no class.
std::string category_file(const LayerInfo& info) {
  std::vector<std::string> names;
  for (const LegendEntry& entry : info.legend) {
    if (names.size() <= std::size_t(entry.value)) names.resize(std::size_t(entry.value) + 1);
    names[std::size_t(entry.value)] = entry.label;
  }
  std::string xml = "<PAMDataset>\n  <PAMRasterBand band=\"1\">\n    <CategoryNames>\n";
  for (const std::string& name : names) xml += "      <Category>" + xml_text(name) + "</Category>\n";
  return xml + "    </CategoryNames>\n  </PAMRasterBand>\n</PAMDataset>\n";
}

std::string shortest(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", x);
  return text;
}

std::string paletted_renderer(const LayerInfo& info) {
  std::string xml = "    <rasterrenderer type=\"paletted\" band=\"1\" opacity=\"1\">\n      <colorPalette>\n";
  for (const LegendEntry& entry : info.legend)
    xml += "        <paletteEntry value=\"" + shortest(entry.value) + "\" color=\"" + entry.colour + "\" label=\"" +
           xml_text(entry.label) + "\" alpha=\"255\"/>\n";
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
           xml_text(entry.label) + "\" alpha=\"255\"/>\n";
  return xml + "        </colorrampshader>\n      </rastershader>\n    </rasterrenderer>\n";
}

}  // namespace

GeoTiffWriter::GeoTiffWriter(fs::path path, MapGrid grid, LayerInfo info) : state_(std::make_unique<State>()) {
  GONOGO_ASSERT(!info.legend.empty());
  create_folder(path.has_parent_path() ? path.parent_path() : fs::path("."));
  std::string scratch_name = ".";
  scratch_name += path.stem().string() + ".scratch.tif";
  state_->scratch = path.parent_path() / scratch_name;
  state_->dataset = create_scratch(state_->scratch, grid, info);
  state_->path = std::move(path);
  state_->grid = std::move(grid);
  state_->info = std::move(info);
}

GeoTiffWriter::~GeoTiffWriter() {
  GdalCall call;
  state_->dataset.reset();
  std::error_code ignored;
  fs::remove(state_->scratch, ignored);
}

void GeoTiffWriter::write(Window window, const Tile& tile) {
  GONOGO_ASSERT(tile.columns == window.columns && tile.rows == window.rows);
  std::vector<float> value = tile.value;
  const float nodata = float(state_->info.classes ? kClassNoData : kFloatNoData);
  for (float& v : value)
    if (std::isnan(v)) v = nodata;
  GdalCall call;
  if (state_->dataset->GetRasterBand(1)->RasterIO(GF_Write, window.column, window.row, window.columns, window.rows,
                                                  value.data(), window.columns, window.rows, GDT_Float32, 0, 0,
                                                  nullptr) != CE_None)
    throw DeviceError(state_->path.string() + ": cannot be written (" + call.message() + ")");
}

void GeoTiffWriter::finish(int threads) {
  GdalCall call;
  state_->dataset->FlushCache();
  if (call.failed()) throw DeviceError(state_->path.string() + ": cannot be written (" + call.message() + ")");
  replace_file_atomically(state_->path, [&](const fs::path& temporary) {
    copy_to_cog(*state_->dataset, temporary, state_->info, threads);
  });
  if (state_->info.classes) write_file_atomically(state_->path.string() + ".aux.xml", category_file(state_->info));
  write_file_atomically(fs::path(state_->path).replace_extension(".qml"), qgis_style(state_->info));
}

std::string qgis_style(const LayerInfo& info) {
  return "<!DOCTYPE qgis>\n<qgis version=\"3.22\">\n  <pipe>\n" +
         (info.classes ? paletted_renderer(info) : ramp_renderer(info)) + "  </pipe>\n</qgis>\n";
}

}  // namespace gonogo::terrain
