#include "pipeline/report/figure/scatter.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/line.h"
#include "pipeline/report/figure/canvas.h"
#include "pipeline/report/figure/ticks.h"

namespace gonogo::report {
namespace {

constexpr Colour kFrame = {0.13, 0.13, 0.16, 1}, kFaint = {0.9, 0.9, 0.92, 1};
constexpr int kBins = 16;

struct Range {
  double low = HUGE_VAL, high = -HUGE_VAL;
  double share(double value) const { return (value - low) / (high - low); }
};

Range range_of(const std::vector<double>& values) {
  Range range;
  for (const double value : values)
    if (std::isfinite(value)) range = {std::min(range.low, value), std::max(range.high, value)};
  if (!(range.high >= range.low)) range = {0, 1};
  if (range.high == range.low) range = {range.low - 0.5, range.high + 0.5};
  return range;
}

void draw_points(const Canvas& canvas, Box box, const ScatterTable& table, std::size_t x, std::size_t y, double size) {
  const std::vector<double>&xs = table.columns[x].values, &ys = table.columns[y].values;
  const Range across = range_of(xs), up = range_of(ys);
  for (std::size_t i = 0; i < xs.size(); ++i) {
    if (!std::isfinite(xs[i]) || !std::isfinite(ys[i])) continue;
    canvas.set(colour_from(table.classes[std::size_t(table.class_of_row[i])].colour, 0.8));
    cairo_new_path(canvas.cairo());
    cairo_arc(canvas.cairo(), box.left + across.share(xs[i]) * box.width, box.bottom() - up.share(ys[i]) * box.height,
              size, 0, 6.2832);
    cairo_fill(canvas.cairo());
  }
  canvas.outline(box, kFrame, 1.5);
}

void draw_histogram(const Canvas& canvas, Box box, const ScatterTable& table, std::size_t column) {
  const std::vector<double>& values = table.columns[column].values;
  const Range range = range_of(values);
  std::vector<std::vector<int>> counts(kBins, std::vector<int>(table.classes.size(), 0));
  std::vector<int> sums(kBins, 0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    const auto bin = std::size_t(std::clamp(int(range.share(values[i]) * kBins), 0, kBins - 1));
    ++counts[bin][std::size_t(table.class_of_row[i])];
    ++sums[bin];
  }
  const double largest = std::max(1, *std::max_element(sums.begin(), sums.end()));
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    double bottom = box.bottom();
    for (std::size_t k = 0; k < table.classes.size(); ++k) {
      const double height = 0.95 * box.height * counts[bin][k] / largest;
      canvas.fill({box.left + double(bin) * box.width / kBins, bottom - height, box.width / kBins - 1, height},
                  colour_from(table.classes[k].colour));
      bottom -= height;
    }
  }
  canvas.outline(box, kFrame, 1.5);
}

std::string legend_text(const ScatterTable& table, std::size_t k) {
  const auto rows = std::count(table.class_of_row.begin(), table.class_of_row.end(), int(k));
  return table.classes[k].label + line(" (%td)", rows);
}

void draw_legend(const Canvas& canvas, double left, double top, const ScatterTable& table) {
  for (std::size_t k = 0; k < table.classes.size(); ++k) {
    canvas.fill({left, top + 32 * double(k), 22, 22}, colour_from(table.classes[k].colour));
    canvas.text(left + 32, top + 32 * double(k) + 19, legend_text(table, k), 20);
  }
}

/// Pixels from the legend's left edge to the end of its longest line.
double legend_width(const ScatterTable& table) {
  const Canvas measure(1, 1);
  double width = 0;
  for (std::size_t k = 0; k < table.classes.size(); ++k)
    width = std::max(width, 32 + measure.text_width(legend_text(table, k), 20));
  return width;
}

void draw_ticks(const Canvas& canvas, Box box, Range range, bool upright) {
  for (const double value : axis_ticks(range.low, range.high, 6)) {
    if (value < range.low || value > range.high) continue;
    if (upright) {
      const double y = box.bottom() - range.share(value) * box.height;
      canvas.line(box.left, y, box.right(), y, kFaint, 1);
      canvas.text(box.left - 10, y + 7, line("%.6g", value), 20, Align::right);
    } else {
      const double x = box.left + range.share(value) * box.width;
      canvas.line(x, box.top, x, box.bottom(), kFaint, 1);
      canvas.text(x, box.bottom() + 28, line("%.6g", value), 20, Align::centre);
    }
  }
}

}  // namespace

