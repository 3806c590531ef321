// The soils of a region with their tabulated answers. The key is the soil code of the raster and the moisture state.
// Fine-grained soils have two more entries for cells with a measured cone index: high enough, and below VCI50. Ditches
// that a model answers for have an entry for every soil in which they lie.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

#include "pipeline/map/evaluate/soil_response.h"
#include "pipeline/map/region/sources.h"

namespace gonogo::map {

/// What a measured cone index says of a fine-grained soil; one below VCI1 is a rule.
enum class Measured { nothing, firm, soft };

struct SoilTable {
  std::vector<Soil> soils;                   // the name includes the moisture state, if there is one
  std::vector<SoilResponse> responses;       // [soils]
  std::vector<int> moisture;                 // [soils] 0: any state; k: the region's k-th state
  std::vector<char> may_be_soft;             // [soils] 1: may be fine-grained, a measured cone index counts
  ConeIndexNeed need;                        // the measured cone index is compared with it
  std::vector<std::uint64_t> cells;          // [soils] cells with a slope; counted while the map is made
  std::vector<std::string> without_samples;  // "wet loam": soils without a sample in that state
  std::vector<char> has_ditch;               // [soils] 1: the entry of a ditch
  std::vector<Measured> measured;            // [soils] of a ditch as of its soil

  /// Position in `soils`; nothing if the table does not list the code or has no sample in this state.
  std::optional<std::size_t> find(int code, int state) const { return find(code, state, Measured::nothing); }
  std::optional<std::size_t> find(int code, int state, Measured measured) const;
  /// The entry of a ditch, by its position in MapSources::ditches, in the soil at a position of `soils`.
  std::optional<std::size_t> find_ditch(std::size_t soil, std::size_t ditch) const;

  void add(Soil soil, int state, bool soft_allowed, Measured measured, SoilResponse response);
  void add_ditch(std::size_t soil, std::size_t ditch, Soil with_ditch, SoilResponse response);

 private:
  void append(Soil soil, int state, bool soft_allowed, SoilResponse response, bool ditch);
  static std::int64_t key(int code, int state, Measured measured) {
    return std::int64_t(code) * 16 + 4 * state + int(measured);
  }

  std::unordered_map<std::int64_t, std::size_t> index_;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> ditch_;  // by (soil, ditch)
};

/// Standard error of Horn's gradient [rise per metre]: e sqrt(1 - r) sqrt(12) / (8 cell). e is the elevation's standard
/// error [m], r its correlation between neighbouring cells. 12 is the sum of the squared weights 1 2 1 of both sides.
double gradient_error(const RegionRaster& elevation, const terrain::MapGrid& grid);

/// Tabulates the model for every soil of the region and every moisture state that the map needs. `error_of_gradient`
/// [rise per metre] widens the interval on P(go). Throws InputError for a moisture that the region does not define.
SoilTable make_soil_table(const OutcomeModel& model, const Region& region, const MapRules& rules,
                          double error_of_gradient);

/// The table of a map: leaves out soils by name that do not occur on it, and has an entry for every ditch of the
/// sources in every soil in which one of its cells lies. The vehicle is no faster there than the trials that crossed
/// ditches.
SoilTable make_soil_table(const OutcomeModel& model, const Region& region, const MapRules& rules,
                          double error_of_gradient, const MapSources& sources);

}  // namespace gonogo::map
