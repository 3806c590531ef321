#include "terrain/raster/raster_open.h"

#include <cpl_string.h>
#include <gdal_utils.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <optional>

#include "base/error.h"
#include "base/format.h"
#include "base/shell.h"
#include "base/units.h"
#include "terrain/raster/open_file.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;
namespace {

/// A band of a raster, mirrored so that its first row is the northernmost and its columns run eastward.
class MirroredBand : public GDALRasterBand {
 public:
  MirroredBand(GDALDataset* owner, GDALRasterBand& source, bool rows, bool columns)
      : source_(&source), rows_(rows), columns_(columns) {
    poDS = owner;
    nBand = 1;
    eDataType = source.GetRasterDataType();
    nBlockXSize = owner->GetRasterXSize();
    nBlockYSize = 1;
  }
  double GetNoDataValue(int* has) override { return source_->GetNoDataValue(has); }
  double GetScale(int* has) override { return source_->GetScale(has); }
  double GetOffset(int* has) override { return source_->GetOffset(has); }
  const char* GetUnitType() override { return source_->GetUnitType(); }
  char** GetCategoryNames() override { return source_->GetCategoryNames(); }
  GDALColorTable* GetColorTable() override { return source_->GetColorTable(); }
  GDALColorInterp GetColorInterpretation() override { return source_->GetColorInterpretation(); }
  int GetMaskFlags() override { return mask_ ? GMF_PER_DATASET : source_->GetMaskFlags(); }
  GDALRasterBand* GetMaskBand() override { return mask_ ? mask_.get() : GDALRasterBand::GetMaskBand(); }
  void set_mask(std::unique_ptr<MirroredBand> mask) { mask_ = std::move(mask); }

 protected:
  CPLErr IReadBlock(int, int row, void* data) override {
    const int size = GDALGetDataTypeSizeBytes(eDataType), from = rows_ ? poDS->GetRasterYSize() - 1 - row : row;
    auto* first = static_cast<GByte*>(data) + (columns_ ? std::size_t(nBlockXSize - 1) * std::size_t(size) : 0);
    return source_->RasterIO(GF_Read, 0, from, nBlockXSize, 1, first, nBlockXSize, 1, eDataType,
                             columns_ ? -size : size, 0, nullptr);
  }

 private:
  GDALRasterBand* source_;
  bool rows_, columns_;
  std::unique_ptr<MirroredBand> mask_;
};

/// The bands of another dataset, which must outlive it, on a north-up grid.
class Mirrored : public GDALDataset {
 public:
  Mirrored(GDALDataset& source, const GeoTransform& t) : source_(&source), transform_(t) {
    nRasterXSize = source.GetRasterXSize();
    nRasterYSize = source.GetRasterYSize();
    eAccess = GA_ReadOnly;
    SetDescription(source.GetDescription());
    const bool rows = t.value[5] > 0, columns = t.value[1] < 0;
    for (int b = 1; b <= source.GetRasterCount(); ++b) {
      GDALRasterBand& band = *source.GetRasterBand(b);
      auto mirrored = std::make_unique<MirroredBand>(this, band, rows, columns);
      if (!(band.GetMaskFlags() & (GMF_NODATA | GMF_ALL_VALID)))
        mirrored->set_mask(std::make_unique<MirroredBand>(this, *band.GetMaskBand(), rows, columns));
      SetBand(b, mirrored.release());  // owned by GDALDataset
    }
    if (rows) transform_.value[3] += nRasterYSize * t.value[5];
    if (columns) transform_.value[0] += nRasterXSize * t.value[1];
    transform_.value[5] = -std::abs(t.value[5]);
    transform_.value[1] = std::abs(t.value[1]);
  }
  CPLErr GetGeoTransform(double* transform) override {
    std::copy(std::begin(transform_.value), std::end(transform_.value), transform);
    return CE_None;
  }
  const OGRSpatialReference* GetSpatialRef() const override { return source_->GetSpatialRef(); }
  char** GetFileList() override { return source_->GetFileList(); }

