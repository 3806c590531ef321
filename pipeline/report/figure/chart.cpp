#include "pipeline/report/figure/chart.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "base/units.h"
#include "pipeline/report/figure/canvas.h"
#include "pipeline/report/figure/ticks.h"

namespace gonogo::report {
namespace {

constexpr Colour kFrame = {0.13, 0.13, 0.16, 1}, kFaint = {0.87, 0.87, 0.9, 1}, kMiddle = {0.55, 0.55, 0.6, 1};
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

std::string number_text(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", std::fabs(x) < 1e-12 ? 0.0 : x);
  return text;
}

struct Axes {
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

void draw_axes(const Canvas& canvas, const Axes& axes) {
  const Chart& chart = axes.chart;
  for (const double v : x_ticks(chart)) {
    canvas.line(axes.x(v), axes.box.top, axes.x(v), axes.box.bottom(), kFaint, 1);
    canvas.text(axes.x(v), axes.box.bottom() + 28, number_text(v), kLetters, Align::centre);
  }
  for (const double v : ticks_inside(chart.y_low, chart.y_high)) {
    canvas.line(axes.box.left, axes.y(v), axes.box.right(), axes.y(v), kFaint, 1);
    canvas.text(axes.box.left - 12, axes.y(v) + 7, number_text(v), kLetters, Align::right);
  }
  canvas.outline(axes.box, kFrame, 1.5);
  canvas.text(axes.box.left + axes.box.width / 2, axes.box.bottom() + 62, chart.x_label, kLetters, Align::centre);
  canvas.text(axes.box.left - 84, axes.box.top + axes.box.height / 2, chart.y_label, kLetters, Align::centre, false,
              true);
  canvas.text(axes.box.left, axes.box.top - 16, chart.title, kLetters, Align::left, true);
}

void draw_series(const Canvas& canvas, const Axes& axes, const ChartSeries& series, const SeriesStyle& style) {
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

void draw_legend(const Canvas& canvas, const Axes& axes) {
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
  const Axes axes = {{room.left + 110, room.top + 40, room.width - 150, room.height - 130}, chart};
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

}  // namespace gonogo::report
