#include "terrain/raster/height_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "base/cancel.h"
#include "base/error.h"
#include "base/line.h"
#include "terrain/raster/flat_areas.h"

namespace gonogo::terrain {
namespace {

constexpr float kNoData = std::numeric_limits<float>::quiet_NaN();
constexpr std::array<float, 3> kSuspicious = {-999, -99, 0};
constexpr std::size_t kMaxCodes = 3;
constexpr double kCliff = 1.7320508;  // rise over run: 60 degrees

/// Counts of one suspicious value.
struct Suspect {
  std::uint64_t cells = 0, borders = 0, cliffs = 0;
};

class Voids {
 public:
  Voids(const HeightScale& scale, int columns) : scale_(scale), columns_(columns) {}

  bool is_impossible(float stored) const {
    const double height = scale_.scale * double(stored) + scale_.offset;
    if (stored == -9999) return true;
    return scale_.on_earth ? height < -11500 || height > 9000 : std::abs(height) > 30000;
  }

  /// Counts impossible values and replaces them by NaN; then suspicious ones and their borders.
  void take(std::vector<float>& row) {
    for (float& v : row) {
      if (!std::isnan(v) && is_impossible(v)) count_impossible(v), v = kNoData;
    }
    for (int c = 0; c < columns_; ++c) {
      const float v = row[std::size_t(c)];
      if (c > 0) compare(v, row[std::size_t(c) - 1], scale_.cell_width);
      if (!above_.empty()) compare(v, above_[std::size_t(c)], scale_.cell_height);
      if (Suspect* suspect = suspect_of(v)) ++suspect->cells;
    }
    above_ = row;
  }

  std::vector<FoundVoid> found(const std::string& name) const {
    if (impossible_.size() > kMaxCodes) refuse(name);
    std::vector<FoundVoid> voids;
    for (const auto& [value, cells] : impossible_) voids.push_back({value, cells});
    for (std::size_t s = 0; s < kSuspicious.size(); ++s)
      if (suspect_[s].borders >= 2 && 2 * suspect_[s].cliffs >= suspect_[s].borders)
        voids.push_back({kSuspicious[s], suspect_[s].cells});
    return voids;
  }

 private:
  void count_impossible(float v) {
    lowest_ = std::min(lowest_, scale_.scale * double(v) + scale_.offset);
    highest_ = std::max(highest_, scale_.scale * double(v) + scale_.offset);
    if (impossible_.size() <= kMaxCodes || impossible_.count(v)) ++impossible_[v];
  }
  Suspect* suspect_of(float v) {
    for (std::size_t s = 0; s < kSuspicious.size(); ++s)
      if (v == kSuspicious[s]) return &suspect_[s];
    return nullptr;
  }
  void compare(float a, float b, double distance) {
    if (a == b || std::isnan(a) || std::isnan(b)) return;
    const bool cliff = std::abs(scale_.scale * (double(a) - double(b))) > kCliff * distance;
    for (const float v : {a, b})
      if (Suspect* suspect = suspect_of(v)) {
        ++suspect->borders;
        suspect->cliffs += cliff;
      }
  }
  [[noreturn]] void refuse(const std::string& name) const {
    throw InputError(
        line("%s: heights such as %.5g and %.5g m do not occur on %s; if they are feet, say so with \"unit\": "
             "\"ft\" of the elevation in the region or --height-unit ft, and declare what is no height with "
             "gdal_edit.py -a_nodata",
             name.c_str(), lowest_, highest_, scale_.on_earth ? "the Earth" : "a solid body"));
  }

  HeightScale scale_;
  int columns_;
  std::map<float, std::uint64_t> impossible_;
  std::array<Suspect, kSuspicious.size()> suspect_{};
  std::vector<float> above_;
  double lowest_ = std::numeric_limits<double>::infinity(), highest_ = -lowest_;
};

/// Stored values of one row; NaN: declared as nodata, or not finite.
void read_row(GDALDataset& dataset, const std::string& name, int row, std::vector<float>& value,
              std::vector<unsigned char>& valid) {
  const GdalCall call;
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  const int columns = int(value.size());
  if (band.RasterIO(GF_Read, 0, row, columns, 1, value.data(), columns, 1, GDT_Float32, 0, 0, nullptr) != CE_None ||
      band.GetMaskBand()->RasterIO(GF_Read, 0, row, columns, 1, valid.data(), columns, 1, GDT_Byte, 0, 0, nullptr) !=
          CE_None)
    throw InputError(name + ": reading its cells failed (" + call.message() +
                     "); the file is damaged or incomplete, fetch it again");
  for (std::size_t c = 0; c < value.size(); ++c)
    if (!valid[c] || !std::isfinite(value[c])) value[c] = kNoData;
}

}  // namespace

HeightScan scan_heights(GDALDataset& dataset, const std::string& name, const HeightScale& scale) {
  const int columns = dataset.GetRasterXSize(), rows = dataset.GetRasterYSize();
  std::vector<float> row(static_cast<std::size_t>(columns));
  std::vector<unsigned char> valid(row.size());
  Voids voids(scale, columns);
  FlatAreas flats(columns, scale.cell_width * scale.cell_height);
  for (int r = 0; r < rows; ++r) {
    if (r % 256 == 0) stop_if_cancelled();
    read_row(dataset, name, r, row, valid);
    voids.take(row);
    flats.take(row);
  }
  HeightScan scan;
  scan.voids = voids.found(name);
  flats.finish(rows, scan);
  return scan;
}

}  // namespace gonogo::terrain
