#include "terrain/raster/gdal_support.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_http.h>
#include <cpl_string.h>
#include <ogr_srs_api.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/units.h"
#include "terrain/raster/open_file.h"

namespace gonogo::terrain {
namespace {

/// The one file that GDAL's /vsicurl/, /vsis3/ and their like may name.
constexpr const char* kCurlNames = "CPL_VSIL_CURL_ALLOWED_FILENAME";

/// Answers every request of GDAL in place of the network.
CPLHTTPResult* refuse_request(const char*, CSLConstList, GDALProgressFunc, void*, CPLHTTPFetchWriteFunc, void*, void*) {
  auto* answer = static_cast<CPLHTTPResult*>(CPLCalloc(1, sizeof(CPLHTTPResult)));
  answer->nStatus = 1;
  answer->pszErrBuf = CPLStrdup("the network is not used; --allow-network permits it");
  return answer;
}

/// Takes the table of coordinate systems that a Python wheel carries (scripts/build_wheel.sh), where there is one.
void use_carried_systems() {
  const char* share = std::getenv("GONOGO_SHARE");
  if (!share) return;
  const std::filesystem::path folder = std::filesystem::path(share) / "wheel";
  if (!std::filesystem::is_regular_file(folder / "proj.db")) return;
  const char* const folders[] = {folder.c_str(), nullptr};
  OSRSetPROJSearchPaths(folders);
}

}  // namespace

GdalCall::GdalCall() {
  static const bool prepared = [] {
    register_drivers();
    use_carried_systems();
    // GDAL keeps decoded blocks; by default up to 5 % of the machine's memory, which maps do not need.
    if (!CPLGetConfigOption("GDAL_CACHEMAX", nullptr)) GDALSetCacheMax64(std::int64_t(128) << 20);
    return true;
  }();
  (void)prepared;
  CPLPushErrorHandler(CPLQuietErrorHandler);
  CPLErrorReset();
  is_offline_ = !network_allowed();
  if (!is_offline_) return;
  CPLHTTPPushFetchCallback(&refuse_request, nullptr);
  if (const char* before = CPLGetThreadLocalConfigOption(kCurlNames, nullptr)) curl_names_ = before;
  CPLSetThreadLocalConfigOption(kCurlNames, "/vsicurl/none");
}

GdalCall::~GdalCall() {
  CPLPopErrorHandler();
  if (!is_offline_) return;
  CPLHTTPPopFetchCallback();
  CPLSetThreadLocalConfigOption(kCurlNames, curl_names_ ? curl_names_->c_str() : nullptr);
}

std::string GdalCall::message() const {
  std::string text = CPLGetLastErrorMsg();
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text.empty() ? "no reason given" : text;
}

bool GdalCall::warned() const { return CPLGetLastErrorType() >= CE_Warning; }

bool GdalCall::failed() const { return CPLGetLastErrorType() >= CE_Failure; }

void refuse_to_write(const std::filesystem::path& path, const GdalCall& call) {
  throw DeviceError(path.string() + ": cannot be written (" + call.message() + ")");
}

FixedDate::FixedDate() { CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", kDay); }
FixedDate::~FixedDate() { CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", nullptr); }

OGRSpatialReference system_of(const MapGrid& grid) {
  OGRSpatialReference crs;
  crs.importFromWkt(grid.crs_wkt.c_str());
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

OGRSpatialReference own_degrees(const OGRSpatialReference& crs) {
  OGRSpatialReference degrees;
  degrees.CopyGeogCSFrom(&crs);
  degrees.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return degrees;
}

OGRSpatialReference wgs84() {
  OGRSpatialReference crs;
  crs.importFromEPSG(4326);
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

std::string export_wkt(const OGRSpatialReference& crs) {
  char* text = nullptr;
  const char* const options[] = {"FORMAT=WKT2_2019", "MULTILINE=NO", nullptr};
  crs.exportToWkt(&text, options);
  std::string wkt = text ? text : "";
  CPLFree(text);
  return wkt;
}

double ground_distance(std::array<double, 2> from, std::array<double, 2> to, double semi_major,
                       double inverse_flattening) {
  const double f = inverse_flattening > 0 ? 1 / inverse_flattening : 0, e2 = f * (2 - f);
  const double latitude = (from[1] + to[1]) / 2 * kDegree, sine = std::sin(latitude), w2 = 1 - e2 * sine * sine;
  const double east = std::remainder(to[0] - from[0], 360.0) * kDegree, north = (to[1] - from[1]) * kDegree;
  return semi_major * std::hypot(north * (1 - e2) / (w2 * std::sqrt(w2)), east * std::cos(latitude) / std::sqrt(w2));
}

namespace {

Transformation exact_way(const OGRSpatialReference& from, const OGRSpatialReference& to) {
  OGRCoordinateTransformationOptions options;
  options.SetBallparkAllowed(false);
  return Transformation(OGRCreateCoordinateTransformation(&from, &to, options));
}

/// Whether a datum has the Earth's centre: by its ellipsoid, GRS 80 or WGS 84, unless PROJ knows that it lies farther
/// off.
bool is_geocentric(const OGRSpatialReference& crs) {
  constexpr double a = 6378137, inverse_f = 298.2572;
  if (std::abs(crs.GetSemiMajor() - a) > 0.01 || std::abs(crs.GetInvFlattening() - inverse_f) > 1e-3) return false;
  const OGRSpatialReference degrees = own_degrees(crs);
  const Transformation way = exact_way(degrees, wgs84());
  if (!way) return true;
  double west = 0, south = 0, east = 0, north = 0;
  crs.GetAreaOfUse(&west, &south, &east, &north, nullptr);
  const std::array<double, 2> here = {west > east ? 180 : (west + east) / 2, (south + north) / 2};
  std::array<double, 2> there = here;
  return way->Transform(1, &there[0], &there[1]) && ground_distance(here, there, a, inverse_f) <= kGeocentricShift;
}

}  // namespace

std::string check_shift(const OGRSpatialReference& from, const OGRSpatialReference& to, const std::string& name,
                        double cell) {
  const GdalCall call;
  if (from.IsSame(&to) || exact_way(from, to)) return "";
  const char *here = from.GetName(), *there = to.GetName();
  const std::string text = name + ": is in \"" + (here ? here : "?") + "\", and how that datum lies to the one of \"" +
                           (there ? there : "?") + "\" is not known here, so that it may be off by ";
  if (from.IsLocal() != to.IsLocal())
    throw InputError(name + ": is in \"" + (here ? here : "?") + "\" and the map in \"" + (there ? there : "?") +
                     "\", and a local system is not related to the globe; bring both into one system");
  const bool near = is_geocentric(from) && is_geocentric(to);
  if (near && kGeocentricShift <= 0.5 * cell) return text + line("up to %g m", kGeocentricShift);
  throw InputError(text +
                   (near ? line("up to %g m, more than half of a cell of %.3g m", kGeocentricShift, cell)
                         : std::string("hundreds of metres")) +
                   "; install PROJ's grids (projsync) or bring both to one datum");
}

DatasetHandle open_reduced(const std::filesystem::path& layer, double max_cells) {
  const GdalCall call;
  const auto open = [&](const char* const* options) {
    DatasetHandle dataset(GDALDataset::Open(layer.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY, nullptr, options));
    if (!dataset) throw DeviceError(layer.string() + ": cannot be read back (" + call.message() + ")");
    return dataset;
  };
  DatasetHandle dataset = open(nullptr);
  const int overviews = dataset->GetRasterBand(1)->GetOverviewCount();
  for (int o = 0; o < overviews; ++o) {
    if (double(dataset->GetRasterXSize()) * dataset->GetRasterYSize() <= max_cells) break;
    CPLStringList options;
    options.SetNameValue("OVERVIEW_LEVEL", std::to_string(o).c_str());
    dataset = open(options.List());
  }
  return dataset;
}

Transformation to_wgs84(const MapGrid& grid, const std::filesystem::path& path) {
  const GdalCall call;
  const OGRSpatialReference from = system_of(grid), to = wgs84();
  Transformation turn(OGRCreateCoordinateTransformation(&from, &to));
  if (!turn)
    throw InputError(path.string() +
                     ": this format holds longitude and latitude on WGS 84, to which no way is known from \"" +
                     grid.crs_name + "\"; write a GeoPackage (.gpkg)");
  return turn;
}

}  // namespace gonogo::terrain
