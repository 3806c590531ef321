// Rasters of soil properties in a folder, and the textures of their cells.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "terrain/raster/grid.h"
#include "terrain/raster/raster_source.h"

namespace gonogo::map {

/// Parts by texture, in the order of terrain::usda_texture_codes().
using TextureMixture = std::array<std::uint8_t, 12>;

/// Shares by mass [%] and their standard errors.
struct TextureShares {
  double sand = 0, silt = 0, clay = 0;
  double sand_error = 0, clay_error = 0;
};

/// Texture classes at 5 x 5 equally likely points of independent normal errors of sand and clay, kept inside the
/// triangle, rounded to `parts` parts by their largest remainders.
TextureMixture texture_mixture(const TextureShares& shares, int parts);

/// Water: held against a suction of 10, 33 and 1500 kPa.
enum class SoilProperty { sand, silt, clay, bulk_density, water_10, water_33, water_1500 };
inline constexpr std::size_t kSoilProperties = 7;
/// Mean or median or representative value; 5 % and 95 % point, or low and high value.
enum class SoilStatistic { middle, low, high };
/// Rasters of soil properties as SoilGrids and SSURGO publish them, recognised by their file names.
///
///   SoilGrids 2.0   sand_0-5cm_mean.tif, clay_5-15cm_Q0.05.tif, bdod_0-5cm_mean.vrt, wv0033_0-5cm_mean.tif
///   SSURGO          sandtotal_r.tif, claytotal_l.tif, dbthirdbar_r.tif, wthirdbar_r.tif
///   gNATSGO         mukey.tif, a raster of map units, and mukey.csv, a table of the columns of SSURGO by map unit
///
/// Units: SoilGrids, FAQ (docs.isric.org/globaldata/soilgrids/SoilGrids_faqs_01.html): sand, silt, clay g/kg; bdod
/// cg/cm3; wv 1e-3 cm3/cm3. SSURGO, table chorizon (SSURGO Metadata, Table Column Descriptions, NRCS): per cent by
/// mass, g/cm3 at 33 kPa, per cent by volume.
struct SoilLayer {
  SoilProperty property;
  SoilStatistic statistic;
  double thickness = 30;  // [cm]
  double per_count = 1;   // [%, g/cm3 or volume %] of one count of the file
  std::string unit;       // of a count, for messages
  std::string column;     // of mukey.csv; empty: the raster holds the values
  terrain::RasterFiles files;
};

struct SoilFolder {
  std::filesystem::path elevation;
  std::vector<SoilLayer> layers;
  std::filesystem::path table;          // mukey.csv; empty: none
  std::string source, licence;          // of the layers
  std::vector<std::string> left_out{};  // names of layers deeper than 30 cm
};

/// What a folder holds. The only raster that is no soil layer is the elevation; of several, the one whose name holds
/// "dem", "dtm" or "elev". Throws InputError: no folder, no elevation or several, no sand and clay, one property from
/// two publishers or without a middle.
SoilFolder read_soil_folder(const std::filesystem::path& folder);

/// What was found while reading, for remarks and refusals.
struct SoilFindings {
  std::uint64_t cells = 0, known = 0;
  std::uint64_t off = 0;   // cells whose shares add up to less than 90 or more than 110 %
  double mean_sum = 0;     // of the shares as they are [%]; only where all three are given
  std::uint64_t sums = 0;  // cells behind it
};
/// Soil layers of a folder read together, window by window: shares of sand, silt and clay with their errors, and water.
class SoilCells {
 public:
  /// `error`: standard error of sand and clay where no low and high values are given [%]. `water`: the property that
  /// water() answers; nothing: none. The cells are those of the first layer. Throws InputError for rasters and tables
  /// that cannot be read, and for map units in the table twice.
  SoilCells(const SoilFolder& folder, double error, std::optional<SoilProperty> water);

  const terrain::MapGrid& grid() const { return sources_.front().grid(); }
  /// What was found in the rasters, as RasterSource::remarks().
  std::vector<std::string> remarks() const;

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
