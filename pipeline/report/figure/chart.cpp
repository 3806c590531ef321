#include "pipeline/report/figure/chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"
#include "pipeline/report/figure/canvas.h"

namespace gonogo::report {
namespace {

constexpr Colour kGrid = {0.87, 0.87, 0.9, 1}, kScatterGrid = {0.9, 0.9, 0.92, 1}, kMiddle = {0.55, 0.55, 0.6, 1};
constexpr double kLetters = 20, kPanelWidth = 720, kPanelHeight = 640;  // [pixel]

struct SeriesStyle {
  const char* colour;
  std::vector<double> dashes;
};

/// Okabe and Ito's colours (jfly.uni-koeln.de/color).
const SeriesStyle& style_of(std::size_t series) {
  static const std::array<SeriesStyle, 5> styles = {
      {{"#0072b2", {}}, {"#d55e00", {16, 8}}, {"#009e73", {5, 6}}, {"#8a8a8a", {22, 6, 5, 6}}, {"#cc79a7", {}}}};
  return styles[series % styles.size()];
}

std::string tick_text(double x) { return line("%.4g", std::fabs(x) < 1e-12 ? 0.0 : x); }

struct ChartAxes {
  Box box;
  const Chart& chart;
  double x(double value) const {
    const double share = chart.log_x ? std::log(value / chart.x_low) / std::log(chart.x_high / chart.x_low)
                                     : (value - chart.x_low) / (chart.x_high - chart.x_low);
    return box.left + share * box.width;
  }
  double y(double value) const {
    return box.bottom() - (value - chart.y_low) / (chart.y_high - chart.y_low) * box.height;
  }
};

/// Round numbers inside [low, high].
std::vector<double> ticks_inside(double low, double high) {
  const double step = tick_step(high - low);
  std::vector<double> ticks;
  for (double v = std::ceil(low / step - 1e-9) * step; v <= high + 1e-9 * step; v += step) ticks.push_back(v);
  return ticks;
}

std::vector<double> x_ticks(const Chart& chart) {
  return chart.log_x && !chart.series.empty() ? chart.series.front().x : ticks_inside(chart.x_low, chart.x_high);
}

void draw_axes(const Canvas& canvas, const ChartAxes& axes) {
  const Chart& chart = axes.chart;
  for (const double v : x_ticks(chart)) {
    canvas.line(axes.x(v), axes.box.top, axes.x(v), axes.box.bottom(), kGrid, 1);
    canvas.text(axes.x(v), axes.box.bottom() + 28, tick_text(v), kLetters, Align::centre);
  }
  for (const double v : ticks_inside(chart.y_low, chart.y_high)) {
    canvas.line(axes.box.left, axes.y(v), axes.box.right(), axes.y(v), kGrid, 1);
    canvas.text(axes.box.left - 12, axes.y(v) + 7, tick_text(v), kLetters, Align::right);
  }
  canvas.outline(axes.box, kFrame, 1.5);
  canvas.text(axes.box.left + axes.box.width / 2, axes.box.bottom() + 62, chart.x_label, kLetters, Align::centre);
  canvas.text(axes.box.left - 84, axes.box.top + axes.box.height / 2, chart.y_label, kLetters, Align::centre, false,
              true);
  canvas.text(axes.box.left, axes.box.top - 16, chart.title, kLetters, Align::left, true);
}

void draw_series(const Canvas& canvas, const ChartAxes& axes, const ChartSeries& series, const SeriesStyle& style) {
  const Colour colour = colour_from(style.colour);
  for (std::size_t k = 0; k < series.x.size(); ++k) {
    const double x = axes.x(series.x[k]), y = axes.y(series.y[k]);
    if (k + 1 < series.x.size())
      canvas.line(x, y, axes.x(series.x[k + 1]), axes.y(series.y[k + 1]), colour, 3, style.dashes);
    if (k < series.low.size()) {
      const double low = axes.y(series.low[k]), high = axes.y(series.high[k]);
      canvas.line(x, low, x, high, colour, 1.5);
      for (double end : {low, high}) canvas.line(x - 6, end, x + 6, end, colour, 1.5);
    }
    canvas.set(colour);
    cairo_new_path(canvas.cairo());
    cairo_arc(canvas.cairo(), x, y, 5, 0, 2 * kPi);
    cairo_fill(canvas.cairo());
  }
}

void draw_legend(const Canvas& canvas, const ChartAxes& axes) {
  double width = 0;
  for (const ChartSeries& series : axes.chart.series)
    width = std::max(width, canvas.text_width(series.label, kLetters));
  const double line = 28, height = line * double(axes.chart.series.size()) + 14;
  const double left = axes.chart.legend_right ? axes.box.right() - width - 98 : axes.box.left + 14;
  const Box box = {left, axes.box.top + 14, width + 84, height};
  canvas.fill(box, {1, 1, 1, 0.85});
  for (std::size_t s = 0; s < axes.chart.series.size(); ++s) {
    const double y = box.top + 22 + line * double(s);
    canvas.line(box.left + 10, y, box.left + 60, y, colour_from(style_of(s).colour), 3, style_of(s).dashes);
    canvas.text(box.left + 70, y + 7, axes.chart.series[s].label, kLetters);
  }
}

void draw_chart(const Canvas& canvas, Box room, const Chart& chart) {
  const ChartAxes axes = {{room.left + 110, room.top + 40, room.width - 150, room.height - 130}, chart};
  draw_axes(canvas, axes);
  if (chart.diagonal)
    canvas.line(axes.x(chart.x_low), axes.y(chart.x_low), axes.x(chart.x_high), axes.y(chart.x_high), kMiddle, 1.5);
  cairo_save(canvas.cairo());
  cairo_rectangle(canvas.cairo(), axes.box.left - 6, axes.box.top - 6, axes.box.width + 12, axes.box.height + 12);
  cairo_clip(canvas.cairo());
  for (std::size_t s = chart.series.size(); s-- > 0;) draw_series(canvas, axes, chart.series[s], style_of(s));
  cairo_restore(canvas.cairo());
  draw_legend(canvas, axes);
}

}  // namespace

void write_charts(const std::filesystem::path& path, const std::string& title, const std::vector<Chart>& charts) {
  const Canvas canvas(int(kPanelWidth * double(charts.size())), int(kPanelHeight) + 60);
  canvas.text(30, 44, title, 24, Align::left, true);
  for (std::size_t k = 0; k < charts.size(); ++k)
    draw_chart(canvas, {kPanelWidth * double(k), 60, kPanelWidth, kPanelHeight}, charts[k]);
  canvas.write_png(path);
}

namespace {

constexpr double kPlotLetters = 22;  // of letters
constexpr double kDot = 7;           // radius of points
constexpr int kPlotWidth = 1500, kPlotHeight = 820;

/// Okabe and Ito's colours (jfly.uni-koeln.de/color).
Colour colour_of(const LinePlot& plot, std::size_t line) {
  static const std::array<const char*, 8> colours = {"#0072b2", "#e69f00", "#009e73", "#d55e00",
                                                     "#56b4e9", "#cc79a7", "#000000", "#b8a800"};
  const int chosen = plot.lines[line].colour;
  return colour_from(colours[(chosen < 0 ? line : std::size_t(chosen)) % colours.size()]);
}

Colour faint(Colour c) {
  c.alpha = 0.22;
  return c;
}

struct Span {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
  void cover(double x) {
    if (std::isfinite(x)) {
      low = std::min(low, x);
      high = std::max(high, x);
    }
  }
};

struct PlotAxes {
  Box box;
  double x_low, x_high, y_low, y_high;
  double x(double v) const { return box.left + (v - x_low) / (x_high - x_low) * box.width; }
  double y(double v) const { return box.bottom() - (v - y_low) / (y_high - y_low) * box.height; }
};

std::string label_of(double v) { return line("%.6g", std::fabs(v) < 1e-12 ? 0.0 : v); }

void draw_axes(const Canvas& canvas, const PlotAxes& a, const LinePlot& plot, const std::vector<double>& xs,
               const std::vector<double>& ys) {
  for (const double v : xs) {
    canvas.line(a.x(v), a.box.top, a.x(v), a.box.bottom(), kGrid, 1.5);
    canvas.text(a.x(v), a.box.bottom() + 32, label_of(v), kPlotLetters, Align::centre);
  }
  for (const double v : ys) {
    canvas.line(a.box.left, a.y(v), a.box.right(), a.y(v), kGrid, 1.5);
    canvas.text(a.box.left - 12, a.y(v) + 8, label_of(v), kPlotLetters, Align::right);
  }
  canvas.text(a.box.left + a.box.width / 2, a.box.bottom() + 70, plot.x_label, kPlotLetters, Align::centre);
  canvas.text(a.box.left - 100, a.box.top + a.box.height / 2, plot.y_label, kPlotLetters, Align::centre, false, true);
  canvas.text(a.box.left, 48, plot.title, 28, Align::left, true);
}

void draw_points(const Canvas& canvas, const PlotAxes& a, const PlotLine& line) {
  cairo_t* cairo = canvas.cairo();
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    if (!std::isfinite(line.x[i]) || !std::isfinite(line.y[i])) continue;
    cairo_new_path(cairo);
    cairo_arc(cairo, a.x(line.x[i]), a.y(line.y[i]), kDot, 0, 6.2832);
    cairo_fill(cairo);
  }
}

void draw_curve(const Canvas& canvas, const PlotAxes& a, const PlotLine& line) {
  cairo_t* cairo = canvas.cairo();
  cairo_set_line_width(cairo, 3);
  cairo_new_path(cairo);
  bool broken = true;
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    const bool here = std::isfinite(line.x[i]) && std::isfinite(line.y[i]);
    if (here && broken) cairo_move_to(cairo, a.x(line.x[i]), a.y(line.y[i]));
    if (here && !broken) cairo_line_to(cairo, a.x(line.x[i]), a.y(line.y[i]));
    broken = !here;
  }
  cairo_stroke(cairo);
}

