// Bekker, Janosi-Hanamoto, Wong & Reece and Ishigami (vehicle/semi_empirical/bekker_wong.h) on a benchmark's points:
// what people use today, in the same table.
#pragma once
#include "pipeline/inspect/soil_numbers.h"
#include "pipeline/lab/wheels/run.h"
#include "vehicle/semi_empirical/bekker_wong.h"

namespace gonogo::lab {

/// Soil numbers and what else they may be: the nominal ones first.
struct BekkerCases {
  std::vector<vehicle::BekkerSoil> soil;
};

/// As measured by others, from the benchmark's soil: nothing where it has no Bekker numbers or no Janosi K. The cases
/// are the ends of its ranges.
std::optional<BekkerCases> measured_numbers(const Benchmark& b);
/// As tests of our grains give them: a standard error up and down of each number.
BekkerCases exported_numbers(const inspect::SoilNumbers& numbers);

/// A point that the formulas cannot do, such as a wheel that sinks to its axle, stays without prediction. On a slope
/// the slip is that at which the pull is the load's part along it; 1 where none is. A whole vehicle is its mean wheel.
Predictor analytic_predictor(const Benchmark& b, const BekkerCases& cases, const std::string& name,
                             const std::string& about);

}  // namespace gonogo::lab
