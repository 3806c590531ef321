#include "terrain/raster/derived_dataset.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gonogo::terrain {
namespace {

/// One band on the grid of another dataset, which must outlive it.
class OnGridOf : public GDALDataset {
 public:
  explicit OnGridOf(GDALDataset& source) : source_(&source) {
    nRasterXSize = source.GetRasterXSize();
    nRasterYSize = source.GetRasterYSize();
    eAccess = GA_ReadOnly;
  }
  void set_band(GDALRasterBand* band) { SetBand(1, band); }  // owned by GDALDataset
  CPLErr GetGeoTransform(double* transform) override { return source_->GetGeoTransform(transform); }
  const OGRSpatialReference* GetSpatialRef() const override { return source_->GetSpatialRef(); }

 private:
  GDALDataset* source_;
};

class WithoutVoids : public GDALRasterBand {
 public:
  WithoutVoids(GDALDataset* owner, GDALRasterBand& source, const std::vector<FoundVoid>& voids) : source_(&source) {
    for (const FoundVoid& found : voids) void_.push_back(found.value);
    poDS = owner;
    nBand = 1;
    eDataType = GDT_Float32;
    source.GetBlockSize(&nBlockXSize, &nBlockYSize);
  }
  double GetNoDataValue(int* has) override {
    if (has) *has = TRUE;
    return std::numeric_limits<double>::quiet_NaN();
  }
  double GetScale(int* has) override { return source_->GetScale(has); }
  double GetOffset(int* has) override { return source_->GetOffset(has); }

 protected:
  CPLErr IReadBlock(int across, int down, void* data) override {
    int columns = 0, rows = 0;
    GetActualBlockSize(across, down, &columns, &rows);
    const int left = across * nBlockXSize, top = down * nBlockYSize;
    auto* value = static_cast<float*>(data);
    std::vector<unsigned char> valid(std::size_t(nBlockXSize) * std::size_t(nBlockYSize));
    if (source_->RasterIO(GF_Read, left, top, columns, rows, value, columns, rows, GDT_Float32, 4,
                          GSpacing(4) * nBlockXSize, nullptr) != CE_None ||
        source_->GetMaskBand()->RasterIO(GF_Read, left, top, columns, rows, valid.data(), columns, rows, GDT_Byte, 1,
                                         nBlockXSize, nullptr) != CE_None)
      return CE_Failure;
    for (std::size_t i = 0; i < valid.size(); ++i)
      if (!valid[i] || std::find(void_.begin(), void_.end(), value[i]) != void_.end())
        value[i] = std::numeric_limits<float>::quiet_NaN();
    return CE_None;
  }

 private:
  GDALRasterBand* source_;
  std::vector<float> void_;
};

class Runs : public GDALRasterBand {
 public:
  Runs(GDALDataset* owner, std::shared_ptr<const CellRuns> runs) : runs_(std::move(runs)) {
    poDS = owner;
    nBand = 1;
    eDataType = GDT_Byte;
    nBlockXSize = owner->GetRasterXSize();
    nBlockYSize = 1;
  }

 protected:
  CPLErr IReadBlock(int, int row, void* data) override {
    auto* value = static_cast<unsigned char*>(data);
    std::fill_n(value, nBlockXSize, 0);
    for (const auto& [begin, end] : (*runs_)[std::size_t(row)]) std::fill(value + begin, value + end, 1);
    return CE_None;
  }

 private:
  std::shared_ptr<const CellRuns> runs_;
};

void put_over(OpenRaster& raster, std::unique_ptr<OnGridOf> derived) {
  raster.sources.push_back(std::move(raster.dataset));
  raster.dataset.reset(derived.release());
}

}  // namespace

void leave_out_voids(OpenRaster& raster, const std::vector<FoundVoid>& voids) {
  auto derived = std::make_unique<OnGridOf>(*raster.dataset);
  derived->set_band(new WithoutVoids(derived.get(), *raster.dataset->GetRasterBand(1), voids));
  put_over(raster, std::move(derived));
}

void mark_runs(OpenRaster& raster, const std::shared_ptr<const CellRuns>& runs) {
  auto derived = std::make_unique<OnGridOf>(*raster.dataset);
  derived->set_band(new Runs(derived.get(), runs));
  put_over(raster, std::move(derived));
}

}  // namespace gonogo::terrain
