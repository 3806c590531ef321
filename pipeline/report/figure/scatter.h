// Rows of a table as points coloured by class: one pair of columns, or every pair beside histograms.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace gonogo::report {

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
