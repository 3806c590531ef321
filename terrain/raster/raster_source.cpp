#include "terrain/raster/raster_source.h"

#include <cpl_string.h>
#include <algorithm>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "base/format.h"
#include "terrain/raster/height_scan.h"
#include "terrain/raster/raster_open.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;

struct RasterSource::State {
  OpenRaster raster;
  MapGrid grid;
  double scale = 1, offset = 0;  // stored value -> value
  std::string how_warped, unit;
  std::vector<std::string> remarks;
  std::function<OpenRaster()> open;       // the same once more
  std::optional<OpenRaster> flat;         // open_flat(), where there are flat areas
  std::function<OpenRaster()> open_flat;  // empty without flat areas
};

namespace {

void require_some_value(const RasterSource& source) {
  for (const Window band : windows_of(source.grid(), source.grid().columns, 64)) {
    const Tile tile = source.read(band);
    if (std::any_of(tile.value.begin(), tile.value.end(), [](float v) { return !std::isnan(v); })) return;
  }
  throw InputError(source.name() + ": every cell is nodata; give a raster that covers the region");
}

/// How a raster's own cells become cells of `grid`: its cells' side [units of the grid] from its extent there.
double side_on(const std::array<double, 4>& extent, GDALDataset& dataset) {
  return std::sqrt((extent[2] - extent[0]) / dataset.GetRasterXSize() * (extent[3] - extent[1]) /
                   dataset.GetRasterYSize());
}

/// Both with a margin, so that equal grids in slightly different projections still count as equal.
std::string resampling_of(RasterKind kind, double cell, double source_cell, bool elevation) {
  if (kind == RasterKind::classes) return cell > 1.1 * source_cell ? "mode" : "near";
  if (elevation) return cell > 1.5 * source_cell ? "average" : "cubic";
  return "bilinear";
}

OpenRaster open_without(const RasterFiles& files, const std::vector<FoundVoid>& voids) {
  OpenRaster raster = open_raster(files);
  if (!voids.empty()) leave_out_voids(raster, voids);
  return raster;
}

OpenRaster open_flat_of(const RasterFiles& files, const std::shared_ptr<const CellRuns>& runs) {
  OpenRaster raster = open_raster(files);
  mark_runs(raster, runs);
  return raster;
}

/// Values of the window; NaN: nodata, infinities and what lies outside of the grid.
Tile read_window(const OpenRaster& raster, const MapGrid& grid, Window window, double scale, double offset) {
  Tile tile(window.columns, window.rows, kNoData);
  const int left = std::max(0, window.column), top = std::max(0, window.row);
  const int right = std::min(grid.columns, window.column + window.columns);
  const int bottom = std::min(grid.rows, window.row + window.rows);
  if (left >= right || top >= bottom) return tile;
  const int columns = right - left, rows = bottom - top;
  std::vector<float> value(std::size_t(columns) * rows);
  std::vector<unsigned char> valid(value.size());
  GdalCall call;
  GDALRasterBand& band = *raster.dataset->GetRasterBand(1);
  if (band.RasterIO(GF_Read, left, top, columns, rows, value.data(), columns, rows, GDT_Float32, 0, 0, nullptr) !=
          CE_None ||
      band.GetMaskBand()->RasterIO(GF_Read, left, top, columns, rows, valid.data(), columns, rows, GDT_Byte, 0, 0,
                                   nullptr) != CE_None)
    throw InputError(raster.name + ": reading its cells failed (" + call.message() +
                     "); the file is damaged or incomplete, fetch it again");
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const std::size_t i = std::size_t(row) * columns + column;
      if (valid[i] && std::isfinite(value[i]))
        tile.at(left - window.column + column, top - window.row + row) = float(value[i] * scale + offset);
    }
  return tile;
}

/// The cells of a raster that a grid lies on, and some around them; all of them where that cannot be told.
Window window_under(GDALDataset& dataset, const GeoTransform& t, const OGRSpatialReference& crs, const MapGrid& grid) {
  constexpr int margin = 4;
  const int columns = dataset.GetRasterXSize(), rows = dataset.GetRasterYSize();
  const auto extent = extent_on(grid, system_of(grid), crs);
  if (!extent || (*extent)[0] > (*extent)[2]) return {0, 0, columns, rows};
  const auto place = [](double at, int most) { return int(std::clamp(std::floor(at), 0.0, double(most))); };
  const int left = place(((*extent)[0] - t.value[0]) / t.value[1] - margin, columns - 1);
  const int right = place(((*extent)[2] - t.value[0]) / t.value[1] + margin, columns - 1);
  const int top = place(((*extent)[3] - t.value[3]) / t.value[5] - margin, rows - 1);
  const int bottom = place(((*extent)[1] - t.value[3]) / t.value[5] + margin, rows - 1);
  return {left, top, right - left + 1, bottom - top + 1};
}

