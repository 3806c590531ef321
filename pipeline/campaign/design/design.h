// Which points a campaign simulates: the study's "design" section.
//
//   "design": {
//     "method": "sobol", "points": 96, "replicate_every": 10, "preset": "realistic_soil",
//     "ranges": {"slope_along": [0, 35], ...}, "fixed": {"bed_depth": 0.3, ...},
//     "strata": [{"name": "dry sand", "share": 0.3, "ranges": {"friction_angle": [30, 40], "cohesion": [0, 1]}}, ...]
//   }
//
//   method           points
//   sobol            scrambled Sobol' sequence
//   latin_hypercube  Latin hypercubes of "block" points (default 64), one after the other
//   factorial        every combination of "levels": {"slope_along": 5, ...} values, evenly spaced, ends included
//   csv              rows of "file", whose header names variables; "ranges" are their box, by default what they span
//   original         lines of "file" as the original study wrote them (read_original_points)
//
// Section or preset give each variable of the contract a range or a fixed value. After every `replicate_every` points,
// one of them, drawn at random, is repeated with another bed seed: 96 points with 10 are 105 trials. A longer design
// begins with the same trials. A factorial has one length.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/json/config.h"
#include "pipeline/campaign/setup/record.h"

namespace gonogo::campaign {

struct SampledVariable {
  std::size_t variable;     // position in contract().variables
  double minimum, maximum;  // [unit of the variable]
};

/// A part of the sampled box that gets a share of the points: a soil, a load.
struct Stratum {
  std::string name;
  double share = 0;                     // of all points; all strata together have 1
  std::vector<SampledVariable> ranges;  // inside the design's; the others are the design's
};

struct DesignSpec {
  std::string method;
  std::uint64_t seed = 0;                  // of the study
  std::uint64_t points = 0;                // without replicates
  std::uint64_t replicate_every = 0;       // 0: no replicates
  std::vector<SampledVariable> ranges;     // in the order of the contract; of points from a file, what they span
  std::vector<double> fixed;               // per variable of the contract; NaN where it is sampled
  std::vector<Stratum> strata = {};        // empty: the whole box alike
  std::uint64_t block = 64;                // points of one Latin hypercube
  std::vector<std::uint64_t> levels = {};  // [ranges] of a factorial
  std::vector<DesignPoint> given = {};     // points of a file: variables and proposal_density
};

/// Reads and checks the section. Throws InputError for unknown variables, with the nearest known name, and for ranges
/// and counts out of range. A variable needs either a range or a fixed value.
DesignSpec read_design(const Config& section, std::uint64_t seed);

/// The same without the points of a file, which need not exist yet: method, ranges and fixed values.
DesignSpec read_design_box(const Config& section, std::uint64_t seed);

/// Number of trials, replicates included.
std::uint64_t trial_count(const DesignSpec& spec);

/// All points in order; make_design(longer)[i] = make_design(shorter)[i].
std::vector<DesignPoint> make_design(const DesignSpec& spec);

/// Density of the design's strata at a point, relative to uniform over the sampled box.
double stratified_density(const DesignSpec& spec, const std::vector<double>& variables);

/// Named ranges, by name of the variable, in its unit. The study must give the variables that are in neither map; what
/// it says itself overrides its preset.
struct DesignPreset {
  std::map<std::string, std::pair<double, double>> ranges;
  std::map<std::string, double> fixed;
};

std::vector<std::string> preset_names();

/// Empty for the empty name.
///
///   study_reproduction  the continuous ranges of the original study
///   realistic_soil      slopes that vehicles meet, soils from loose sand to firm clay
///
/// study_reproduction: R. Serban's go_nogo programs, projectchrono fork, commit 6e9a73d694, 2017-06-25. Slope 0 to 30
/// degrees straight uphill, friction 0.2 to 1.0 (as friction angle, atan: 11.3 to 45 degrees), tyre friction 0.8, bed
/// of 100 mm, go at 7 m in 6.5 s, 1.1 m/s. Its cohesion, a contact stress of 100 to 1000 kPa, is no soil's; the preset
/// takes the whole range of the contract.
///
/// realistic_soil: friction angles of 20 to 42 degrees and cohesions up to 25 kPa, which cover the soils of
/// configs/soils (sources there).
DesignPreset design_preset(const std::string& name);

/// Comma-separated values with a header that names variables of the contract, in any order, then one point per line. A
/// column "proposal_density" is needed where the points do not come from a uniform design. `fixed` [variable count]
/// holds the values of the variables without a column. Throws InputError with file and line.
std::vector<DesignPoint> read_point_csv(const std::filesystem::path& file, const std::vector<double>& fixed);

/// The original study's input (R. Serban's go_nogo programs, projectchrono fork, commit 6e9a73d694, 2017): one run per
/// line, "slope [deg]  particle radius [mm]  particle density [kg/m^3]  friction [-]  cohesion [kPa]".
///   slope -> slope_along;  friction -> friction_angle = atan(friction) (Coulomb);  cohesion -> cohesion *
///   cohesion_scale
/// Its cohesion is a contact stress, not a soil's, hence the scale. Radius and density belong to the grains of the
/// study's calibration here: they must be the same on every line.
std::vector<DesignPoint> read_original_points(const std::filesystem::path& file, const std::vector<double>& fixed,
                                              double cohesion_scale);

}  // namespace gonogo::campaign
