// The rasters and shapes of a region, opened on the grid of its elevation and read window by window.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "pipeline/campaign/design/design.h"
#include "pipeline/map/region/region.h"
#include "pipeline/map/region/rules.h"
#include "terrain/raster/raster_source.h"
#include "terrain/raster/vector/read_vector.h"

namespace gonogo::map {

/// What the obstacles of a region make of a cell.
struct ObstacleMark {
  enum class Kind : std::uint8_t {
    none,   // the soil decides
    rule,   // a rule decides; index: its position in land_rules()
    road,   // index: code of the road's soil
    ditch,  // a ditch of a modelled size crosses the soil; index: its position in MapSources::ditches
  };
  Kind kind = Kind::none;
  std::uint32_t index = 0;  // below kMostMarks
};

struct MapSources {
  terrain::RasterSource elevation;
  std::optional<terrain::RasterSource> soil_class, land_cover, moisture, cone_index;
  std::shared_ptr<const terrain::ShapeCells> obstacles;  // null: none; numbers of marks
  std::vector<DitchSize> ditches{};                      // that a model answers for
  double ditch_step = 0;                                 // to which their sizes are rounded up [m]

  /// Opens the same rasters again, for use by another thread.
  MapSources again() const;
  /// One sentence each, without a full stop: what was found in the files.
  std::vector<std::string> remarks() const;
};

/// Opens the region's rasters on the grid of its elevation. Throws InputError for files that cannot be read and for a
/// map of fewer than 3 x 3 cells.
MapSources open_sources(const Region& region);

/// What the rasters say about the cells of a window, as far as the region has them.
class Readings {
 public:
  Readings(const MapSources& sources, terrain::Window window);

  std::size_t size() const { return size_; }
  /// Code of the soil; nothing where the raster does not say. Without a soil raster 0.
  std::optional<int> soil_code(std::size_t cell) const;
  /// 0: any moisture; k: the region's k-th state.
  int moisture_state(const Region& region, const MapRules& rules, std::size_t cell) const;
  /// Position in land_rules() of the rule that land cover, or an exactly flat area, makes; nothing: the soil decides.
  std::optional<std::size_t> land_rule(const Region& region, std::size_t cell) const;
  ObstacleMark obstacle(std::size_t cell) const;
  /// [counts of the raster]; nothing where none was measured.
  std::optional<double> cone_index(std::size_t cell) const;

 private:
  std::size_t size_;
  std::optional<terrain::Tile> soil_, moisture_, land_, cone_index_, flat_, obstacle_;
};

/// Codes that occur in the soil raster, which the sources must have.
std::set<int> soil_codes(const MapSources& sources);

/// Share of the cells with a slope whose slope and soil lie inside the ranges that a design samples [0, 1]. The heading
/// is uphill. A soil counts with the share of its points that lie inside. Variables that the design holds fixed are
/// ignored, and so are variables that the region does not know.
double share_inside(const Region& region, const campaign::DesignSpec& spec);

}  // namespace gonogo::map
