#include "pipeline/map/soil_grids/soil_layers.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <regex>

#include "base/error.h"
#include "base/file.h"
#include "base/nearest.h"

namespace gonogo::map {
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
  const std::string text = read_file(found.table);
  std::string header = text.substr(0, text.find_first_of("\r\n")) + ",";
  for (std::size_t at = 0, end; (end = header.find(',', at)) != std::string::npos; at = end + 1) {
    const std::string column = header.substr(at, end - at);
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

}  // namespace gonogo::map
