#include "terrain/raster/raster_source.h"

#include <gdal_utils.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include "base/error.h"
#include "terrain/raster/gdal_support.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;

struct RasterSource::State {
  fs::path path;
  DatasetHandle original;  // what a warped dataset reads from; must outlive it
  DatasetHandle dataset;
  MapGrid grid;
  double scale = 1, offset = 0;  // stored value -> value
};

namespace {

constexpr float kNoData = std::numeric_limits<float>::quiet_NaN();

DatasetHandle open_dataset(const fs::path& path) {
  const bool virtual_file = path.string().rfind("/vsi", 0) == 0;
  std::error_code ec;
  if (!virtual_file && !fs::exists(path, ec)) throw InputError(path.string() + ": no such file; check the path");
  GdalCall call;
  DatasetHandle dataset(GDALDataset::Open(path.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
  if (!dataset)
    throw InputError(path.string() + ": cannot be read as a raster (" + call.message() +
                     "); give a format that gdalinfo opens, for example GeoTIFF");
  if (dataset->GetRasterCount() < 1)
    throw InputError(path.string() + ": holds no raster band; name one raster of it, as gdalinfo lists them");
  return dataset;
}

/// UTM zone of a place on WGS 84, as "EPSG:32610".
std::string utm_code(double longitude, double latitude) {
  const int zone = std::clamp(int(std::floor((longitude + 180) / 6)) + 1, 1, 60);
  return "EPSG:" + std::to_string((latitude >= 0 ? 32600 : 32700) + zone);
}

const OGRSpatialReference& require_crs(GDALDataset& dataset, const fs::path& path) {
  const OGRSpatialReference* crs = dataset.GetSpatialRef();
  if (!crs || crs->IsEmpty())
    throw InputError(path.string() +
                     ": names no coordinate system; find out which one it is in and write it in with: gdal_edit.py "
                     "-a_srs EPSG:<code> " +
                     path.string());
  return *crs;
}

struct GeoTransform {
  double value[6];  // x = v0 + v1 column + v2 row, y = v3 + v4 column + v5 row
};

GeoTransform require_north_up(GDALDataset& dataset, const fs::path& path) {
  GeoTransform t;
  if (dataset.GetGeoTransform(t.value) != CE_None)
    throw InputError(path.string() +
                     ": does not say where its cells lie (no geotransform); georeference it first, for "
                     "example with gdal_translate -a_ullr");
  const std::string repair = "; straighten it with: gdalwarp -r bilinear " + path.string() + " north_up.tif";
  const double turned = 1e-9 * std::hypot(t.value[1], t.value[5]);
  if (std::abs(t.value[2]) > turned || std::abs(t.value[4]) > turned)
    throw InputError(path.string() + ": its rows do not run west to east (rotated geotransform)" + repair);
  if (!(t.value[1] > 0) || !(t.value[5] < 0))
    throw InputError(path.string() + ": its first row is not the northernmost or its columns do not run eastward" +
                     repair);
  return t;
}

void refuse_degrees(const OGRSpatialReference& crs, const GeoTransform& t, const GDALDataset& dataset,
                    const fs::path& path) {
  if (crs.IsProjected()) return;
  std::string target = "EPSG:<code of a projected system in metres>";
  std::string what = "is in a coordinate system that is not a map projection";
  if (crs.IsGeographic()) {
    auto& raster = const_cast<GDALDataset&>(dataset);
    target = utm_code(t.value[0] + t.value[1] * raster.GetRasterXSize() / 2,
                      t.value[3] + t.value[5] * raster.GetRasterYSize() / 2);
    what = "is in degrees, where a slope in ground metres cannot be taken from the cells";
  }
  throw InputError(path.string() + ": " + what + "; reproject it with: gdalwarp -t_srs " + target + " -r cubic " +
                   path.string() + " " + path.stem().string() + "_projected.tif");
}

std::string export_wkt(const OGRSpatialReference& crs) {
  char* text = nullptr;
  const char* const options[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
  crs.exportToWkt(&text, options);
  std::string wkt = text ? text : "";
  CPLFree(text);
  return wkt;
}

MapGrid describe_grid(GDALDataset& dataset, const OGRSpatialReference& crs, const GeoTransform& t) {
  MapGrid grid;
  grid.columns = dataset.GetRasterXSize();
  grid.rows = dataset.GetRasterYSize();
  grid.west = t.value[0];
  grid.north = t.value[3];
  grid.cell_width = t.value[1];
  grid.cell_height = -t.value[5];
  const char* unit = nullptr;
  grid.metres_per_unit = crs.GetLinearUnits(&unit);
  if (unit) grid.unit_name = unit;
  grid.crs_wkt = export_wkt(crs);
  if (const char* name = crs.GetName()) grid.crs_name = name;
  const char *authority = crs.GetAuthorityName(nullptr), *code = crs.GetAuthorityCode(nullptr);
  if (authority && code) grid.crs_code = std::string(authority) + ":" + code;
  return grid;
}

/// Factor from the band's stated unit of height to metres.
double vertical_metres(GDALRasterBand& band, const fs::path& path) {
  std::string unit = band.GetUnitType();
  std::transform(unit.begin(), unit.end(), unit.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  for (const char* name : {"", "m", "metre", "meter", "metres", "meters"})
    if (unit == name) return 1;
  for (const char* name : {"ft", "foot", "feet", "international foot"})
    if (unit == name) return 0.3048;
  for (const char* name : {"us survey foot", "us_survey_foot", "us-ft", "ftus", "us survey feet"})
    if (unit == name) return 1200.0 / 3937.0;
  throw InputError(path.string() + ": heights are in \"" + unit +
                   "\"; metres and feet are understood, convert it with gdal_calc.py");
}

void require_some_value(const RasterSource& source) {
  const MapGrid& grid = source.grid();
  constexpr int band_rows = 256;
  for (int row = 0; row < grid.rows; row += band_rows) {
    const Tile tile = source.read({0, row, grid.columns, std::min(band_rows, grid.rows - row)});
    if (std::any_of(tile.value.begin(), tile.value.end(), [](float v) { return !std::isnan(v); })) return;
  }
  throw InputError(source.path().string() + ": every cell is nodata; give a raster that covers the region");
}

/// Extent of a raster in another coordinate system: {west, south, east, north}, or nothing when it cannot be carried
/// over.
std::optional<std::array<double, 4>> extent_on(GDALDataset& dataset, const GeoTransform& t,
                                               const OGRSpatialReference& from, const OGRSpatialReference& to) {
  std::unique_ptr<OGRCoordinateTransformation> transformation(OGRCreateCoordinateTransformation(&from, &to));
  std::array<double, 4> out;
  const double east = t.value[0] + t.value[1] * dataset.GetRasterXSize();
  const double south = t.value[3] + t.value[5] * dataset.GetRasterYSize();
  if (!transformation ||
      !transformation->TransformBounds(t.value[0], south, east, t.value[3], &out[0], &out[1], &out[2], &out[3], 21))
    return std::nullopt;
  return out;
}

DatasetHandle warp_to(GDALDataset& source, const MapGrid& grid, const char* resampling, const fs::path& path) {
  char edges[4][40];
  const double east = grid.west + grid.columns * grid.cell_width, south = grid.north - grid.rows * grid.cell_height;
  const double corners[4] = {grid.west, south, east, grid.north};
  for (int i = 0; i < 4; ++i) std::snprintf(edges[i], sizeof edges[i], "%.17g", corners[i]);
  const std::string columns = std::to_string(grid.columns), rows = std::to_string(grid.rows);
  // Float32 with not-a-number as nodata: a code such as 0 stays a value and what the source does not cover does not
  // become one. -et 0: exact transformation, so that a cell's value does not depend on the window it is read in.
  const char* arguments[] = {"-of",        "VRT",      "-t_srs",        grid.crs_wkt.c_str(),
                             "-te",        edges[0],   edges[1],        edges[2],
                             edges[3],     "-ts",      columns.c_str(), rows.c_str(),
                             "-r",         resampling, "-ot",           "Float32",
                             "-dstnodata", "nan",      "-et",           "0",
                             nullptr};
  GdalCall call;
  GDALWarpAppOptions* options = GDALWarpAppOptionsNew(const_cast<char**>(arguments), nullptr);
  GDALDatasetH source_handle = &source;
  int usage_error = 0;
  DatasetHandle warped(GDALDataset::FromHandle(GDALWarp("", nullptr, 1, &source_handle, options, &usage_error)));
  GDALWarpAppOptionsFree(options);
  if (!warped) throw InputError(path.string() + ": cannot be warped to the elevation grid (" + call.message() + ")");
  return warped;
}

}  // namespace

RasterSource::RasterSource(std::unique_ptr<State> state) : state_(std::move(state)) {}
RasterSource::RasterSource(RasterSource&&) noexcept = default;
RasterSource& RasterSource::operator=(RasterSource&&) noexcept = default;
RasterSource::~RasterSource() = default;

const MapGrid& RasterSource::grid() const { return state_->grid; }
const fs::path& RasterSource::path() const { return state_->path; }

RasterSource RasterSource::open_elevation(const fs::path& path) {
  auto state = std::make_unique<State>();
  state->path = path;
  state->dataset = open_dataset(path);
  const OGRSpatialReference& crs = require_crs(*state->dataset, path);
  const GeoTransform t = require_north_up(*state->dataset, path);
  refuse_degrees(crs, t, *state->dataset, path);
  state->grid = describe_grid(*state->dataset, crs, t);
  GDALRasterBand& band = *state->dataset->GetRasterBand(1);
  const double metres = vertical_metres(band, path);
  state->scale = band.GetScale() * metres;
  state->offset = band.GetOffset() * metres;
  RasterSource source(std::move(state));
  require_some_value(source);
  return source;
}

RasterSource RasterSource::open_on_grid(const fs::path& path, const MapGrid& grid, RasterKind kind) {
  DatasetHandle original = open_dataset(path);
  const OGRSpatialReference& crs = require_crs(*original, path);
  const GeoTransform t = require_north_up(*original, path);
  OGRSpatialReference target;
  target.importFromWkt(grid.crs_wkt.c_str());
  target.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const double east = grid.west + grid.columns * grid.cell_width, south = grid.north - grid.rows * grid.cell_height;
  const auto extent = extent_on(*original, t, crs, target);
  if (!extent || (*extent)[0] >= east || (*extent)[2] <= grid.west || (*extent)[1] >= grid.north ||
      (*extent)[3] <= south)
    throw InputError(path.string() + ": does not overlap the elevation raster; give a raster of the same region");
  const double source_cell = std::sqrt(((*extent)[2] - (*extent)[0]) / original->GetRasterXSize() *
                                       ((*extent)[3] - (*extent)[1]) / original->GetRasterYSize());
  // A margin of a tenth, so that equal grids in slightly different projections still count as equal.
  const bool coarser_map = std::sqrt(grid.cell_width * grid.cell_height) > 1.1 * source_cell;
  const char* resampling = kind == RasterKind::continuous ? "bilinear" : coarser_map ? "mode" : "near";
  auto state = std::make_unique<State>();
  state->path = path;
  state->grid = grid;
  state->scale = original->GetRasterBand(1)->GetScale();
  state->offset = original->GetRasterBand(1)->GetOffset();
  state->dataset = warp_to(*original, grid, resampling, path);
  state->original = std::move(original);
  return RasterSource(std::move(state));
}

Tile RasterSource::read(Window window) const {
  Tile tile(window.columns, window.rows, kNoData);
  const int left = std::max(0, window.column), top = std::max(0, window.row);
  const int right = std::min(state_->grid.columns, window.column + window.columns);
  const int bottom = std::min(state_->grid.rows, window.row + window.rows);
  if (left >= right || top >= bottom) return tile;
  const int columns = right - left, rows = bottom - top;
  std::vector<float> value(std::size_t(columns) * rows);
  std::vector<unsigned char> valid(value.size());
  GdalCall call;
  GDALRasterBand& band = *state_->dataset->GetRasterBand(1);
  if (band.RasterIO(GF_Read, left, top, columns, rows, value.data(), columns, rows, GDT_Float32, 0, 0, nullptr) !=
          CE_None ||
      band.GetMaskBand()->RasterIO(GF_Read, left, top, columns, rows, valid.data(), columns, rows, GDT_Byte, 0, 0,
                                   nullptr) != CE_None)
    throw InputError(state_->path.string() + ": reading its cells failed (" + call.message() +
                     "); the file is damaged or incomplete, fetch it again");
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const std::size_t i = std::size_t(row) * columns + column;
      if (valid[i] && std::isfinite(value[i]))
        tile.at(left - window.column + column, top - window.row + row) =
            float(value[i] * state_->scale + state_->offset);
    }
  return tile;
}

}  // namespace gonogo::terrain
