#include "pipeline/report/figure/line_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/error.h"
#include "pipeline/report/figure/canvas.h"
#include "pipeline/report/figure/ticks.h"

namespace gonogo::report {
namespace {

constexpr Colour kFrame = {0.13, 0.13, 0.16, 1}, kFaint = {0.87, 0.87, 0.9, 1};
constexpr double kSize = 22;  // of letters
constexpr double kDot = 7;    // radius of points
constexpr int kWidth = 1500, kPlotHeight = 820;

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

struct Axes {
  Box box;
  double x_low, x_high, y_low, y_high;
  double x(double v) const { return box.left + (v - x_low) / (x_high - x_low) * box.width; }
  double y(double v) const { return box.bottom() - (v - y_low) / (y_high - y_low) * box.height; }
};

std::string label_of(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", std::fabs(v) < 1e-12 ? 0.0 : v);
  return text;
}

void draw_axes(const Canvas& canvas, const Axes& a, const LinePlot& plot, const std::vector<double>& xs,
               const std::vector<double>& ys) {
  for (const double v : xs) {
    canvas.line(a.x(v), a.box.top, a.x(v), a.box.bottom(), kFaint, 1.5);
    canvas.text(a.x(v), a.box.bottom() + 32, label_of(v), kSize, Align::centre);
  }
  for (const double v : ys) {
    canvas.line(a.box.left, a.y(v), a.box.right(), a.y(v), kFaint, 1.5);
    canvas.text(a.box.left - 12, a.y(v) + 8, label_of(v), kSize, Align::right);
  }
  canvas.text(a.box.left + a.box.width / 2, a.box.bottom() + 70, plot.x_label, kSize, Align::centre);
  canvas.text(a.box.left - 100, a.box.top + a.box.height / 2, plot.y_label, kSize, Align::centre, false, true);
  canvas.text(a.box.left, 48, plot.title, 28, Align::left, true);
}

void draw_points(const Canvas& canvas, const Axes& a, const PlotLine& line) {
  cairo_t* cairo = canvas.cairo();
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    if (!std::isfinite(line.x[i]) || !std::isfinite(line.y[i])) continue;
    cairo_new_path(cairo);
    cairo_arc(cairo, a.x(line.x[i]), a.y(line.y[i]), kDot, 0, 6.2832);
    cairo_fill(cairo);
  }
}

void draw_curve(const Canvas& canvas, const Axes& a, const PlotLine& line) {
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
void draw_band(const Canvas& canvas, const Axes& a, const PlotLine& line, Colour colour) {
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
void draw_bars(const Canvas& canvas, const Axes& a, const PlotLine& line, Colour colour) {
  for (std::size_t i = 0; i < line.x.size(); ++i)
    canvas.line(a.x(line.x[i]), a.y(line.y[i]), a.x(line.x[i]), a.y(line.upper[i]), faint(colour), 2 * kDot);
}

void draw(const Canvas& canvas, const Axes& a, const PlotLine& line, Colour colour) {
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

void draw_legend(const Canvas& canvas, const Axes& a, const LinePlot& plot) {
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

  const Canvas canvas(kWidth, kPlotHeight + 20 + int(30 * plot.notes.size()));
  double legend = 0;
  for (const PlotLine& line : plot.lines) legend = std::max(legend, canvas.text_width(line.label, 20));
  const double left = 150, top = 76, right = legend > 0 ? legend + 110 : 40;
  const Axes axes = {.box = {left, top, kWidth - left - right, kPlotHeight - top - 100},
                     .x_low = xs.front(),
                     .x_high = xs.back(),
                     .y_low = ys.front(),
                     .y_high = ys.back()};
  draw_axes(canvas, axes, plot, xs, ys);
  for (std::size_t k = 0; k < plot.lines.size(); ++k) draw(canvas, axes, plot.lines[k], colour_of(plot, k));
  canvas.outline(axes.box, kFrame, 2);
  draw_legend(canvas, axes, plot);
  double line = kPlotHeight + 10;
  for (const std::string& note : plot.notes) {
    canvas.text(left, line, note, 20);
    line += 30;
  }
  canvas.write_png(path);
}

}  // namespace gonogo::report
