// What is known of a variable at a place: a value, a range in which every value is as likely, or nothing.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "pipeline/campaign/study/contract.h"

namespace gonogo::map {

struct Spread {
  enum class Kind { unknown, fixed, range };
  Kind kind = Kind::unknown;
  double low = 0, high = 0;  // [unit of the variable]; equal when fixed
  std::string source;        // where the number comes from, or why there is none
};

/// By name of the variable. Variables that are not listed are unknown: the model sums them out.
using Spreads = std::map<std::string, Spread>;

/// An object of {"fixed": x, "source": ...}, {"range": [low, high], "source": ...} or {"unknown": why} by variable.
/// Throws InputError for other variables, values outside the contract's range, or numbers without a source.
/// Slopes come from the elevation raster and are refused here.
Spreads read_spreads(const Config& config);

/// Equally weighted points over all variables of the contract, not-a-number where unknown: the Hammersley set of
/// `draws` points over the ranges (one point when there is no range), so always the same points. Slopes stay unknown.
/// Hammersley 1960, "Monte Carlo methods for solving multivariable problems".
std::vector<std::vector<double>> spread_points(const Spreads& spreads, int draws);

}  // namespace gonogo::map
