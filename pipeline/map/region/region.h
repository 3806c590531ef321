// A region: its rasters, and what its soil classes mean in the variables of the contract. The file's schema is
// configs/schema/region.json.
#pragma once
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "base/units.h"
#include "pipeline/map/region/obstacle.h"
#include "pipeline/map/soils/soil.h"
#include "terrain/raster/grid.h"
#include "terrain/soil/calibration.h"

namespace gonogo::map {

using terrain::has_data;
using terrain::kNoData;

struct RegionRaster {
  terrain::RasterFiles files;
  std::string source, licence;
  double error = 0;               // standard error of elevations [m]; 0: not stated
  double error_correlation = 0;   // of that error between neighbouring cells [-1, 1]
  double unit = 1;                // one count of a cone index raster [Pa]
  terrain::HeightWish heights{};  // of the elevation
};

/// What a land cover code means. A verdict holds whatever the soil; without a verdict the soil decides.
struct LandRule {
  int code = 0;  // in the land cover raster
  std::string name;
  std::optional<campaign::Verdict> verdict{};        // no_go or unknown
  campaign::Reason reason = campaign::Reason::none;  // water, vegetation or built_up
};

struct Region {
  std::filesystem::path file;
  std::string name, about;
  RegionRaster elevation;
  std::optional<RegionRaster> soil_class, land_cover, moisture, cone_index;
  std::optional<double> cone_index_everywhere{};  // in place of the raster [Pa]
  terrain::GridWish grid;
  std::optional<double> gravity;                // [m/s^2]; none: that of the elevation's body
  std::vector<LandRule> land;                   // for the codes of land_cover
  std::vector<MoistureState> moistures;         // empty: moisture is not told apart
  std::vector<Obstacle> obstacles;              // in the file's order
  std::optional<CrossingLimits> crossing;       // of the vehicle; none: obstacles but buildings are unknown
  std::vector<Soil> soils;                      // empty without a soil raster: `values` hold everywhere
  std::string texture;                          // of soils without one of their own; empty: not known
  Spreads values;                               // for variables that a soil does not give
  std::optional<terrain::Calibration> table{};  // of the model's grains, whose triaxial angle is the model's variable
  std::string soil_text{};                      // names and hashes of soils that come by name; empty: none does
};

/// Whether a cone index was measured, somewhere or everywhere.
inline bool has_cone_index(const Region& region) {
  return region.cone_index.has_value() || region.cone_index_everywhere.has_value();
}
/// Greatest cone index that is read [Pa]: that of a penetrometer's dial with the smaller cone.
inline constexpr double kMaxConeIndex = 750 * kPsi;

/// Reads a region file. Paths in it are relative to its folder. Does not open the rasters. Throws InputError.
Region read_region(const std::filesystem::path& path);

/// Rules that decide before the soil does. First come the region's own, in their order. Three follow: for a land cover
/// code that the region does not list, for a measured cone index below VCI1, and for large exactly flat areas of which
/// nobody said what they are. Two follow for each obstacle: no_go, and unknown.
std::vector<LandRule> land_rules(const Region& region);
inline std::size_t land_unknown_rule(const Region& region) { return region.land.size(); }
inline std::size_t below_one_pass_rule(const Region& region) { return region.land.size() + 1; }
inline std::size_t flat_rule(const Region& region) { return region.land.size() + 2; }
inline std::size_t obstacle_rule(const Region& region, std::size_t obstacle, Crossing crossing) {
  return region.land.size() + 3 + 2 * obstacle + (crossing == Crossing::unknown);
}

/// Equally likely points of a soil over the variables of the contract [points][variable count]; slopes are NaN. Every
/// sample is combined with every one of `draws` points of the ranges. Friction angles of other tests, and the cohesions
/// beside them, become those of triaxial compression, by the region's table where it has one. `overriding` wins over
/// the soil's values, and these win over the region's. A soil's own number of draws wins over `draws`; its samples then
/// take shifted sets.
std::vector<std::vector<double>> soil_points(const Region& region, const Soil& soil, const Spreads& overriding,
                                             int draws);

/// "1.62 m/s2"
std::string gravity_text(double gravity);

/// Whether two are the same for trials: within 2 %. On the Earth gravity varies by 0.5 %.
bool is_same_gravity(double a, double b);

/// Gravity of the region's ground [m/s^2]: what its file says, or that of the body with this equatorial radius [m].
/// Throws InputError where neither gives it, and where they contradict each other.
double ground_gravity(const Region& region, double body_radius);

/// Throws InputError unless the ground has the gravity of the model's trials [m/s^2].
void require_gravity(const Region& region, double body_radius, double of_trials);

}  // namespace gonogo::map
