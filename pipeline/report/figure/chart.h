// Line charts side by side as one PNG: series of points with error bars, told apart by colour, dashes and marks.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace gonogo::report {

struct ChartSeries {
  std::string label;
  std::vector<double> x, y;
  std::vector<double> low, high;  // ends of the error bars; empty: none
};

struct Chart {
  std::string title, x_label, y_label;
  double x_low = 0, x_high = 1, y_low = 0, y_high = 1;
  bool diagonal = false;      // a thin line y = x
  bool log_x = false;         // logarithmic x axis, with ticks at the places of the first series; x_low above 0
  bool legend_right = false;  // for curves that fall; left is for those that rise
  std::vector<ChartSeries> series;
};

/// Throws DeviceError when the file cannot be written.
void write_charts(const std::filesystem::path& path, const std::string& title, const std::vector<Chart>& charts);

}  // namespace gonogo::report
