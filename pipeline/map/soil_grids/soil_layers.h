// Rasters of soil properties as SoilGrids and SSURGO publish them, recognised by their file names.
//
//   SoilGrids 2.0   sand_0-5cm_mean.tif, clay_5-15cm_Q0.05.tif, bdod_0-5cm_mean.vrt, wv0033_0-5cm_mean.tif
//   SSURGO          sandtotal_r.tif, claytotal_l.tif, dbthirdbar_r.tif, wthirdbar_r.tif
//   gNATSGO         mukey.tif, a raster of map units, and mukey.csv, a table of the columns of SSURGO by map unit
//
// Units: SoilGrids, FAQ (docs.isric.org/globaldata/soilgrids/SoilGrids_faqs_01.html): sand, silt, clay g/kg; bdod
// cg/cm3; wv 1e-3 cm3/cm3. SSURGO, table chorizon (SSURGO Metadata, Table Column Descriptions, NRCS): per cent by mass,
// g/cm3 at 33 kPa, per cent by volume.
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "terrain/raster/grid.h"

namespace gonogo::map {

/// Water: held against a suction of 10, 33 and 1500 kPa.
enum class SoilProperty { sand, silt, clay, bulk_density, water_10, water_33, water_1500 };
inline constexpr std::size_t kSoilProperties = 7;
/// Mean or median or representative value; 5 % and 95 % point, or low and high value.
enum class SoilStatistic { middle, low, high };

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

}  // namespace gonogo::map
