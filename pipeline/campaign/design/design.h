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
//   original         lines of "file" as the original study wrote them (point_file.h)
//
// Section or preset give each variable of the contract a range or a fixed value. After every `replicate_every` points,
// one of them, drawn at random, is repeated with another bed seed: 96 points with 10 are 105 trials. A longer design
// begins with the same trials. A factorial has one length.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "pipeline/campaign/trial/record.h"

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

}  // namespace gonogo::campaign
