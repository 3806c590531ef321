#include "pipeline/map/soil_grids/make_region.h"

#include <algorithm>
#include <map>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/json/json.h"
#include "base/progress.h"
#include "pipeline/map/soil_grids/soil_cells.h"
#include "terrain/raster/layer/cog.h"
#include "terrain/raster/layer/geotiff.h"
#include "terrain/soil/soil.h"

namespace gonogo::map {
namespace fs = std::filesystem;
using terrain::MapGrid;
using terrain::Tile;
namespace {

constexpr std::size_t kMaxCodes = 250;  // of a byte layer, less nodata

std::optional<SoilProperty> property_of_suction(int kPa) {
  if (kPa == 10) return SoilProperty::water_10;
  if (kPa == 33) return SoilProperty::water_33;
  if (kPa == 1500) return SoilProperty::water_1500;
  return std::nullopt;
}

/// The water of the ground, and its suction [kPa].
struct GroundWater {
  std::optional<SoilProperty> property;
  int suction = 0;
};

GroundWater choose_water(const RegionMakeRequest& request, const SoilFolder& found, std::vector<std::string>& remarks) {
  const auto has = [&](SoilProperty p) {
    return std::any_of(found.layers.begin(), found.layers.end(), [p](const SoilLayer& l) { return l.property == p; });
  };
  std::vector<int> given;
  for (const int kPa : {33, 10, 1500})
    if (has(*property_of_suction(kPa))) given.push_back(kPa);
  if (request.suction && std::find(given.begin(), given.end(), *request.suction) == given.end())
    throw InputError(request.folder.string() + line(": holds no water content at %d kPa; ", *request.suction) +
                     (given.empty() ? "add its layer" : line("add its layer, or ask for %d", given.front())));
  if (given.empty()) {
    remarks.push_back("no layer of water: the moisture is open; choose it with gonogo map --moisture");
    return {};
  }
  if (!has(SoilProperty::bulk_density)) {
    remarks.push_back("no bulk density: water by volume cannot be turned into water by mass, and the moisture is open");
    return {};
  }
  const int kPa = request.suction.value_or(given.front());
  remarks.push_back(line("the ground holds the water of a suction of %d kPa", kPa));
  return {property_of_suction(kPa), kPa};
}

/// Mixtures by how fine their parts are, so that a byte holds their codes.
struct Mixtures {
  int parts = 8;
  std::map<TextureMixture, int> code;  // from 1
};

Mixtures find_mixtures(const SoilCells& cells, SoilFindings& findings) {
  std::vector<Mixtures> tried;
  for (const int parts : {8, 4, 2, 1}) tried.push_back({parts, {}});
  for (const terrain::Window window : windows_of(cells.grid(), terrain::kTileCells, terrain::kTileCells)) {
    stop_if_cancelled();
    for (const auto& shares : cells.read(window, findings).shares)
      for (Mixtures& m : tried)
        if (shares && m.code.size() <= kMaxCodes) m.code.emplace(texture_mixture(*shares, m.parts), 0);
  }
  for (Mixtures& m : tried) {
    if (m.code.size() > kMaxCodes) continue;
    int next = 0;
    for (auto& [mixture, code] : m.code) code = ++next;
    return m;
  }
  throw DeviceError("more mixtures than textures");  // one part gives at most twelve
}

void check_findings(const SoilFolder& found, const SoilFindings& findings, std::vector<std::string>& remarks) {
  const std::string where = found.layers.front().files.name();
  if (findings.known == 0)
    throw InputError(where + ": no cell has values of sand, silt and clay; give layers that cover the region");
  const double sum = findings.mean_sum / double(findings.sums);
  if (2 * findings.off > findings.known)
    throw InputError(where + line(": sand, silt and clay add up to %.3g %% in the mean, and to 90 to 110 %% in %.0f %% "
                                  "of the cells only; SoilGrids is in g/kg, SSURGO in %%: give the files as published",
                                  sum, 100 - 100.0 * double(findings.off) / double(findings.known)));
  if (findings.off > 0)
    remarks.push_back(
        line("sand, silt and clay do not add up to 90 to 110 %% in %llu cells; they were scaled to 100 %%",
             static_cast<unsigned long long>(findings.off)));
  if (findings.known < findings.cells)
    remarks.push_back(line("%.1f %% of the soil's cells have no data; they are unknown",
                           100.0 * double(findings.cells - findings.known) / double(findings.cells)));
}

void write_layers(const RegionMakeRequest& request, const SoilCells& cells, const Mixtures& mixtures,
                  const GroundWater& water, RegionMade& made) {
  terrain::LayerInfo classes{
      .name = "mixture of USDA textures", .unit = "", .classes = true, .legend = {}, .metadata = {}};
  for (const auto& [mixture, code] : mixtures.code)
    classes.legend.push_back({double(code), "mixture " + std::to_string(code), "#a6865a"});
  terrain::LayerInfo wet{.name = "water over dry mass", .unit = "%", .classes = false, .legend = {}, .metadata = {}};
  wet.legend = {{0, "0", "#ffffff"}, {50, "50", "#2166ac"}};
  wet.smooth = true;
  terrain::GeoTiffWriter soil(request.folder / "soil_class.tif", cells.grid(), classes);
  std::optional<terrain::GeoTiffWriter> held;
  if (water.property) held.emplace(request.folder / "water.tif", cells.grid(), wet);
  SoilFindings again;
  for (const terrain::Window window : windows_of(cells.grid(), terrain::kTileCells, terrain::kTileCells)) {
    stop_if_cancelled();
    const SoilCells::Window read = cells.read(window, again);
    Tile code(window.columns, window.rows, terrain::kNoData);
    for (std::size_t i = 0; i < code.value.size(); ++i)
      if (read.shares[i]) code.value[i] = float(mixtures.code.at(texture_mixture(*read.shares[i], mixtures.parts)));
    soil.write(window, code);
    if (held) held->write(window, read.water);
  }
  soil.finish();
  made.files.push_back(request.folder / "soil_class.tif");
  if (!held) return;
  held->finish();
  made.files.push_back(request.folder / "water.tif");
}

Json raster_json(const char* role, const std::string& file, const std::string& source, const std::string& licence) {
  return Json::Object{{"role", role}, {"file", file}, {"source", source}, {"licence", licence}};
}

Json soil_json(const TextureMixture& mixture, int code) {
  Json soil = Json::object(), parts = Json::object();
  std::string name;
  for (std::size_t t = 0; t < mixture.size(); ++t) {
    if (mixture[t] == 0) continue;
    const std::string& texture = terrain::usda_texture_codes()[t];
    parts[texture] = int(mixture[t]);
    name += (name.empty() ? "" : ", ") + std::to_string(int(mixture[t])) + " " + texture;
  }
  soil["code"] = code;
  soil["name"] = name;
  soil["mixture"] = parts;
  return soil;
}

/// Between the rows of configs/soils/usda.json: up to 15, 22 to 26, above 30 % (sandy loam).
Json moisture_json() {
  Json json = Json::Object{
      {"dry", Json::Array{0.0, 18.0}}, {"moist", Json::Array{18.0, 28.0}}, {"wet", Json::Array{28.0, 1000.0}}};
  json["source"] =
      "middles of the gaps between the rows behind configs/soils/usda.json (sandy loam: up to 15, 22 to 26, above 30 "
      "%)";
  return json;
}

}  // namespace

RegionMade make_region(const RegionMakeRequest& request) {
  RegionMade made;
  const SoilFolder found = read_soil_folder(request.folder);
  const GroundWater water = choose_water(request, found, made.remarks);
  const SoilCells cells(found, request.texture_error, water.property);
  const auto elevation = terrain::RasterSource::open_elevation(found.elevation);
  const auto on_elevation =
      terrain::RasterSource::open_on_grid(found.layers.front().files, elevation.grid(), terrain::RasterKind::classes);
  for (const std::string& remark : on_elevation.remarks()) made.remarks.push_back(remark);
  for (const std::string& remark : cells.remarks()) made.remarks.push_back(remark);
  for (const std::string& name : found.left_out)
    made.remarks.push_back(name + " lies deeper than 30 cm and is left out");
  if (std::none_of(found.layers.begin(), found.layers.end(),
                   [](const SoilLayer& l) { return l.statistic != SoilStatistic::middle; }))
    made.remarks.push_back(
        line("no low and high values: a standard error of %g %% is assumed for sand and clay", request.texture_error));
  SoilFindings findings;
  const Mixtures mixtures = find_mixtures(cells, findings);
  check_findings(found, findings, made.remarks);
  if (mixtures.parts < 8)
    made.remarks.push_back(line("mixtures are rounded to %d parts, so that a byte holds their codes", mixtures.parts));
  made.files.push_back(request.folder / "region.json");
  write_layers(request, cells, mixtures, water, made);
  Json region = Json::object(), rasters = Json::array(), soils = Json::array();
  rasters.push_back(raster_json("elevation", found.elevation.filename().string(), found.elevation.filename().string(),
                                "licence not stated"));
  rasters.push_back(raster_json("soil_class", "soil_class.tif", "textures of " + found.source, found.licence));
  if (water.property)
    rasters.push_back(raster_json("moisture", "water.tif",
                                  line("water at %d kPa over bulk density of ", water.suction) + found.source,
                                  found.licence));
  for (const auto& [mixture, code] : mixtures.code) soils.push_back(soil_json(mixture, code));
  region["schema"] = "gonogo/region/1";
  region["region"] =
      request.name.empty() ? fs::absolute(request.folder / "").parent_path().filename().string() : request.name;
  region["rasters"] = rasters;
  region["soils"] = soils;
  region["moisture"] = moisture_json();
  write_file_atomically(made.files.front(), region.dump(2) + "\n");
  made.soils = int(mixtures.code.size());
  return made;
}

}  // namespace gonogo::map
