#include "terrain/raster/height_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "base/error.h"
#include "base/format.h"
#include "base/progress.h"
#include "terrain/raster/raster_open.h"

namespace gonogo::terrain {
namespace {

struct HeightScan {
  std::vector<FoundVoid> voids;
  CellRuns flat;  // [row]; empty when no area is flat
  int flat_areas = 0;
  std::uint64_t flat_cells = 0;
};

/// The command that declares a value to be none.
std::string declaring(const std::string& value, GDALDataset& dataset, const std::string& name) {
  return command_on("gdal_translate -a_nodata " + value, dataset, name, "declared.tif");
}

constexpr int kShortest = 4;             // run [cells]
constexpr std::uint64_t kCells = 400;    // of an area
constexpr double kHectare = 1e4;         // [m2]
constexpr double kOfWholeNumbers = 1e6;  // [m2]
constexpr double kLowerShare = 0.05;     // of all borders

int root_of(std::vector<int>& parent, int node) {
  while (parent[std::size_t(node)] != node)
    node = parent[std::size_t(node)] = parent[std::size_t(parent[std::size_t(node)])];
  return node;
}

/// Finds large areas of exactly one height, row by row.
class FlatAreas {
 public:
  FlatAreas(int columns, double cell_area) : columns_(columns), cell_area_(cell_area) {}

  /// The next row [columns]; NaN: no height.
  void take(const std::vector<float>& row);
  /// Moves what was found into `scan`. Call once, after the last of `rows` rows.
  void finish(int rows, HeightScan& scan);

 private:
  struct Run {
    int begin, end, area;
  };
  /// A connected area that may still grow.
  struct Area {
    float value = 0;
    std::uint64_t cells = 0, higher = 0, lower = 0;  // borders with higher and lower cells
    std::vector<std::array<int, 3>> runs = {};       // row, begin, end
  };
  std::vector<Run> runs_in(const std::vector<float>& row) const;
  void join(std::vector<Run>& runs, const std::vector<float>& row);
  void count_borders(const std::vector<Run>& runs, const std::vector<float>& own, const std::vector<float>& other);
  void count_ends(const std::vector<Run>& runs, const std::vector<float>& own);
  void retire(Area&& area);

