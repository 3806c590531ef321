// Curves, bands and points over one pair of axes, as PNG: the picture of a test. Knows nothing of what it draws.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace gonogo::report {

struct PlotLine {
  std::string label;
  std::vector<double> x, y;       // a not-a-number breaks the line
  bool points = false;            // dots instead of a line
  std::vector<double> most = {};  // from y to it a band instead of a line, or bars instead of dots; as long as y
  int colour = -1;                // place in the palette, to share one; -1: its own place among the lines
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
