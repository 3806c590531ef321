// Two maps of one region side by side: where either passes, by how much P(go) differs, and whether that is more than
// what both leave open.
//
// With the 5 % and 95 % points of P(go) in both maps, s = (high - low) / (2 x 1.645) stands for a standard deviation
// and z = (P2 - P1) / sqrt(s1^2 + s2^2) says how many of them the difference is; |z| >= 1.96 is called significant. The
// two maps' errors are taken as independent; what they share (slope, soil) cancels in truth, so that real differences
// are rather missed than made up.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/json/json.h"

namespace gonogo::map {

struct CompareRequest {
  std::filesystem::path first, second;  // folders of maps, both for the uphill heading
  std::filesystem::path out;            // folder
  int threads = 0;
};

/// Which of the two passes (go or slow-go) in a cell.
enum class PassChange : int { both = 1, only_first = 2, only_second = 3, neither = 4, unknown = 5 };
/// How P(go) changes from the first to the second.
enum class GoChange : int { lower = 1, not_significant = 2, higher = 3 };

/// 0 when nothing is open in either and they are the same, infinite when they differ.
double significance(double p1, double low1, double high1, double p2, double low2, double high2);
PassChange pass_change(int verdict1, int verdict2);

/// Writes change.tif, difference.tif (P2 - P1), significance.tif (z), change_significance.tif, compare.png (figure),
/// change.png and change.kml, compare.csv. Cells, area and share of every class in the result. Throws InputError for
/// folders that hold no map, maps of different grids or of another heading than uphill.
Json compare_maps(const CompareRequest& request);
std::string compare_text(const Json& result);

}  // namespace gonogo::map
