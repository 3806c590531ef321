#include "terrain/raster/raster_warp.h"

#include <cpl_string.h>
#include <gdal_utils.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <limits>

#include "base/error.h"
#include "base/line.h"
#include "terrain/raster/ground_scale.h"

namespace gonogo::terrain {
namespace {

constexpr double kScaleTolerance = 0.01;  // of a map's metres against the ground's
constexpr double kFarScale = 0.03;        // the same of a system that was asked for
constexpr double kWidest = 12;            // [deg] of longitude on one UTM grid: 0.5 % of scale at its edges
constexpr double kPolar = 84;             // [deg] beyond which UTM is not defined

using Transformation = std::unique_ptr<OGRCoordinateTransformation>;

/// Ground size of the cell at (column, row) [m]: {eastward, southward}, or nothing when it has no place on the ground.
std::optional<std::array<double, 2>> ground_size(const OGRSpatialReference& crs,
                                                 OGRCoordinateTransformation& to_degrees, const GeoTransform& t,
                                                 double column, double row) {
  std::array<std::array<double, 2>, 3> place;
  const std::array<std::array<double, 2>, 3> cells = {{{column, row}, {column + 1, row}, {column, row + 1}}};
  for (std::size_t i = 0; i < 3; ++i) {
    double x = t.value[0] + t.value[1] * cells[i][0], y = t.value[3] + t.value[5] * cells[i][1];
    if (!to_degrees.Transform(1, &x, &y) || !std::isfinite(x) || !std::isfinite(y) || std::abs(y) > 90)
      return std::nullopt;
    place[i] = {x, y};
  }
  const double a = crs.GetSemiMajor(), f = crs.GetInvFlattening();
  return std::array<double, 2>{ground_distance(place[0], place[1], a, f), ground_distance(place[0], place[2], a, f)};
}

/// Corners and middles of the sides and the middle of a raster, as cells inside it.
std::vector<std::array<double, 2>> probes(int columns, int rows) {
  std::vector<std::array<double, 2>> list;
  for (const double y : {0.0, 0.5, 1.0})
    for (const double x : {0.0, 0.5, 1.0}) list.push_back({x * (columns - 1), y * (rows - 1)});
  return list;
}

/// How far the map's metres are off the ground's at the worst place: |ground / map - 1|. Infinite where a place has
/// none.
double scale_error(const OGRSpatialReference& crs, OGRCoordinateTransformation& to_degrees, int columns, int rows,
                   const GeoTransform& t) {
  const double metres = crs.GetLinearUnits();
  double worst = 0;
  for (const auto& [column, row] : probes(columns, rows)) {
    const auto size = ground_size(crs, to_degrees, t, column, row);
    if (!size) return std::numeric_limits<double>::infinity();
    worst = std::max(
        {worst, std::abs((*size)[0] / (t.value[1] * metres) - 1), std::abs((*size)[1] / (-t.value[5] * metres) - 1)});
  }
  return worst;
}

/// Whether the map's metres are the ground's within the tolerance everywhere.
bool in_ground_metres(const OGRSpatialReference& crs, OGRCoordinateTransformation& to_degrees, GDALDataset& dataset,
                      const GeoTransform& t) {
  return crs.IsProjected() &&
         scale_error(crs, to_degrees, dataset.GetRasterXSize(), dataset.GetRasterYSize(), t) <= kScaleTolerance;
}

OGRSpatialReference traditional(OGRSpatialReference crs) {
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

OGRSpatialReference wished_system(const std::string& text) {
  OGRSpatialReference crs;
  GdalCall call;
  if (crs.SetFromUserInput(text.c_str()) != OGRERR_NONE || !crs.IsProjected())
    throw InputError("the region's grid: \"" + text +
                     "\" is no projected coordinate system that PROJ knows; give for example \"EPSG:32611\"");
  return traditional(crs);
}

/// UTM of the raster's own datum, on a sphere the same without its scale of 0.9996, or UPS near a pole (parameters of
/// EPSG 5041 and 5042).
OGRSpatialReference metric_system(const OGRSpatialReference& crs, double longitude, double latitude) {
  OGRSpatialReference target;
  target.SetProjCS("map grid");
  target.CopyGeogCSFrom(&crs);
  if (std::abs(latitude) > kPolar) {
    target.SetPS(latitude > 0 ? 90 : -90, 0, 0.994, 2e6, 2e6);
    target.SetProjCS(latitude > 0 ? "polar stereographic north" : "polar stereographic south");
  } else {
    const double turned = longitude - 360 * std::floor((longitude + 180) / 360);
    const int zone = std::clamp(int(std::floor((turned + 180) / 6)) + 1, 1, 60);
    const char* datum = crs.GetAttrValue("GEOGCS");
    if (crs.GetInvFlattening() == 0) {  // PROJ has no UTM on spheres
      target.SetTM(0, 6 * zone - 183, 1, 5e5, 0);
      target.SetProjCS(line("%s / transverse Mercator about %d", datum ? datum : "sphere", 6 * zone - 183).c_str());
      return traditional(target);
    }
    target.SetUTM(zone, latitude >= 0);
    target.SetProjCS(
        line("%s / UTM zone %d%c", datum ? datum : "unknown datum", zone, latitude >= 0 ? 'N' : 'S').c_str());
    target.AutoIdentifyEPSG();
  }
  return traditional(target);
}

/// Three significant digits.
double rounded_cell(double size) {
  const double unit = std::pow(10, std::floor(std::log10(size)) - 2);
  return std::round(size / unit) * unit;
}

MapGrid grid_over(const std::array<double, 4>& extent, const OGRSpatialReference& crs, double cell_m,
                  const std::string& name) {
  const double cell = cell_m / crs.GetLinearUnits();
  const double west = std::floor(extent[0] / cell), north = std::ceil(extent[3] / cell);
  const double columns = std::ceil(extent[2] / cell) - west, rows = north - std::floor(extent[1] / cell);
  if (!(columns >= 1 && rows >= 1 && columns < 1e6 && rows < 1e6))
    throw InputError(
        line("%s: a grid of %g m cells over it would have %g x %g cells; choose larger cells with "
             "\"grid\" in the region",
             name.c_str(), cell_m, columns, rows));
  return describe_grid(int(columns), int(rows), crs, {{west * cell, cell, 0, north * cell, 0, -cell}});
}

/// Degrees of longitude that a raster is wide.
double width_in_degrees(const std::array<double, 4>& degrees) {
  const double width = degrees[2] - degrees[0];
  return width < 0 ? width + 360 : width;
}

/// Refuses a system whose metres are not the ground's on this grid.
void require_near(const OGRSpatialReference& crs, const MapGrid& grid, const std::string& name) {
  OGRSpatialReference degrees;
  degrees.CopyGeogCSFrom(&crs);
  degrees = traditional(degrees);
  const Transformation to_degrees(OGRCreateCoordinateTransformation(&crs, &degrees));
  const GeoTransform t = {{grid.west, grid.cell_width, 0, grid.north, 0, -grid.cell_height}};
  const double error =
      to_degrees ? scale_error(crs, *to_degrees, grid.columns, grid.rows, t) : std::numeric_limits<double>::infinity();
  if (error <= kFarScale) return;
  throw InputError(
      name + ": the grid's system \"" + grid.crs_name + "\" belongs to another part of the globe, " +
      (std::isfinite(error) ? line("its metres are %.3g %% off those of the ground there", 100 * error)
                            : "in which the raster has no place") +
      line("; at most %g %% will do: choose the UTM zone of the region, or leave \"crs\" out", 100 * kFarScale));
}

}  // namespace

std::optional<std::array<double, 2>> middle_cell_size(GDALDataset& dataset, const GeoTransform& t,
                                                      const OGRSpatialReference& crs) {
  OGRSpatialReference degrees;
  degrees.CopyGeogCSFrom(&crs);
  degrees = traditional(degrees);
  const Transformation to_degrees(OGRCreateCoordinateTransformation(&crs, &degrees));
  if (!to_degrees) return std::nullopt;
  return ground_size(crs, *to_degrees, t, dataset.GetRasterXSize() / 2.0 - 0.5, dataset.GetRasterYSize() / 2.0 - 0.5);
}

std::optional<std::array<double, 4>> extent_on(GDALDataset& dataset, const GeoTransform& t,
                                               const OGRSpatialReference& from, const OGRSpatialReference& to) {
  const Transformation transformation(OGRCreateCoordinateTransformation(&from, &to));
  std::array<double, 4> out;
  const double east = t.value[0] + t.value[1] * dataset.GetRasterXSize();
  const double south = t.value[3] + t.value[5] * dataset.GetRasterYSize();
  if (!transformation ||
      !transformation->TransformBounds(t.value[0], south, east, t.value[3], &out[0], &out[1], &out[2], &out[3], 21))
    return std::nullopt;
  return out;
}

std::optional<MapGrid> grid_for(const OpenRaster& raster, const OGRSpatialReference& crs, const GeoTransform& t,
                                const GridWish& wish) {
  GdalCall call;
  GDALDataset& dataset = *raster.dataset;
  const auto refuse = [&](const std::string& why) { return InputError(raster.name + ": " + why); };
  if (!crs.IsProjected() && !crs.IsGeographic())
    throw refuse(
        "is in a coordinate system that is neither a map projection nor longitude and latitude; give it in one");
  OGRSpatialReference degrees;
  degrees.CopyGeogCSFrom(&crs);
  degrees = traditional(degrees);
  const Transformation to_degrees(OGRCreateCoordinateTransformation(&crs, &degrees));
  if (!to_degrees)
    throw refuse("its coordinate system cannot be related to longitude and latitude (" + call.message() + ")");
  if (wish.crs.empty() && wish.cell_size == 0 && in_ground_metres(crs, *to_degrees, dataset, t)) return std::nullopt;
  const double middle_column = dataset.GetRasterXSize() / 2.0, middle_row = dataset.GetRasterYSize() / 2.0;
  const auto size = ground_size(crs, *to_degrees, t, middle_column - 0.5, middle_row - 0.5);
  if (!size || !((*size)[0] > 0 && (*size)[1] > 0))
    throw refuse("its cells have no size on the ground; latitudes must lie between -90 and 90 degrees");
  double x = t.value[0] + t.value[1] * middle_column, y = t.value[3] + t.value[5] * middle_row;
  to_degrees->Transform(1, &x, &y);
  OGRSpatialReference target;
  if (!wish.crs.empty())
    target = wished_system(wish.crs);
  else if (crs.IsProjected() && wish.cell_size > 0 && in_ground_metres(crs, *to_degrees, dataset, t))
    target = traditional(crs);
  else
    target = metric_system(crs, x, y);
  const auto around = extent_on(dataset, t, crs, degrees);
  const bool polar = std::abs(y) > kPolar;
  if (wish.crs.empty() && !polar && around && width_in_degrees(*around) > kWidest)
    throw refuse(
        line("is %.3g degrees of longitude wide, at most %g fit on one grid in metres; cut it with gdalwarp -te, "
             "or name a projection with \"grid\" in the region",
             width_in_degrees(*around), kWidest));
  const auto extent = extent_on(dataset, t, crs, target);
  if (!extent) throw refuse("cannot be carried over to the map's grid (" + call.message() + ")");
  const double cell = wish.cell_size > 0 ? wish.cell_size : rounded_cell(std::sqrt((*size)[0] * (*size)[1]));
  const MapGrid grid = grid_over(*extent, target, cell, raster.name);
  if (!wish.crs.empty()) require_near(target, grid, raster.name);
  return grid;
}

void require_known_shift(const OGRSpatialReference& from, const OGRSpatialReference& to, const std::string& name) {
  GdalCall call;
  OGRCoordinateTransformationOptions options;
  options.SetBallparkAllowed(false);
  const Transformation exact(OGRCreateCoordinateTransformation(&from, &to, options));
  if (exact) return;
  const char *here = from.GetName(), *there = to.GetName();
  throw InputError(name + ": is in \"" + (here ? here : "?") + "\", and how that datum lies to the one of \"" +
                   (there ? there : "?") +
                   "\" is not known here, so that it could be off by hundreds of metres; install PROJ's grids "
                   "(projsync) or bring both rasters to one datum");
}

void warp_to(OpenRaster& raster, const MapGrid& grid, const std::string& resampling) {
  char edges[4][40];
  const double east = grid.west + grid.columns * grid.cell_width, south = grid.north - grid.rows * grid.cell_height;
  const double corners[4] = {grid.west, south, east, grid.north};
  for (int i = 0; i < 4; ++i) std::snprintf(edges[i], sizeof edges[i], "%.17g", corners[i]);
  const std::string columns = std::to_string(grid.columns), rows = std::to_string(grid.rows);
  // Float32 with NaN as nodata: a code such as 0 stays a value and what the source does not cover does not
  // become one. -et 0: exact transformation, so that a cell's value does not depend on the window it is read in.
  // Overviews of the source are not read: they are pictures, not measurements.
  // Interpolation without GDAL's wider kernels for cells that are narrower one way (degrees far from the equator):
  // those do not give a plane back as a plane, and slopes would be off by half a degree.
  CPLStringList words;
  const std::vector<std::string> asked = {
      "-of", "VRT", "-t_srs",   grid.crs_wkt, "-te",     edges[0],     edges[1], edges[2], edges[3], "-ts",  columns,
      rows,  "-r",  resampling, "-ot",        "Float32", "-dstnodata", "nan",    "-et",    "0",      "-ovr", "NONE"};
  for (const std::string& word : asked) words.AddString(word.c_str());
  if (resampling == "cubic" || resampling == "bilinear")
    for (const char* word : {"-wo", "XSCALE=1", "-wo", "YSCALE=1"}) words.AddString(word);
  GdalCall call;
  GDALWarpAppOptions* options = GDALWarpAppOptionsNew(words.List(), nullptr);
  GDALDatasetH source = raster.dataset.get();
  int usage_error = 0;
  DatasetHandle warped(GDALDataset::FromHandle(GDALWarp("", nullptr, 1, &source, options, &usage_error)));
  GDALWarpAppOptionsFree(options);
  if (!warped) throw InputError(raster.name + ": cannot be warped to the map's grid (" + call.message() + ")");
  raster.sources.push_back(std::move(raster.dataset));
  raster.dataset = std::move(warped);
}

}  // namespace gonogo::terrain
