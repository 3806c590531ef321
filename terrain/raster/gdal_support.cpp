#include "terrain/raster/gdal_support.h"

#include <cpl_conv.h>
#include <cpl_error.h>

#include <algorithm>
#include <cstdint>

namespace gonogo::terrain {

GdalCall::GdalCall() {
  static const bool registered = [] {
    GDALAllRegister();
    // GDAL keeps decoded blocks; by default up to 5 % of the machine's memory, which maps do not need.
    if (!CPLGetConfigOption("GDAL_CACHEMAX", nullptr)) GDALSetCacheMax64(std::int64_t(128) << 20);
    return true;
  }();
  (void)registered;
  CPLPushErrorHandler(CPLQuietErrorHandler);
  CPLErrorReset();
}

GdalCall::~GdalCall() { CPLPopErrorHandler(); }

std::string GdalCall::message() const {
  std::string text = CPLGetLastErrorMsg();
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text.empty() ? "no reason given" : text;
}

bool GdalCall::warned() const { return CPLGetLastErrorType() >= CE_Warning; }

bool GdalCall::failed() const { return CPLGetLastErrorType() >= CE_Failure; }

}  // namespace gonogo::terrain
