// Charts as PNG files: series side by side, curves and bands over one pair of axes, scatter plots, bars.
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

// Curves, bands and points over one pair of axes, as PNG.

struct PlotLine {
  std::string label = {};
  std::vector<double> x = {}, y = {};  // NaN breaks the line
  bool points = false;                 // dots instead of a line
  /// As long as y, or empty. A band from y to here replaces the line, bars replace the dots.
  std::vector<double> upper = {};
  int colour = -1;  // place in the palette; -1: that of the line among the lines

  void add(double at_x, double at_y) {
    x.push_back(at_x);
    y.push_back(at_y);
  }
};

struct LinePlot {
  std::string title{}, x_label{}, y_label{};
  std::vector<PlotLine> lines{};
  std::vector<std::string> notes{};  // below the axes, one line each
  bool from_zero = true;             // the axes begin at zero where all values are at or above it
};

/// Writes a PNG 1500 pixels wide. Throws InputError for a plot without a finite point, DeviceError when it cannot be
/// written.
void draw_line_plot(const std::filesystem::path& path, const LinePlot& plot);

// Rows of a table as points coloured by class: one pair of columns, or every pair beside histograms.

struct ScatterColumn {
  std::string label;
  std::vector<double> values;  // [rows]; rows with NaN are left out
};

struct ScatterClass {
  std::string label, colour;  // "#rrggbb"
};

struct ScatterTable {
  std::string title;
  std::vector<ScatterColumn> columns;
  std::vector<ScatterClass> classes;
  std::vector<int> class_of_row;  // position in `classes`
};

/// Points of columns x and y, written as a PNG. Throws DeviceError when it cannot be written.
void draw_scatter(const std::filesystem::path& path, const ScatterTable& table, std::size_t x, std::size_t y);

/// Every pair of columns below the diagonal, stacked histograms of each column on it.
void draw_pairs(const std::filesystem::path& path, const ScatterTable& table);

/// Horizontal bars, one for each label; several series are drawn side by side, each against its own largest value.
struct Bars {
  std::string title;
  std::vector<std::string> labels;
  std::vector<std::string> series;
  std::vector<std::vector<double>> values;  // [series][labels]
};
void draw_bars(const std::filesystem::path& path, const Bars& bars);

}  // namespace gonogo::report
