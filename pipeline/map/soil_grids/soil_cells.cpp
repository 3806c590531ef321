#include "pipeline/map/soil_grids/soil_cells.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "base/error.h"
#include "base/file.h"
#include "base/line.h"

namespace gonogo::map {
using terrain::RasterKind;
using terrain::RasterSource;
using terrain::Tile;
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kFifthPercentile = 1.645;  // standard deviations to either side of the middle

/// Largest value of a property that a soil can have [%, g/cm3, volume %]. Quartz has 2.65 g/cm3.
double largest(SoilProperty p) { return p == SoilProperty::bulk_density ? 2.65 : 100; }

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

double number_in(const std::string& cell, const std::string& where) {
  if (cell.empty()) return kUnknown;
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size())
    throw InputError(where + ": \"" + cell + "\" is not a number; leave the cell empty where it is not known");
  return value;
}

/// Rows of mukey.csv by map unit, in the order of the layers.
std::unordered_map<std::int64_t, std::vector<double>> read_table(const SoilFolder& folder) {
  std::istringstream in(read_file(folder.table));
  std::string text;
  std::getline(in, text);
  if (!text.empty() && text.back() == '\r') text.pop_back();
  const std::vector<std::string> header = cells_of(text);
  const auto place_of = [&](const std::string& name) {
    const auto at = std::find(header.begin(), header.end(), name);
    if (at == header.end())
      throw InputError(folder.table.string() + ": has no column " + name + "; add the map unit keys of the raster");
    return std::size_t(at - header.begin());
  };
  const std::size_t key = place_of("mukey");
  std::unordered_map<std::int64_t, std::vector<double>> rows;
  for (int number = 2; std::getline(in, text); ++number) {
    if (!text.empty() && text.back() == '\r') text.pop_back();
    if (text.empty()) continue;
    const std::string where = folder.table.string() + ": line " + std::to_string(number);
    std::vector<std::string> cells = cells_of(text);
    if (cells.size() > header.size()) throw InputError(where + ": has more cells than the header");
    cells.resize(header.size());
    const double unit = number_in(cells[key], where + ": mukey");
    if (!(unit >= 0)) throw InputError(where + ": mukey: is missing; every row needs its map unit");
    std::vector<double>& row = rows[std::int64_t(unit)];
    if (!row.empty()) throw InputError(where + ": mukey " + cells[key] + " is given twice; keep one row");
    for (const SoilLayer& layer : folder.layers)
      row.push_back(layer.column.empty() ? kUnknown
                                         : number_in(cells[place_of(layer.column)], where + ": " + layer.column));
  }
  return rows;
}

/// Means over the layers of the upper 30 cm, by thickness: [property][statistic].
struct Means {
  std::array<std::array<double, 3>, kSoilProperties> sum{}, weight{};
  void add(const SoilLayer& layer, double value) {
    const auto p = std::size_t(layer.property), s = std::size_t(layer.statistic);
    sum[p][s] += value * layer.thickness;  // NaN stays: half a profile is no profile
    weight[p][s] += layer.thickness;
  }
  double at(SoilProperty p, SoilStatistic s) const {
    const auto i = std::size_t(p), j = std::size_t(s);
    return weight[i][j] > 0 ? sum[i][j] / weight[i][j] : kUnknown;
  }
  double middle(SoilProperty p) const { return at(p, SoilStatistic::middle); }
  /// Standard error from the 5 % and 95 % points.
  double error(SoilProperty p, double fallback) const {
    const double low = at(p, SoilStatistic::low), high = at(p, SoilStatistic::high);
    return std::isnan(low + high) ? fallback : std::max(0.0, high - low) / (2 * kFifthPercentile);
  }
};

/// The third share is what the other two leave. Shares are scaled to add up to 100.
std::optional<TextureShares> shares_of(const Means& of, double error, SoilFindings& findings) {
  double sand = of.middle(SoilProperty::sand), silt = of.middle(SoilProperty::silt),
         clay = of.middle(SoilProperty::clay);
  if (int(std::isnan(sand)) + int(std::isnan(silt)) + int(std::isnan(clay)) > 1) return std::nullopt;
  if (std::isnan(sand)) sand = std::max(0.0, 100 - silt - clay);
  if (std::isnan(clay)) clay = std::max(0.0, 100 - sand - silt);
  const bool all = !std::isnan(silt);
  if (!all) silt = std::max(0.0, 100 - sand - clay);
  const double sum = sand + silt + clay;
  if (!(sum > 0)) return std::nullopt;  // SoilGrids holds zeros over water and towns
  findings.mean_sum += sum;
  ++findings.sums;
  findings.off += sum < 90 || sum > 110;
  ++findings.known;
  return TextureShares{.sand = 100 * sand / sum,
                       .silt = 100 * silt / sum,
                       .clay = 100 * clay / sum,
                       .sand_error = of.error(SoilProperty::sand, error),
                       .clay_error = of.error(SoilProperty::clay, error)};
}

}  // namespace

SoilCells::SoilCells(const SoilFolder& folder, double error, std::optional<SoilProperty> water)
    : folder_(folder), error_(error), water_(water) {
  for (const SoilLayer& layer : folder.layers)
    sources_.push_back(sources_.empty() ? RasterSource::open_as_it_lies(layer.files)
                                        : RasterSource::open_on_grid(
                                              layer.files, grid(),
                                              layer.column.empty() ? RasterKind::continuous : RasterKind::classes));
  if (!folder.table.empty()) row_of_ = read_table(folder);
}

double SoilCells::value_at(std::size_t l, float cell) const {
  const SoilLayer& layer = folder_.layers[l];
  double count = cell;
  if (!layer.column.empty() && !std::isnan(cell)) {
    const auto row = row_of_.find(std::int64_t(cell));
    count = row == row_of_.end() ? kUnknown : row->second[l];
  }
  const double value = count * layer.per_count;
  if (value < 0 || value > largest(layer.property) * 1.0001)
    throw InputError((layer.column.empty() ? layer.files.name() : folder_.table.string() + ": " + layer.column) +
                     line(": holds %g, and %s allows 0 to %g; convert the file to the unit of its name, or declare its "
                          "nodata value",
                          count, layer.unit.c_str(), largest(layer.property) / layer.per_count));
  return value;
}

SoilCells::Window SoilCells::read(terrain::Window window, SoilFindings& findings) const {
  std::vector<Tile> tiles;
  for (const RasterSource& source : sources_) tiles.push_back(source.read(window));
  Window result{{}, Tile(window.columns, window.rows, float(kUnknown))};
  for (std::size_t i = 0; i < result.water.value.size(); ++i) {
    Means means;
    for (std::size_t l = 0; l < tiles.size(); ++l) means.add(folder_.layers[l], value_at(l, tiles[l].value[i]));
    ++findings.cells;
    result.shares.push_back(shares_of(means, error_, findings));
    // Water of 1 g/cm3: volume per cent over the bulk density is per cent of the dry mass.
    if (water_ && result.shares.back())
      result.water.value[i] = float(means.middle(*water_) / means.middle(SoilProperty::bulk_density));
  }
  return result;
}

}  // namespace gonogo::map