 private:
  GDALDataset* source_;
  GeoTransform transform_;
};

bool is_straight(const GeoTransform& t) {
  const double turned = 1e-9 * std::hypot(t.value[1], t.value[5]);
  return std::abs(t.value[2]) <= turned && std::abs(t.value[4]) <= turned;
}

/// For rasters whose rows run northward, as in NetCDF and GRIB, or whose columns run westward.
void mirror_to_north_up(OpenRaster& raster) {
  GeoTransform t;
  GDALDataset& dataset = *raster.dataset;
  if (dataset.GetGeoTransform(t.value) != CE_None || !is_straight(t) || t.value[1] == 0 || t.value[5] == 0) return;
  if (t.value[1] > 0 && t.value[5] < 0) return;
  auto mirrored = std::make_unique<Mirrored>(dataset, t);
  raster.sources.push_back(std::move(raster.dataset));
  raster.dataset.reset(mirrored.release());
}

OpenRaster open_one(const fs::path& path) {
  OpenRaster raster;
  raster.name = path.string();
  raster.dataset = open_file(path, FileKind::raster);
  if (raster.dataset->GetRasterCount() < 1)
    throw InputError(raster.name +
                     ": holds no raster band, or several rasters; take one of those that gdalinfo lists out with "
                     "gdal_translate");
  mirror_to_north_up(raster);
  return raster;
}

bool same_place_system(GDALDataset& a, GDALDataset& b) {
  const OGRSpatialReference *first = a.GetSpatialRef(), *second = b.GetSpatialRef();
  if (!first || !second) return first == second;
  return first->IsSame(second);
}

/// "EPSG:26911", or the whole description where no authority has a number for it.
std::string code_of(const OGRSpatialReference& crs) {
  const char *authority = crs.GetAuthorityName(nullptr), *code = crs.GetAuthorityCode(nullptr);
  return authority && code ? std::string(authority) + ":" + code : export_wkt(crs);
}

/// How to bring a tile to the system of the first.
std::string how_to_bring(GDALDataset& tile, const std::string& name, const OGRSpatialReference* system) {
  if (!system || !tile.GetSpatialRef()) return "name the system of each with gdal_translate -a_srs";
  return "bring it there with: " +
         command_on("gdalwarp -r bilinear -t_srs " + shell_word(code_of(*system)), tile, name, "tile.tif");
}

/// Puts tiles together. GDAL leaves out tiles that do not fit, with a warning; here they are refused.
void join_tiles(OpenRaster& raster, const RasterFiles& files) {
  std::vector<GDALDatasetH> handles;
  for (std::size_t i = 0; i < raster.sources.size(); ++i) {
    if (!same_place_system(*raster.sources.front(), *raster.sources[i]))
      throw InputError(
          files.file[i].string() + ": is not in the coordinate system of " + files.file[0].string() +
          ", and tiles of one raster must share it; " +
          how_to_bring(*raster.sources[i], files.file[i].string(), raster.sources.front()->GetSpatialRef()));
    require_north_up(*raster.sources[i], files.file[i].string());
    handles.push_back(raster.sources[i].get());
  }
  const char* arguments[] = {"-resolution", "highest", nullptr};
  GdalCall call;
  GDALBuildVRTOptions* options = GDALBuildVRTOptionsNew(const_cast<char**>(arguments), nullptr);
  int usage_error = 0;
  raster.dataset.reset(
      GDALDataset::FromHandle(GDALBuildVRT("", int(handles.size()), handles.data(), nullptr, options, &usage_error)));
  GDALBuildVRTOptionsFree(options);
  if (!raster.dataset) throw InputError(raster.name + ": cannot be put together (" + call.message() + ")");
  if (call.warned())
    throw InputError(raster.name + ": do not fit together (" + call.message() +
                     "); give tiles of one raster, alike in type and bands");
}

}  // namespace

OpenRaster open_raster(const RasterFiles& files) {
  OpenRaster raster;
  raster.name = files.name();
  if (files.file.empty()) throw InputError("a raster without a file; name one");
  if (files.file.size() == 1) return open_one(files.file.front());
  std::vector<DatasetHandle> mirrored;
  for (const fs::path& file : files.file) {
    OpenRaster tile = open_one(file);
    raster.sources.push_back(std::move(tile.dataset));
    for (DatasetHandle& below : tile.sources) mirrored.push_back(std::move(below));
  }
  join_tiles(raster, files);
  raster.sources.insert(raster.sources.begin(), std::make_move_iterator(mirrored.begin()),
                        std::make_move_iterator(mirrored.end()));
  return raster;
}

std::string command_on(const std::string& program, GDALDataset& dataset, const std::string& name,
                       const std::string& rest) {
  static const std::string tiles = RasterFiles(std::vector<fs::path>(2)).name();
  const std::string inside = dataset.GetDescription();
  std::string file = shell_word(inside.rfind("/vsizip/", 0) == 0 ? inside : name);
  if (name.ends_with(tiles)) file = "<tile>";
  return program + " " + file + " " + rest;
}

