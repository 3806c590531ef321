#include "pipeline/report/figure/figure_legend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace gonogo::report {
namespace {

std::string percent(double share) {
  char text[16];
  std::snprintf(text, sizeof text, share > 0 && share < 0.0005 ? "< 0.1 %%" : "%.1f %%", 100 * share);
  return text;
}

Colour between_stops(const std::vector<FigureStop>& ramp, double value) {
  for (std::size_t i = 1; i < ramp.size(); ++i) {
    if (value > ramp[i].value && i + 1 < ramp.size()) continue;
    const double t = std::clamp((value - ramp[i - 1].value) / (ramp[i].value - ramp[i - 1].value), 0.0, 1.0);
    const Colour a = colour_from(ramp[i - 1].colour), b = colour_from(ramp[i].colour);
    return {a.red + t * (b.red - a.red), a.green + t * (b.green - a.green), a.blue + t * (b.blue - a.blue), 1};
  }
  return kNoValue;
}

}  // namespace

Palette class_palette(const std::vector<FigureClass>& classes) {
  std::array<Colour, 256> colours;
  colours.fill(kNoValue);
  for (const FigureClass& entry : classes) colours[std::size_t(entry.code)] = colour_from(entry.colour);
  return [colours](float value) { return colours[std::size_t(value)]; };
}

Palette ramp_palette(const std::vector<FigureStop>& ramp) {
  constexpr int steps = 1024;
  const double low = ramp.front().value, high = ramp.back().value;
  std::vector<Colour> colours;
  for (int i = 0; i <= steps; ++i) colours.push_back(between_stops(ramp, low + (high - low) * i / steps));
  return [=](float value) {
    return value < low ? kNoValue : colours[std::size_t(std::min(1.0, (value - low) / (high - low)) * steps)];
  };
}

void draw_ramp(const Canvas& canvas, Box bar, const std::vector<FigureStop>& ramp) {
  const Palette palette = ramp_palette(ramp);
  const int steps = int(bar.height);
  const double low = ramp.front().value, high = ramp.back().value;
  for (int i = 0; i < steps; ++i)
    canvas.fill({bar.left, bar.bottom() - (i + 1) * bar.height / steps, bar.width, bar.height / steps + 0.5},
                palette(float(low + (high - low) * (i + 0.5) / steps)));
  canvas.outline(bar, kFrame, 2);
  for (int k = 0; k <= 4; ++k) {
    char text[16];
    std::snprintf(text, sizeof text, "%g", low + (high - low) * k / 4);
    const double y = bar.bottom() - k / 4.0 * bar.height;
    canvas.line(bar.right(), y, bar.right() + 8, y, kFrame, 2);
    canvas.text(bar.right() + 18, y + 9, text, 24);
  }
  canvas.fill({bar.left, bar.bottom() + 34, bar.width, 30}, kNoValue);
  canvas.outline({bar.left, bar.bottom() + 34, bar.width, 30}, kFrame, 1.5);
  canvas.text(bar.right() + 18, bar.bottom() + 58, "no value", 24);
}

namespace {

/// With one decimal; a little that there is never reads as nothing.
std::string square_kilometres(double area) {
  if (area > 0 && area < 0.05) return "< 0.1 km\u00b2";
  char text[32];
  std::snprintf(text, sizeof text, "%.1f km\u00b2", area);
  return text;
}

}  // namespace

void draw_legend(const Canvas& canvas, Box room, const std::vector<FigureClass>& classes, double size,
                 double area_km2) {
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
    if (area_km2 > 0)
      canvas.text(room.right(), baseline, square_kilometres(entry.share * area_km2), size, Align::right);
    const auto lines = canvas.wrapped(entry.label, size, room.right() - numbers - label_left);
    for (std::size_t i = 0; i < lines.size(); ++i)
      canvas.text(label_left, baseline + 1.2 * size * double(i), lines[i], size);
    y += size * (1.75 + 1.2 * double(lines.size() - 1));
  }
}

void draw_notes(const Canvas& canvas, double left, double top, const std::vector<std::string>& lines) {
  double y = top;
  for (const std::string& line : lines) canvas.text(left, y += 30, line, 21);
}

std::vector<std::string> wrapped_notes(const std::vector<std::string>& notes, double width) {
  const Canvas ruler(8, 8);
  std::vector<std::string> lines;
  for (const std::string& note : notes)
    for (const std::string& line : ruler.wrapped(note, 21, width)) lines.push_back(line);
  return lines;
}

terrain::Tile marked_where_missing(terrain::Tile value, const terrain::Tile& there) {
  for (std::size_t i = 0; i < value.value.size(); ++i)
    if (std::isnan(value.value[i]) && !std::isnan(there.value[i])) value.value[i] = kMissing;
  return value;
}

}  // namespace gonogo::report
