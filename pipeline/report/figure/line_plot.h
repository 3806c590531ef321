// Curves, bands and points over one pair of axes, as PNG.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace gonogo::report {

struct PlotLine {
  std::string label = {};
  std::vector<double> x = {}, y = {};  // NaN breaks the line
  bool points = false;                 // dots instead of a line
  /// As long as y, or empty. A band from y to here replaces the line, bars replace the dots.
  std::vector<double> upper = {};
  int colour = -1;  // place in the palette; -1: that of the line among the lines
};

struct LinePlot {
  std::string title, x_label, y_label;
  std::vector<PlotLine> lines;
  std::vector<std::string> notes;  // below the axes, one line each
  bool from_zero = true;           // the axes begin at zero where all values are at or above it
};

/// Writes a PNG 1500 pixels wide. Throws InputError for a plot without a finite point, DeviceError when it cannot be
/// written.
void draw_line_plot(const std::filesystem::path& path, const LinePlot& plot);

}  // namespace gonogo::report
