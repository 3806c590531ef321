// Which points a campaign simulates: the study's "design" section.
//
//   "design": {
//     "method": "sobol", "points": 96, "replicate_every": 10,
//     "ranges": {"slope_along": [0, 35], ...}, "fixed": {"bed_depth": 0.3, ...}
//   }
//
// Every variable of the contract is either ranged or fixed. After each `replicate_every` points one of them, taken at
// random, is repeated with another bed seed, so that 96 points with 10 are 105 trials. A longer design begins with the
// same trials.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "pipeline/trial/record.h"

namespace gonogo::pipeline {

struct SampledVariable {
  std::size_t variable;     // position in contract().variables
  double minimum, maximum;  // [unit of the variable]
};

struct DesignSpec {
  std::string method;                   // "sobol"
  std::uint64_t seed = 0;               // of the study
  std::uint64_t points = 0;             // without replicates
  std::uint64_t replicate_every = 0;    // 0: no replicates
  std::vector<SampledVariable> ranges;  // in the order of the contract
  std::vector<double> fixed;            // per variable of the contract; not-a-number where it is sampled
};

/// Reads and checks the section. Throws InputError for unknown variables (with the nearest known one), ranges outside
/// the contract's, variables that are neither ranged nor fixed or both, and counts out of range.
DesignSpec read_design(const Config& section, std::uint64_t seed);

/// Number of trials, replicates included.
std::uint64_t trial_count(const DesignSpec& spec);

/// All points in order; make_design(longer)[i] = make_design(shorter)[i].
std::vector<DesignPoint> make_design(const DesignSpec& spec);

/// How well the points, the first 8192 of a longer design, fill the sampled box.
struct Coverage {
  double discrepancy = 0;      // star discrepancy in the L2 norm (Warnock), of the points scaled to the unit cube
  double expected_random = 0;  // root mean square of the same for independent uniform points
  double largest_gap = 0;      // largest empty interval of any one-dimensional projection, as a share of the range
};
Coverage coverage(const DesignSpec& spec, const std::vector<DesignPoint>& design);

}  // namespace gonogo::pipeline