std::function<OpenRaster()> warping(const std::function<OpenRaster()>& open, const MapGrid& grid,
                                    const std::string& resampling) {
  return [open, grid, resampling] {
    OpenRaster raster = open();
    warp_to(raster, grid, resampling);
    return raster;
  };
}

}  // namespace

RasterSource::RasterSource(std::unique_ptr<State> state) : state_(std::move(state)) {}
RasterSource::RasterSource(RasterSource&&) noexcept = default;
RasterSource& RasterSource::operator=(RasterSource&&) noexcept = default;
RasterSource::~RasterSource() = default;

const MapGrid& RasterSource::grid() const { return state_->grid; }
std::string RasterSource::name() const { return state_->raster.name; }
const std::string& RasterSource::unit() const { return state_->unit; }
const std::string& RasterSource::how_warped() const { return state_->how_warped; }
const std::vector<std::string>& RasterSource::remarks() const { return state_->remarks; }
bool RasterSource::has_flat() const { return state_->flat.has_value(); }

RasterSource RasterSource::again() const {
  auto state = std::make_unique<State>();
  state->grid = state_->grid;
  state->scale = state_->scale;
  state->offset = state_->offset;
  state->how_warped = state_->how_warped;
  state->unit = state_->unit;
  state->remarks = state_->remarks;
  state->open = state_->open;
  state->open_flat = state_->open_flat;
  state->raster = state->open();
  if (state->open_flat) state->flat = state->open_flat();
  return RasterSource(std::move(state));
}

RasterSource RasterSource::open_elevation(const RasterFiles& files, const GridWish& wish) {
  return open(files, wish, nullptr);
}

RasterSource RasterSource::open_heights(const RasterFiles& files, const GridWish& wish, const HeightWish& heights) {
  return open(files, wish, &heights);
}

RasterSource RasterSource::open(const RasterFiles& files, const GridWish& wish, const HeightWish* heights) {
  const GdalCall quiet;
  auto state = std::make_unique<State>();
  state->raster = open_raster(files);
  GDALDataset& dataset = *state->raster.dataset;
  if (heights) require_heights(dataset, state->raster.name);
  const OGRSpatialReference crs = require_crs(dataset, state->raster.name);
  const GeoTransform t = require_north_up(dataset, state->raster.name);
  require_metres(dataset, crs, t, state->raster.name);
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  const double metres = heights ? height_unit(dataset, crs, state->raster.name, heights->unit, state->remarks)
                                : vertical_metres(band, state->raster.name);
  if (const std::string bands = heights ? remark_on_bands(dataset, state->raster.name) : ""; !bands.empty())
    state->remarks.push_back(bands);
  state->scale = band.GetScale() * metres;
  state->offset = band.GetOffset() * metres;
  const auto grid = grid_for(state->raster, crs, t, wish);
  HeightDoubt doubt;
  if (heights) {
    const HeightScale scale = height_scale(dataset, t, crs, state->scale, state->offset);
    doubt = doubt_heights(dataset, state->raster.name, scale, *heights, state->remarks);
  }
  state->open = [files, doubt] { return open_without(files, doubt.voids); };
  if (doubt.flat) state->open_flat = [files, doubt] { return open_flat_of(files, doubt.flat); };
  if (grid) {
    const OGRSpatialReference target = system_of(*grid);
    const std::string shift = check_shift(crs, target, state->raster.name, grid->cell_width_m());
    if (!shift.empty()) state->remarks.push_back(shift);
    const auto extent = extent_on(dataset, t, crs, target);
    const std::string resampling = resampling_of(RasterKind::continuous, grid->cell_width,
                                                 extent ? side_on(*extent, dataset) : grid->cell_width, true);
    state->grid = *grid;
    state->how_warped =
        line("elevation was warped from %s to %s, cells of %g m, %s", crs.GetName() ? crs.GetName() : "?",
             grid->crs_name.c_str(), grid->cell_width_m(), resampling.c_str());
    state->open = warping(state->open, *grid, resampling);
    if (state->open_flat) state->open_flat = warping(state->open_flat, *grid, "near");
  } else {
    state->grid = describe_grid(dataset.GetRasterXSize(), dataset.GetRasterYSize(), crs, t);
  }
  if (grid || !doubt.voids.empty()) state->raster = state->open();
  if (state->open_flat) state->flat = state->open_flat();
  RasterSource source(std::move(state));
  require_some_value(source);
  return source;
}