const OGRSpatialReference& require_crs(GDALDataset& dataset, const std::string& name) {
  const GdalCall call;
  const OGRSpatialReference* crs = dataset.GetSpatialRef();
  if (call.failed())
    throw InputError(name + ": its coordinate system cannot be read (" + call.message() +
                     "); the file is damaged, fetch it again");
  const bool has_points = dataset.GetGCPCount() > 0;
  if (has_points || ((!crs || crs->IsEmpty()) && dataset.GetMetadata("GEOLOCATION")))
    throw InputError(
        name + ": is placed by " + (has_points ? "ground control points" : "a place for every cell") +
        ", not by a grid; lay it on one with: " + command_on("gdalwarp -r bilinear", dataset, name, "on_a_grid.tif"));
  if (!crs || crs->IsEmpty())
    throw InputError(name + ": names no coordinate system; find out which one it is in, and write it in with: " +
                     command_on("gdal_translate -a_srs EPSG:<code>", dataset, name, "with_system.tif") +
                     ". A grid that nobody related to the globe takes -a_srs " +
                     "'LOCAL_CS[\"site\",UNIT[\"metre\",1]]'");
  return *crs;
}

GeoTransform require_north_up(GDALDataset& dataset, const std::string& name) {
  GeoTransform t;
  if (dataset.GetGeoTransform(t.value) != CE_None)
    throw InputError(name +
                     ": does not say where its cells lie (no geotransform); name the edges of its ground with: " +
                     command_on("gdal_translate -a_ullr <west> <north> <east> <south>", dataset, name, "placed.tif"));
  if (!is_straight(t) || !(t.value[1] > 0) || !(t.value[5] < 0))
    throw InputError(name + ": its rows do not run west to east (rotated geotransform); straighten it with: " +
                     command_on("gdalwarp -r bilinear", dataset, name, "north_up.tif"));
  return t;
}