/// Faint, with its edges drawn thin.
void draw_band(const Canvas& canvas, const PlotAxes& a, const PlotLine& line, Colour colour) {
  cairo_t* cairo = canvas.cairo();
  cairo_new_path(cairo);
  for (std::size_t i = 0; i < line.x.size(); ++i) cairo_line_to(cairo, a.x(line.x[i]), a.y(line.y[i]));
  for (std::size_t i = line.x.size(); i-- > 0;) cairo_line_to(cairo, a.x(line.x[i]), a.y(line.upper[i]));
  cairo_close_path(cairo);
  canvas.set(faint(colour));
  cairo_fill_preserve(cairo);
  canvas.set(colour);
  cairo_set_line_width(cairo, 1.2);
  cairo_stroke(cairo);
}

/// One at every x, as wide as a dot.
void draw_bars(const Canvas& canvas, const PlotAxes& a, const PlotLine& line, Colour colour) {
  for (std::size_t i = 0; i < line.x.size(); ++i)
    canvas.line(a.x(line.x[i]), a.y(line.y[i]), a.x(line.x[i]), a.y(line.upper[i]), faint(colour), 2 * kDot);
}

void draw_line(const Canvas& canvas, const PlotAxes& a, const PlotLine& line, Colour colour) {
  if (!line.upper.empty()) return line.points ? draw_bars(canvas, a, line, colour) : draw_band(canvas, a, line, colour);
  canvas.set(colour);
  line.points ? draw_points(canvas, a, line) : draw_curve(canvas, a, line);
}

