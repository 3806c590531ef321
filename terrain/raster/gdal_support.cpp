#include "terrain/raster/gdal_support.h"

#include <cpl_error.h>

#include <algorithm>

namespace gonogo::terrain {

GdalCall::GdalCall() {
  static const bool registered = [] {
    GDALAllRegister();
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

bool GdalCall::failed() const { return CPLGetLastErrorType() >= CE_Failure; }

}  // namespace gonogo::terrain
