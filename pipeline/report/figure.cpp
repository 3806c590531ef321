#include "pipeline/report/figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "pipeline/report/canvas.h"
#include "pipeline/report/figure_chart.h"
#include "pipeline/report/figure_panel.h"

namespace gonogo::pipeline {
namespace {

constexpr int kWidth = 2400;
constexpr double kMargin = 60, kHead = 240;
// Relief must not change what a colour means: weaker where colours are read against a ramp or a long legend.
constexpr double kMapRelief = 1.25, kSideRelief = 0.7;
constexpr Colour kFrame = {0.13, 0.13, 0.16, 1};
constexpr Colour kNothing = {0.80, 0.80, 0.84, 1};  // P(go) where there is none

std::string percent(double share) {
  char text[16];
  std::snprintf(text, sizeof text, share > 0 && share < 0.0005 ? "< 0.1 %%" : "%.1f %%", 100 * share);
  return text;
}

Palette class_palette(const std::vector<FigureClass>& classes) {
  std::array<Colour, 256> colours;
  colours.fill(kNothing);
  for (const FigureClass& entry : classes) colours[std::size_t(entry.code)] = colour_from(entry.colour);
  return [colours](float value) { return colours[std::size_t(value)]; };
}

Colour between_stops(const std::vector<FigureStop>& ramp, double value) {
  for (std::size_t i = 1; i < ramp.size(); ++i) {
    if (value > ramp[i].value && i + 1 < ramp.size()) continue;
    const double t = std::clamp((value - ramp[i - 1].value) / (ramp[i].value - ramp[i - 1].value), 0.0, 1.0);
    const Colour a = colour_from(ramp[i - 1].colour), b = colour_from(ramp[i].colour);
    return {a.red + t * (b.red - a.red), a.green + t * (b.green - a.green), a.blue + t * (b.blue - a.blue), 1};
  }
  return kNothing;
}

/// Values in [0, 1] by the ramp; below 0 the colour of cells that have none.
Palette ramp_palette(const std::vector<FigureStop>& ramp) {
  constexpr int steps = 1024;
  std::vector<Colour> colours;
  for (int i = 0; i <= steps; ++i) colours.push_back(between_stops(ramp, double(i) / steps));
  return [colours](float value) { return value < 0 ? kNothing : colours[std::size_t(std::min(1.0f, value) * steps)]; };
}

void draw_ramp(const Canvas& canvas, Box bar, const Palette& ramp) {
  const int steps = int(bar.height);
  for (int i = 0; i < steps; ++i)
    canvas.fill({bar.left, bar.bottom() - (i + 1) * bar.height / steps, bar.width, bar.height / steps + 0.5},
                ramp(float((i + 0.5) / steps)));
  canvas.outline(bar, kFrame, 2);
  for (const double p : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    char text[16];
    std::snprintf(text, sizeof text, "%g", p);
    const double y = bar.bottom() - p * bar.height;
    canvas.line(bar.right(), y, bar.right() + 8, y, kFrame, 2);
    canvas.text(bar.right() + 18, y + 9, text, 24);
  }
  canvas.fill({bar.left, bar.bottom() + 34, bar.width, 30}, kNothing);
  canvas.outline({bar.left, bar.bottom() + 34, bar.width, 30}, kFrame, 1.5);
  canvas.text(bar.right() + 18, bar.bottom() + 58, "no value", 24);
}

/// Swatch, label and share, and the area where `area_km2` is given; long labels take more lines.
void draw_legend(const Canvas& canvas, Box room, const std::vector<FigureClass>& classes, double size,
                 double area_km2 = 0) {
  const double numbers = canvas.text_width(area_km2 > 0 ? "100.0 %   10000.0 km\u00b2" : "100.0 %", size);
  double y = room.top;
  for (const FigureClass& entry : classes) {
    const Box swatch = {room.left, y, size * 1.6, size * 1.15};
    canvas.fill(swatch, colour_from(entry.colour));
    canvas.outline(swatch, kFrame, 1.5);
    const double label_left = swatch.right() + size * 0.6, baseline = y + size * 0.95;
    const double share_right =
        area_km2 > 0 ? room.right() - canvas.text_width("   10000.0 km\u00b2", size) : room.right();
    canvas.text(share_right, baseline, percent(entry.share), size, Align::right);
    char area[32];
    std::snprintf(area, sizeof area, "%.1f km\u00b2", entry.share * area_km2);
    if (area_km2 > 0) canvas.text(room.right(), baseline, area, size, Align::right);
    const auto lines = canvas.wrapped(entry.label, size, room.right() - numbers - label_left);
    for (std::size_t i = 0; i < lines.size(); ++i)
      canvas.text(label_left, baseline + 1.2 * size * double(i), lines[i], size);
    y += size * (1.75 + 1.2 * double(lines.size() - 1));
  }
}

void draw_side_panels(const Canvas& canvas, const MapFigure& figure, Box room) {
  constexpr double legend_width = 345, heading = 46;
  const double panel_height = (room.height - 2 * heading - 40) / 2;
  const Box p_box = fit_panel(figure.grid, {room.left, room.top + heading, room.width - legend_width, panel_height});
  canvas.text(room.left, room.top + 28, "P(go), probability of go or slow-go", 30, Align::left, true);
  // Cells without P(go) are drawn, not left white: white means no elevation.
  terrain::Tile p_go = figure.p_go;
  for (std::size_t i = 0; i < p_go.value.size(); ++i)
    if (std::isnan(p_go.value[i]) && !std::isnan(figure.verdict.value[i])) p_go.value[i] = -1;
  const Palette ramp = ramp_palette(figure.p_go_ramp);
  draw_cells(canvas, p_box, p_go, figure.shade, ramp, kSideRelief);
  draw_coordinates(canvas, p_box, figure.grid, false);
  draw_ramp(canvas, {p_box.right() + 36, p_box.top + 6, 42, std::clamp(p_box.height - 80, 200.0, 300.0)}, ramp);
  const double second = room.bottom() - p_box.height;
  const Box reason_box = {room.left, second, p_box.width, p_box.height};
  canvas.text(room.left, second - 18, "Likeliest reason", 30, Align::left, true);
  draw_cells(canvas, reason_box, figure.reason, figure.shade, class_palette(figure.reasons), kSideRelief);
  draw_coordinates(canvas, reason_box, figure.grid, false);
  draw_legend(canvas, {reason_box.right() + 24, reason_box.top + 4, room.right() - reason_box.right() - 24, 0},
              figure.reasons, 20);
}

void draw_notes(const Canvas& canvas, double top, const std::vector<std::string>& lines) {
  double y = top;
  for (const std::string& line : lines) canvas.text(kMargin, y += 30, line, 21);
}

std::vector<std::string> wrapped_notes(const MapFigure& figure) {
  const Canvas ruler(8, 8);
  std::vector<std::string> lines;
  for (const std::string& note : figure.notes)
    for (const std::string& line : ruler.wrapped(note, 21, kWidth - 2 * kMargin)) lines.push_back(line);
  return lines;
}

}  // namespace

void draw_map_figure(const std::filesystem::path& path, const MapFigure& figure) {
  constexpr double map_left = kMargin + 80, side_left = 1430, lower_height = 480;
  const Box map_box = fit_panel(figure.grid, {map_left, kHead, side_left - map_left - 70, 1500});
  const double side_height = std::max(map_box.height, 760.0);
  const double lower_top = kHead + side_height + 110;
  const std::vector<std::string> notes = wrapped_notes(figure);
  const Canvas canvas(kWidth, int(lower_top + lower_height + 30 + 30 * double(notes.size()) + 40));
  canvas.text(kMargin, 88, figure.title, 56, Align::left, true);
  canvas.text(kMargin, 144, figure.subtitle, 34);
  draw_cells(canvas, map_box, figure.verdict, figure.shade, class_palette(figure.classes), kMapRelief);
  draw_coordinates(canvas, map_box, figure.grid, true);
  draw_scale_and_north(canvas, map_box, figure.grid);
  draw_side_panels(canvas, figure, {side_left, kHead - 46, kWidth - kMargin - side_left, side_height + 46});
  canvas.text(kMargin, lower_top + 34, "Class and share of the area", 30, Align::left, true);
  draw_legend(canvas, {kMargin, lower_top + 66, 600, 0}, figure.classes, 30, figure.area_km2);
  canvas.text(800, lower_top + 34, "P(go) over slope, by soil and its share of the area", 30, Align::left, true);
  draw_curves(canvas, {760, lower_top + 50, kWidth - kMargin - 760, lower_height - 50}, figure);
  draw_notes(canvas, lower_top + lower_height + 20, notes);
  canvas.write_png(path);
}

}  // namespace gonogo::pipeline
