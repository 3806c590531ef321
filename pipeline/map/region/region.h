// A region: its rasters, and what its soil classes mean in the variables of the contract. configs/schema/region.json
// describes the file.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "pipeline/map/region/spread.h"
#include "terrain/raster/grid.h"

namespace gonogo::map {

struct RegionRaster {
  terrain::RasterFiles files;
  std::string source, licence;
  double error = 0;              // of elevations: standard error [m], 0 when not stated
  double error_correlation = 0;  // between neighbouring cells
  double unit = 1;               // of cone indices [Pa]
};

/// Values measured together on one sample of a soil; the rest of the soil's variables follow its own spreads.
struct SoilSample {
  Spreads values;  // all fixed
  std::string source;
  std::optional<double> water_percent = std::nullopt;  // of the dry mass, when it was measured
  std::optional<double> cone_index = std::nullopt;     // [Pa], when it was measured
};

/// What a land cover code says whatever the soil: a verdict with its reason, or nothing (the soil decides).
struct LandRule {
  int code = 0;  // in the land cover raster
  std::string name;
  std::optional<campaign::Verdict> verdict;          // no_go or unknown
  campaign::Reason reason = campaign::Reason::none;  // water, vegetation or built_up
};

/// A state of the soil's moisture: the samples whose water content lies in [low, high) belong to it.
struct MoistureState {
  std::string name;          // "dry", "moist" or "wet"
  double low = 0, high = 0;  // [percent of the dry mass]
};

struct Soil {
  int code = 0;  // in the soil class raster
  std::string name;
  std::string note;
  std::string texture;              // one of terrain::usda_textures(); empty: the region's, or not known
  std::vector<SoilSample> samples;  // equally likely; empty: only `values`
  Spreads values;
};

struct Region {
  std::filesystem::path file;
  std::string name, about;
  RegionRaster elevation;
  std::optional<RegionRaster> soil_class, land_cover, moisture, cone_index;
  terrain::GridWish grid;
  std::vector<LandRule> land;            // of land_cover
  std::vector<MoistureState> moistures;  // empty: the region does not tell moisture apart
  std::vector<Soil> soils;               // empty when the region names no soil raster: `values` hold everywhere
  std::string texture;                   // of every soil that does not say otherwise; empty: not known
  Spreads values;                        // for every soil that does not say otherwise
};

/// Samples of a soil that belong to a state of moisture; one whose water content was not measured belongs to all.
std::vector<SoilSample> samples_in(const Soil& soil, const MoistureState& state);

/// Throws InputError. Paths are relative to the region's folder; the rasters themselves are opened by the map.
Region read_region(const std::filesystem::path& path);

/// What decides in a cell whatever its soil: the region's own rules in their order, then the one for land cover that
/// none of them names, then those for fine-grained soil that was measured below VCI1 and below VCI50.
std::vector<LandRule> land_rules(const Region& region);
inline std::size_t land_unknown_rule(const Region& region) { return region.land.size(); }
inline std::size_t below_one_pass_rule(const Region& region) { return region.land.size() + 1; }
inline std::size_t below_fifty_passes_rule(const Region& region) { return region.land.size() + 2; }

/// Equally weighted points of a soil over the variables of the contract (slopes not-a-number): every sample with every
/// drawn point of the ranges. `overriding` values win over the soil's, those over the region's.
std::vector<std::vector<double>> soil_points(const Region& region, const Soil& soil, const Spreads& overriding,
                                             int draws);

}  // namespace gonogo::map
