#include "pipeline/map/soil_grids/soil_cells.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <regex>

#include "base/error.h"
#include "base/files/csv.h"
#include "base/files/file.h"
#include "base/format.h"
#include "terrain/soil/soil.h"

namespace gonogo::map {

namespace {

/// Quantiles of the standard normal distribution at 0.1, 0.3, 0.5, 0.7, 0.9.
constexpr std::array<double, 5> kNormal = {-1.28155, -0.52440, 0, 0.52440, 1.28155};
constexpr int kPoints = 25;

std::size_t code_of(double sand, double clay) {
  sand = std::clamp(sand, 0.0, 100.0);
  clay = std::clamp(clay, 0.0, 100.0);
  const double sum = std::max(100.0, sand + clay);
  sand *= 100 / sum;
  clay *= 100 / sum;
  const auto& names = terrain::usda_texture_codes();
  const std::string name = terrain::usda_texture(sand, std::max(0.0, 100 - sand - clay), clay);
  return std::size_t(std::find(names.begin(), names.end(), name) - names.begin());
}

}  // namespace

TextureMixture texture_mixture(const TextureShares& s, int parts) {
  std::array<int, 12> count{};
  for (const double a : kNormal)
    for (const double b : kNormal) ++count[code_of(s.sand + a * s.sand_error, s.clay + b * s.clay_error)];
  TextureMixture mixture{};
  std::array<int, 12> rest{};
  int given = 0;
  for (std::size_t t = 0; t < count.size(); ++t) {
    mixture[t] = std::uint8_t(count[t] * parts / kPoints);
    rest[t] = count[t] * parts % kPoints;
    given += mixture[t];
  }
  for (; given < parts; ++given) {
    const auto largest = std::max_element(rest.begin(), rest.end());
    ++mixture[std::size_t(largest - rest.begin())];
    *largest = -1;
  }
  return mixture;
}

namespace fs = std::filesystem;
namespace {

constexpr double kDeepest = 30;  // layers below it carry no wheel [cm]

struct Series {
  const char* name;
  SoilProperty property;
  double per_count;
  const char* unit;
};

constexpr Series kSoilGrids[] = {{"sand", SoilProperty::sand, 0.1, "g/kg"},
                                 {"silt", SoilProperty::silt, 0.1, "g/kg"},
                                 {"clay", SoilProperty::clay, 0.1, "g/kg"},
                                 {"bdod", SoilProperty::bulk_density, 0.01, "cg/cm3"},
                                 {"wv0010", SoilProperty::water_10, 0.1, "1e-3 cm3/cm3"},
                                 {"wv0033", SoilProperty::water_33, 0.1, "1e-3 cm3/cm3"},
                                 {"wv003", SoilProperty::water_33, 0.1, "1e-3 cm3/cm3"},
                                 {"wv1500", SoilProperty::water_1500, 0.1, "1e-3 cm3/cm3"}};
constexpr Series kSsurgo[] = {{"sandtotal", SoilProperty::sand, 1, "%"},
                              {"silttotal", SoilProperty::silt, 1, "%"},
                              {"claytotal", SoilProperty::clay, 1, "%"},
                              {"dbthirdbar", SoilProperty::bulk_density, 1, "g/cm3"},
                              {"wtenthbar", SoilProperty::water_10, 1, "% of the volume"},
                              {"wthirdbar", SoilProperty::water_33, 1, "% of the volume"},
                              {"wfifteenbar", SoilProperty::water_1500, 1, "% of the volume"}};

template <std::size_t N>
const Series* series_named(const Series (&all)[N], const std::string& name) {
  for (const Series& s : all)
    if (name == s.name) return &s;
  return nullptr;
}

bool is_raster(const fs::path& file) {
  const std::string end = file.extension().string();
  return end == ".tif" || end == ".tiff" || end == ".vrt" || end == ".img";
}

SoilStatistic statistic_of(const std::string& word) {
  if (word == "l" || word == "Q0.05" || word == "Q05" || word == "Q5") return SoilStatistic::low;
  if (word == "h" || word == "Q0.95" || word == "Q95") return SoilStatistic::high;
  return SoilStatistic::middle;
}

struct Recognised {
  SoilLayer layer;
  bool is_soil_grids = false;
  double top = 0;  // [cm]
};

std::optional<Recognised> recognise(const std::string& name) {
  static const std::regex soil_grids(R"((\w+?)_(\d+)-(\d+)cm_(mean|Q0\.05|Q05|Q5|Q0\.5|Q0\.50|Q50|Q0\.95|Q95))"),
      ssurgo("([a-z]+)_([lrh])");
  std::smatch part;
  if (std::regex_match(name, part, soil_grids)) {
    const Series* s = series_named(kSoilGrids, part[1]);
    if (!s) return {};
    const double top = std::stod(part[2]), bottom = std::stod(part[3]);
    return Recognised{.layer = {.property = s->property,
                                .statistic = statistic_of(part[4]),
                                .thickness = bottom - top,
                                .per_count = s->per_count,
                                .unit = s->unit,
                                .column = {},
                                .files = {}},
                      .is_soil_grids = true,
                      .top = top};
  }
  if (!std::regex_match(name, part, ssurgo)) return {};
  const Series* s = series_named(kSsurgo, part[1]);
  if (!s) return {};
  return Recognised{.layer = {.property = s->property,
                              .statistic = statistic_of(part[2]),
                              .per_count = s->per_count,
                              .unit = s->unit,
                              .column = {},
                              .files = {}}};
}

/// Columns of the header of mukey.csv as layers.
void add_table(const fs::path& raster, SoilFolder& found) {
  found.table = raster.parent_path() / "mukey.csv";
  if (!fs::is_regular_file(found.table))
    throw InputError(
        raster.string() + ": is a raster of map units, and " + found.table.string() +
        " is not there; give a table with the columns mukey, sandtotal_r, claytotal_r, ... (docs/regions.md)");
  const std::vector<CsvLine> lines = read_csv_lines(found.table, "map units");
  for (const std::string& column : lines.front().cell) {
    if (auto r = recognise(column); r && !r->is_soil_grids) {
      r->layer.column = column;
      r->layer.files = raster;
      found.layers.push_back(r->layer);
    }
  }
}

fs::path elevation_among(const fs::path& folder, const std::vector<fs::path>& rest) {
  if (rest.size() == 1) return rest.front();
  std::vector<fs::path> named;
  std::vector<std::string> names;
  for (const fs::path& file : rest) {
    std::string name = file.stem().string();
    names.push_back(file.filename().string());
    for (char& c : name) c = char(std::tolower(static_cast<unsigned char>(c)));
    for (const char* word : {"dem", "dtm", "elev"})
      if (name.find(word) != std::string::npos) {
        named.push_back(file);
        break;
      }
  }
  if (named.size() == 1) return named.front();
  throw InputError(folder.string() + ": " +
                   (rest.empty() ? "holds no elevation raster; add one"
                                 : "which of " + join_words(names) + " is the elevation? Name one elevation.tif") +
                   ", such as elevation.tif beside the soil layers");
}

/// Every property needs its middle, from one publisher.
void check_layers(const fs::path& folder, const SoilFolder& found) {
  std::array<bool, kSoilProperties> middle{}, any{};
  std::array<std::string, kSoilProperties> unit{};
  for (const SoilLayer& layer : found.layers) {
    const auto p = std::size_t(layer.property);
    any[p] = true;
    if (layer.statistic == SoilStatistic::middle) middle[p] = true;
    if (!unit[p].empty() && unit[p] != layer.unit)
      throw InputError(folder.string() + ": holds one property in " + unit[p] + " and in " + layer.unit + " (" +
                       layer.files.name() + "); keep the layers of one publisher");
    unit[p] = layer.unit;
  }
  for (std::size_t p = 0; p < kSoilProperties; ++p)
    if (any[p] && !middle[p])
      throw InputError(folder.string() +
                       ": holds a low or high value without the middle one; add the layer that ends in _mean or _r");
  const int of_three = middle[0] + middle[1] + middle[2];
  if (of_three < 2)
    throw InputError(folder.string() + ": holds " + std::to_string(of_three) +
                     " of sand, silt and clay, and two are needed; add for example sand_0-5cm_mean.tif and "
                     "clay_0-5cm_mean.tif of SoilGrids, or sandtotal_r.tif and claytotal_r.tif of SSURGO");
}

}  // namespace

SoilFolder read_soil_folder(const fs::path& folder) {
  if (!fs::is_directory(folder)) throw InputError(folder.string() + ": no such folder; give one that holds rasters");
  std::vector<fs::path> files, rest;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && is_raster(entry.path()) && entry.path().stem() != "soil_class" &&
        entry.path().stem() != "water")
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  SoilFolder found;
  bool soil_grids = false;
  for (const fs::path& file : files) {
    if (file.stem() == "mukey") {
      add_table(file, found);
    } else if (auto r = recognise(file.stem().string())) {
      if (r->top >= kDeepest) {
        found.left_out.push_back(file.filename().string());
        continue;
      }
      soil_grids = soil_grids || r->is_soil_grids;
      r->layer.files = file;
      found.layers.push_back(r->layer);
    } else {
      rest.push_back(file);
    }
  }
  found.elevation = elevation_among(folder, rest);
  check_layers(folder, found);
  found.source = soil_grids ? "SoilGrids 2.0 (Poggio et al., SOIL 7:217, 2021)" : "SSURGO or gNATSGO (USDA NRCS)";
  found.licence = soil_grids ? "CC BY 4.0" : "public domain";
  return found;
}