/// In the legend: a stroke of the curve, a piece of the band, or one of the points.
void draw_sample(const Canvas& canvas, double x, double y, const PlotLine& line, Colour colour) {
  if (!line.upper.empty()) return canvas.line(x, y, x + 40, y, faint(colour), 20);
  if (!line.points) return canvas.line(x, y, x + 40, y, colour, 4);
  canvas.set(colour);
  cairo_new_path(canvas.cairo());
  cairo_arc(canvas.cairo(), x + 20, y, kDot, 0, 6.2832);
  cairo_fill(canvas.cairo());
}

void draw_legend(const Canvas& canvas, const PlotAxes& a, const LinePlot& plot) {
  double y = a.box.top + 16;
  for (std::size_t k = 0; k < plot.lines.size(); ++k, y += 34) {
    if (plot.lines[k].label.empty()) continue;
    draw_sample(canvas, a.box.right() + 24, y, plot.lines[k], colour_of(plot, k));
    canvas.text(a.box.right() + 76, y + 8, plot.lines[k].label, 20);
  }
}

}  // namespace

void draw_line_plot(const std::filesystem::path& path, const LinePlot& plot) {
  Span x, y;
  for (const PlotLine& line : plot.lines)
    for (std::size_t i = 0; i < line.x.size(); ++i)
      if (std::isfinite(line.x[i]) && std::isfinite(line.y[i])) {
        x.cover(line.x[i]);
        y.cover(line.y[i]);
        if (!line.upper.empty()) y.cover(line.upper[i]);
      }
  if (!(x.high >= x.low)) throw InputError(path.string() + ": nothing to draw, every point is missing");
  if (plot.from_zero && x.low > 0) x.low = 0;
  if (plot.from_zero && y.low > 0) y.low = 0;
  const auto xs = axis_ticks(x.low, x.high, 8), ys = axis_ticks(y.low, y.high, 6);

  const Canvas canvas(kPlotWidth, kPlotHeight + 20 + int(30 * plot.notes.size()));
  double legend = 0;
  for (const PlotLine& line : plot.lines) legend = std::max(legend, canvas.text_width(line.label, 20));
  const double left = 150, top = 76, right = legend > 0 ? legend + 110 : 40;
  const PlotAxes axes = {.box = {left, top, kPlotWidth - left - right, kPlotHeight - top - 100},
                         .x_low = xs.front(),
                         .x_high = xs.back(),
                         .y_low = ys.front(),
                         .y_high = ys.back()};
  draw_axes(canvas, axes, plot, xs, ys);
  for (std::size_t k = 0; k < plot.lines.size(); ++k) draw_line(canvas, axes, plot.lines[k], colour_of(plot, k));
  canvas.outline(axes.box, kFrame, 2);
  draw_legend(canvas, axes, plot);
  double line = kPlotHeight + 10;
  for (const std::string& note : plot.notes) {
    canvas.text(left, line, note, 20);
    line += 30;
  }
  canvas.write_png(path);
}

namespace {

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
      canvas.line(box.left, y, box.right(), y, kScatterGrid, 1);
      canvas.text(box.left - 10, y + 7, line("%.6g", value), 20, Align::right);
    } else {
      const double x = box.left + range.share(value) * box.width;
      canvas.line(x, box.top, x, box.bottom(), kScatterGrid, 1);
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
