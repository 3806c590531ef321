// Shared by the .cpp files of this folder only: GDAL handles and its last error.
#pragma once
#include <gdal_priv.h>

#include <memory>
#include <string>

namespace gonogo::terrain {

struct CloseDataset {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using DatasetHandle = std::unique_ptr<GDALDataset, CloseDataset>;

/// Drivers registered once; GDAL's messages kept for ours instead of printed. Alive while GDAL is called.
class GdalCall {
 public:
  GdalCall();
  ~GdalCall();
  GdalCall(const GdalCall&) = delete;
  GdalCall& operator=(const GdalCall&) = delete;
  /// What GDAL said last, in one line without a full stop; "no reason given" when it said nothing.
  std::string message() const;
  bool failed() const;
  bool warned() const;  // or failed
};

}  // namespace gonogo::terrain