using terrain::RasterKind;
using terrain::RasterSource;
using terrain::Tile;
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kFifthPercentile = 1.645;  // standard deviations to either side of the middle

/// Largest value of a property that a soil can have [%, g/cm3, volume %]. Quartz has 2.65 g/cm3.
double largest(SoilProperty p) { return p == SoilProperty::bulk_density ? 2.65 : 100; }

double number_in(const std::string& cell, const std::string& where) {
  if (is_missing(cell)) return kUnknown;
  if (const auto value = cell_number(cell)) return *value;
  throw InputError(where + ": \"" + cell + "\" is not a number; leave the cell empty where it is not known");
}

/// Rows of mukey.csv by map unit, in the order of the layers.
std::unordered_map<std::int64_t, std::vector<double>> read_table(const SoilFolder& folder) {
  std::vector<CsvLine> lines = read_csv_lines(folder.table, "map units");
  const std::vector<std::string> header = lines.front().cell;
  lines.erase(lines.begin());
  if (lines.empty()) throw InputError(folder.table.string() + ": holds a header and no map units");
  const auto place_of = [&](const std::string& name) {
    const auto at = std::find(header.begin(), header.end(), name);
    if (at == header.end())
      throw InputError(folder.table.string() + ": has no column " + name + "; add the map unit keys of the raster");
    return std::size_t(at - header.begin());
  };
  const std::size_t key = place_of("mukey");
  std::unordered_map<std::int64_t, std::vector<double>> rows;
  for (const CsvLine& line : lines) {
    const std::string where = folder.table.string() + ": line " + std::to_string(line.number);
    const std::vector<std::string>& cells = line.cell;
    if (cells.size() != header.size())
      throw InputError(where + ": has " + std::to_string(cells.size()) + " cells, and the header " +
                       std::to_string(header.size()) + "; the table is damaged or incomplete, write it again");
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

/// Counts below it are codes of voids. Others that a property cannot have may be in another unit, and are refused.
const terrain::ValueRange kNoCode{-900, std::numeric_limits<double>::infinity(), "content of a soil"};

}  // namespace

SoilCells::SoilCells(const SoilFolder& folder, double error, std::optional<SoilProperty> water)
    : folder_(folder), error_(error), water_(water) {
  for (const SoilLayer& layer : folder.layers) {
    const bool is_classes = !layer.column.empty();
    const auto range = is_classes ? std::nullopt : std::optional(kNoCode);
    sources_.push_back(
        sources_.empty() ? RasterSource::open_as_it_lies(layer.files, range)
                         : RasterSource::open_on_grid(
                               layer.files, grid(), is_classes ? RasterKind::classes : RasterKind::continuous, range));
  }
  if (!folder.table.empty()) row_of_ = read_table(folder);
}

std::vector<std::string> SoilCells::remarks() const {
  std::vector<std::string> list;
  for (const RasterSource& source : sources_) list.insert(list.end(), source.remarks().begin(), source.remarks().end());
  return list;
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
