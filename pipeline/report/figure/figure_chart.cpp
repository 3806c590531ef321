#include "pipeline/report/figure/figure_chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "base/units.h"

namespace gonogo::report {
namespace {

constexpr Colour kFrame = {0.13, 0.13, 0.16, 1};
constexpr double kSize = 24;  // of letters

struct LineStyle {
  const char* colour;
  std::vector<double> dashes;
};

/// Okabe and Ito's colours (jfly.uni-koeln.de/color) without the reddish ones; dashes tell lines apart that coincide.
const LineStyle& style_of(std::size_t curve) {
  static const std::array<LineStyle, 6> styles = {{{"#0072b2", {}},
                                                   {"#e69f00", {22, 12}},
                                                   {"#009e73", {8, 8}},
                                                   {"#56b4e9", {30, 8, 8, 8}},
                                                   {"#000000", {4, 8}},
                                                   {"#b8a800", {40, 14}}}};
  return styles[curve % styles.size()];
}

std::string label_of(double x, const char* format = "%g") {
  char text[32];
  std::snprintf(text, sizeof text, format, x);
  return text;
}

struct Axes {
  Box box;
  double slope_end;  // [deg]
  double x(double slope_deg) const { return box.left + slope_deg / slope_end * box.width; }
  double y(double p) const { return box.bottom() - p * box.height; }
};

void draw_axes(const Canvas& canvas, const Axes& axes) {
  constexpr Colour faint = {0.85, 0.85, 0.88, 1};
  for (const double p : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}) {
    canvas.line(axes.box.left, axes.y(p), axes.box.right(), axes.y(p), faint, 1.5);
    canvas.text(axes.box.left - 14, axes.y(p) + 9, label_of(p), kSize, Align::right);
  }
  for (double slope = 0; slope <= axes.slope_end; slope += 5) {
    canvas.line(axes.x(slope), axes.box.bottom(), axes.x(slope), axes.box.bottom() + 9, kFrame, 2);
    canvas.text(axes.x(slope), axes.box.bottom() + 36, label_of(slope) + "\u00b0", kSize, Align::centre);
  }
  for (const double grade : {0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0, 100.0}) {
    const double slope = to_degrees(std::atan(grade / 100));
    if (slope > axes.slope_end) break;
    canvas.line(axes.x(slope), axes.box.top - 9, axes.x(slope), axes.box.top, kFrame, 2);
    canvas.text(axes.x(slope), axes.box.top - 18, label_of(grade) + " %", kSize, Align::centre);
  }
  canvas.text(axes.box.left - 78, axes.box.top + axes.box.height / 2, "P(go)", kSize, Align::centre, false, true);
  canvas.text(axes.box.left + axes.box.width / 2, axes.box.bottom() + 74,
              "uphill slope: degrees below, per cent grade above", kSize, Align::centre);
}

/// The name stands where no curve can be: beyond the steepest sampled slope.
void draw_threshold(const Canvas& canvas, const Axes& axes, double p, const std::string& name, double below) {
  canvas.line(axes.box.left, axes.y(p), axes.box.right(), axes.y(p), {0.3, 0.3, 0.34, 1}, 2, {4, 7});
  const double width = canvas.text_width(name, 20) + 12, top = axes.y(p) + below;
  canvas.fill({axes.box.right() - width - 4, top, width, 26}, {1, 1, 1, 1});
  canvas.text(axes.box.right() - 10, top + 20, name, 20, Align::right);
}

void draw_unsampled(const Canvas& canvas, const Axes& axes, double steepest) {
  if (steepest >= axes.slope_end) return;
  const Box box = {axes.x(steepest), axes.box.top, axes.box.right() - axes.x(steepest), axes.box.height};
  canvas.fill(box, {0.93, 0.93, 0.95, 1});
  canvas.hatch(box, {0.72, 0.72, 0.77, 1}, 18);
}

void draw_line(const Canvas& canvas, const Axes& axes, const FigureCurve& curve, const LineStyle& style) {
  cairo_t* cairo = canvas.cairo();
  canvas.set(colour_from(style.colour));
  cairo_set_line_width(cairo, 5);
  cairo_set_dash(cairo, style.dashes.data(), int(style.dashes.size()), 0);
  cairo_new_path(cairo);
  bool broken = true;
  for (std::size_t i = 0; i < curve.slope_deg.size(); ++i) {
    if (std::isnan(curve.p_go[i])) {
      broken = true;
      continue;
    }
    const double x = axes.x(curve.slope_deg[i]), y = axes.y(curve.p_go[i]);
    if (broken)
      cairo_move_to(cairo, x, y);
    else
      cairo_line_to(cairo, x, y);
    broken = false;
  }
  cairo_stroke(cairo);
  cairo_set_dash(cairo, nullptr, 0, 0);
}

}  // namespace

void draw_curves(const Canvas& canvas, Box room, const MapFigure& figure) {
  double legend_width = 0;
  for (const FigureCurve& curve : figure.curves)
    legend_width = std::max(legend_width, canvas.text_width(curve.label, kSize));
  legend_width = std::max(legend_width, canvas.text_width("steeper than sampled", kSize)) + 120;
  const double end = std::max(10.0, 5 * std::ceil((figure.steepest_sampled_deg + 4) / 5));
  const Axes axes = {{room.left + 100, room.top + 50, room.width - 100 - legend_width, room.height - 50 - 90}, end};
  draw_axes(canvas, axes);
  draw_unsampled(canvas, axes, figure.steepest_sampled_deg);
  draw_threshold(canvas, axes, figure.go_threshold, "go", -30);
  draw_threshold(canvas, axes, figure.no_go_threshold, "no-go", 4);
  for (std::size_t c = figure.curves.size(); c-- > 0;) draw_line(canvas, axes, figure.curves[c], style_of(c));
  canvas.outline(axes.box, kFrame, 2.5);
  double y = axes.box.top + 20;
  for (std::size_t c = 0; c < figure.curves.size(); ++c, y += 42) {
    const LineStyle& style = style_of(c);
    canvas.line(axes.box.right() + 30, y, axes.box.right() + 98, y, colour_from(style.colour), 5, style.dashes);
    canvas.text(axes.box.right() + 114, y + 9, figure.curves[c].label, kSize);
  }
  const Box swatch = {axes.box.right() + 42, y - 13, 44, 28};
  canvas.fill(swatch, {0.93, 0.93, 0.95, 1});
  canvas.hatch(swatch, {0.72, 0.72, 0.77, 1}, 12);
  canvas.text(axes.box.right() + 114, y + 9, "steeper than sampled", kSize);
}

}  // namespace gonogo::report
