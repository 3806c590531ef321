// Soils of a region: what may be known of them, as region files describe them, and by name.
#pragma once
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "pipeline/campaign/study/contract.h"
#include "terrain/soil/strength.h"

namespace gonogo::map {

/// What is known about a variable: a value, a range with a uniform distribution, or nothing.
struct Spread {
  enum class Kind { unknown, fixed, range };
  Kind kind = Kind::unknown;
  double low = 0, high = 0;                        // [unit of the variable]; equal when fixed
  std::string source;                              // where the number comes from, or why there is none
  terrain::AngleMeaning meaning{.assumed = true};  // of a friction angle and the cohesion beside it
};

/// By name of the variable. A variable that is not listed is unknown, and the model sums it out.
using Spreads = std::map<std::string, Spread>;

/// Source of numbers that a vehicle has and the ground does not.
inline std::string vehicle_source(const std::string& vehicle) { return "file of the vehicle " + vehicle; }

/// Reads an object that gives {"fixed": x, "source": ...}, {"range": [low, high], "source": ...} or {"unknown": why}
/// for each variable. A friction angle may say its "test", "stage" and "dilation_deg"; without them it is that of
/// triaxial compression, peak. Throws InputError for other variables, slopes, values outside the contract's range, and
/// numbers without a source. Slopes are refused because the elevation raster gives them.
Spreads read_spreads(const Config& config);

/// Equally likely points over all variables of the contract [points][variable count]; NaN where unknown, as slopes are,
/// and 0 for sizes of obstacles that are not given: there is none.
/// They are the Hammersley set of `draws` points over the ranges, or one point without a range. No random numbers.
/// Hammersley 1960, "Monte Carlo methods for solving multivariable problems". Every `shift` is another set: it is
/// rotated by shift times the square root of the dimension's prime, modulo 1 (Cranley and Patterson 1976).
std::vector<std::vector<double>> spread_points(const Spreads& spreads, int draws, int shift = 0);

/// Values measured together on one sample of a soil, or the ranges of a soil that is known by name. Other variables
/// follow the spreads of the soil.
struct SoilSample {
  Spreads values;
  std::string source;
  std::optional<double> water_percent = std::nullopt;  // of the dry mass; none: not measured
  std::optional<double> cone_index = std::nullopt;     // [Pa]; none: not measured
  std::string texture{};                               // empty: as the soil's
  std::string moisture{};                              // "dry", "moist" or "wet" without a water content; empty: any
  int alternative = 0;  // samples of different numbers are alternatives, of which nobody said which one holds
};

/// A moisture state. Samples with a water content in [low, high) belong to it.
struct MoistureState {
  std::string name;          // "dry", "moist" or "wet"
  double low = 0, high = 0;  // [percent of the dry mass]
};

/// A soil of a region.
struct Soil {
  int code = 0;  // in the soil class raster
  std::string name;
  std::string note{};
  std::string texture{};              // one of terrain::usda_textures(); empty: as the region's
  std::vector<SoilSample> samples{};  // equally likely; empty: `values` alone hold
  Spreads values{};
  int draws = 0;                                               // points drawn for each sample; 0: as the rules say
  double max_speed = std::numeric_limits<double>::infinity();  // of a road [m/s]
  std::string
      not_texture{};  // file of a soil that has the name of a USDA texture and is another one; empty: no such name
  std::vector<std::string> doubts{};  // one sentence each: measurements of it that contradict each other
  bool given = true;                  // false: nobody said what the soil is, the samples are all that it may be
};

/// Soils of roads have codes from here on, beyond those of rasters.
inline constexpr int kRoadCode = 100000;

/// Samples of a soil in a moisture state: by their water content, else by the name of their moisture. A sample without
/// either belongs to every state.
std::vector<SoilSample> samples_in(const Soil& soil, const MoistureState& state);

/// Key "texture"; empty when the file does not give it.
std::string read_texture(const Config& config);

/// Samples, draws and texture of a soil whose name stands under `key`. Throws InputError.
void take_named(const Config& config, const std::string& key, Soil& soil);

/// An entry of "soils". Throws InputError.
Soil read_soil(const Config& config);

/// A road's soil: "paved", or as "like" of a soil. Paved ground is stronger than any that trials sampled.
Soil read_road_soil(const Config& config, int code, const std::string& name);

/// A soil by name, for maps and region files that hold no table of their own. `text`: a USDA texture of
/// configs/soils/usda.json ("sandy loam"), a class of the USCS ("SM") in uscs.json, the name of a soil in configs/soils
/// ("lete_sand"), or a soil file; a moisture may follow ("sandy loam, wet"), or be asked for beside it. Every value of
/// a range is as likely. Each of the soil's states is one sample; with a moisture
/// ("dry", "moist" or "wet") only the states of that moisture are. Throws InputError for an unknown name, with the
/// nearest ones, and for a soil without a state of that moisture.
Soil named_soil(const std::string& text, const std::string& asked);

/// What a soil may be that nobody named: every USDA texture, at this moisture or at any if it is empty.
Soil soil_not_given(const std::string& moisture);

/// The soils of a raster of USDA textures. `class_names` are the names that the raster gives its codes, from code 0 on;
/// without any the codes are 1 to 12 of terrain::usda_texture_codes(). Names that are no texture are left out.
/// Throws InputError, with `where` first, if the raster names no texture.
std::vector<Soil> texture_soils(const std::vector<std::string>& class_names, const std::string& moisture,
                                const std::string& where);

/// Hash of the soil files behind such a text, for the record of a map.
std::string soil_hash(const std::string& text);

}  // namespace gonogo::map