  int columns_, row_ = 0;
  double cell_area_;
  bool whole_numbers_ = true;
  std::vector<float> above_;
  std::vector<Run> open_;    // runs of the row above
  std::vector<Area> areas_;  // those of open_
  std::vector<Area> large_;  // finished
};

std::vector<FlatAreas::Run> FlatAreas::runs_in(const std::vector<float>& row) const {
  std::vector<Run> runs;
  for (int begin = 0; begin < columns_;) {
    const float value = row[std::size_t(begin)];
    int end = begin + 1;
    while (end < columns_ && row[std::size_t(end)] == value) ++end;
    if (end - begin >= kShortest) runs.push_back({begin, end, 0});
    begin = end;
  }
  return runs;
}

/// Gives every run its area: those of touching runs above with the same height become one.
void FlatAreas::join(std::vector<Run>& runs, const std::vector<float>& row) {
  const int before = int(areas_.size());
  std::vector<int> parent(areas_.size() + runs.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (std::size_t a = 0, b = 0; a < open_.size() && b < runs.size();) {
    const Run &up = open_[a], &down = runs[b];
    if (std::max(up.begin, down.begin) < std::min(up.end, down.end) &&
        above_[std::size_t(up.begin)] == row[std::size_t(down.begin)])
      parent[std::size_t(root_of(parent, up.area))] = root_of(parent, before + int(b));
    ++(up.end < down.end ? a : b);
  }
  std::vector<Area> next;
  std::vector<int> place(parent.size(), -1);  // of a root in `next`
  for (std::size_t b = 0; b < runs.size(); ++b) {
    int& at = place[std::size_t(root_of(parent, before + int(b)))];
    if (at < 0) {
      at = int(next.size());
      next.push_back({.value = row[std::size_t(runs[b].begin)]});
    }
    runs[b].area = at;
    next[std::size_t(at)].cells += std::uint64_t(runs[b].end - runs[b].begin);
    next[std::size_t(at)].runs.push_back({row_, runs[b].begin, runs[b].end});
  }
  for (int a = 0; a < before; ++a) {
    Area& old = areas_[std::size_t(a)];
    const int at = place[std::size_t(root_of(parent, a))];
    if (at < 0) {
      retire(std::move(old));
      continue;
    }
    Area& into = next[std::size_t(at)];
    if (old.runs.size() > into.runs.size()) std::swap(old.runs, into.runs);
    into.runs.insert(into.runs.end(), old.runs.begin(), old.runs.end());
    into.cells += old.cells;
    into.higher += old.higher;
    into.lower += old.lower;
  }
  areas_ = std::move(next);
}

void FlatAreas::count_borders(const std::vector<Run>& runs, const std::vector<float>& own,
                              const std::vector<float>& other) {
  for (const Run& run : runs) {
    Area& area = areas_[std::size_t(run.area)];
    const float value = own[std::size_t(run.begin)];
    for (int c = run.begin; c < run.end; ++c) {
      area.higher += other[std::size_t(c)] > value;
      area.lower += other[std::size_t(c)] < value;
    }
  }
}

void FlatAreas::count_ends(const std::vector<Run>& runs, const std::vector<float>& own) {
  for (const Run& run : runs) {
    Area& area = areas_[std::size_t(run.area)];
    for (const int beside : {run.begin - 1, run.end}) {
      if (beside < 0 || beside >= columns_) continue;
      area.higher += own[std::size_t(beside)] > area.value;
      area.lower += own[std::size_t(beside)] < area.value;
    }
  }
}

void FlatAreas::take(const std::vector<float>& row) {
  for (const float v : row) whole_numbers_ = whole_numbers_ && (std::isnan(v) || v == std::floor(v));
  std::vector<Run> runs = runs_in(row);
  if (row_ > 0) count_borders(open_, above_, row);
  join(runs, row);
  if (row_ > 0) count_borders(runs, row, above_);
  count_ends(runs, row);
  open_ = std::move(runs);
  above_ = row;
  ++row_;
}

void FlatAreas::retire(Area&& area) {
  if (area.cells >= kCells && double(area.cells) * cell_area_ >= kHectare) large_.push_back(std::move(area));
}

void FlatAreas::finish(int rows, HeightScan& scan) {
  for (Area& area : areas_) retire(std::move(area));
  for (const Area& area : large_) {
    const bool on_a_plain = double(area.lower) > kLowerShare * double(area.lower + area.higher);
    if (whole_numbers_ && (double(area.cells) * cell_area_ < kOfWholeNumbers || on_a_plain)) continue;
    scan.flat.resize(std::size_t(rows));
    for (const auto& [row, begin, end] : area.runs) scan.flat[std::size_t(row)].emplace_back(begin, end);
    ++scan.flat_areas;
    scan.flat_cells += area.cells;
  }
  for (auto& runs : scan.flat) std::sort(runs.begin(), runs.end());
}

constexpr double kVoidCode = -9999;
constexpr std::size_t kMaxCodes = 3;
constexpr double kCliff = 1.7320508;  // rise over run: 60 degrees

/// The nodata value that a band of floating point declares: other digits of it can be stored.
class NodataDigits {
 public:
  explicit NodataDigits(GDALRasterBand& band) {
    int has = 0;
    const double value = band.GetNoDataValue(&has);
    if (has && std::isfinite(value) && std::abs(value) > kLeast && GDALDataTypeIsFloating(band.GetRasterDataType()))
      value_ = value;
  }
  /// Whether a stored value that counts as data is the declared one but for digits: -3.4028e38 for -3.4e38.
  bool is_near(float stored) const {
    return value_ && double(stored) != *value_ &&
           std::abs(double(stored) / *value_ - 1) < (std::abs(*value_) > kHuge ? 2e-3 : 1e-5);
  }

 private:
  static constexpr double kLeast = 900, kHuge = 1e30;
  std::optional<double> value_;
};

/// Cells that hold -9999 or an end of the band's whole numbers, which nobody declared: what programs write where
/// nothing was measured. A code is one if every other stored value lies more than a quarter of it away.
class LonelyCodes {
 public:
  explicit LonelyCodes(GDALRasterBand& band) {
    const auto add = [&](double code) { codes_.push_back({float(code), 0, std::numeric_limits<double>::infinity()}); };
    add(kVoidCode);
    switch (band.GetRasterDataType()) {
      case GDT_Byte:
        add(255);
        break;
      case GDT_UInt16:
        add(65535);
        break;
      case GDT_Int16:
        add(-32768), add(32767);
        break;
      case GDT_Int32:
        add(-2147483648.0), add(2147483647.0);
        break;
      default:
        break;
    }
  }
  void count(float stored) {
    for (Code& code : codes_) {
      if (stored == code.value)
        ++code.cells;
      else
        code.nearest = std::min(code.nearest, std::abs(double(stored) - code.value));
    }
  }
  void add_to(std::vector<FoundVoid>& voids) const {
    for (const Code& code : codes_)
      if (code.cells > 0 && 4 * code.nearest > std::abs(code.value) && std::isfinite(code.nearest))
        voids.push_back({code.value, code.cells});
  }

 private:
  struct Code {
    float value = 0;
    std::uint64_t cells = 0;
    double nearest = 0;  // to any other stored value
  };
  std::vector<Code> codes_;
};

/// The values that count as voids, and their cells; refused above three kinds.
class ImpossibleValues {
 public:
  void count(float stored, double value) {
    lowest_ = std::min(lowest_, value);
    highest_ = std::max(highest_, value);
    if (cells_.size() <= kMaxCodes || cells_.count(stored)) ++cells_[stored];
  }
  bool are_too_many() const { return cells_.size() > kMaxCodes; }
  std::vector<FoundVoid> list() const {
    std::vector<FoundVoid> voids;
    for (const auto& [value, cells] : cells_) voids.push_back({value, cells});
    return voids;
  }
  double lowest() const { return lowest_; }
  double highest() const { return highest_; }

 private:
  std::map<float, std::uint64_t> cells_;
  double lowest_ = std::numeric_limits<double>::infinity(), highest_ = -lowest_;
};

/// Counts of one suspicious value.
struct Suspect {
  float stored = 0;
  std::uint64_t cells = 0, borders = 0, cliffs = 0;
};

class Voids {
 public:
  Voids(const HeightScale& scale, const NodataDigits& nodata, int columns)
      : scale_(scale), nodata_(nodata), columns_(columns) {
    for (const float stored : {-999.f, -99.f, 0.f, 255.f}) suspect_.push_back({.stored = stored});
    if (scale.is_plain) return;
    // Codes of programs that write no height, and the ends of whole numbers of 16 and 32 bits.
    for (const double stored : {kVoidCode, (kVoidCode - scale.offset) / scale.scale, -32768.0, -32767.0, 32767.0,
                                65535.0, -2147483648.0, 2147483647.0})
      suspect_.push_back({.stored = float(stored)});
  }

  bool is_impossible(float stored) const {
    const double height = scale_.scale * double(stored) + scale_.offset;
    if (nodata_.is_near(stored)) return true;
    if (stored == kVoidCode && scale_.is_plain) return true;
    return scale_.on_earth ? height < -11500 || height > 9000 : std::abs(height) > 30000;
  }

  /// Counts impossible values and replaces them by NaN; then suspicious ones and their borders.
  void take(std::vector<float>& row) {
    for (float& v : row) {
      if (std::isnan(v) || !is_impossible(v)) continue;
      impossible_.count(v, scale_.scale * double(v) + scale_.offset);
      v = kNoData;
    }
    for (int c = 0; c < columns_; ++c) {
      const float v = row[std::size_t(c)];
      if (c > 0) compare(v, row[std::size_t(c) - 1], scale_.cell_width);
      if (!above_.empty()) compare(v, above_[std::size_t(c)], scale_.cell_height);
      if (Suspect* suspect = suspect_of(v)) ++suspect->cells;
    }
    above_ = row;
  }

  std::vector<FoundVoid> found(GDALDataset& dataset, const std::string& name) const {
    if (impossible_.are_too_many()) refuse(dataset, name);
    std::vector<FoundVoid> voids = impossible_.list();
    for (const Suspect& s : suspect_)
      if (s.borders >= 2 && 2 * s.cliffs >= s.borders) voids.push_back({s.stored, s.cells});
    return voids;
  }

 private:
  Suspect* suspect_of(float v) {
    for (Suspect& s : suspect_)
      if (v == s.stored) return &s;
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
  [[noreturn]] void refuse(GDALDataset& dataset, const std::string& name) const {
    throw InputError(
        name +
        line(": heights such as %.5g and %.5g m do not occur on %s; if they are feet, say so with \"unit\": \"ft\" of "
             "the elevation in the region or --height-unit ft, and declare what is no height with: ",
             impossible_.lowest(), impossible_.highest(), scale_.on_earth ? "the Earth" : "a solid body") +
        declaring("<value>", dataset, name));
  }

  HeightScale scale_;
  NodataDigits nodata_;
  int columns_;
  ImpossibleValues impossible_;
  std::vector<Suspect> suspect_;
  std::vector<float> above_;
};

/// Stored values of one row; NaN: declared as nodata, or not finite. The declared nodata with other digits is kept:
/// GDAL's mask takes it for nodata, and its warper for a value.
void read_row(GDALDataset& dataset, const std::string& name, const NodataDigits& nodata, int left, int row,
              std::vector<float>& value, std::vector<unsigned char>& valid) {
  const GdalCall call;
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  const int columns = int(value.size());
  if (band.RasterIO(GF_Read, left, row, columns, 1, value.data(), columns, 1, GDT_Float32, 0, 0, nullptr) != CE_None ||
      band.GetMaskBand()->RasterIO(GF_Read, left, row, columns, 1, valid.data(), columns, 1, GDT_Byte, 0, 0, nullptr) !=
          CE_None)
    throw InputError(name + ": reading its cells failed (" + call.message() +
                     "); the file is damaged or incomplete, fetch it again");
  for (std::size_t c = 0; c < value.size(); ++c)
    if ((!valid[c] && !nodata.is_near(value[c])) || !std::isfinite(value[c])) value[c] = kNoData;
}

/// Reads all cells once, row by row. Voids are
///   - -9999 where values have neither scale nor offset, the declared nodata with other digits, and heights outside of
///   -11,500 to 9,000 m on the Earth or +-30,000 m elsewhere, if there are at most three;
///   - -999, -99 and 0, and with scale or offset -9999, stored or scaled, and the ends of whole numbers of 16 and 32
///   bits, if at least half of their borders with other heights are steeper than 60 degrees.
/// Flat are connected areas of one height with at least 400 cells and 1 ha. Where all heights are whole numbers, plains
/// have such areas too; there it takes 1 km2 that hardly borders on anything lower. Fringes less than four cells wide
/// are not counted in. Memory grows with the width of the raster and the flat areas.
/// Throws InputError when more values than three cannot be heights, and for a damaged file.
HeightScan scan_heights(GDALDataset& dataset, const std::string& name, const HeightScale& scale) {
  const int columns = dataset.GetRasterXSize(), rows = dataset.GetRasterYSize();
  std::vector<float> row(static_cast<std::size_t>(columns));
  std::vector<unsigned char> valid(row.size());
  const NodataDigits nodata(*dataset.GetRasterBand(1));
  Voids voids(scale, nodata, columns);
  FlatAreas flats(columns, scale.cell_width * scale.cell_height);
  for (int r = 0; r < rows; ++r) {
    if (r % 256 == 0) stop_if_cancelled();
    read_row(dataset, name, nodata, 0, r, row, valid);
    voids.take(row);
    flats.take(row);
  }
  HeightScan scan;
  scan.voids = voids.found(dataset, name);
  flats.finish(rows, scan);
  return scan;
}

}  // namespace

HeightScale height_scale(GDALDataset& dataset, const GeoTransform& t, const OGRSpatialReference& crs, double scale,
                         double offset) {
  constexpr double earth = 6378137, tolerance = 0.01;
  const auto cell = middle_cell_size(dataset, t, crs);
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  return {.scale = scale,
          .offset = offset,
          .is_plain = band.GetScale() == 1 && band.GetOffset() == 0,
          .cell_width = cell ? (*cell)[0] : 1,
          .cell_height = cell ? (*cell)[1] : 1,
          .on_earth = std::abs(crs.GetSemiMajor() / earth - 1) < tolerance};
}

HeightDoubt doubt_heights(GDALDataset& dataset, const std::string& name, const HeightScale& scale,
                          const HeightWish& wish, std::vector<std::string>& remarks) {
  HeightScan scan = scan_heights(dataset, name, scale);
  HeightDoubt doubt;
  for (const FoundVoid& found : scan.voids)
    remarks.push_back(
        line("%llu cells of the elevation hold %g, which is no height there; they count as without elevation. Declare "
             "it with: ",
             static_cast<unsigned long long>(found.cells), found.value) +
        declaring(line("%.9g", found.value), dataset, name));
  doubt.voids = std::move(scan.voids);
  if (scan.flat_cells == 0 || wish.flat_is_ground) return doubt;
  remarks.push_back(line(
      "exactly one height on %d %s of the elevation, %.3g km2 in all, as water and voids have; unknown unless land "
      "cover tells what it is. If it is ground, say \"flat\": \"ground\" in the region, or --flat-is-ground",
      scan.flat_areas, scan.flat_areas == 1 ? "area" : "areas",
      double(scan.flat_cells) * scale.cell_width * scale.cell_height * 1e-6));
  doubt.flat = std::make_shared<const CellRuns>(std::move(scan.flat));
  return doubt;
}

std::vector<FoundVoid> doubt_values(GDALDataset& dataset, const std::string& name, Window window,
                                    const ValueRange& range, std::vector<std::string>& remarks) {
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  const double scale = band.GetScale(), offset = band.GetOffset();
  const NodataDigits nodata(band);
  std::vector<float> row(static_cast<std::size_t>(window.columns));
  std::vector<unsigned char> valid(row.size());
  ImpossibleValues impossible;
  LonelyCodes lonely(band);
  for (int r = 0; r < window.rows; ++r) {
    if (r % 256 == 0) stop_if_cancelled();
    read_row(dataset, name, nodata, window.column, window.row + r, row, valid);
    for (const float stored : row) {
      const double value = scale * double(stored) + offset;
      if (value < range.low || value > range.high || nodata.is_near(stored))
        impossible.count(stored, value);
      else
        lonely.count(stored);
    }
  }
  if (impossible.are_too_many())
    throw InputError(
        line("%s: holds values such as %.5g and %.5g, and ", name.c_str(), impossible.lowest(), impossible.highest()) +
        (std::isfinite(range.high) ? line("a %s lies between %g and %g", range.what.c_str(), range.low, range.high)
                                   : line("no %s is that low", range.what.c_str())) +
        "; check its unit and scale, and declare what is no value with: " + declaring("<value>", dataset, name));
  std::vector<FoundVoid> voids = impossible.list();
  lonely.add_to(voids);
  for (const FoundVoid& found : voids)
    remarks.push_back(line("%llu cells of ", static_cast<unsigned long long>(found.cells)) + name +
                      line(" hold %g, which is no %s; they count as without data. Declare it with: ", found.value,
                           range.what.c_str()) +
                      declaring(line("%.9g", found.value), dataset, name));
  return voids;
}

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
    for (const FoundVoid& found : voids) void_.push_back(float(found.value));
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
