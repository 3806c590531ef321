// A validation figure: curves, and numbers held against bounds.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "pipeline/report/figure/chart.h"

namespace gonogo::lab {

/// One number and the bounds it must keep.
struct BoundedNumber {
  std::string key, claim;
  double low = 0, high = 0, measured = 0;
  bool holds() const { return measured >= low && measured <= high; }  // false for NaN
};

struct CheckFigure {
  std::string name;  // of its files
  std::string csv;   // the numbers of the plot, in SI units
  report::LinePlot plot{};
  std::vector<BoundedNumber> check{};
  std::string over_time{};  // the same over time: <name>_over_time.csv; empty: none
};

/// Measured numbers by key, each with its bounds and whether it keeps them.
Json as_json(const CheckFigure& figure);
std::string as_text(const CheckFigure& figure);
/// <name>.csv, <name>.json and, where the build has pictures, <name>.png.
void write_figure(const std::filesystem::path& folder, const CheckFigure& figure);

}  // namespace gonogo::lab
