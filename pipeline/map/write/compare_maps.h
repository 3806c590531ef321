// Compares two maps of one region: where each passes, how much P(go) differs, and whether the difference is
// significant.
//
// Both maps give 5 % and 95 % points of P(go). s = (high - low) / (2 x 1.645) is taken as the standard deviation.
// z = (P2 - P1) / sqrt(s1^2 + s2^2); a difference with |z| >= 1.96 is called significant. The errors of the two maps
// are treated as independent. In truth both share the errors of slope and soil, which cancel in the difference. The
// test is therefore conservative: it misses some real differences.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "base/units.h"

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

/// Cells of a class of the comparison.
struct ComparedClass {
  int code = 0;  // of PassChange or GoChange
  std::string label;
  std::uint64_t cells = 0;
  double area = 0, share = 0;  // [km2], of all cells that are compared [0, 1]
};

struct MapComparison {
  std::string first, second;                        // names of the maps
  double gravity = kGravity;                        // of both [m/s^2]
  std::vector<ComparedClass> change, significance;  // by PassChange, by GoChange
  std::string remark;                               // why there is no overlay for globes; empty: there is one
  std::vector<std::filesystem::path> files;
};

/// Writes change.tif, difference.tif (P2 - P1), significance.tif (z), change_significance.tif, compare.png (figure),
/// change.png, change.kml and compare.csv. Throws InputError for a folder without a map, for maps of different grids,
/// and for headings other than uphill.
MapComparison compare_maps(const CompareRequest& request);
/// { first, second, gravity, change: [{ class, cells, area_km2, share }], significance: likewise, remark, files }.
Json compare_json(const MapComparison& result);
std::string compare_text(const MapComparison& result);

}  // namespace gonogo::map
