// Compares two maps of one region: where each passes, how much P(go) differs, and whether the difference is
// significant.
//
// Both maps give 5 % and 95 % points of P(go). s = (high - low) / (2 x 1.645) is taken as the standard deviation.
// z = (P2 - P1) / sqrt(s1^2 + s2^2); a difference with |z| >= 1.96 is called significant. The errors of the two maps
// are treated as independent. In truth both share the errors of slope and soil, which cancel in the difference. The
// test is therefore conservative: it misses some real differences.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/json/json.h"

namespace gonogo::map {

struct CompareRequest {
  std::filesystem::path first, second;  // map folders, both for the uphill heading
  std::filesystem::path out;            // folder for the results
  int threads = 0;                      // 0: all cores
};

/// In which of the two maps a cell passes, as go or slow_go.
enum class PassChange : int { both = 1, only_first = 2, only_second = 3, neither = 4, unknown = 5 };
/// How P(go) changes from the first map to the second.
enum class GoChange : int { lower = 1, not_significant = 2, higher = 3 };

/// z as above. If both intervals are empty, it is 0 for equal P(go) and infinite otherwise.
double significance(double p1, double low1, double high1, double p2, double low2, double high2);
PassChange pass_change(int verdict1, int verdict2);

/// Writes change.tif, difference.tif (P2 - P1), significance.tif (z), change_significance.tif, compare.png (figure),
/// change.png, change.kml and compare.csv. Returns cells, area and share of every class. Throws InputError for a folder
/// without a map, for maps of different grids, and for headings other than uphill.
Json compare_maps(const CompareRequest& request);
std::string compare_text(const Json& result);

}  // namespace gonogo::map
