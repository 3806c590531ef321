// Soil layers of a folder read together, window by window: shares of sand, silt and clay with their errors, and water.
#pragma once
#include <memory>
#include <optional>
#include <unordered_map>

#include "pipeline/map/soil_grids/soil_layers.h"
#include "pipeline/map/soil_grids/texture_mixture.h"
#include "terrain/raster/raster_source.h"

namespace gonogo::map {

/// What was met while reading, for remarks and refusals.
struct SoilFindings {
  std::uint64_t cells = 0, known = 0;
  std::uint64_t off = 0;   // cells whose shares add up to less than 90 or more than 110 %
  double mean_sum = 0;     // of the shares as they are [%]; only where all three are given
  std::uint64_t sums = 0;  // cells behind it
};

class SoilCells {
 public:
  /// `error`: standard error of sand and clay where no low and high values are given [%]. `water`: the property that
  /// water() answers; nothing: none. The cells are those of the first layer. Throws InputError for rasters and tables
  /// that cannot be read, and for map units in the table twice.
  SoilCells(const SoilFolder& folder, double error, std::optional<SoilProperty> water);

  const terrain::MapGrid& grid() const { return sources_.front().grid(); }

  struct Window {
    std::vector<std::optional<TextureShares>> shares;  // none: no data
    terrain::Tile water;                               // [% of the dry mass], NaN: no data
  };
  /// Throws InputError for shares above 100 % and other values that the unit does not allow.
  Window read(terrain::Window window, SoilFindings& findings) const;

 private:
  struct Table;
  double value_at(std::size_t layer, float cell) const;

  const SoilFolder& folder_;
  double error_;
  std::optional<SoilProperty> water_;
  std::vector<terrain::RasterSource> sources_;                    // [layer]
  std::unordered_map<std::int64_t, std::vector<double>> row_of_;  // map unit -> [layer]
};

}  // namespace gonogo::map
