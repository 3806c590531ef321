// A region: its rasters, and what its soil classes mean in the variables of the contract. The file's schema is
// configs/schema/region.json.
#pragma once
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "pipeline/map/region/obstacle.h"
#include "pipeline/map/region/spread.h"
#include "terrain/raster/grid.h"

namespace gonogo::map {

struct RegionRaster {
  terrain::RasterFiles files;
  std::string source, licence;
  double error = 0;               // standard error of elevations [m]; 0: not stated
  double error_correlation = 0;   // of that error between neighbouring cells [-1, 1]
  double unit = 1;                // one count of a cone index raster [Pa]
  terrain::HeightWish heights{};  // of the elevation
};

/// Values measured together on one sample of a soil, or the ranges of a soil that is known by name. Other variables
/// follow the spreads of the soil.
struct SoilSample {
  Spreads values;
  std::string source;
  std::optional<double> water_percent = std::nullopt;  // of the dry mass; none: not measured
  std::optional<double> cone_index = std::nullopt;     // [Pa]; none: not measured
  std::string texture{};                               // empty: as the soil's
  std::string moisture{};                              // "dry", "moist" or "wet" without a water content; empty: any
};

/// What a land cover code means. A verdict holds whatever the soil; without a verdict the soil decides.
struct LandRule {
  int code = 0;  // in the land cover raster
  std::string name;
  std::optional<campaign::Verdict> verdict;          // no_go or unknown
  campaign::Reason reason = campaign::Reason::none;  // water, vegetation or built_up
};

/// A moisture state. Samples with a water content in [low, high) belong to it.
struct MoistureState {
  std::string name;          // "dry", "moist" or "wet"
  double low = 0, high = 0;  // [percent of the dry mass]
};

struct Soil {
  int code = 0;  // in the soil class raster
  std::string name;
  std::string note;
  std::string texture;              // one of terrain::usda_textures(); empty: as the region's
  std::vector<SoilSample> samples;  // equally likely; empty: `values` alone hold
  Spreads values;
  int draws = 0;                                               // points drawn for each sample; 0: as the rules say
  double max_speed = std::numeric_limits<double>::infinity();  // of a road [m/s]
  bool given = true;  // false: nobody said what the soil is, the samples are all that it may be
};

struct Region {
  std::filesystem::path file;
  std::string name, about;
  RegionRaster elevation;
  std::optional<RegionRaster> soil_class, land_cover, moisture, cone_index;
  terrain::GridWish grid;
  std::optional<double> gravity;           // [m/s^2]; none: that of the elevation's body
  std::vector<LandRule> land;              // for the codes of land_cover
  std::vector<MoistureState> moistures;    // empty: moisture is not told apart
  std::vector<Obstacle> obstacles;         // in the file's order
  std::optional<CrossingLimits> crossing;  // of the vehicle; none: obstacles but buildings are unknown
  std::vector<Soil> soils;                 // empty without a soil raster: `values` hold everywhere
  std::string texture;                     // of soils without one of their own; empty: not known
  Spreads values;                          // for variables that a soil does not give
  std::string soil_text{};                 // names and hashes of soils that come by name; empty: none does
};

/// Soils of roads have codes from here on, beyond those of rasters.
inline constexpr int kRoadCode = 100000;

/// Samples of a soil in a moisture state: by their water content, else by the name of their moisture. A sample without
/// either belongs to every state.
std::vector<SoilSample> samples_in(const Soil& soil, const MoistureState& state);

/// Reads a region file. Paths in it are relative to its folder. Does not open the rasters. Throws InputError.
Region read_region(const std::filesystem::path& path);

/// Rules that decide before the soil does. First come the region's own, in their order. Four follow: for a land cover
/// code that the region does not list, for a measured cone index below VCI1 and below VCI50, and for large exactly flat
/// areas of which nobody said what they are. Two follow for each obstacle: no_go, and unknown.
std::vector<LandRule> land_rules(const Region& region);
inline std::size_t land_unknown_rule(const Region& region) { return region.land.size(); }
inline std::size_t below_one_pass_rule(const Region& region) { return region.land.size() + 1; }
inline std::size_t below_fifty_passes_rule(const Region& region) { return region.land.size() + 2; }

inline std::size_t flat_rule(const Region& region) { return region.land.size() + 3; }
inline std::size_t obstacle_rule(const Region& region, std::size_t obstacle, Crossing crossing) {
  return region.land.size() + 4 + 2 * obstacle + (crossing == Crossing::unknown);
}

/// Equally likely points of a soil over the variables of the contract [points][variable count]; slopes are NaN. Every
/// sample is combined with every one of `draws` points of the ranges. `overriding` wins over the soil's values, and
/// these win over the region's. A soil's own number of draws wins over `draws`; its samples then take shifted sets.
std::vector<std::vector<double>> soil_points(const Region& region, const Soil& soil, const Spreads& overriding,
                                             int draws);

}  // namespace gonogo::map