void draw_scatter(const std::filesystem::path& path, const ScatterTable& table, std::size_t x, std::size_t y) {
  const Box box{150, 90, 960, 790};
  const Canvas canvas(std::max(1400, int(box.right() + 48 + legend_width(table))), 1000);
  canvas.text(box.left, 50, table.title, 28, Align::left, true);
  draw_ticks(canvas, box, range_of(table.columns[x].values), false);
  draw_ticks(canvas, box, range_of(table.columns[y].values), true);
  draw_points(canvas, box, table, x, y, table.class_of_row.size() > 2000 ? 3 : 6);
  canvas.text(box.left + box.width / 2, box.bottom() + 70, table.columns[x].label, 22, Align::centre);
  canvas.text(50, box.top + box.height / 2, table.columns[y].label, 22, Align::centre, false, true);
  draw_legend(canvas, box.right() + 24, box.top, table);
  canvas.write_png(path);
}

void draw_pairs(const std::filesystem::path& path, const ScatterTable& table) {
  const std::size_t count = table.columns.size();
  const double side = 210, gap = 14, left = 60, top = 90;
  const int size = int(left + double(count) * (side + gap)) + 40;
  const Canvas canvas(std::max(size, 700), int(top) + size + 20);
  canvas.text(left, 50, table.title, 28, Align::left, true);
  for (std::size_t row = 0; row < count; ++row) {
    const double y = top + double(row) * (side + gap);
    for (std::size_t column = 0; column < row; ++column)
      draw_points(canvas, {left + double(column) * (side + gap), y, side, side}, table, column, row,
                  table.class_of_row.size() > 1000 ? 1.5 : 3);
    draw_histogram(canvas, {left + double(row) * (side + gap), y, side, side}, table, row);
    canvas.text(left - 20, y + side / 2, table.columns[row].label, 18, Align::centre, false, true);
    canvas.text(left + double(row) * (side + gap) + side / 2, top + double(count) * (side + gap) + 16,
                table.columns[row].label, 18, Align::centre);
  }
  draw_legend(canvas, std::max(left + double(count) * (side + gap), 700.0) - 240, top, table);
  canvas.write_png(path);
}

void draw_bars(const std::filesystem::path& path, const Bars& bars) {
  const double label = 300, width = 420, gap = 90, height = 34, top = 130;
  const Canvas canvas(int(label + double(bars.series.size()) * (width + gap)) + 40,
                      int(top + height * double(bars.labels.size())) + 40);
  canvas.text(30, 50, bars.title, 28, Align::left, true);
  for (std::size_t s = 0; s < bars.series.size(); ++s) {
    const double left = label + double(s) * (width + gap);
    const double largest = std::max(1e-12, *std::max_element(bars.values[s].begin(), bars.values[s].end()));
    canvas.text(left, top - 20, bars.series[s], 20);
    for (std::size_t i = 0; i < bars.labels.size(); ++i) {
      const double y = top + height * double(i);
      if (s == 0) canvas.text(label - 14, y + 22, bars.labels[i], 20, Align::right);
      const double length = width * std::max(0.0, bars.values[s][i]) / largest;
      canvas.fill({left, y + 4, length, height - 8}, colour_from("#0072b2"));
      canvas.text(left + length + 8, y + 22, line("%.3g", bars.values[s][i]), 18);
    }
  }
  canvas.write_png(path);
}

}  // namespace gonogo::report