RasterSource RasterSource::open_as_it_lies(const RasterFiles& files, const std::optional<ValueRange>& range) {
  const GdalCall quiet;
  auto state = std::make_unique<State>();
  state->raster = open_raster(files);
  GDALDataset& dataset = *state->raster.dataset;
  const OGRSpatialReference& crs = require_crs(dataset, state->raster.name);
  const GeoTransform t = require_north_up(dataset, state->raster.name);
  state->grid = describe_grid(dataset.GetRasterXSize(), dataset.GetRasterYSize(), crs, t);
  state->scale = dataset.GetRasterBand(1)->GetScale();
  state->offset = dataset.GetRasterBand(1)->GetOffset();
  std::vector<FoundVoid> voids;
  if (range)
    voids = doubt_values(dataset, state->raster.name, {0, 0, state->grid.columns, state->grid.rows}, *range,
                         state->remarks);
  state->open = [files, voids] { return open_without(files, voids); };
  if (!voids.empty()) state->raster = state->open();
  return RasterSource(std::move(state));
}

RasterSource RasterSource::open_on_grid(const RasterFiles& files, const MapGrid& grid, RasterKind kind,
                                        const std::optional<ValueRange>& range) {
  const GdalCall quiet;
  const OpenRaster original = open_raster(files);
  GDALDataset& dataset = *original.dataset;
  require_one_value(dataset, original.name);
  const OGRSpatialReference& crs = require_crs(dataset, original.name);
  const GeoTransform t = require_north_up(dataset, original.name);
  require_metres(dataset, crs, t, original.name);
  const OGRSpatialReference target = system_of(grid);
  const double cell = std::sqrt(grid.cell_width * grid.cell_height);
  const auto own_cell = middle_cell_size(dataset, t, crs);
  const std::string shift =
      check_shift(crs, target, original.name,
                  std::max(cell * grid.metres_per_unit, own_cell ? std::min((*own_cell)[0], (*own_cell)[1]) : 0));
  const double east = grid.east(), south = grid.south();
  const auto extent = extent_on(dataset, t, crs, target);
  if (!extent || (*extent)[0] >= east || (*extent)[2] <= grid.west || (*extent)[1] >= grid.north ||
      (*extent)[3] <= south)
    throw InputError(original.name + ": does not overlap the elevation raster; give a raster of the same region");
  const std::string resampling = resampling_of(kind, cell, side_on(*extent, dataset), false);
  auto state = std::make_unique<State>();
  state->grid = grid;
  state->scale = dataset.GetRasterBand(1)->GetScale();
  state->offset = dataset.GetRasterBand(1)->GetOffset();
  state->unit = dataset.GetRasterBand(1)->GetUnitType();
  if (!shift.empty()) state->remarks.push_back(shift);
  std::vector<FoundVoid> voids;
  if (range) voids = doubt_values(dataset, original.name, window_under(dataset, t, crs, grid), *range, state->remarks);
  state->open = warping([files, voids] { return open_without(files, voids); }, grid, resampling);
  state->raster = state->open();
  return RasterSource(std::move(state));
}

Tile RasterSource::read(Window window) const {
  return read_window(state_->raster, state_->grid, window, state_->scale, state_->offset);
}

Tile RasterSource::read_flat(Window window) const {
  if (!state_->flat) return Tile(window.columns, window.rows, 0);
  Tile tile = read_window(*state_->flat, state_->grid, window, 1, 0);
  for (float& v : tile.value) v = v == 1 ? 1 : 0;
  return tile;
}

std::vector<std::string> class_names(const RasterFiles& files) {
  const GdalCall quiet;
  const OpenRaster raster = open_raster(files);
  std::vector<std::string> names;
  char** list = raster.dataset->GetRasterBand(1)->GetCategoryNames();
  for (char** name = list; name && *name; ++name) names.emplace_back(*name);
  return names;
}

std::vector<fs::path> files_behind(const RasterFiles& files) {
  const GdalCall quiet;
  std::vector<fs::path> list;
  for (const fs::path& file : files.file) {
    const OpenRaster raster = open_raster(file);
    char** names = raster.dataset->GetFileList();
    std::error_code ignored;
    if (file.extension() == ".zip") list.push_back(file);
    for (char** name = names; name && *name; ++name)
      if (fs::is_regular_file(*name, ignored)) list.emplace_back(*name);
    CSLDestroy(names);
  }
  return list;
}

}  // namespace gonogo::terrain