double vertical_metres(GDALRasterBand& band, const std::string& name) {
  std::string unit = band.GetUnitType();
  std::transform(unit.begin(), unit.end(), unit.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  for (const char* known : {"", "m", "metre", "meter", "metres", "meters"})
    if (unit == known) return 1;
  for (const char* known : {"ft", "foot", "feet", "international foot"})
    if (unit == known) return 0.3048;
  for (const char* known : {"us survey foot", "us_survey_foot", "us-ft", "ftus", "us survey feet"})
    if (unit == known) return 1200.0 / 3937.0;
  throw InputError(name + ": heights are in \"" + unit + "\"; metres and feet are understood; convert it with: " +
                   command_on("gdal_calc.py -A", *band.GetDataset(), name,
                              "--calc=\"A*<metres>\" --type=Float32 --outfile=metres.tif"));
}

MapGrid describe_grid(int columns, int rows, const OGRSpatialReference& crs, const GeoTransform& t) {
  MapGrid grid;
  grid.columns = columns;
  grid.rows = rows;
  grid.west = t.value[0];
  grid.north = t.value[3];
  grid.cell_width = t.value[1];
  grid.cell_height = -t.value[5];
  const char* unit = nullptr;
  grid.metres_per_unit = crs.GetLinearUnits(&unit);
  if (unit) grid.unit_name = unit;
  grid.crs_wkt = export_wkt(crs);
  grid.body_radius = crs.GetSemiMajor();
  if (const char* name = crs.GetName()) grid.crs_name = name;
  if (crs.GetAuthorityName(nullptr) && crs.GetAuthorityCode(nullptr)) grid.crs_code = code_of(crs);
  return grid;
}

namespace {

constexpr double kFoot = 0.3048, kSurveyFoot = 1200.0 / 3937.0;  // [m]

void refuse_complex(GDALDataset& dataset, const std::string& name) {
  const GDALDataType type = dataset.GetRasterBand(1)->GetRasterDataType();
  if (GDALDataTypeIsComplex(type))
    throw InputError(name + ": holds complex values (" + GDALGetDataTypeName(type) +
                     "), of which nobody said what counts; give a raster of real values");
}

/// Metres per vertical unit; nothing when the coordinate system has no vertical part.
std::optional<double> unit_of_system(const OGRSpatialReference& crs) {
  if (!crs.IsVertical()) return std::nullopt;
  return crs.GetTargetLinearUnits("VERT_CS", nullptr);
}

std::string unit_name(double metres) {
  if (metres == 1) return "metres";
  return std::abs(metres / kFoot - 1) < 1e-3 ? "feet" : line("units of %g m", metres);
}

/// International and survey foot count as the same here; the difference is 2e-6.
bool differ(double a, double b) { return std::abs(a / b - 1) > 1e-3; }

/// With a scale of 0 every cell would have one value.
void refuse_scale(GDALDataset& dataset, const std::string& name) {
  const double scale = dataset.GetRasterBand(1)->GetScale(), offset = dataset.GetRasterBand(1)->GetOffset();
  if (scale != 0 && std::isfinite(scale) && std::isfinite(offset)) return;
  throw InputError(name +
                   line(": names a scale of %g and an offset of %g for its values, and a scale other than 0 is needed; "
                        "set them with: ",
                        scale, offset) +
                   command_on("gdal_translate -a_scale <scale> -a_offset <offset>", dataset, name, "scaled.tif"));
}

}  // namespace

void require_metres(GDALDataset& dataset, const OGRSpatialReference& crs, const GeoTransform& t,
                    const std::string& name) {
  constexpr double kFinest = 0.05;  // side of a cell [units]: 5 km in degrees
  if (!crs.IsProjected() || std::max(t.value[1], -t.value[5]) > kFinest) return;
  const double east = t.value[0] + dataset.GetRasterXSize() * t.value[1];
  const double south = t.value[3] + dataset.GetRasterYSize() * t.value[5];
  if (t.value[0] < -180 || east > 360 || t.value[3] > 90 || south < -90) return;
  throw InputError(name +
                   line(": its cells of %g are said to be in %s, but lie from %g to %g and %g to %g, as "
                        "longitudes and latitudes do; if they are, say so with: ",
                        t.value[1], crs.GetName() ? crs.GetName() : "metres", t.value[0], east, south, t.value[3]) +
                   command_on("gdal_translate -a_srs EPSG:4326", dataset, name, "in_degrees.tif"));
}

void require_one_value(GDALDataset& dataset, const std::string& name) {
  refuse_complex(dataset, name);
  refuse_scale(dataset, name);
  if (dataset.GetRasterCount() >= 3 && dataset.GetRasterBand(1)->GetColorInterpretation() == GCI_RedBand)
    throw InputError(
        name +
        ": is a picture with bands of red, green and blue, whose colours are no values; give the raster that it shows");
}

void require_heights(GDALDataset& dataset, const std::string& name) {
  refuse_complex(dataset, name);
  refuse_scale(dataset, name);
  if (dataset.GetRasterCount() > 2)
    throw InputError(
        name +
        line(": has %d bands, and an elevation raster has one; a picture in colour tells no heights. If one "
             "band holds them, take it out with: ",
             dataset.GetRasterCount()) +
        command_on("gdal_translate -b 1", dataset, name, "heights.tif"));
  if (dataset.GetRasterBand(1)->GetColorTable())
    throw InputError(name +
                     ": has a colour table, so it holds classes or a picture, not heights; give an elevation raster");
  if (dataset.GetRasterCount() == 2 && dataset.GetRasterBand(2)->GetColorInterpretation() == GCI_AlphaBand &&
      !(dataset.GetRasterBand(1)->GetMaskFlags() & GMF_ALPHA))
    throw InputError(
        name +
        ": marks its voids by a second band that is transparent there, which counts for whole numbers of 8 "
        "and 16 bits alone; make the band a mask with: " +
        command_on("gdal_translate -b 1 -mask 2", dataset, name, "masked.tif"));
}

std::string remark_on_bands(GDALDataset& dataset, const std::string& name) {
  if (dataset.GetRasterCount() < 2 || dataset.GetRasterBand(2)->GetColorInterpretation() == GCI_AlphaBand) return "";
  const std::string first = dataset.GetRasterBand(1)->GetDescription(),
                    second = dataset.GetRasterBand(2)->GetDescription();
  return name + ": has two bands; the first" + (first.empty() ? "" : ", \"" + first + "\",") + " is taken for heights" +
         (second.empty() ? "" : ", \"" + second + "\" is not read") + ". If they are in the other, take it out with: " +
         command_on("gdal_translate -b 2", dataset, name, "heights.tif");
}

double height_unit(GDALDataset& dataset, const OGRSpatialReference& crs, const std::string& name,
                   const std::string& told, std::vector<std::string>& remarks) {
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  const std::optional<double> of_system = unit_of_system(crs);
  std::optional<double> of_band;
  if (!std::string(band.GetUnitType()).empty()) of_band = vertical_metres(band, name);
  const std::optional<double> said = of_band ? of_band : of_system;
  if (!told.empty()) {
    const double metres = told == "m" ? 1 : told == "ft" ? kFoot : kSurveyFoot;
    if (said && differ(*said, metres))
      remarks.push_back(name + ": heights are taken as " + unit_name(metres) + ", as was asked, though it says " +
                        unit_name(*said));
    return metres;
  }
  const std::string remedy =
      "; say which holds with \"unit\" of the elevation in the region, or --height-unit: m, ft or us-ft";
  if (of_band && of_system && differ(*of_band, *of_system))
    throw InputError(name + ": its band says that heights are in " + unit_name(*of_band) +
                     ", and its coordinate system that they are in " + unit_name(*of_system) + remedy);
  if (!said && crs.IsProjected() && differ(crs.GetLinearUnits(), 1))
    throw InputError(name + ": its grid is in " + unit_name(crs.GetLinearUnits()) +
                     ", and nothing says whether its heights are in metres or feet" + remedy);
  return said.value_or(1);
}

namespace {

constexpr double kScaleTolerance = 0.01;  // of a map's metres against the ground's
constexpr double kFarScale = 0.03;        // the same of a system that was asked for
constexpr double kWidest = 12;            // [deg] of longitude on one UTM grid: 0.5 % of scale at its edges
constexpr double kPolar = 84;             // [deg] beyond which UTM is not defined

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
  const OGRSpatialReference degrees = own_degrees(crs);
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
  if (crs.IsLocal())
    return std::array<double, 2>{t.value[1] * crs.GetLinearUnits(), -t.value[5] * crs.GetLinearUnits()};
  const OGRSpatialReference degrees = own_degrees(crs);
  const Transformation to_degrees(OGRCreateCoordinateTransformation(&crs, &degrees));
  if (!to_degrees) return std::nullopt;
  return ground_size(crs, *to_degrees, t, dataset.GetRasterXSize() / 2.0 - 0.5, dataset.GetRasterYSize() / 2.0 - 0.5);
}

namespace {

/// {west, south, east, north} in another coordinate system.
std::optional<std::array<double, 4>> turned(const std::array<double, 4>& in, const OGRSpatialReference& from,
                                            const OGRSpatialReference& to) {
  if (from.IsSame(&to)) return in;
  const Transformation transformation(OGRCreateCoordinateTransformation(&from, &to));
  std::array<double, 4> out;
  if (!transformation ||
      !transformation->TransformBounds(in[0], in[1], in[2], in[3], &out[0], &out[1], &out[2], &out[3], 21))
    return std::nullopt;
  return out;
}

}  // namespace

std::optional<std::array<double, 4>> extent_on(GDALDataset& dataset, const GeoTransform& t,
                                               const OGRSpatialReference& from, const OGRSpatialReference& to) {
  const double east = t.value[0] + t.value[1] * dataset.GetRasterXSize();
  const double south = t.value[3] + t.value[5] * dataset.GetRasterYSize();
  return turned({t.value[0], south, east, t.value[3]}, from, to);
}

std::optional<std::array<double, 4>> extent_on(const MapGrid& grid, const OGRSpatialReference& from,
                                               const OGRSpatialReference& to) {
  return turned({grid.west, grid.south(), grid.east(), grid.north}, from, to);
}

std::optional<MapGrid> grid_for(const OpenRaster& raster, const OGRSpatialReference& crs, const GeoTransform& t,
                                const GridWish& wish) {
  GdalCall call;
  GDALDataset& dataset = *raster.dataset;
  const auto refuse = [&](const std::string& why) { return InputError(raster.name + ": " + why); };
  if (crs.IsLocal()) {
    if (wish.crs.empty() && wish.cell_size == 0) return std::nullopt;
    throw refuse("is in a local system, which nobody related to the globe; leave \"grid\" out of the region");
  }
  if (!crs.IsProjected() && !crs.IsGeographic())
    throw refuse(
        "is in a coordinate system that is neither a map projection, nor longitude and latitude, nor a local one; give "
        "it in one");
  const OGRSpatialReference degrees = own_degrees(crs);
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
    throw refuse(line("is %.3g degrees of longitude wide, at most %g fit on one grid in metres; name a projection with "
                      "\"grid\" in the region, or cut it with: ",
                      width_in_degrees(*around), kWidest) +
                 command_on("gdalwarp -te <west> <south> <east> <north>", dataset, raster.name, "cut.tif"));
  const auto extent = extent_on(dataset, t, crs, target);
  if (!extent) throw refuse("cannot be carried over to the map's grid (" + call.message() + ")");
  const double cell = wish.cell_size > 0 ? wish.cell_size : rounded_cell(std::sqrt((*size)[0] * (*size)[1]));
  const MapGrid grid = grid_over(*extent, target, cell, raster.name);
  if (!wish.crs.empty()) require_near(target, grid, raster.name);
  return grid;
}

void warp_to(OpenRaster& raster, const MapGrid& grid, const std::string& resampling) {
  char edges[4][40];
  const double east = grid.east(), south = grid.south();
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
