// What is known about a variable: a value, a range with a uniform distribution, or nothing.
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

/// By name of the variable. A variable that is not listed is unknown, and the model sums it out.
using Spreads = std::map<std::string, Spread>;

/// Reads an object that gives {"fixed": x, "source": ...}, {"range": [low, high], "source": ...} or {"unknown": why}
/// for each variable. Throws InputError for other variables, slopes, values outside the contract's range, and numbers
/// without a source. Slopes are refused because the elevation raster gives them.
Spreads read_spreads(const Config& config);

/// Equally likely points over all variables of the contract [points][variable count]; NaN where unknown, as slopes are,
/// and 0 for sizes of obstacles that are not given: there is none.
/// They are the Hammersley set of `draws` points over the ranges, or one point without a range. No random numbers.
/// Hammersley 1960, "Monte Carlo methods for solving multivariable problems". Every `shift` is another set: it is
/// rotated by shift times the square root of the dimension's prime, modulo 1 (Cranley and Patterson 1976).
std::vector<std::vector<double>> spread_points(const Spreads& spreads, int draws, int shift = 0);

}  // namespace gonogo::map
